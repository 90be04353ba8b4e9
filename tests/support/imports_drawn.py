"""The real imports between the rooms of the house, as a drawing.

`python -m tests.support.imports_drawn` prints it.

An arrow leads from a room to one that it imports from; where a way over other rooms leads there as
well, it is left out, so that the drawing shows the layers.
"""

import ast
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cache
from pathlib import Path

from tests.support.documents import ROOT

HOUSE = ROOT / "mars_asp"


@cache
def imported(path: Path) -> Sequence[str]:
    """Return the names that a file imports from `mars_asp`, each with its module."""
    return [
        f"{node.module}.{each.name}"
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("mars_asp")
        for each in node.names
    ]


def rooms(folder: Path) -> set[str]:
    """Return the files and folders of a package by their names."""
    found = (path for path in folder.iterdir() if path.suffix == ".py" or path.is_dir())
    return {path.stem for path in found if not path.name.startswith("__")}


def imports_between(folder: Path) -> dict[str, set[str]]:
    """Return which rooms of a package import from which others of it."""
    names = rooms(folder)
    prefix = ".".join(folder.relative_to(ROOT).parts)
    found: dict[str, set[str]] = {name: set() for name in names}
    for path in folder.rglob("*.py"):
        room = path.relative_to(folder).with_suffix("").parts[0]
        for name in imported(path) if room in names else ():
            other = name.removeprefix(f"{prefix}.").split(".")[0]
            if name.startswith(prefix) and other in names and other != room:
                found[room].add(other)
    return found


def drawing(folder: Path) -> str:
    """Return a Mermaid diagram of the rooms of a package and their imports."""
    imports = imports_between(folder)
    below: dict[str, list[str]] = {}
    for room, other in sorted(_direct(imports)):
        below.setdefault(room, []).append(other)
    lines = [f"  {room} --> {' & '.join(others)}" for room, others in below.items()]
    drawn = below.keys() | {other for others in below.values() for other in others}
    alone = [f"  {room}" for room in sorted(imports.keys() - drawn)]
    return "\n".join(("flowchart TD", *lines, *alone, ""))


def _direct(imports: Mapping[str, Set[str]]) -> Iterator[tuple[str, str]]:
    """Yield the imports that no longer path implies."""
    below = {room: _reached(room, imports) for room in imports}
    for room, others in imports.items():
        for other in others:
            if not any(other in below[between] for between in others - {other}):
                yield room, other


def _reached(room: str, imports: Mapping[str, Set[str]]) -> set[str]:
    found: set[str] = set()
    waiting = list(imports[room])
    while waiting:
        other = waiting.pop()
        if other not in found:
            found.add(other)
            waiting += imports[other]
    return found


if __name__ == "__main__":
    for name in (".", "asp", "reasoning", "execution"):
        print(drawing(HOUSE / name))
