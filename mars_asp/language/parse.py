"""Reads `.mars` text into plain values, and reports every syntax error of a file in one run."""

import re
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import replace
from itertools import islice
from operator import itemgetter
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from mars_asp.annotations.blocks import Blocks, read_blocks
from mars_asp.diagnostic import Diagnostic, MarsError, point, whole_file
from mars_asp.language.layout import Layout, lay_out
from mars_asp.language.lines import Read, read_lines
from mars_asp.language.statements import Builder, Raw, begin_of
from mars_asp.model.declarations import (
    ENGINES,
    FOREIGN,
    Configuration,
    Conversion,
    Muxed,
    Name,
    PackNode,
    StandIn,
    ends_of,
)
from mars_asp.model.graph import LaunchTree
from mars_asp.model.names import BARE, QUOTED, plain
from mars_asp.output import visible
from mars_asp.reading import WallError, overlay_bytes, read_file
from mars_asp.spelling import suggestion

#: Far above any robot; a larger file is a mistake that would only cost time.
MOST_BYTES = 64 * 1024 * 1024
#: The reading of a file ends after this many wrong statements.
MOST_ERRORS = 500
#: Written in place of a converter if a transformer is abstract.
ABSTRACT = "no converter declared"
#: The control characters of Unicode, without white space.
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1b\x7f-\x84\x86-\x9f]")
_CONVERSION = (
    r"(?://|#)[ \t]*(?P<node>DataTransformer[0-9]+):[ \t]*"
    rf"(?P<converter>{BARE}|{QUOTED}|{ABSTRACT})[ \t]*\((?P<source>[^\n]*?) -> (?P<target>[^\n]*)\)"
)
_STAND_IN = (
    rf"(?m)(?://|#)[ \t]*(?P<node>InheritanceNode[0-9]+):"
    rf"[ \t]*(?P<module>{BARE}|{QUOTED})[ \t]*(?= -- |$)"
)
#: In a comment, between the name of a node and that of its rule pack.
OF_PACK = "node of the pack"
_PACK_NODE = (
    rf"(?m)(?://|#)[ \t]*(?P<node>{BARE}|{QUOTED}):[ \t]*{OF_PACK}[ \t]+(?P<pack>[a-z][a-z0-9_-]*)"
    r"[ \t]*(?= -- |$)"
)


#: In a comment, before the format of the files that a configuration was imported from.
IMPORTED = "imported from"
#: In a comment, after the name of a node with topics that could not be read.
NOT_ALL_READ = "not all topics read"
#: In a comment, between the name of a module and that of the mux on its commands.
OF_MUX = "commands pass a"
_END = r"[ \t]*(?= -- |$)"
_IMPORTED = rf"(?m)^[ \t]*(?://|#)[ \t]*{IMPORTED}[ \t]+(?P<format>{'|'.join(FOREIGN)}){_END}"
_ABOUT_IMPORTED = (
    rf"(?m)^[ \t]*(?://|#)[ \t]*(?P<module>{BARE}|{QUOTED}):[ \t]*"
    rf"(?:{NOT_ALL_READ}|{OF_MUX}[ \t]+(?P<engine>{'|'.join(ENGINES)})"
    rf"(?:,[ \t]*(?P<mux>{BARE}|{QUOTED}))?){_END}"
)


class Parsed(NamedTuple):
    """The values in a readable file, with its warnings and notes.

    `blocks` are the original texts of its module blocks; `included` the texts of the files that it
    includes, by path; `trees` its launch trees.
    """

    configuration: Configuration
    warnings: tuple[Diagnostic, ...]
    blocks: tuple[str, ...] = ()
    included: Mapping[str, str] = MappingProxyType({})
    trees: tuple[LaunchTree, ...] = ()


def parse_file(path: Path) -> Parsed:
    """Return the content of a `.mars` file.

    Raises:
        MarsError: the file cannot be read, or is not in the language.
    """
    return parse_text(read_text(path), str(path))


