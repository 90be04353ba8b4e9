"""Annotation lines: their words, and the text after each word."""

import re
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from mars_asp.annotations.sources import Source
from mars_asp.model import attributes
from mars_asp.model.declarations import DELIVERY_MODES, GRASP, MOTION_FUNCTIONS, SERVICE_KINDS
from mars_asp.model.names import QUOTED

BOUNDARIES = ("module_start", "module_name", "module_end")
OVERRIDES = ("Output", "Input", "Port", "Signature", "Window")
WORDS = (
    *(*BOUNDARIES, *SERVICE_KINDS, *MOTION_FUNCTIONS, GRASP, "Vertex", "Guard"),
    *(*attributes.WORDS, *OVERRIDES),
)
_LOWER = {word.lower(): word for word in WORDS}
#: A word, the text attached to it, and the rest of the line.
_DIRECTIVE = re.compile(r"@([A-Za-z]\w*)(?![\w(.]|\s*:(?!:))(\S*)(?:\s+|$)(.*)")
#: A `--` in quotes begins no remark.
_REMARK = re.compile(rf"(?P<quoted>{QUOTED})|(?:^|\s)--(?:\s|$)")
_DELIVERY = re.compile(rf"(?i)\s*(?:{'|'.join(DELIVERY_MODES)})\b")
_LETTERS = {word: frozenset(word) for word in WORDS}
_MOST_MISSPELT = 20
_SHORT = 4
#: The maximal number of unknown words in one file that are compared with annotation words.
MOST_OTHERS = 500
#: The maximal length of the text after an annotation's word; more is cut off.
MOST_CHARACTERS = 8192


class Directive(NamedTuple):
    """One annotation: its correct `word`, and the word as `written`.

    `offset` is that of the `@`, `end` that of the end of the annotation, `until` that of the end of
    its comment, where code may follow. `rest` is the text after the word; `pieces` are the offsets
    at which each line of `rest` begins, in `rest` and in the file.
    """

    word: str
    written: str
    rest: str
    offset: int
    end: int
    until: int
    pieces: tuple[tuple[int, int], ...]

    def place(self, index: int) -> int:
        """Return the offset in its file of a character of `rest`."""
        begin, offset = self.pieces[bisect_left(self.pieces, (index + 1,)) - 1]
        return offset + index - begin


@dataclass(frozen=True, slots=True)
class Misspelt:
    """A word that resembles an annotation word; `corrected` has the right word."""

    written: str
    corrected: Directive


@dataclass(frozen=True, slots=True)
class Uncompared:
    """The first unknown word after too many unknown words to compare."""

    offset: int


class _DirectiveWords:
    """Finds annotation words and misspelt ones; `meant` has the correct word of each."""

    def __init__(self) -> None:
        self.meant: dict[str, str] = {}
        self.others = 0
        self.uncompared: Uncompared | None = None

    def is_near(self, word: str, offset: int) -> bool:
        meant = _LOWER.get(word.lower())
        if meant is None:
            self.others += 1
            if self.others > MOST_OTHERS:
                self.uncompared = self.uncompared or Uncompared(offset)
                return False
            meant = nearest(word)
        if meant is not None:
            self.meant[word] = meant
        return meant is not None


def directives(source: Source) -> Iterator[Directive | Misspelt | Uncompared]:
    """Yield the annotations of a source in order; lines that end with a comma are joined.

    Outside of modules, a misspelt word belongs to another tool unless its form is unmistakable.
    """
    words = _DirectiveWords()
    inside = False
    for line in source.annotations(words.is_near):
        match = _DIRECTIVE.match(line.text)
        if match is None:
            continue
        written, meant = match[1] + match[2], words.meant[match[1]]
        # No other use of comments has such a line, even if the word is misspelt.
        plain = "_" in meant or _DELIVERY.match(match[3])
        if not (inside or written == meant or plain):
            continue
        # Texts are joined once: a comment may have very many lines.
        texts = [_without_remark(match[3])]
        pieces = [(0, line.offset + match.start(3))]
        last, length = line, 0
        while texts[-1].endswith(",") and length <= MOST_CHARACTERS:
            below = source.following(last)
            if below is None:
                break
            length += len(texts[-1]) + 1
            texts.append(_without_remark(below.text))
            pieces.append((length, below.offset))
            last = below
        is_right = match[1].lower() in _LOWER and not match[2]
        directive = Directive(
            meant,
            written if is_right else meant,
            " ".join(texts),
            line.offset,
            last.offset + len(last.text),
            last.until,
            tuple(pieces),
        )
        yield directive if is_right else Misspelt(written, directive)
        if meant in ("module_start", "module_end"):
            inside = meant == "module_start"
    if words.uncompared is not None:
        yield words.uncompared


def _without_remark(text: str) -> str:
    if "--" in text:
        remarks = (match.start() for match in _REMARK.finditer(text) if match["quoted"] is None)
        text = text[: next(remarks, None)]
    return text.rstrip()


@lru_cache(maxsize=1024)
def nearest(word: str) -> str | None:
    """Return the annotation word within two edits of a word, or None."""
    if len(word) > _MOST_MISSPELT:
        return None
    letters = set(word)
    # An edit changes two letters at most.
    alike = (ours for ours, own in _LETTERS.items() if len(letters ^ own) <= 4)
    near = [ours for ours in alike if abs(len(ours) - len(word)) <= 2 and edits(word, ours) <= 2]
    # A short word has many neighbours that other tools use: `@post` is not `@Port`.
    near = [ours for ours in near if len(ours) > _SHORT or edits(word, ours) == 1]
    # Among several words, the nearest one regardless of case: `@ouput` is not `@Input`.
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
