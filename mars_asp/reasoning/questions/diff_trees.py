"""Lines of launch trees that differ between two robots: those of nodes, and those of all files."""

from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from sys import maxsize

from mars_asp.asp.solve.atoms import Fact
from mars_asp.diagnostic import Span, point

#: Facts that compare nodes, or locate them.
_OBSERVED = frozenset({"place", "starts_like"})
#: The path of a file, relative to the folder of the robot, and the text of a line.
_Line = tuple[str, str]


class TreeLines:
    """The lines from which the launch trees of a robot were read, and the facts of each node."""

    def __init__(
        self, facts: Sequence[Fact], folder: str, lines_of: Callable[[str], Sequence[str]]
    ) -> None:
        """Take the facts of launch trees; paths are compared relative to the robot's folder."""
        folder = folder.rstrip("/")
        self._prefix = "" if folder == "." else f"{folder}/"
        self._facts: dict[str, dict[str, set[Span]]] = {}
        for owner, text, span in _of_nodes(facts):
            spans = self._facts.setdefault(owner, {})
            spans.setdefault(self._relative(text), set()).add(span)
        #: The lines of each file that are locations of facts, sorted.
        self._starts: dict[str, list[int]] = {}
        for path, line in sorted({(fact.span.path, fact.span.line) for fact in facts}):
            self._starts.setdefault(path, []).append(line)
        self._lines = {path: [line.strip() for line in lines_of(path)] for path in self._starts}
        self._count = Counter(line for _, line in self._located())

    def _relative(self, text: str) -> str:
        return text.replace(self._prefix, "") if self._prefix else text

    def _located(self) -> Iterator[tuple[Span, _Line]]:
        for path, lines in self._lines.items():
            for number, text in enumerate(lines, 1):
                if text:
                    yield point(path, number, 1), (self._relative(path), text)

    def lines_beyond(self, other: "TreeLines") -> tuple[Span, ...]:
        """Return the lines that the other robot lacks; of repeated lines, the surplus."""
        left = Counter(other._count)
        found = []
        for span, line in self._located():
            left[line] -= 1
            if left[line] < 0:
                found.append(span)
        return tuple(found)

    def of_nodes(self, names: Iterable[str], other: "TreeLines") -> set[Span]:
        """Return the locations of facts about some nodes, which the other robot lacks."""
        return {
            span
            for name in names
            for text, spans in self._facts.get(name, {}).items()
            if text not in other._facts.get(name, {})
            for span in spans
        }

    def split(
        self, spans: Iterable[Span], differing: Sequence[Span]
    ) -> tuple[frozenset[Span], frozenset[Span]]:
        """Return the lines among `differing` in the statements at some locations, and the others.

        A statement ends before the next location of a fact.
        """
        lines: dict[str, list[int]] = {}
        for each in differing:
            lines.setdefault(each.path, []).append(each.line)
        changed: set[Span] = set()
        unchanged: set[Span] = set()
        for span in spans:
            starts, found = self._starts.get(span.path, ()), lines.get(span.path, ())
            after = bisect_right(starts, span.line)
            end = starts[after] if after < len(starts) else maxsize
            within = [line for line in found if span.line <= line < end]
            changed.update(point(span.path, line, 1) for line in within)
            if not within:
                unchanged.add(span)
        return frozenset(changed), frozenset(unchanged)

    def naming(self, words: Collection[str], spans: Iterable[Span]) -> frozenset[Span]:
        """Return those of some locations whose line has one of the words."""
        lines = ((span, self._lines[span.path][span.line - 1]) for span in spans)
        return frozenset(span for span, line in lines if any(word in line for word in words))


def _of_nodes(facts: Iterable[Fact]) -> Iterator[tuple[str, str, Span]]:
    """Yield the name of the node of each fact, the text of the fact without numbers, its place."""
    owners: dict[object, str] = {}
    for fact in facts:
        name, (first, *rest) = fact.atom.name, fact.atom.arguments
        if name == "launched":
            owners[first] = str(rest[-1])
        elif first not in owners and isinstance(first, int) and rest and rest[0] in owners:
            # The end of a topic, an input or a renaming, which has a number of its own.
            owners[first] = owners[rest.pop(0)]
        if isinstance(first, int) and first in owners and name not in _OBSERVED:
            yield owners[first], f"{name}({','.join(map(str, rest))})", fact.span
