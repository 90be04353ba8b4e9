"""Lines of files that one of two robots has and the other lacks, each known by what it is under.

Independent lines may be in any order, and equal lines occur in many places of a file: the `timeout`
of each input of a mux, the closing bracket of each list. So a line is known by its text and by the
lines that it is under: by its indentation, and in an annotation by the module.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

from mars_asp.diagnostic import Span, point


class FileLine(NamedTuple):
    """A line with the file it is compared in, its location, and that of the line it is under.

    `key` is equal for lines of equal text under equal lines of one file; `above` is the key of the
    line it is under.
    """

    file: str
    text: str
    span: Span
    head: Span | None
    key: int
    above: int


def file_lines(path: str, file: str, lines: Sequence[str]) -> Iterator[FileLine]:
    """Yield the lines of a file that are not blank; `file` is its name in comparisons."""
    above: list[tuple[int, FileLine]] = []
    module: FileLine | None = None
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text:
            continue
        indent = len(line) - len(line.lstrip())
        while above and above[-1][0] >= indent:
            above.pop()
        if "@module_start" in text:
            module = None
        head = module or (above[-1][1] if above else None)
        over = hash(file) if head is None else head.key
        place, key = point(path, number, 1), hash((over, text))
        found = FileLine(file, text, place, head and head.span, key, over)
        above.append((indent, found))
        if "@module_name" in text:
            module = found
        elif "@module_end" in text:
            module = None
        yield found


def differing_lines(
    one: Iterable[FileLine], other: Iterable[FileLine]
) -> tuple[tuple[FileLine, ...], tuple[FileLine, ...]]:
    """Return the lines that each of two robots has and the other lacks.

    Of repeated lines only the surplus differs. Lines under a line that differs, as under a name
    that was changed, are compared by the texts down to them from that line, in their order.
    """
    one, other = tuple(one), tuple(other)
    rests = _surplus(one, other), _surplus(other, one)
    (texts, old), (others, new) = map(_under_differing, rests)
    under, matches = (old, new), SequenceMatcher(None, texts, others).get_matching_blocks()
    same: tuple[set[Span], set[Span]] = set(), set()
    for *begins, size in matches:
        for found, lines, begin in zip(same, under, begins, strict=True):
            found.update(line.span for line in lines[begin : begin + size])
    gone, come = (
        tuple(line for line in rest if line.span not in found)
        for rest, found in zip(rests, same, strict=True)
    )
    return gone, come


def _surplus(lines: Iterable[FileLine], others: Iterable[FileLine]) -> list[FileLine]:
    left = Counter(line.key for line in others)
    found = []
    for line in lines:
        left[line.key] -= 1
        if left[line.key] < 0:
            found.append(line)
    return found


def _under_differing(lines: Sequence[FileLine]) -> tuple[list[tuple[int, int]], list[FileLine]]:
    """Return the lines under another one of the lines, and for each what it is known by.

    That is what its topmost line that differs is under, and the texts from there.
    """
    known: dict[Span, tuple[int, int]] = {}
    found = []
    for line in lines:
        if line.head is None or line.head not in known:
            known[line.span] = line.above, 0
        else:
            above, texts = known[line.head]
            known[line.span] = above, hash((texts, line.text))
            found.append(line)
    return [known[line.span] for line in found], found
