"""The occurrences of module names in a text, which may have errors while it is typed.

A `.mars` file names modules in lists, relationships and module blocks, a source in `@module_name`.
"""

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.annotations.blocks import block_lines
from mars_asp.annotations.directives import Directive, directives
from mars_asp.annotations.languages import LANGUAGES
from mars_asp.annotations.sources import Source
from mars_asp.language.layout import Layout, lay_out
from mars_asp.language.tokens import Token, tokens_of
from mars_asp.lsp.places import MOST_CHARACTERS, Position, Range, Text
from mars_asp.model.declarations import GATING, VERBS
from mars_asp.model.names import BARE, QUOTED, plain, read_name

#: Context of a module name: `@modules`, after a `:` in it, `@module_name`, or another statement.
Role: TypeAlias = Literal["listed", "describing", "annotated", "line"]
_END = re.compile(rf"({BARE}|{QUOTED})(?:\.({BARE}|{QUOTED})?)?")
_HEADER = re.compile(r"\s*(@(?:configuration|specification))(?!\w)")
_NAMED = re.compile(rf"(?i)^[ \t]*@module_name[ \t]+({BARE}|{QUOTED})")
_STAND_IN = re.compile(
    rf"(?://|#)[ \t]*InheritanceNode[0-9]+:[ \t]*({BARE}|{QUOTED})[ \t]*(?= -- |$)"
)
_CONVERSION = re.compile(
    rf"(?://|#)[ \t]*DataTransformer[0-9]+:[ \t]*(?!no converter declared)({BARE}|{QUOTED})[ \t]*\("
)


class PortOccurrence(NamedTuple):
    """An occurrence of a port; `is_output` is whether it is an output."""

    name: str
    range: Range
    #: None if it may be an input: the left end of a gate line.
    is_output: bool | None


class Occurrence(NamedTuple):
    """An occurrence of a module, with its port if one is named.

    `described` is the describing module, `Camera` of `left: Camera`.
    """

    name: str
    range: Range
    role: Role
    port: PortOccurrence | None = None
    described: str | None = None


class DocumentOutline(NamedTuple):
    """The occurrences in a text, in order; `blocks` are first and last lines of blocks, from 1."""

    text: Text
    mentions: tuple[Occurrence, ...]
    blocks: tuple[tuple[int, int], ...] = ()
    #: The range of `@configuration` or `@specification`.
    header: Range | None = None

    def at(self, position: Position) -> Occurrence | None:
        """Return the occurrence whose module name or port contains a position, or None."""
        for each in self.mentions:
            end = each.range.end if each.port is None else each.port.range.end
            if each.range.start <= position <= end:
                return each
        return None


@lru_cache(maxsize=16)
def outline(path: str, written: str) -> DocumentOutline:
    """Return the occurrences of modules in a `.mars` file or a source; none if it is too large."""
    text = Text(path, written)
    if len(written) > MOST_CHARACTERS:
        return DocumentOutline(text, ())
    if is_configuration(path):
        return _of_configuration(text)
    return DocumentOutline(text, tuple(_of_source(text)))


def is_configuration(path: str) -> bool:
    """Whether a file is a `.mars` file."""
    return path.lower().endswith(".mars")


def language_of(path: str) -> str | None:
    """Return the programming language of a source, or None if its suffix is unknown."""
    return LANGUAGES.get(Path(path).suffix.lower())


def annotated(text: Text) -> Iterator[tuple[Source, Directive]]:
    """Yield each correctly spelt annotation of a source, with the source."""
    language = language_of(text.path)
    if language is None:
        return
    source = Source(text.path, language, text.plain.encode("utf-8", "replace").decode())
    for each in directives(source):
        if isinstance(each, Directive):
            yield source, each


def _of_source(text: Text) -> Iterator[Occurrence]:
    for source, each in annotated(text):
        if each.word == "module_name" and (name := read_name(each.rest)) is not None:
            span = source.span(each.place(0), each.place(len(each.rest)))
            yield Occurrence(name, text.range(span), "annotated")


# ---- Configurations ------------------------------------------------------------------------------


class _Named(NamedTuple):
    """A module name in a statement, with its port; all offsets count from the statement's begin."""

    name: str
    begin: int
    end: int
    role: Role
    described: str | None = None
    port: str | None = None
    port_begin: int = 0
    port_end: int = 0
    is_output: bool | None = False


