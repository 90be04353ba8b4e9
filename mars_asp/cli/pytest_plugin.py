"""A plugin of pytest: the cases of packs, in their folders `cases` and `tests`, are tests.

A file is collected if a `pack.toml` lies beside such a folder, so that other suites are unaffected,
or if `mars-asp test --snapshot` wrote it; `-p no:mars_asp` disables the plugin.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from mars_asp.asp.cases import Check

_SUFFIXES = (".lp", ".mars")
#: The start of the line above the expectations of a snapshot.
_SNAPSHOT = b"# snapshot: written by `mars-asp test --snapshot`"
_MANIFEST, _FOLDERS = "pack.toml", ("cases", "tests")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "pytest.Collector | None":
    """Return the collector of a case file; None for any other file."""
    if file_path.suffix not in _SUFFIXES:
        return None
    # Few imports are needed to find that a file belongs to no pack.
    folders = (each.parent for each in file_path.parents if each.name in _FOLDERS)
    pack = next((each for each in folders if (each / _MANIFEST).is_file()), None)
    if pack is None:
        if file_path.suffix != ".mars" or _SNAPSHOT not in file_path.read_bytes():
            return None
    elif file_path.suffix == ".mars":
        from mars_asp.reasoning.cases.configurations import is_case

        # Cases include the other files.
        if not is_case(file_path):
            return None
    found: CaseFile = CaseFile.from_parent(parent, path=file_path)
    found.pack = pack
    return found


class CaseFile(pytest.File):
    """A file of cases; `pack` is its pack, None without one."""

    pack: Path | None

    def collect(self) -> "Iterator[pytest.Item]":
        """Yield the cases of the file, run with the rules of its pack.

        Raises:
            CollectError: the rules or the cases have errors.
        """
        from mars_asp.diagnostic import MarsError
        from mars_asp.reasoning.cases import run_case

        try:
            outcome = run_case(self.path, _rulebook(self.config, self.pack, self.path.parent))
        except MarsError as error:
            text = (f"{d.span.path}:{d.span.line}: {d.message}" for d in error.diagnostics)
            raise self.CollectError("\n".join(text)) from None
        for check in outcome.checks:
            item = CaseItem.from_parent(self, name=check.title or self.path.stem)
            item.check = check
            yield item


class CaseItem(pytest.Item):
    """One case with its result."""

    check: "Check"

    def runtest(self) -> None:
        """Fail if the rules do not give the expected result.

        Raises:
            UnmetError: the result differs.
        """
        if not self.check.passed:
            raise UnmetError(self.check)

    def repr_failure(self, excinfo: "pytest.ExceptionInfo[BaseException]") -> str:  # type: ignore[override]
        """Return the expectation, its location and the result as text."""
        if not isinstance(excinfo.value, UnmetError):
            return str(super().repr_failure(excinfo))
        lines = []
        for failure in self.check.failures:
            place = f"{failure.span.path}:{failure.span.line}:{failure.span.column}"
            lines += [f"{place}: expected {failure.expected}", *failure.lines]
        return "\n".join(lines)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Return the location of the case."""
        return self.path, self.check.span.line - 1, self.name


class UnmetError(Exception):
    """The rules do not give the result that a case expects."""


_BOOKS = pytest.StashKey[dict[tuple[Path, ...], object]]()


def _rulebook(config: pytest.Config, pack: Path | None, folder: Path):  # type: ignore[no-untyped-def]
    """Return the rules of a pack, or those of the settings and packs around a folder, read once."""
    from mars_asp.cli.settings import settings_for
    from mars_asp.reasoning.packs import packs_around, with_companions
    from mars_asp.reasoning.rules import STAGES, load_rulebook

    books = config.stash.setdefault(_BOOKS, {})
    if pack is None:
        packs = (*settings_for(folder).packs(), *packs_around(folder))
    else:
        packs = with_companions(pack)
    if packs not in books:
        books[packs] = load_rulebook(packs, STAGES)
    return books[packs]
