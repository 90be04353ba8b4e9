"""A source: its comment lines that begin with an annotation, its code, and locations in it."""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

from mars_asp.annotations.comments import (
    annotated_comments,
    annotation_end,
    blanked,
    inner_comments,
    tokens,
)
from mars_asp.diagnostic import FileText

#: The text before the first word of a comment, and of its further lines, by the kind of comment. A
#: mark of another kind begins code that was commented out.
_OPENING = {
    "c": r"(?:/\*[*!]?|//[/!]?)?[ \t]*+",
    "python": r"#*+[ \t]*+",
    "matlab": r"%*+[ \t]*+",
}
_BELOW = {
    "/*": r"[ \t]*+(?:\*(?!/))?[ \t]*+",
    "//": r"[ \t]*+(?://[/!]?)?[ \t]*+",
    "%{": r"[ \t]*+",
}
_ANNOTATION = r"@([A-Za-z]\w*+)"
_OPENING_HERE = {language: re.compile(pattern) for language, pattern in _OPENING.items()}
_BELOW_HERE = {mark: re.compile(pattern) for mark, pattern in _BELOW.items()}
_ANNOTATED = {language: re.compile(pattern + _ANNOTATION) for language, pattern in _OPENING.items()}
_ANNOTATED_BELOW = {
    mark: re.compile(r"\n" + pattern + _ANNOTATION) for mark, pattern in _BELOW.items()
}
_DEAD = r"if[ \t]++(?:0|false)[ \t]*+(?://[^\n]*+)?(?=\n|\Z)"
_DEAD_IF = re.compile(rf"#[ \t]*+{_DEAD}")
#: A preprocessor line of a condition, to its end.
_CONDITION = re.compile(
    rf"#[ \t]*+(?:(?P<dead>{_DEAD})|(?P<open>if|ifdef|ifndef)\b[^\n]*+"
    r"|(?P<other>else|elif)\b[^\n]*+|(?P<close>endif)\b[^\n]*+)"
)
_MOST_EXCERPT = 400
#: The maximal distance of a continuing comment after an annotation with a final comma.
_MOST_BETWEEN = 4096


class CommentLine(NamedTuple):
    """One line of a comment.

    `offset` is the begin of its text after the marks, `end` the end of the line, `until` the end of
    the comment; `mark` are the first two characters of the comment.
    """

    offset: int
    text: str
    end: int
    until: int
    mark: str


@dataclass(frozen=True, slots=True)
class SourceRange:
    """A range of a source, and the same range with comments and strings blanked.

    `cut` is whether it ends at the maximal length.
    """

    text: str
    code: str
    cut: bool