def read_text(path: Path) -> str:
    r"""Return the text of a `.mars` file, with `\n` for every line end.

    Raises:
        MarsError: the file cannot be read, or is not text.
    """
    return plain_lines(decode(read_bytes(path), str(path)))


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return the content of a file that the user names; of a larger one `most` bytes and one more.

    Raises:
        MarsError: the file cannot be read, or lies outside of the permitted folders.
    """
    held = overlay_bytes(path)
    if held is not None:
        return held[: most + 1]
    try:
        return read_file(path, most)
    except OSError as error:
        advice = error.advice if isinstance(error, WallError) else None
        reason = error.strerror or "cannot be read"
        if isinstance(error, FileNotFoundError):
            reason = "no such file"
        found = unreadable(str(path), f"{reason[:1].lower()}{reason[1:]}", advice)
        raise MarsError((found,)) from None


def decode(raw: bytes, shown: str, most: int = MOST_BYTES) -> str:
    """Return the text of at most `most` bytes; errors name the file as `shown`.

    Raises:
        MarsError: the bytes are too many, or not text.
    """
    if len(raw) > most:
        raise MarsError((unreadable(shown, f"is larger than {most} bytes"),))
    encoding = "utf-16" if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    try:
        return raw.decode(encoding)
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        found = Diagnostic(
            "encoding",
            "error",
            "the file is not UTF-8",
            point(shown, line, 1),
            help="save it as UTF-8",
        )
        raise MarsError((found,)) from None


def plain_lines(text: str) -> str:
    r"""Return a text without byte order mark and with `\n` for every line end."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def parse_text(text: str, path: str) -> Parsed:
    """Return the content of a `.mars` text; `path` is the file name in locations.

    Raises:
        MarsError: every syntax error of the text.
    """
    text = plain_lines(text)
    blocks = read_blocks(path, text)
    layout = lay_out(path, text, blocks.lines)
    problems = [d for d in blocks.diagnostics if d.severity == "error"]
    warnings = tuple(d for d in blocks.diagnostics if d.severity != "error")
    builder = Builder(layout)
    for base, raw in _statements(layout, problems):
        builder.add(base, raw)
    configuration = builder.configuration(complete=not problems)
    stand_ins: tuple[StandIn, ...] = ()
    pack_nodes: tuple[PackNode, ...] = ()
    if configuration.kind == "specification":
        stand_ins = tuple(_stand_ins(layout, blocks))
        pack_nodes = tuple(_pack_nodes(layout, blocks))
    problems += (*builder.problems, *_contrary(stand_ins))
    wrong = {problem.span.line for problem in problems}
    problems += islice(_control_characters(text, path, wrong), MOST_ERRORS)
    if problems:
        raise MarsError(problems)
    result = _read_conversions(layout, blocks) if configuration.kind == "specification" else ()
    configuration = _with_origin(configuration, layout, blocks)
    warnings += tuple(_about_nobody(configuration, stand_ins))
    configuration = replace(
        configuration,
        declared=blocks.modules,
        conversions=result,
        stand_ins=stand_ins,
        pack_nodes=pack_nodes,
    )
    lines = text.split("\n")
    written = tuple("\n".join(lines[first - 1 : last]) for first, last in blocks.lines)
    return Parsed(configuration, warnings, written)


def _control_characters(text: str, path: str, wrong: Set[int]) -> Iterator[Diagnostic]:
    """Yield an error for the first control character of each line not in `wrong`."""
    if not _CONTROL.search(text):
        return
    for number, line in enumerate(text.split("\n"), 1):
        found = _CONTROL.search(line)
        if found and number not in wrong:
            yield Diagnostic(
                "syntax",
                "error",
                f"a control character, `{visible(found[0])}`",
                point(path, number, found.start() + 1),
                help="delete it: a terminal would obey it wherever the line is printed",
                excerpt=line,
            )


def _statements(layout: Layout, problems: list[Diagnostic]) -> Iterator[tuple[int, Raw]]:
    """Yield each statement with the offset that its own offsets are relative to.

    Simple lines are read one by one. The remaining text is parsed as a whole; only if that fails,
    each statement by itself, so that no error hides another.
    """
    read, rest = read_lines(layout.grammatical)
    if rest is None:
        yield from ((0, raw) for _, _, raw in read)
        return
    # Loading Lark takes as long as reading a small file, and is often unnecessary.
    from mars_asp.language.grammar import parsed  # noqa: PLC0415

    found = parsed(rest)
    if isinstance(found, list):
        both = [(begin, raw) for begin, _, raw in read]
        both += ((begin_of(raw), raw) for raw in found)
        both.sort(key=itemgetter(0))
        yield from ((0, raw) for _, raw in both)
    else:
        yield from _one_by_one(layout, read, problems)


def _one_by_one(
    layout: Layout, read: Iterable[Read], problems: list[Diagnostic]
) -> Iterator[tuple[int, Raw]]:
    from mars_asp.language.expected import describe  # noqa: PLC0415 -- Lark, as above
    from mars_asp.language.grammar import parsed  # noqa: PLC0415

    plain = {end: raw for _, end, raw in read}
    base = wrong = 0
    for piece in layout.grammatical.split("\n"):
        end = base + len(piece)
        if end in plain:
            yield 0, plain[end]
        elif piece.strip():
            if wrong == MOST_ERRORS:
                problems.append(_given_up(layout, base))
                return
            found = parsed(piece + "\n")
            if isinstance(found, list):
                yield from ((base, raw) for raw in found)
            else:
                problems.append(describe(layout, base, piece, found))
                wrong += 1
        base = end + 1


