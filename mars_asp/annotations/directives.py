"""Annotation lines: which of our words stands there, and what stands behind it."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from mars_asp.annotations.comments import CommentLine, Lexed
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


@dataclass(frozen=True, slots=True)
class Directive:
    """One annotation: `word` is ours, `written` as it stands.

    `offset` is that of the `@`, `end` the one behind the annotation. `rest` is what stands behind
    the word; `pieces` say where each of its lines begins, in `rest` and in the file.
    """

    word: str
    written: str
    rest: str
    offset: int
    end: int
    pieces: tuple[tuple[int, int], ...]

    @property
    def is_plainly_ours(self) -> bool:
        """Whether no other use of comments writes such a line, however it is spelt."""
        return "_" in self.word or _DELIVERY.match(self.rest) is not None

    def place(self, index: int) -> int:
        """Return the offset in the file of a character of `rest`."""
        begin, offset = max(piece for piece in self.pieces if piece[0] <= index)
        return offset + index - begin


@dataclass(frozen=True, slots=True)
class Misspelt:
    """A word that is nearly ours; `corrected` is what it should be."""

    written: str
    corrected: Directive


def directives(source: Lexed) -> Iterator[Directive | Misspelt]:
    """Yield the annotations of a source in order, comma-wrapped ones joined."""
    comments = source.comments
    index = 0
    while index < len(comments):
        comment = comments[index]
        index += 1
        match = _DIRECTIVE.match(comment.text)
        if match is None:
            continue
        word = _LOWER.get(match[1].lower())
        meant = word or nearest(match[1])
        if meant is None:
            continue
        # Pieces are joined once: a comment may go on for very many lines.
        lines = [(comment.offset + match.start(3), _REMARK.split(match[3], maxsplit=1)[0])]
        end = comment.offset + len(comment.text)
        while lines[-1][1].rstrip().endswith(",") and _continues(source, comments, index):
            following = comments[index]
            lines.append((following.offset, _REMARK.split(following.text, maxsplit=1)[0]))
            end = following.offset + len(following.text)
            index += 1
        pieces, length = [], 0
        for offset, text in lines:
            pieces.append((length, offset))
            length += len(text.rstrip()) + 1
        rest = " ".join(text.rstrip() for _, text in lines)
        written = match[1] + match[2]
        is_right = word is not None and not match[2]
        directive = Directive(
            meant, written if is_right else meant, rest, comment.offset, end, tuple(pieces)
        )
        yield directive if is_right else Misspelt(written, directive)


def _continues(source: Lexed, comments: Sequence[CommentLine], index: int) -> bool:
    """Say whether the next comment line stands on the next line and begins nothing of its own."""
    if index >= len(comments) or comments[index].text.startswith("@"):
        return False
    line = source.position(comments[index - 1].offset)[0]
    return source.position(comments[index].offset)[0] == line + 1


@lru_cache(maxsize=1024)
def nearest(word: str) -> str | None:
    """Return our word within two edits of another one."""
    if len(word) > _MOST_MISSPELT:
        return None
    near = [(edits(word, ours), ours) for ours in WORDS if abs(len(ours) - len(word)) < 3]
    distance, ours = min(near, default=(3, ""))
    return ours if distance <= 2 else None


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
