"""Module blocks that differ in their names alone, read once.

Robots of one kind have modules of one kind, so a file of ten thousand modules repeats its blocks.
The module of a block without problems is kept by the text of the block without the name; a block of
the same text is the same module with another name and location.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias, TypeVar

from mars_asp.annotations.directives import BOUNDARIES, MOST_CHARACTERS, WORDS
from mars_asp.annotations.modules import read_modules
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Span
from mars_asp.model.attributes import Attribute
from mars_asp.model.declarations import Function, Module, Service, Vertex
from mars_asp.model.names import BARE

_Placed = TypeVar("_Placed", Attribute, Function, Service, Vertex)
#: The text before the name of a block, and the text after it.
_Around: TypeAlias = tuple[str, str]
_HEAD = re.compile(rf"([ \t]*@module_start[ \t]*\n[ \t]*@module_name[ \t]+)({BARE})[ \t]*(?=\n)")
_FIRST, _LAST = "@module_start", "@module_end"
_WITHIN = "|".join(word for word in WORDS if word not in BOUNDARIES)
#: Words of annotations that a block must not contain: they depend on state outside of the block,
#: such as the count of unknown words.
_STRANGE = re.compile(rf"@(?!(?:{_WITHIN})\b)")


def read_alike(
    path: str, lines: Sequence[str], blocks: Sequence[tuple[int, int]]
) -> dict[int, Module]:
    """Return the modules of blocks without problems, by the line at which a block begins.

    `lines` are the lines of the file, `blocks` the first and last line of each block, from 1.
    """
    read: dict[int, Module] = {}
    known: dict[_Around, Module | None] = {}
    for first, last in blocks:
        text = "\n".join(lines[first - 1 : last])
        head = _HEAD.match(text)
        if head is None:
            continue
        before, name = head.groups()
        around = before, text[head.end() :]
        if around not in known:
            known[around] = _read_block(text, around)
        module = known[around]
        if module is not None and len(name) <= MOST_CHARACTERS:
            read[first] = _placed(module, name, path, first - 1)
    return read


def is_closed(lines: Sequence[str], block: tuple[int, int]) -> bool:
    """Whether a block begins with `@module_start` and ends with `@module_end`."""
    first, last = block
    return lines[first - 1].strip(" \t") == _FIRST and lines[last - 1].strip(" \t") == _LAST


def _read_block(text: str, around: _Around) -> Module | None:
    """Return the module of a block, or None if it has problems or may depend on text outside it."""
    body, _, end = around[1].rpartition("\n")
    if end.strip(" \t") != _LAST or _STRANGE.search(body):
        return None
    modules, problems = read_modules(Source("", "mars", text.encode("utf-8", "replace").decode()))
    return modules[0] if len(modules) == 1 and not problems else None


def _placed(module: Module, name: str, path: str, below: int) -> Module:
    """Return a copy of a module with another name and path, moved down by `below` lines."""

    def at(span: Span) -> Span:
        _, line, column, end_line, end_column = span
        return Span(path, line + below, column, end_line + below, end_column)

    assert module.named is not None
    _, line, column, _, _ = module.named
    return Module(
        name,
        at(module.span),
        _all_placed(module.services, at),
        _all_placed(module.functions, at),
        _all_placed(module.vertices, at),
        Span(path, line + below, column, line + below, column + len(name)),
        module.guard and at(module.guard),
        _all_placed(module.attributes, at),
    )


def _all_placed(found: tuple[_Placed, ...], at: Callable[[Span], Span]) -> tuple[_Placed, ...]:
    return tuple([replace(each, span=at(each.span)) for each in found]) if found else ()