def _given_up(layout: Layout, base: int) -> Diagnostic:
    return Diagnostic(
        "syntax",
        "error",
        f"{MOST_ERRORS} errors above: the rest of the file was not read",
        layout.span(base, base + 1),
        help="is this a `.mars` file? if so, fix those first",
    )


def _read_conversions(layout: Layout, blocks: Blocks) -> tuple[Conversion, ...]:
    """Return the conversions of transformers, in comments outside of module blocks."""
    return tuple(
        Conversion(
            match["node"],
            None if match["converter"] == ABSTRACT else plain(match["converter"]),
            match["source"],
            match["target"],
            layout.span(match.start("node"), match.end("target")),
        )
        for match in _outside("DataTransformer", _CONVERSION, layout, blocks)
    )


def _stand_ins(layout: Layout, blocks: Blocks) -> Iterator[StandIn]:
    """Yield the modules that InheritanceNodes represent, in comments outside of module blocks."""
    for match in _outside("InheritanceNode", _STAND_IN, layout, blocks):
        span = layout.span(match.start("node"), match.end("module"))
        yield StandIn(match["node"], plain(match["module"]), span)


def _pack_nodes(layout: Layout, blocks: Blocks) -> Iterator[PackNode]:
    """Yield the nodes of rule packs that comments name."""
    for match in _outside(OF_PACK, _PACK_NODE, layout, blocks):
        span = layout.span(match.start("node"), match.end("pack"))
        yield PackNode(plain(match["node"]), match["pack"], span)


def _with_origin(configuration: Configuration, layout: Layout, blocks: Blocks) -> Configuration:
    """Return a configuration with the information in comments about imported files."""
    imported = next(_outside(IMPORTED, _IMPORTED, layout, blocks), None)
    if imported is None:
        return configuration
    opaque: list[Name] = []
    muxes: list[Muxed] = []
    for match in _outside("", _ABOUT_IMPORTED, layout, blocks):
        module, span = plain(match["module"]), layout.span(match.start("module"), match.end())
        engine = next((each for each in ENGINES if each == match["engine"]), None)
        if engine is None:
            opaque.append(Name(module, span))
        else:
            name = plain(match["mux"]) if match["mux"] else engine
            muxes.append(Muxed(module, engine, span, name=name))
    return replace(
        configuration, origin=imported["format"], opaque=tuple(opaque), muxes=tuple(muxes)
    )


def _outside(words: str, pattern: str, layout: Layout, blocks: Blocks) -> Iterator[re.Match[str]]:
    """Yield the matches of a pattern outside of module blocks; none without `words` in the text."""
    if words not in layout.text:
        return  # as in most files, so that the pattern is not compiled
    inside = {number for first, last in blocks.lines for number in range(first, last + 1)}
    for match in re.finditer(pattern, layout.text):
        if layout.position(match.start())[0] not in inside:
            yield match


def _contrary(stand_ins: Iterable[StandIn]) -> Iterator[Diagnostic]:
    """Yield an error for each node that two comments assign to different modules."""
    first: dict[str, str] = {}
    for each in stand_ins:
        module = first.setdefault(each.node, each.module)
        if module != each.module:
            message = f"comments assign `{each.node}` to both `{module}` and `{each.module}`"
            help_text = "an InheritanceNode serves one module: keep one comment"
            yield Diagnostic("stand-in", "error", message, each.span, help=help_text)


def _about_nobody(
    configuration: Configuration, stand_ins: Iterable[StandIn]
) -> Iterator[Diagnostic]:
    """Yield a warning for each comment whose node or module does not exist."""
    known = {name.text for name in configuration.modules}
    known.update(name for each in configuration.relationships for name in ends_of(each))
    named = [
        *((each.node, "node", each.span) for each in stand_ins),
        *((each.module, "module", each.span) for each in stand_ins),
        *((each.text, "module", each.span) for each in configuration.opaque),
        *((each.module, "module", each.span) for each in configuration.muxes),
    ]
    for name, sort, span in named:
        if name not in known:
            yield Diagnostic(
                "stand-in",
                "warning",
                f"the comment names `{name}`, which is not a {sort} of the {configuration.kind}",
                span,
                help=suggestion(name, known, "name one, or drop the comment"),
            )


def unreadable(shown: str, reason: str, advice: str | None = None) -> Diagnostic:
    """Return the error that a file cannot be read, with reason and advice."""
    place = whole_file(shown)
    # An excerpt would read the whole file.
    return Diagnostic("unreadable", "error", reason, place, help=advice, excerpt="")
