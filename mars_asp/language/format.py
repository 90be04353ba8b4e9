"""Canonical layout of a `.mars` text; comments keep their positions.

It works on the tokens of each statement and on the lines between statements, so that text outside
the grammar (comments, blank lines, module blocks) stays. Only the layout changes, neither the
words, the numbers, nor the order of lines.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from itertools import pairwise
from typing import Literal, TypeAlias

from mars_asp.annotations.blocks import read_blocks
from mars_asp.diagnostic import Diagnostic, MarsError, Span, whole_file
from mars_asp.language.layout import QUOTED_OR_COMMENT, Layout, lay_out
from mars_asp.language.parse import parse_text, plain_lines
from mars_asp.language.print import fill
from mars_asp.language.tokens import Token, tokens_of

_WORD = re.compile(r"\S+")
_VERBATIM = re.compile(r"\s*[\"']|\s--(?:\s|$)")

Kind: TypeAlias = Literal["blank", "comment", "statement", "first", "block", "last"]


@dataclass(frozen=True, slots=True)
class FormattedLine:
    """A line of output; the lines of a module block are `first`, `block` and `last`."""

    kind: Kind
    text: str = ""


def format_text(text: str, path: str) -> str:
    r"""Return a text in canonical layout, with `\n` for every line end.

    Raises:
        MarsError: every syntax error of the text.
    """
    before = parse_text(text, path).configuration
    text = plain_lines(text)
    blocks = read_blocks(path, text).lines
    lines = _FormattedLines(lay_out(path, text, blocks), blocks)
    formatted = "".join(f"{line}\n" for line in _spaced(list(lines.all())))
    if meaning(parse_text(formatted, path).configuration) != meaning(before):
        message = (
            "formatting would change the meaning of this file; this is a bug, please report it"
        )
        raise MarsError((Diagnostic("format", "error", message, whole_file(path)),))
    return formatted


def meaning(value: object) -> object:
    """Return a model value without locations and original spelling, to compare two of them."""
    if isinstance(value, tuple):
        return tuple(map(meaning, value))
    if is_dataclass(value) and not isinstance(value, type):
        kept = ((f.name, getattr(value, f.name)) for f in fields(value) if f.compare)
        return tuple((name, meaning(part)) for name, part in kept if not isinstance(part, Span))
    return value


class _FormattedLines:
    """The lines of one text, statement by statement."""

    def __init__(self, layout: Layout, blocks: Iterable[tuple[int, int]]) -> None:
        self._layout = layout
        self._kinds: dict[int, Kind] = {}
        for first, last in blocks:
            self._kinds |= dict.fromkeys(range(first, last + 1), "block")
            self._kinds |= {first: "first", last: "last"}

    def all(self) -> Iterator[FormattedLine]:
        """Yield every line, with all blank lines of the original."""
        begin = 0
        for piece in self._layout.grammatical.removesuffix("\n").split("\n"):
            end = begin + len(piece)
            if piece.strip():
                yield from (
                    FormattedLine("statement", text) for text in self._statement(begin, end)
                )
            else:
                yield from self._between(begin, end)
            begin = end + 1

    def _between(self, begin: int, end: int) -> Iterator[FormattedLine]:
        """Yield the comment, block and blank lines between two offsets outside statements."""
        number = self._layout.position(begin)[0]
        for count, text in enumerate(self._layout.text[begin:end].split("\n")):
            kind = self._kinds.get(number + count)
            if kind is not None:
                yield FormattedLine(kind, _block_line(text))
            else:
                yield FormattedLine("comment" if text.strip() else "blank", text.strip())

    def _statement(self, begin: int, end: int) -> Iterator[str]:
        """Yield the lines of one statement.

        A statement with comments inside keeps its line breaks, as a comment belongs to the words
        next to it; any other gets a new layout.
        """
        tokens = tokens_of(self._layout, begin, end)
        gaps = [list(self._gap(a.end, b.begin)) for a, b in pairwise(tokens)]
        (after,) = self._gap(tokens[-1].end, end)
        spaces = _spaces(tokens)
        if not any(any(gap) for gap in gaps):
            *lines, line = _filled(tokens, spaces)
            yield from lines
        else:
            line = tokens[0].text
            for token, gap, space in zip(tokens[1:], gaps, spaces, strict=True):
                if len(gap) == 1:
                    line += space + token.text
                    continue
                yield _with_comment(line, gap[0])
                yield from filter(None, gap[1:])
                line = token.text
        yield _with_comment(line, after)

    def _gap(self, begin: int, end: int) -> Iterator[str]:
        """Yield the text between two tokens line by line; the next token is on the last line."""
        first, *lines = self._layout.text[begin:end].split("\n")
        yield first.strip()
        number = self._layout.position(begin)[0]
        for count, text in enumerate(lines, 1):
            inside = number + count in self._kinds
            yield _block_line(text) if inside else text.strip()


def _spaces(tokens: list[Token]) -> list[str]:
    """Return "" or " " for each token but the first: the space before it on the same line.

    The arguments of a mode follow its name directly and have blanks between them; the slots of a
    tuple have none.
    """
    mode = any(token.text == "uses_data_from" for token in tokens)
    spaces: list[str] = []
    inside = False
    for before, token in pairwise(tokens):
        inside = (inside or before.text == "(") and before.text != ")"
        closed = token.text in (",", ")", "=", ":") or before.text in ("(", "=")
        opens_arguments = token.text == "(" and mode
        in_tuple = inside and not mode
        spaces.append("" if closed or opens_arguments or in_tuple else " ")
    return spaces


def _filled(tokens: list[Token], spaces: list[str]) -> Iterator[str]:
    """Yield the lines of a statement; only a list of names or paths may have several."""
    words = [token.text for token in tokens]
    heads = 1 if words[0] in ("@modules", "@sources") else 2
    listed = heads == 1 or words[1:2] == ["is_controlled_by"]
    parts = [""]
    for space, word in zip(["", *spaces], words, strict=True):
        if listed and parts[-1].endswith(","):
            parts.append(word)
        else:
            parts[-1] += space + word
    head = " ".join(words[:heads])
    if not listed:
        return iter(parts)
    return fill(head, [parts[0].removeprefix(head).lstrip(" "), *parts[1:]])


def _with_comment(line: str, comment: str) -> str:
    return f"{line}  {comment}" if comment else line


def _block_line(text: str) -> str:
    """Return a line of a module block, with canonical annotations and unchanged code."""
    text = text.rstrip()
    if not text.lstrip().startswith("@"):
        return text
    found = QUOTED_OR_COMMENT.finditer(text)
    comment = next((match for match in found if match["quoted"] is None), None)
    code = text[: comment.start()] if comment else text
    verbatim = _VERBATIM.search(code)
    end = verbatim.start() if verbatim else len(code)
    words = " ".join(_WORD.findall(code[:end])) + code[end:].rstrip()
    return _with_comment(words, comment[0] if comment else "")


def _spaced(lines: list[FormattedLine]) -> Iterator[str]:
    """Yield lines with at most one blank between two, and one around each module block."""
    shown: FormattedLine | None = None
    blank = False
    for line in lines:
        if line.kind == "blank" or (line.kind == "block" and not line.text):
            blank = True
            continue
        if shown is not None:
            opens = line.kind == "first" and shown.kind != "comment"
            inner = shown.kind == "first" or line.kind == "last"
            if opens or shown.kind == "last" or (blank and not inner):
                yield ""
        yield line.text
        shown, blank = line, False
