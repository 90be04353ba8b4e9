"""Annotation lines: which of our words stands there, and what stands behind it."""

import re
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from mars_asp.annotations.sources import Source
from mars_asp.model import DELIVERY_MODES, GRASP, MOTION_FUNCTIONS, SERVICE_KINDS

BOUNDARIES = ("module_start", "module_name", "module_end")
OVERRIDES = ("Output", "Input", "Signature")
WORDS = (*BOUNDARIES, *SERVICE_KINDS, *MOTION_FUNCTIONS, GRASP, "Vertex", *OVERRIDES)
_LOWER = {word.lower(): word for word in WORDS}
#: A word, what is glued to it, and the rest of the line.
_DIRECTIVE = re.compile(r"@([A-Za-z]\w*)(?![\w(.]|\s*:(?!:))(\S*)(?:\s+|$)(.*)")
_REMARK = re.compile(r"(?:^|\s)--(?:\s|$)")
_DELIVERY = re.compile(rf"(?i)\s*(?:{'|'.join(DELIVERY_MODES)})\b")
_MOST_MISSPELT = 20
#: What stands behind the word of an annotation may be so long; what goes on longer is cut.
MOST_CHARACTERS = 8192


@dataclass(frozen=True, slots=True)
class Directive:
    """One annotation: `word` is ours, `written` as it stands.

    `offset` is that of the `@`, `end` the one behind the annotation, `until` the one behind its
    comment, from which code may stand. `rest` is what stands behind the word; `pieces` say where
    each of its lines begins, in `rest` and in the file.
    """

    word: str
    written: str
    rest: str
    offset: int
    end: int
    until: int
    pieces: tuple[tuple[int, int], ...]

    @property
    def is_plainly_ours(self) -> bool:
        """Whether no other use of comments writes such a line, however it is spelt."""
        return "_" in self.word or _DELIVERY.match(self.rest) is not None

    def place(self, source: Source, index: int) -> int:
        """Return the offset in its file of a character of `rest`."""
        begin, offset = self.pieces[bisect_left(self.pieces, (index + 1,)) - 1]
        return source.within(offset, self.rest[begin:], index - begin)


@dataclass(frozen=True, slots=True)
class Misspelt:
    """A word that is nearly ours; `corrected` is what it should be."""

    written: str
    corrected: Directive


def directives(source: Source) -> Iterator[Directive | Misspelt]:
    """Yield the annotations of a source in order, comma-wrapped ones joined."""
    for line in source.annotations(_is_near):
        match = _DIRECTIVE.match(line.text)
        meant = match and (_LOWER.get(match[1].lower()) or nearest(match[1]))
        if match is None or meant is None:
            continue
        # Pieces are joined once: a comment may go on for very many lines.
        texts = [_REMARK.split(match[3], maxsplit=1)[0].rstrip()]
        pieces = [(0, source.within(line.offset, line.text, match.start(3)))]
        last, length = line, 0
        while texts[-1].endswith(",") and length <= MOST_CHARACTERS:
            below = source.following(last)
            if below is None:
                break
            length += len(texts[-1]) + 1
            texts.append(_REMARK.split(below.text, maxsplit=1)[0].rstrip())
            pieces.append((length, below.offset))
            last = below
        end = source.within(last.offset, last.text, len(last.text))
        written = match[1] + match[2]
        is_right = match[1].lower() in _LOWER and not match[2]
        directive = Directive(
            meant,
            written if is_right else meant,
            " ".join(texts),
            line.offset,
            end,
            last.until,
            tuple(pieces),
        )
        yield directive if is_right else Misspelt(written, directive)


def _is_near(word: str) -> bool:
    return word.lower() in _LOWER or nearest(word) is not None


@lru_cache(maxsize=1024)
def nearest(word: str) -> str | None:
    """Return our word within two edits of another one."""
    if len(word) > _MOST_MISSPELT:
        return None
    near = [ours for ours in WORDS if abs(len(ours) - len(word)) < 3 and edits(word, ours) <= 2]
    # Of several the one that is nearest whatever the capitals: `@ouput` is no `@Input`.
    return min(near, key=lambda ours: (edits(word.lower(), ours.lower()), ours), default=None)


def edits(first: str, second: str) -> int:
    """Return the number of edits between two words; swapped neighbours are one (Damerau 1964)."""
    before: list[int] = []
    above = list(range(len(second) + 1))
    for row, left in enumerate(first, 1):
        current = [row]
        for column, right in enumerate(second, 1):
            cost = min(above[column] + 1, current[-1] + 1, above[column - 1] + (left != right))
            swapped = row > 1 and column > 1 and first[row - 2] == right
            if swapped and left == second[column - 2]:
                cost = min(cost, before[column - 2] + 1)
            current.append(cost)
        before, above = above, current
    return above[-1]
