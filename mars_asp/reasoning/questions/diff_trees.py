"""Lines of launch trees that differ between two robots, and those that caused a finding."""

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from difflib import SequenceMatcher
from pathlib import PurePath, PurePosixPath
from sys import maxsize
from typing import NamedTuple

import clingo

from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.trace import Trace
from mars_asp.asp.trace.text import steps_of
from mars_asp.asp.trace.tree import Absent, Given
from mars_asp.diagnostic import Span, point
from mars_asp.reasoning.findings import MEANINGS
from mars_asp.reasoning.questions.diff_lines import FileLine, differing_lines, file_lines
from mars_asp.reasoning.session import Evidence

#: Facts that compare nodes, or locate them.
_OBSERVED = frozenset({"place", "starts_like"})
#: Files in which a package lists the programs and files that it installs.
_BUILD_FILES = frozenset({"CMakeLists.txt", "package.xml", "setup.cfg", "setup.py"})
_ANYTHING = re.compile(r"(?<=[(,])_(?=[,)])")


class _TreeFact(NamedTuple):
    """A fact with its node, "" if it has none, and its text without numbers and folder."""

    owner: str
    text: str
    words: frozenset[str]
    span: Span


def matching(
    pattern: str,
    symbols: Callable[[str, int], Iterable[clingo.Symbol]],
    wanted_text: Callable[[str], str] = str,
    found_text: Callable[[str], str] = str,
) -> Iterator[clingo.Symbol]:
    """Yield the symbols that match an atom as text, in which `_` is any argument.

    An atom with a number is skipped, as identifiers belong to one robot only. `wanted_text` and
    `found_text` make the texts of arguments comparable.
    """
    try:
        wanted = clingo.parse_term(_ANYTHING.sub("_any", pattern))
    except RuntimeError:
        return
    if any(argument.type == clingo.SymbolType.Number for argument in wanted.arguments):
        return
    texts = [wanted_text(str(argument)) for argument in wanted.arguments]
    for symbol in symbols(wanted.name, len(wanted.arguments)):
        pairs = zip(texts, symbol.arguments, strict=True)
        if all(text in ("_any", found_text(str(found))) for text, found in pairs):
            yield symbol


