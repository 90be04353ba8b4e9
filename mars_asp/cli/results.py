"""Findings for other programs: results of a run, printed after all files were read."""

import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from mars_asp.cli.diagnostic_text import Suggestion
from mars_asp.cli.selection import Hidden, Selected
from mars_asp.diagnostic import Diagnostic
from mars_asp.reasoning.analysis import Consequence, diagnostic


class Result(NamedTuple):
    """A diagnostic, with its consequence if a rule found it.

    `hidden` is the reason for not reporting it, `is_new` whether the baseline lacks it (None
    without a baseline), and `suggestion` its repair if there is exactly one.
    """

    diagnostic: Diagnostic
    consequence: Consequence | None = None
    hidden: Hidden | None = None
    is_new: bool | None = None
    suggestion: Suggestion | None = None

    @property
    def has_file(self) -> bool:
        """Whether the location is in a file, and not in the command line or standard input."""
        path = self.diagnostic.span.path
        return path != "-" and not path.startswith("<") and not self.is_of_command

    @property
    def is_of_command(self) -> bool:
        """Whether the result is about the command line."""
        return self.diagnostic.span.path.startswith("--")


def results_of(selected: Selected) -> Iterator[Result]:
    """Yield results for the reported and hidden findings of a file, and for remarks."""
    is_new = True if selected.is_compared else None
    for each in selected.shown:
        yield Result(diagnostic(each), each, None, is_new)
    for hidden in selected.hidden:
        state = not hidden.is_known if selected.is_compared else None
        yield Result(diagnostic(hidden.consequence), hidden.consequence, hidden, state)
    yield from map(Result, selected.remarks)


@cache
def root_of(here: Path) -> Path:
    """Return the repository's root, to which paths are relative, or `here` outside of one."""
    for folder in (here, *here.parents):
        if (folder / ".git").exists():
            return folder
    return here


def seen_from_root(path: str) -> tuple[str, bool]:
    """Return a path relative to the root, or absolute if outside, and whether it is inside."""
    whole = Path(os.path.abspath(path))  # noqa: PTH100 -- links stay as they are named
    root = root_of(Path.cwd())
    if whole.is_relative_to(root):
        return whole.relative_to(root).as_posix(), True
    return whole.as_posix(), False
