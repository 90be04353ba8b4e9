"""A source: its comment lines that begin with an annotation, its code, and locations in it.

Offsets count bytes; text is decoded only where it is read.
"""

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

from mars_asp.annotations.comments import blanked, tokens
from mars_asp.annotations.skim import (
    annotated_comments,
    annotation_end,
    comment_end,
    inner_comments,
)

#: The text before the first word of a comment, and of its further lines, by the kind of comment. A
#: mark of another kind begins code that was commented out.
_OPENING = {
    "c": rb"(?:/\*[*!]?|//[/!]?)?[ \t]*+",
    "python": rb"#*+[ \t]*+",
    "matlab": rb"%*+[ \t]*+",
}
_BELOW = {
    b"/*": rb"[ \t]*+(?:\*(?!/))?[ \t]*+",
    b"//": rb"[ \t]*+(?://[/!]?)?[ \t]*+",
    b"%{": rb"[ \t]*+",
}
_ANNOTATION = rb"@([A-Za-z][\w\x80-\xff]*+)"
_OPENING_HERE = {language: re.compile(pattern) for language, pattern in _OPENING.items()}
_BELOW_HERE = {mark: re.compile(pattern) for mark, pattern in _BELOW.items()}
_ANNOTATED = {language: re.compile(pattern + _ANNOTATION) for language, pattern in _OPENING.items()}
_ANNOTATED_BELOW = {
    mark: re.compile(rb"\n" + pattern + _ANNOTATION) for mark, pattern in _BELOW.items()
}
_WORD = re.compile(r"\w+")
_DEAD = rb"if[ \t]++(?:0|false)[ \t]*+(?://[^\n]*+)?(?=\n|\Z)"
_DEAD_IF = re.compile(rb"#[ \t]*+" + _DEAD)
#: A preprocessor line of a condition, to its end.
_CONDITION = re.compile(
    rb"#[ \t]*+(?:(?P<dead>" + _DEAD + rb")|(?P<open>if|ifdef|ifndef)\b[^\n]*+"
    rb"|(?P<other>else|elif)\b[^\n]*+|(?P<close>endif)\b[^\n]*+)"
)
_CONTINUATION = bytes(range(0x80, 0xC0))
_MOST_EXCERPT = 400
#: The maximal distance of a continuing comment after an annotation with a final comma, in bytes.
_MOST_BETWEEN = 4096


class CommentLine(NamedTuple):
    """One line of a comment.

    `offset` is the begin of its text after the marks, `end` the end of the line, `until` the end of
    the comment; `mark` are the first two bytes of the comment.
    """

    offset: int
    text: str
    end: int
    until: int
    mark: bytes


@dataclass(frozen=True, slots=True)
class SourceRange:
    """A range of a source, and the same range with comments and strings blanked.

    `cut` is whether it ends at the maximal length.
    """

    text: str
    code: str
    cut: bool


