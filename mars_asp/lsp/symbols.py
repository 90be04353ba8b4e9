"""The symbols of a text: modules of a configuration or source, predicates of rules."""

from bisect import bisect_right
from collections.abc import Iterable, Iterator
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.lsp.occurrences import DocumentOutline
from mars_asp.lsp.places import Place, Range
from mars_asp.lsp.robot import DocumentContext, OpenFile
from mars_asp.lsp.rule_text import RuleText

Sort: TypeAlias = Literal["module", "predicate"]


class Symbol(NamedTuple):
    """A declared module or predicate: `place` is its name, `whole` its block, line or name."""

    name: str
    detail: str
    sort: Sort
    place: Range
    whole: Range


def module_symbols(found: DocumentOutline) -> Iterator[Symbol]:
    """Yield the modules that a text lists or annotates, in its order."""
    for each in found.mentions:
        if each.role == "listed":
            detail = f"described by {each.described}" if each.described else "listed"
            yield Symbol(each.name, detail, "module", each.range, each.range)
        elif each.role == "annotated":
            yield Symbol(each.name, "annotated", "module", each.range, _block(found, each.range))


def predicate_symbols(text: RuleText) -> Iterator[Symbol]:
    """Yield each predicate that the rules derive, at its first head."""
    seen: set[tuple[str, int]] = set()
    for each in text.mentions:
        if each.is_head and each.key not in seen:
            seen.add(each.key)
            yield Symbol(str(each.signature), "predicate", "predicate", each.range, each.range)


def workspace_symbols(
    scenes: Iterable[DocumentContext], rules: Iterable[RuleText], query: str
) -> Iterator[tuple[str, Sort, Place]]:
    """Yield the symbols of open files and of their robots whose name contains `query`, once each.

    Modules of included files have the names that the robot gives them. Case is ignored.
    """
    files: dict[tuple[str, str], OpenFile] = {}
    for scene in scenes:
        known = [file for robot in scene.robots for file in scene.files(robot)]
        known = known or [OpenFile(scene.here.text.path, "", scene.here.mentions)]
        files |= {(file.path, file.prefix): file for file in known}
    found: dict[tuple[str, Sort, Place], None] = {}
    for file in files.values():
        for each in file.mentions:
            if each.role in ("listed", "annotated"):
                place = Place(file.path, each.range)
                found[file.name_of(each), "module", place] = None
    for text in rules:
        for symbol in predicate_symbols(text):
            found[symbol.name, "predicate", Place(text.text.path, symbol.place)] = None
    return (each for each in found if query.lower() in each[0].lower())


def _block(found: DocumentOutline, name: Range) -> Range:
    """Return the range of the block that contains a name, or of its line if there is none."""
    number = name.start.line + 1
    at = bisect_right(found.blocks, number, key=lambda block: block[0]) - 1
    first, last = (
        found.blocks[at] if at >= 0 and found.blocks[at][1] >= number else (number, number)
    )
    lines = found.text.lines
    return Range(found.text.position(first, 1), found.text.position(last, len(lines[last - 1]) + 1))