class TreeLines:
    """The lines from which the launch trees of a robot were read, and the facts of each node."""

    def __init__(
        self,
        evidence: Evidence | None,
        folder: str,
        lines_of: Callable[[str], Sequence[str]],
        paths: Iterable[str],
    ) -> None:
        """Take facts and findings of launch trees, and `paths` of further files to compare.

        Paths are compared relative to the folder.
        """
        folder = folder.rstrip("/")
        self._prefix = "" if folder == "." else f"{folder}/"
        self._evidence, self._lines_of = evidence, lines_of
        facts = () if evidence is None else evidence.facts
        self._tree_facts = {
            str(fact.atom): _TreeFact(owner, text, words, fact.span)
            for fact, owner, text, words in _without_numbers(facts, self._relative)
        }
        self._count = Counter(each[:2] for each in self._tree_facts.values())
        #: The lines of each file that are locations of facts, sorted.
        self._starts: dict[str, list[int]] = {}
        for path, line in sorted({(fact.span.path, fact.span.line) for fact in facts}):
            self._starts.setdefault(path, []).append(line)
        known = (*self._starts, *paths)
        builds = (path for each in known for path in _build_files(each, self._prefix))
        self._paths = tuple(dict.fromkeys((*known, *builds)))
        self._lines: dict[str, Sequence[FileLine]] = {}

    def _relative(self, text: str) -> str:
        # An argument of an atom may be in quotation marks.
        mark = '"' if text.startswith('"') else ""
        return f"{mark}{text.removeprefix(mark).removeprefix(self._prefix)}"

    def lines_in(self, path: str) -> Sequence[FileLine]:
        """Return the lines of a file that are not blank."""
        if path not in self._lines:
            lines = self._lines_of(path)
            self._lines[path] = tuple(file_lines(path, self._relative(path), lines))
        return self._lines[path]

    def lines_beside(self, other: "TreeLines") -> Iterator[FileLine]:
        """Yield the lines of the files that either robot has facts of.

        A file that the other robot lacks may be one of it by another name.
        """
        also = (f"{self._prefix}{other._relative(path)}" for path in other._paths)
        for path in dict.fromkeys((*self._paths, *also)):
            if other.lines_in(f"{other._prefix}{self._relative(path)}"):
                yield from self.lines_in(path)
            else:
                yield from file_lines(path, "", self._lines_of(path))

    def traces_of(self, atoms: Sequence[clingo.Symbol]) -> dict[clingo.Symbol, Trace]:
        """Return the traces of some findings."""
        return {} if self._evidence is None else self._evidence.explainer.why(atoms)

    def causes(
        self, here: Trace | None, there: Trace | None, other: "TreeLines"
    ) -> frozenset[_TreeFact]:
        """Return the facts that the other robot lacks and that caused a change.

        On them rests the finding here, with the trace `here`, or what prevents that of the other
        robot, with the trace `there`.
        """
        traces = [] if here is None else [here]
        if there is not None:
            absent = {step.atom for step in steps_of(there) if isinstance(step, Absent)}
            traces += self.traces_of(sorted(self._preventing(absent, other))).values()
        atoms = {
            step.atom
            for trace in traces
            for step in steps_of(trace, MEANINGS)
            if isinstance(step, Given)
        }
        found = [self._tree_facts[atom] for atom in atoms if atom in self._tree_facts]
        return frozenset(each for each in found if self._is_surplus(each, other))

    def alike_spans(self, causes: Iterable[_TreeFact], other: "TreeLines") -> set[Span]:
        """Return the locations of surplus facts with a node and a name of some causes in common."""
        alike = {(each.owner, word) for each in causes if each.owner for word in each.words}
        return {
            each.span
            for each in self._tree_facts.values()
            if any((each.owner, word) in alike for word in each.words)
            and self._is_surplus(each, other)
        }

    def _is_surplus(self, fact: _TreeFact, other: "TreeLines") -> bool:
        return self._count[fact[:2]] > other._count[fact[:2]]

    def _preventing(self, absent: Iterable[str], other: "TreeLines") -> set[clingo.Symbol]:
        """Return the atoms here that are absent in a trace of the other robot."""
        if self._evidence is None:
            return set()
        symbols = self._evidence.analysis.grounding.symbols
        return {
            symbol
            for pattern in absent
            for symbol in matching(pattern, symbols, other._relative, self._relative)
        }

    def counterparts(
        self, spans: Iterable[Span], other: "TreeLines", differing: Collection[Span]
    ) -> frozenset[Span]:
        """Return the differing lines here in the place of differing lines of the other robot."""
        lines: dict[str, set[int]] = {}
        for span in spans:
            lines.setdefault(span.path, set()).add(span.line)
        found: set[Span] = set()
        for path, numbers in lines.items():
            own = f"{self._prefix}{other._relative(path)}"
            there, here = other.lines_in(path), self.lines_in(own)
            blocks = SequenceMatcher(None, [x.text for x in there], [x.text for x in here])
            for how, begin, end, first, last in blocks.get_opcodes():
                wanted = [at for at in range(begin, end) if there[at].span.line in numbers]
                if how != "replace" or not wanted:
                    continue
                if end - begin == last - first:
                    # As many lines replace as many: each replaces one.
                    found.update(here[first + at - begin].span for at in wanted)
                else:
                    found.update(_most_alike(there[at], here[first:last]).span for at in wanted)
        return frozenset(found.intersection(differing))

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

    def of_builds(self, file: str, spans: Iterable[Span]) -> frozenset[Span]:
        """Return those of some locations where a build file names a file or a folder of it."""
        builds = [span for span in spans if PurePath(span.path).name in _BUILD_FILES]
        return self.naming(PurePosixPath(file).parts, builds)

    def naming(self, words: Collection[str], spans: Collection[Span]) -> frozenset[Span]:
        """Return those of some locations whose line has one of the words."""
        paths = {span.path for span in spans}
        lines = {line.span: line.text for path in paths for line in self.lines_in(path)}
        return frozenset(span for span in spans if any(word in lines[span] for word in words))


def _build_files(path: str, prefix: str) -> Iterator[str]:
    """Yield the paths that build files of the package of a file may have, below a folder."""
    for folder in PurePosixPath(path).parents:
        if f"{folder}/".startswith(prefix) and (prefix or folder.name):
            yield from (str(folder / name) for name in sorted(_BUILD_FILES))


def _most_alike(line: FileLine, others: Sequence[FileLine]) -> FileLine:
    """Return the line of some others that has most text in common with a line."""
    return max(others, key=lambda each: SequenceMatcher(None, line.text, each.text).ratio())


def differing_files(
    old: TreeLines, new: TreeLines
) -> tuple[tuple[FileLine, ...], tuple[FileLine, ...]]:
    """Return the lines that each of two robots has and the other lacks."""
    return differing_lines(old.lines_beside(new), new.lines_beside(old))


def _without_numbers(
    facts: Iterable[Fact], relative: Callable[[str], str]
) -> Iterator[tuple[Fact, str, str, frozenset[str]]]:
    """Yield facts with their nodes, their texts without identifiers, and the names in them.

    `relative` makes paths relative to the folder of the robot.
    """
    owners: dict[object, str] = {}
    for fact in facts:
        name, (first, *rest) = fact.atom.name, fact.atom.arguments
        if name == "launched":
            owners[first] = str(rest[-1])
        elif first not in owners and isinstance(first, int) and rest and rest[0] in owners:
            # The end of a topic, an input or a renaming, which has a number of its own.
            owners[first] = owners[rest.pop(0)]
        if name not in _OBSERVED:
            owner = owners.get(first, "") if isinstance(first, int) else ""
            rest = rest if owner else [first, *rest]
            words = frozenset(word for word in rest if isinstance(word, str))
            yield fact, owner, f"{name}({','.join(relative(str(word)) for word in rest)})", words