class Source(FileText):
    """A text whose lines end with LF and which begins with no byte order mark."""

    def __init__(self, path: str, language: str, text: str) -> None:
        """Keep a text; `language` is a key of those in `comments`."""
        super().__init__(path, text)
        self.language = "c" if language == "mars" else language
        self._lexicon = language
        self._kind = language if language in _OPENING else "c"

    def annotations(self, known: Callable[[str, int], bool]) -> Iterator[CommentLine]:
        """Yield the comment lines that begin with `@` and a known word, in order.

        Args:
            known: Whether a word is known; called with the word and the offset of its first `@`.
        """
        text, dead = self.text, self._dead
        ours: dict[str, bool] = {}
        for begin, end in annotated_comments(self._lexicon, text):
            if dead and self._in_dead(begin):
                continue
            mark = text[begin : begin + 2]
            match = _ANNOTATED[self._kind].match(text, begin, end)
            found: Iterable[re.Match[str]] = [] if match is None else [match]
            if mark in _ANNOTATED_BELOW and text.find("\n", begin, end) >= 0:
                found = chain(found, _ANNOTATED_BELOW[mark].finditer(text, begin, end))
                if mark != "//":
                    inner = tuple(inner_comments(self._lexicon, text, begin, end))
                    found = (match for match in found if not _is_within(inner, match.start(1)))
            for match in found:
                word, at = match[1], match.start(1) - 1
                if word not in ours:
                    ours[word] = known(word, at)
                if ours[word]:
                    yield self._comment_line(at, end, mark)

    def following(self, line: CommentLine) -> CommentLine | None:
        """Return the comment line below, which may continue an annotation, or None.

        It is None if it is an annotation itself. In a configuration, whose annotations have no
        comment marks, it is the line below, or None if that ends a declaration.
        """
        begin, until, mark = line.end + 1, line.until, line.mark
        opening = _BELOW_HERE.get(mark)
        if self.is_configuration:
            begin = self.text.find("\n", line.end) + 1
            until = annotation_end(self.text, begin) if begin else 0
            if begin >= until or ";" in self.text[begin:until]:
                return None
        elif begin > until:
            found = self._comment_below(line.end)
            if found is None:
                return None
            begin, until = found
            mark, opening = self.text[begin : begin + 2], None
        elif begin == until:
            return None
        match = (opening or _OPENING_HERE[self._kind]).match(self.text, begin, until)
        below = self._comment_line(match.end() if match else begin, until, mark)
        return None if below.text.startswith("@") else below

    def _comment_line(self, offset: int, until: int, mark: str) -> CommentLine:
        """Return the comment line whose text begins at `offset`, in a comment up to `until`."""
        end = self.text.find("\n", offset, until)
        end = until if end < 0 else end
        line = self.text[offset:end].rstrip()
        if mark == "/*":
            line = line.removesuffix("*/").rstrip()
        return CommentLine(offset, line, end, until, mark)

    def _comment_below(self, end: int) -> tuple[int, int] | None:
        """Return begin and end of the comment on the line below, or None without one."""
        last = min(end + _MOST_BETWEEN, len(self.text))
        first = self.text.find("\n", end, last)
        if first < 0:
            return None
        below = self.text.find("\n", first + 1, last)
        for begin, until, kind in tokens(self._lexicon, self.text, end):
            if begin >= (last if below < 0 else below):
                return None
            if kind == "comment" and not self._in_dead(begin):
                return (begin, until) if begin > first else None
        return None

    def stretch(self, begin: int, end: int, most: int) -> SourceRange:
        """Return the text between two offsets, at most `most` characters.

        No string or comment may be open at `begin`; it is for example the end of a comment.
        """
        last = min(end, begin + most)
        text = self.text[begin:last]
        code = blanked(self._lexicon, text)
        for low, high in self._dead[bisect_right(self._dead, (begin,)) :]:
            if low >= last:
                break
            first, after = low - begin, min(high, last) - begin
            code = code[:first] + re.sub(r"[^\n]", " ", code[first:after]) + code[after:]
        return SourceRange(text, code, last < end)

    @property
    def is_configuration(self) -> bool:
        """Whether annotations have no comment marks, as in the blocks of a `.mars` file."""
        return self._lexicon == "mars"

    def excerpt(self, offset: int) -> str:
        """Return the line of an offset, at most its first 400 characters."""
        start = self.text.rfind("\n", 0, offset) + 1
        return self.text[start : start + _MOST_EXCERPT].partition("\n")[0]

    def _in_dead(self, offset: int) -> bool:
        return _is_within(self._dead, offset)

    @cached_property
    def _dead(self) -> tuple[tuple[int, int], ...]:
        return tuple(_dead_stretches(self.text)) if self._lexicon == "c" else ()


def _is_within(spans: Sequence[tuple[int, int]], offset: int) -> bool:
    """Whether an offset is in one of the sorted ranges."""
    index = bisect_right(spans, offset, key=lambda span: span[0])
    return index > 0 and offset < spans[index - 1][1]


def _dead_stretches(text: str) -> Iterator[tuple[int, int]]:
    """Yield the ranges between `#if 0` and its `#else`, `#elif` or `#endif`."""
    first = _DEAD_IF.search(text)
    if first is None:
        return
    depth = begin = 0
    for line in _CONDITION.finditer(text, first.start()):
        kind = line.lastgroup
        start = text.rfind("\n", 0, line.start()) + 1
        begins_line = not text[start : line.start()].strip(" \t")
        if not (depth or kind == "dead") or not begins_line:
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
        yield begin, len(text)