def _of_configuration(text: Text) -> DocumentOutline:
    blocks = block_lines(text.plain)
    layout = lay_out(text.path, text.plain, blocks)
    found = list(_in_blocks(text, blocks))
    found += _in_comments(text, layout)
    header = None
    begin = 0
    for piece in layout.grammatical.split("\n"):
        if piece and not piece.isspace():
            found += (_mention(text, layout, begin, each) for each in _modules_of_statement(piece))
            match = _HEADER.match(piece) if header is None else None
            if match is not None:
                header = _range(text, layout, begin + match.start(1), begin + match.end(1))
        begin += len(piece) + 1
    found.sort(key=lambda each: each.range)
    return DocumentOutline(text, tuple(found), blocks, header)


def _mention(text: Text, layout: Layout, at: int, named: _Named) -> Occurrence:
    """Return the occurrence for a name in the statement that begins at offset `at`."""
    port = None
    if named.port is not None:
        place = _range(text, layout, at + named.port_begin, at + named.port_end)
        port = PortOccurrence(named.port, place, named.is_output)
    place = _range(text, layout, at + named.begin, at + named.end)
    return Occurrence(named.name, place, named.role, port, named.described)


def _range(text: Text, layout: Layout, begin: int, end: int) -> Range:
    line, column = layout.position(begin)
    return text.within(line, column - 1, column - 1 + end - begin)


def _in_blocks(text: Text, blocks: Sequence[tuple[int, int]]) -> Iterator[Occurrence]:
    for first, last in blocks:
        for number in range(first, last + 1):
            match = _NAMED.match(text.lines[number - 1])
            if match is not None:
                yield Occurrence(plain(match[1]), text.within(number, *match.span(1)), "annotated")


def _in_comments(text: Text, layout: Layout) -> Iterator[Occurrence]:
    """Yield the modules named in comments of introduced nodes, which belong to a specification."""
    if not re.search(r"(?:InheritanceNode|DataTransformer)[0-9]", layout.text):
        return
    for number, line in enumerate(text.lines, 1):
        for pattern in (_STAND_IN, _CONVERSION):
            for match in pattern.finditer(line):
                yield Occurrence(plain(match[1]), text.within(number, *match.span(1)), "line")


@lru_cache(maxsize=1 << 14)
def _modules_of_statement(statement: str) -> tuple[_Named, ...]:
    """Return the modules that a statement names; cached, as an edit changes few statements."""
    layout = Layout("", statement, statement)
    tokens = tokens_of(layout, 0, len(statement))
    if tokens[0].text == "@modules":
        return tuple(_in_list(tokens[1:]))
    return () if tokens[0].text.startswith("@") else tuple(_in_line(tokens))


def _in_list(tokens: Sequence[Token]) -> Iterator[_Named]:
    for number, token in enumerate(tokens):
        name = read_name(token.text)
        if name is None:
            continue
        is_describing = number > 0 and tokens[number - 1].text == ":"
        described = None
        if not is_describing and [each.text for each in tokens[number + 1 : number + 2]] == [":"]:
            described = tokens[number + 2].name if number + 2 < len(tokens) else None
        role: Role = "describing" if is_describing else "listed"
        yield _Named(name, token.begin, token.end, role, described)


def _in_line(tokens: Sequence[Token]) -> Iterator[_Named]:
    """Yield the module names of a relationship; of an unfinished line its first word."""
    at = next((n for n, each in enumerate(tokens) if each.text in VERBS), None)
    is_gated = at is not None and tokens[at].text in GATING.values()
    yield from _end(tokens[0], is_output=None if is_gated else False)
    if at is None or tokens[at].text == "is_arbitrated_by":
        return
    begins = [at + 1]
    if tokens[at].text == "is_controlled_by":
        begins += [n + 1 for n in range(at + 1, len(tokens)) if tokens[n].text == ","]
    for begin in begins:
        if begin < len(tokens):
            yield from _end(tokens[begin], is_output=True)


def _end(token: Token, is_output: bool | None) -> Iterator[_Named]:
    match = _END.fullmatch(token.text)
    if match is None or match[1] in VERBS:
        return
    named = _Named(plain(match[1]), token.begin, token.begin + match.end(1), "line")
    if match[2] is not None:
        begin, end = (token.begin + at for at in match.span(2))
        port = plain(match[2])
        named = named._replace(port=port, port_begin=begin, port_end=end, is_output=is_output)
    yield named
