"""Finds case files and their packs: cases of a pack are in its folders `cases` and `tests`."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cases import find_cases
from mars_asp.reasoning.cases.configurations import SUFFIX, is_case
from mars_asp.reasoning.packs import folders_around, is_pack, pack_of

#: The folders of a pack that hold its cases.
FOLDERS = ("cases", "tests")
_SUFFIXES = (".lp", SUFFIX)


class FoundCase(NamedTuple):
    """A file of cases, and its pack, or None if it is in no pack."""

    path: Path
    pack: Path | None


def cases_of(paths: Iterable[Path], rules: Sequence[Path] = ()) -> tuple[FoundCase, ...]:
    """Return the case files at some paths, those of folders sorted by name.

    `rules` are additional packs; their rule files are left out.
    """
    found: dict[Path, FoundCase] = {}
    for path in paths:
        for each in _of_folder(path, rules) if path.is_dir() else (path,):
            found.setdefault(each, FoundCase(each, pack_of_case(each)))
    return tuple(found.values())


def pack_of_case(case: Path) -> Path | None:
    """Return the folder of the pack of a case file, or None if it is in no pack."""
    return pack_of(case, FOLDERS) if case.suffix in _SUFFIXES else None


def _of_folder(folder: Path, rules: Sequence[Path]) -> Iterator[Path]:
    configurations = (path for path in folder.rglob(f"*{SUFFIX}") if is_case(path))
    for path in sorted((*find_cases([folder], rules), *configurations)):
        if not _is_rule(path, folder):
            yield path


def _is_rule(path: Path, given: Path) -> bool:
    """Whether a file belongs to a pack within a folder, but not to the cases of the pack."""
    if pack_of_case(path) is not None:
        return False
    around = folders_around(path.parent)
    return any(is_pack(outer) for _, outer in around if outer.is_relative_to(given))
