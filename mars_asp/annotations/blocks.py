"""Module blocks in a `.mars` file: annotations without comment marks, C++ declarations."""

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.annotations.repeated import repeated
from mars_asp.diagnostic import Diagnostic
from mars_asp.model.declarations import Module

if TYPE_CHECKING:
    from mars_asp.annotations.sources import Source

_START = re.compile(r"(?mi)^[ \t]*@module_start\b")


class Blocks(NamedTuple):
    """The modules of the blocks, the problems, and the (first, last) lines of each block."""

    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]
    lines: tuple[tuple[int, int], ...]


def read_blocks(path: str, text: str) -> Blocks:
    """Read every module block of a `.mars` text; two of one name are an error."""
    found = _read_blocks(path, text)
    if len({module.name for module in found.modules}) == len(found.modules):
        return found
    return found._replace(diagnostics=(*found.diagnostics, *repeated(found.modules)))


def _read_blocks(path: str, text: str) -> Blocks:
    if _START.search(text) is None:
        return Blocks((), (), ())
    # Only a file with blocks needs the import of the reader of declarations.
    from mars_asp.annotations.alike import is_closed, read_alike  # noqa: PLC0415
    from mars_asp.annotations.modules import read_modules  # noqa: PLC0415

    blocks = block_lines(text)
    lines = text.split("\n")
    read = read_alike(path, lines, blocks)
    others = [block for block in blocks if block[0] not in read]
    if not others:
        return Blocks(tuple(read.values()), (), blocks)
    if read and all(is_closed(lines, block) for block in others):
        modules, problems = read_modules(block_source(path, text, others))
        if all(problem.severity != "error" for problem in problems):
            read |= {module.span.line: module for module in modules}
            return Blocks(tuple(read[line] for line in sorted(read)), problems, blocks)
    # The problems of a block may depend on the blocks before it.
    return Blocks(*read_modules(block_source(path, text, blocks)), blocks)


def block_source(path: str, text: str, blocks: Iterable[tuple[int, int]]) -> "Source":
    """Return a `.mars` text as the source of its module blocks, with all other lines blank."""
    from mars_asp.annotations.sources import Source  # noqa: PLC0415 -- as above

    kept = text.split("\n")
    inside = {number for first, last in blocks for number in range(first, last + 1)}
    for number, line in enumerate(kept, 1):
        if number not in inside:
            kept[number - 1] = " " * len(line)
    return Source(path, "mars", "\n".join(kept).encode("utf-8", "replace").decode())


def block_lines(text: str) -> tuple[tuple[int, int], ...]:
    """Return the first and last line of each block; unclosed ones end at a section or the end."""
    found: list[tuple[int, int]] = []
    first = 0
    number = 0
    for number, line in enumerate(text.split("\n"), 1):
        if "@" not in line:
            continue
        word = line.strip().split(" ")[0].lower()
        if word == "@module_start" and not first:
            first = number
        elif word.startswith("@module_end") and first:
            found.append((first, number))
            first = 0
        elif first and word in ("@configuration", "@specification"):
            found.append((first, number - 1))
            first = 0
    if first:
        found.append((first, number))
    return tuple(found)
