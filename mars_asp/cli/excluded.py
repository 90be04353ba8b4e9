"""Paths in a folder that are passed over: by git, by the settings and by options."""

import argparse
import os
import re
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from pathspec import GitIgnoreSpec

from mars_asp.cli.settings import settings_of
from mars_asp.diagnostic import MarsError
from mars_asp.language.parse import plain_lines, read_text

#: A pattern with many asterisks in one name, or many folders of any depth. The time to compare it
#: grows with the length of the name to the power of their number.
_SLOW = re.compile(r"(?:\*[^/*]+){3}\*|(?:\*\*[^*]+){3}\*\*|.{500}")
#: Patterns, as in `.gitignore`, and the folder that they are relative to.
_Patterns = tuple[Path, GitIgnoreSpec]


class Excluded:
    """Decides which paths below a folder are skipped."""

    def __init__(self, root: Path, more: Sequence[tuple[Path, Sequence[str]]] = ()) -> None:
        """Store the folder, and further patterns with the folders that they are relative to.

        A pattern that matches the folder itself has no effect in it.
        """
        self._given, self._root = root, root.resolve()
        self._read: dict[Path, tuple[_Patterns, ...]] = {}
        around = (self._root, *self._root.parents)
        self._is_in_git = any(map(_is_git_root, around))
        patterns = [(at.resolve(), _spec_of_lines(tuple(of))) for at, of in more]
        self._besides = tuple(each for each in patterns if not self._names_root(each))

    def __call__(self, path: Path, is_folder: bool) -> bool:
        """Whether to skip a path; `is_folder` is whether it is a folder."""
        is_given = path.is_relative_to(self._given)
        whole = self._root / path.relative_to(self._given) if is_given else path
        written = f"{whole.as_posix()}{'/' * is_folder}"
        for at, spec in reversed((*self._of_git(whole.parent), *self._besides)):
            above = f"{at.as_posix().rstrip('/')}/"
            if written.startswith(above):
                found = spec.check_file(written[len(above) :])
                if found.include is not None:
                    return found.include
        return False

    def _of_git(self, folder: Path) -> tuple[_Patterns, ...]:
        """Return the patterns of `.gitignore` files that apply in a folder, the innermost last."""
        if folder not in self._read:
            is_top = _is_git_root(folder) or folder == folder.parent
            is_read = self._is_in_git or folder.is_relative_to(self._root)
            above = () if is_top or not is_read else self._of_git(folder.parent)
            files = (folder / ".git" / "info" / "exclude", folder / ".gitignore")
            own = [(folder, _spec_of(file)) for file in files if is_read and file.is_file()]
            self._read[folder] = (*above, *(each for each in own if not self._names_root(each)))
        return self._read[folder]

    def _names_root(self, patterns: _Patterns) -> bool:
        at, spec = patterns
        inner = self._root.relative_to(at).as_posix() if at in self._root.parents else ""
        return bool(inner) and spec.check_file(f"{inner}/").include is True


def _is_git_root(folder: Path) -> bool:
    return os.path.exists(folder / ".git")  # noqa: PTH110 -- false in a folder that is closed


def _spec_of(file: Path) -> GitIgnoreSpec:
    try:
        return _spec_of_lines(tuple(plain_lines(read_text(file)).split("\n")))
    except MarsError:
        return _spec_of_lines(())


# A folder is searched and then each workspace in it; some files have thousands of patterns.
@lru_cache(maxsize=64)
def _spec_of_lines(lines: tuple[str, ...]) -> GitIgnoreSpec:
    """Return the patterns of lines, without those that are very slow to match."""
    quick = [line for line in lines if not _SLOW.search(line)]
    try:
        return GitIgnoreSpec.from_lines(quick)
    except ValueError:
        # Git ignores invalid patterns, such as a lone `!`.
        return GitIgnoreSpec.from_lines(filter(_is_pattern, quick))


def _is_pattern(line: str) -> bool:
    try:
        GitIgnoreSpec.from_lines([line])
    except ValueError:
        return False
    return True


def excluded_in(
    arguments: argparse.Namespace, root: Path, settings_folder: Path | None = None
) -> Excluded:
    """Return the exclusions below `root`, by options and by the settings for the folder.

    Raises:
        MarsError: the settings of the folder are wrong.
    """
    settings = settings_of(arguments, settings_folder or root)
    own = [(Path(settings.path).parent, settings.exclude)] if settings.exclude else []
    typed = [_anchored(each) for each in getattr(arguments, "exclude", ())]
    return Excluded(root, [*own, (Path(), typed)])


def _anchored(pattern: str) -> str:
    """Return a pattern in the form of `.gitignore`; absolute and `./` paths become anchored."""
    if pattern.startswith("./"):
        return pattern[1:]
    here = f"{Path.cwd()}/"
    return pattern[len(here) - 1 :] if pattern.startswith(here) else pattern


def add_exclusion(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that search folders."""
    parser.add_argument("--exclude", metavar="PATTERN", action="append", default=[])
    parser.add_argument("--force-exclude", action="store_true")