class Source:
    """A text as bytes, whose lines end with LF and which begins with no byte order mark."""

    def __init__(self, path: str, language: str, data: bytes, encoding: str = "utf-8") -> None:
        """Keep a text in a language of `skim`, encoded as UTF-8 or Latin-1."""
        self.path = path
        self.language = "c" if language == "mars" else language
        self.data = data
        self._lexicon = language
        self._encoding = encoding
        self._wide = encoding == "utf-8" and not data.isascii()
        self._kind = language if language in _OPENING else "c"
        # The requested locations: offset, line, column and offset of the line's begin.
        self._places: list[tuple[int, int, int, int]] = [(0, 1, 1, 0)]

    def annotations(self, known: Callable[[str, int], bool]) -> Iterator[CommentLine]:
        """Yield the comment lines that begin with `@` and a known word, in order.

        Args:
            known: Whether a word is known; called with the word and the offset of its first `@`.
        """
        data, dead = self.data, self._dead
        first = _ANNOTATED[self._kind].match
        ours: dict[bytes, bool] = {}
        for begin, end in annotated_comments(self._lexicon, data):
            if dead and self._in_dead(begin):
                continue
            mark = data[begin : begin + 2]
            match = first(data, begin, end)
            found: Iterable[re.Match[bytes]] = [] if match is None else [match]
            if mark in _ANNOTATED_BELOW and data.find(b"\n", begin, end) >= 0:
                found = chain(found, _ANNOTATED_BELOW[mark].finditer(data, begin, end))
                if mark != b"//":
                    inner = tuple(inner_comments(self._lexicon, data, begin, end))
                    found = (match for match in found if not _is_within(inner, match.start(1)))
            for match in found:
                word = match[1]
                at = match.start(1) - 1
                if word not in ours:
                    text = _WORD.match(word.decode(self._encoding, "replace"))
                    ours[word] = text is not None and known(text[0], at)
                if ours[word]:
                    yield self._comment_line(at, end, mark)

    def following(self, line: CommentLine) -> CommentLine | None:
        """Return the comment line on the line below, or None if there is none or an annotation.

        In a configuration, with annotations without comment marks, it is the line below, or None if
        that line ends a declaration.
        """
        begin, until, mark = line.end + 1, line.until, line.mark
        opening = _BELOW_HERE.get(mark)
        if self._lexicon == "mars":
            begin = self.data.find(b"\n", line.end) + 1
            until = annotation_end(self.data, begin) if begin else 0
            if begin >= until or b";" in self.data[begin:until]:
                return None
        elif begin > until:
            found = self._comment_below(line.end)
            if found is None:
                return None
            begin, until = found
            mark, opening = self.data[begin : begin + 2], None
        elif begin == until:
            return None
        match = (opening or _OPENING_HERE[self._kind]).match(self.data, begin, until)
        below = self._comment_line(match.end() if match else begin, until, mark)
        return None if below.text.startswith("@") else below

    def _comment_line(self, offset: int, until: int, mark: bytes) -> CommentLine:
        """Return the comment line whose text begins at `offset`, in a comment up to `until`."""
        end = self.data.find(b"\n", offset, until)
        end = until if end < 0 else end
        text = self._decode(offset, end).rstrip()
        if mark == b"/*":
            text = text.removesuffix("*/").rstrip()
        return CommentLine(offset, text, end, until, mark)

    def _comment_below(self, end: int) -> tuple[int, int] | None:
        """Return the first comment after the end of a line, or None if not on the line below."""
        data, last = self.data, min(end + _MOST_BETWEEN, len(self.data))
        first = data.find(b"\n", end, last)
        if first < 0:
            return None
        below = data.find(b"\n", first + 1, last)
        text = self._decode(end, last if below < 0 else below)
        for index, _, kind in tokens(self._lexicon, text):
            begin = self.within(end, text, index)
            if kind == "comment" and not self._in_dead(begin):
                return (begin, comment_end(self._lexicon, data, begin)) if begin > first else None
        return None

    def stretch(self, begin: int, end: int, most: int) -> SourceRange:
        """Return the text between two offsets, at most `most` bytes.

        No string or comment may be open at `begin`; it is for example the end of a comment.
        """
        last = min(end, begin + most)
        text = self._decode(begin, last)
        code = blanked(self._lexicon, text)
        for low, high in self._dead[bisect_right(self._dead, (begin,)) :]:
            if low >= last:
                break
            first = len(self._decode(begin, low))
            after = len(self._decode(begin, min(high, last)))
            code = code[:first] + re.sub(r"[^\n]", " ", code[first:after]) + code[after:]
        return SourceRange(text, code, last < end)

    def within(self, offset: int, text: str, index: int) -> int:
        """Return the offset of a character of the text that begins at an offset."""
        return offset + (len(text[:index].encode()) if self._wide else index)

    @property
    def is_configuration(self) -> bool:
        """Whether annotations have no comment marks, as in the blocks of a `.mars` file."""
        return self._lexicon == "mars"

    @property
    def text(self) -> str:
        """Return the whole text."""
        return self.data.decode(self._encoding, "replace")

    def replaced(self, text: str) -> "Source":
        """Return the source with another text."""
        return Source(self.path, self._lexicon, text.encode(self._encoding), self._encoding)

    def position(self, offset: int) -> tuple[int, int]:
        """Return the line and column, from 1, of an offset; columns count code points."""
        return self._place(offset)[1:3]

    def positions(self, begin: int, end: int) -> tuple[int, int, int, int]:
        """Return the positions of two offsets, the first one first."""
        line, column = self.position(begin)
        # Most ranges end on the line where they begin.
        if self._wide or self.data.find(b"\n", begin, end) >= 0:
            return line, column, *self.position(end)
        return line, column, line, column + end - begin

    def excerpt(self, offset: int) -> str:
        """Return the line of an offset, at most its first 400 characters."""
        start = self._place(offset)[3]
        # A character has at most four bytes.
        text = self._decode(start, min(len(self.data), start + 4 * _MOST_EXCERPT))
        return text.partition("\n")[0][:_MOST_EXCERPT]

    def _place(self, offset: int) -> tuple[int, int, int, int]:
        index = len(self._places)
        # Most requests are in the order of the file.
        if self._places[-1][0] > offset:
            index = bisect_left(self._places, (offset + 1,))
        known, line, column, start = self._places[index - 1]
        if known == offset:
            return self._places[index - 1]
        breaks = self.data.count(b"\n", known, offset)
        if breaks:
            start = self.data.rfind(b"\n", known, offset) + 1
            line, column, known = line + breaks, 1, start
        width = offset - known
        if self._wide:
            width = len(self.data[known:offset].translate(None, _CONTINUATION))
        place = (offset, line, column + width, start)
        self._places.insert(index, place)
        return place

    def _decode(self, begin: int, end: int) -> str:
        # A range that is cut off may end within a character.
        return self.data[begin:end].decode(self._encoding, "ignore")

    def _in_dead(self, offset: int) -> bool:
        return _is_within(self._dead, offset)

    @cached_property
    def _dead(self) -> tuple[tuple[int, int], ...]:
        return tuple(_dead_stretches(self.data)) if self._lexicon == "c" else ()


def _is_within(spans: Sequence[tuple[int, int]], offset: int) -> bool:
    """Whether an offset is in one of some spans, which are sorted."""
    index = bisect_right(spans, offset, key=lambda span: span[0])
    return index > 0 and offset < spans[index - 1][1]


def _dead_stretches(data: bytes) -> Iterator[tuple[int, int]]:
    """Yield the ranges between `#if 0` and its `#else`, `#elif` or `#endif`."""
    first = _DEAD_IF.search(data)
    if first is None:
        return
    depth = begin = 0
    for line in _CONDITION.finditer(data, first.start()):
        kind = line.lastgroup
        if not (depth or kind == "dead") or not _begins_line(data, line.start()):
            continue
        if not depth:
            depth, begin = 1, line.end()
        elif kind in ("dead", "open"):
            depth += 1
        elif kind == "close" or depth == 1:
            depth -= 1
            if not depth:
                yield begin, line.start()
    if depth:
        yield begin, len(data)


def _begins_line(data: bytes, at: int) -> bool:
    start = data.rfind(b"\n", 0, at) + 1
    return start == at or not data[start:at].strip(b" \t")
