"""Annotation lines: which of our words stands there, and what stands behind it."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from mars_asp.annotations.comments import CommentLine, Lexed
from mars_asp.model import GRASP, MOTION_FUNCTIONS, SERVICE_KINDS

BOUNDARIES = ("module_start", "module_name", "module_end")
OVERRIDES = ("Output", "Input", "Signature")
WORDS = (*BOUNDARIES, *SERVICE_KINDS, *MOTION_FUNCTIONS, GRASP, "Vertex", *OVERRIDES)
_LOWER = {word.lower(): word for word in WORDS}
_DIRECTIVE = re.compile(r"@([A-Za-z]\w*)(?![\w:(.])(?:[ \t]+|$)(.*)")
_MOST_MISSPELT = 20


@dataclass(frozen=True, slots=True)
class Directive:
    """One annotation: `word` is ours, `written` as it stands; offsets are of `@` and of `rest`."""

    word: str
    written: str
    rest: str
    offset: int
    rest_offset: int
    end: int


@dataclass(frozen=True, slots=True)
class Misspelt:
    """A word that is nearly ours, `meant`."""

    written: str
    meant: str
    offset: int
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
        if word is None:
            meant = nearest(match[1])
            if meant is not None:
                end = comment.offset + len(comment.text)
                rest = match[2].split(" -- ")[0].rstrip()
                begin = comment.offset + match.start(2)
                meant_one = Directive(meant, meant, rest, comment.offset, begin, end)
                yield Misspelt(match[1], meant, comment.offset, meant_one)
            continue
        # Pieces are joined once: a comment may go on for very many lines.
        pieces, end = [match[2]], comment.offset + len(comment.text)
        while _is_open(pieces[-1]) and _continues(source, comments, index):
            pieces.append(comments[index].text)
            end = comments[index].offset + len(comments[index].text)
            index += 1
        rest = " ".join(pieces)
        rest = re.split(r"(?:^|\s)--(?:\s|$)", rest, maxsplit=1)[0].rstrip()
        yield Directive(word, match[1], rest, comment.offset, comment.offset + match.start(2), end)


def _is_open(piece: str) -> bool:
    return piece.split(" -- ", maxsplit=1)[0].rstrip().endswith(",")


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
