"""Changes between two configurations, and the lines that caused them.

A line has changed if its facts, apart from identifiers, are not those of any line of the other
configuration; so order, comments and layout do not matter. Values that only runs and diagrams use,
such as bounds, count as well. The line is added or removed if its text, or that of the declaration
after it, differs as well; otherwise the same text has another effect in each configuration.
"""

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, zip_longest
from typing import Generic, Literal, TypeAlias, TypeVar

import clingo

from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace import Trace
from mars_asp.asp.trace.text import steps_of
from mars_asp.asp.trace.tree import Absent, Given
from mars_asp.diagnostic import Span, point
from mars_asp.language.print import print_transformation
from mars_asp.model.declarations import VERBS
from mars_asp.model.transformation import normalized
from mars_asp.reasoning.analysis import Consequence
from mars_asp.reasoning.facts.compile import FRAMES, NOWHERE
from mars_asp.reasoning.facts.rates import Rates
from mars_asp.reasoning.findings import MEANINGS
from mars_asp.reasoning.launch_trees import STAGE, analyse_trees, launch_rules
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.blame import reasons
from mars_asp.reasoning.questions.diff_lines import FileLine, differing_lines, file_lines
from mars_asp.reasoning.questions.diff_trees import TreeLines, differing_files, matching
from mars_asp.reasoning.questions.unrealised import unrealised
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Evidence, Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode
from mars_asp.reasoning.synthesis.synthesise import Synthesis
from mars_asp.reasoning.verification import mount_tuples

How: TypeAlias = Literal["appeared", "vanished", "changed"]
#: The facts of a line, without the identifiers of one file.
_LineFacts: TypeAlias = tuple[str, ...]
#: Returns the lines of a file by its path, or none if they are not known.
LinesOf: TypeAlias = Callable[[str], Sequence[str]]
Item = TypeVar("Item")
#: Predicates whose last argument is a rate, as a number that depends on the other rates of a file.
_RATES = frozenset({"required_rate", "offered_rate"})
#: Consequences whose side lines, with their times and priorities, the message leaves out.
_OF_SIDE_LINES = frozenset({"suppression", "inhibition", "lock", "limit"})
_SIDE_LINES = ("is_", "closes_for(", "lock_priority(", "bound_hold(")
#: Facts about the whole configuration, located at lines that do not state them.
_OBSERVED = frozenset(
    {"place", "closed_walk", "entangled", "spelt", "resembles", "in_words"}
    | {"near", "takes_in", "input_of", "output_of", "port_name", "rounded", "multiple"}
    | FRAMES
    | {"below_period"}
)


@dataclass(frozen=True, slots=True)
class Change(Generic[Item]):
    """A consequence or node that is in one configuration only, or differs in both.

    `added` and `removed` are the lines that caused it, which only the new or only the old
    configuration has. `unchanged` are lines of both whose effect differs.
    """

    how: How
    old: Item | None
    new: Item | None
    added: tuple[Span, ...]
    removed: tuple[Span, ...]
    unchanged: tuple[Span, ...] = ()

    @property
    def item(self) -> Item:
        """Return the changed thing in the new configuration, else in the old one."""
        item = self.old if self.new is None else self.new
        assert item is not None
        return item

    @property
    def cited(self) -> tuple[Span, ...]:
        """Return the differing lines that caused it."""
        return (*self.added, *self.removed)


@dataclass(frozen=True, slots=True)
class Difference:
    """All changes; a synthesis is `None` if nothing realises that configuration.

    Nodes are only compared if both configurations have a specification.
    """

    added: tuple[Span, ...]
    removed: tuple[Span, ...]
    consequences: tuple[Change[Consequence], ...]
    nodes: tuple[Change[IntroducedNode], ...]
    old: Synthesis | None
    new: Synthesis | None
    #: The sentences that no specification realises one of them, or each.
    unrealised: tuple[str, ...]

    @property
    def is_empty(self) -> bool:
        """Whether no consequence and no node changed."""
        return not self.consequences and not self.nodes

    @property
    def has_new_errors(self) -> bool:
        """Whether an error appeared."""
        return any(
            change.how == "appeared" and change.item.severity == "error"
            for change in self.consequences
        )


def diff(old: Reasoner, new: Reasoner, lines_of: LinesOf = lambda _: ()) -> Difference:
    """Return the changed consequences and nodes of two projects, with the lines that caused them.

    `lines_of` returns the lines of a file by its path.

    Raises:
        MarsError: rules that clingo refuses.
        TimeoutError: no specification was found in time, for each of the two.
    """
    are_launched = bool(old.project.trees and new.project.trees)
    before, after = (_Side(each, lines_of, are_launched) for each in (old, new))
    if are_launched:
        gone, come = differing_files(before.tree_lines, after.tree_lines)
    else:
        gone, come = differing_lines(
            before.texts.comparable_lines(), after.texts.comparable_lines()
        )
    before.compare(after, gone)
    after.compare(before, come)
    both = before.synthesis is not None and after.synthesis is not None
    kinds = {side.project.configuration.kind for side in (before, after)}
    nodes = [
        chain(side.nodes(), side.declared_nodes() if kinds == {"specification"} else ())
        for side in (before, after)
    ]
    if are_launched:
        consequences = tuple(_changed_findings(before, after))
    else:
        found = _changes(before, after, before.consequences(), after.consequences())
        consequences = _blamed(tuple(found), before, after)
    return Difference(
        after.differing,
        before.differing,
        consequences,
        tuple(_changes(before, after, *nodes)) if both else (),
        before.synthesis,
        after.synthesis,
        tuple(
            unrealised(side.analysis, name)
            for side, name in ((before, "OLD"), (after, "NEW"))
            if side.synthesis is None
        ),
    )


@dataclass(frozen=True, slots=True)
class _DiffEntry(Generic[Item]):
    """A consequence or node; two entries with one key and different values are a change."""

    key: tuple[str, ...]
    value: tuple[str, ...]
    atom: clingo.Symbol
    item: Item
    #: Lines that caused it, besides those of its trace.
    spans: tuple[Span, ...] = ()


class _Side:
    """One of the two configurations, solved; its fields state how it differs from the other."""

    def __init__(self, reasoner: Reasoner, lines_of: LinesOf, is_launched: bool) -> None:
        self.findings: Sequence[Consequence] = ()
        launched: Evidence | None = None
        if is_launched:
            rules = load_rulebook(stages=(STAGE,))
            judged = analyse_trees(reasoner.project, rules)
            self.findings = judged.consequences
            launched = Evidence(launch_rules(rules), judged.facts, judged)
        evidence = reasoner.evidence(resolved=True)
        self.project, self.rulebook = reasoner.project, reasoner.rulebook
        self.analysis, self.synthesis = evidence.analysis, reasoner.synthesis
        self.explainer = evidence.explainer
        project = reasoner.project
        self.facts = (*reasoner.facts, *_unread_values(project))
        #: Each fact with its text and relationship, without identifiers, which are of one file.
        self.texts_of: dict[str, tuple[str, str]] = {}
        #: The locations of each relationship, and the relationships at each location.
        self.places: dict[str, set[Span]] = {}
        self.relationships: dict[Span, set[str]] = {}
        entries: dict[Span, list[str]] = {}
        for fact, of, text in _comparable(self.facts, project.rates):
            entries.setdefault(fact.span, []).append(text)
            self.texts_of[str(fact.atom)] = of, text
            if of:
                self.places.setdefault(of, set()).add(fact.span)
                self.relationships.setdefault(fact.span, set()).add(of)
        #: How often a fact is stated here more often than on the other side.
        self.surplus: Counter[tuple[str, str]] = Counter()
        self.lines = {span: tuple(sorted(texts)) for span, texts in entries.items()}
        self.texts = _Texts(self.lines, lines_of)
        folder = project.configuration.path
        self.tree_lines = TreeLines(launched, folder, lines_of, self.texts.files)
        self.changed: frozenset[Span] = frozenset()
        #: Lines of both sides with another effect here.
        self.unchanged: frozenset[Span] = frozenset()
        #: For each changed statement its differing lines: of an annotation the first one.
        self.shown: dict[Span, tuple[Span, ...]] = {}
        #: All lines that the other side lacks.
        self.differing: tuple[Span, ...] = ()

    def compare(self, other: "_Side", lines: Iterable[FileLine]) -> None:
        """Find the statements that the other side lacks, of which some `lines` differ."""
        are_alike = (self.project.format is None) == (other.project.format is None)
        left = Counter(item for facts in other.lines.values() for item in _items(facts, are_alike))
        changed = []
        for span, facts in sorted(self.lines.items()):
            items = Counter(_items(facts, are_alike))
            if span != NOWHERE and any(left[item] < items[item] for item in items):
                changed.append(span)
            left.subtract(items)
        self.surplus = Counter(self.texts_of.values()) - Counter(other.texts_of.values())
        lines = tuple(lines)
        is_foreign = self.project.format is not None
        self.shown = self.texts.differing(changed, lines, whole=is_foreign)
        self.changed = frozenset(self.shown)
        self.unchanged = frozenset(changed) - self.changed
        self.differing = tuple(sorted(set(chain(*self.shown.values()))))
        if is_foreign and other.project.format is not None:
            # Much of a foreign file, such as the topic of an input, is in no fact.
            self.differing = tuple(line.span for line in lines)

    def cited(self, spans: Iterable[Span]) -> set[Span]:
        """Return the differing lines among some locations."""
        return {each for span in spans for each in self.shown.get(span, ())}

    def given(self, trace: Trace) -> set[Span]:
        """Return the locations of the differing facts on which a trace rests."""
        facts = (step for step in steps_of(trace, MEANINGS) if isinstance(step, Given))
        return {
            fact.span
            for fact in facts
            if fact.span is not None and self.surplus[self.texts_of.get(fact.atom, ("", ""))]
        }

    def counterparts(self, there: Set[Span], other: "_Side") -> set[Span]:
        """Return the locations here of the relationships that the other side has at some."""
        both = (of for span in there for of in other.relationships.get(span, ()))
        return {span for of in both for span in self.places.get(of, ())}

    def consequences(self) -> Iterator[_DiffEntry[Consequence]]:
        for c in self.analysis.consequences:
            # A warning is known by its participants, as in a baseline; a note about more of them is
            # the same note.
            known = () if c.severity == "note" else c.participants
            key = (c.kind, c.subject, c.severity, *known)
            spans = set(c.spans) if c.kind in _OF_SIDE_LINES else ()
            of_lines = sorted(
                " ".join(fact for fact in self.lines.get(span, ()) if fact.startswith(_SIDE_LINES))
                for span in spans
            )
            yield _DiffEntry(key, (*key, c.message, *c.participants, *of_lines), c.atom, c)

    def launch_findings(self) -> Iterator[_DiffEntry[Consequence]]:
        """Yield the findings in launch trees; paths are relative to the folder of the robot."""
        folder = f"{self.project.configuration.path.rstrip('/')}/"
        for c in self.findings:
            tests = (" ".join((test.variable, test.value, test.how)) for test in c.conditions)
            usual = "" if c.is_usual else "unusual"
            value = (c.kind, c.subject, c.severity, c.message, *c.participants, *tests, usual)
            inside = value if folder == "./" else tuple(each.replace(folder, "") for each in value)
            yield _DiffEntry(inside[:3], inside, c.atom, c)

    def nodes(self) -> Iterator[_DiffEntry[IntroducedNode]]:
        if self.synthesis is None:
            return
        resolves = self.synthesis.specification.resolves
        known = {f"{c.key[0]}({c.key[1]})": c for c in self.consequences()}
        for node in self.synthesis.specification.nodes:
            term = clingo.parse_term(node.term)
            if node.kind not in ("gate_node", "data_splitter"):
                key = (node.kind, *resolves[node.name][:1])
                yield _DiffEntry(key, (node.term,), term, node)
                continue
            # A Gate is the same node with other triggers, signs and times, and a splitter with
            # other receivers.
            found = [known[name] for name in resolves[node.name] if name in known]
            values = (word for each in found for word in each.value)
            spans = tuple(span for each in found for span in each.item.spans)
            key = (node.kind, str(term.arguments[0]))
            yield _DiffEntry(key, (node.term, *values), term, node, spans)

    def declared_nodes(self) -> Iterator[_DiffEntry[IntroducedNode]]:
        """Yield the nodes that a specification has already, each with the lines about it."""
        ends = {f.atom.arguments[0]: f.atom.arguments[1:] for f in self.facts if _is_line(f)}
        about: dict[object, list[tuple[str, Span]]] = {}
        for fact in self.facts:
            if str(fact.atom) in self.texts_of:
                of, text = self.texts_of[str(fact.atom)]
                first = fact.atom.arguments[0]
                for name in ends.get(first, (first,)):
                    about.setdefault(name, []).append((f"{of} {text}", fact.span))
        configuration = self.project.configuration
        for name in (module.text for module in configuration.modules):
            kind = configuration.node_kind(name)
            if kind is not None:
                texts, spans = zip(*sorted(about[name]), strict=True)
                term = clingo.Function("node", [clingo.String(name), clingo.Function(kind)])
                node = IntroducedNode(name, kind, str(term))
                yield _DiffEntry((kind, name), (kind, name, *texts), term, node, spans)

    def holds(self, symbol: clingo.Symbol) -> bool:
        atom = self.analysis.grounding.control.symbolic_atoms[symbol]
        taken = frozenset() if self.synthesis is None else self.synthesis.resolution.taken
        return atom is not None and (atom.is_fact or as_term(symbol) in taken)

    def matching(self, pattern: str) -> Iterator[clingo.Symbol]:
        """Yield the true atoms that match an atom as text, in which `_` is any argument."""
        yield from filter(self.holds, matching(pattern, self.analysis.grounding.symbols))


class _Texts:
    """The texts of statements: from each location to the next."""

    def __init__(self, spans: Iterable[Span], lines_of: LinesOf) -> None:
        starts: dict[str, set[int]] = {}
        for span in spans:
            starts.setdefault(span.path, set()).add(span.line)
        files = {path: lines_of(path) for path in starts}
        self.files = files
        self._ends: dict[tuple[str, int], int] = {}
        for path, numbers in starts.items():
            ordered = sorted(numbers)
            ends = [*ordered[1:], len(files[path]) + 1]
            self._ends.update(((path, n), end) for n, end in zip(ordered, ends, strict=True))

    def comparable_lines(self) -> Iterator[FileLine]:
        """Yield the lines of all files."""
        for path, lines in self.files.items():
            yield from file_lines(path, "", lines)

    def differing(
        self, spans: Iterable[Span], lines: Iterable[FileLine], whole: bool
    ) -> dict[Span, tuple[Span, ...]]:
        """Return, for each statement with one of `lines`, the first of these, or all if `whole`.

        A statement of a file whose lines are not known differs as a whole.
        """
        numbers: dict[str, list[int]] = {}
        for each in lines:
            numbers.setdefault(each.span.path, []).append(each.span.line)
        found: dict[Span, tuple[Span, ...]] = {}
        for span in spans:
            among = numbers.get(span.path, ())
            first = bisect_left(among, span.line)
            last = bisect_left(among, self._ends[span.path, span.line])
            within = among[first : last if whole else min(last, first + 1)]
            if not self.files[span.path]:
                found[span] = (span,)
            elif within:
                # The column of a statement is known at its first line alone.
                found[span] = tuple(
                    span if line == span.line else point(span.path, line, 1) for line in within
                )
        return found


def _items(facts: _LineFacts, is_whole: bool) -> tuple[_LineFacts, ...]:
    """Return the facts of a line together if `is_whole`, else one by one."""
    return (facts,) if is_whole else tuple((fact,) for fact in facts)


def _unread_values(project: Project) -> Iterator[Fact]:
    """Yield facts of values that no rule of the analysis reads."""
    yield from mount_tuples("mount_tuple", project.configuration)
    for conversion in project.configuration.conversions:
        values = conversion.converter or "", conversion.source, conversion.target
        yield Fact(Atom("conversion", (conversion.transformer, *values)), conversion.span)
    for module in project.described.values():
        for each in module.functions:
            bounds = (str(bound) for bound in (each.min, each.max, each.rate))
            yield Fact(Atom("bounds", (module.name, each.name, *bounds)), each.span)
        for vertex in module.vertices:
            pose = print_transformation(normalized(vertex.transformation))
            yield Fact(Atom("vertex", (module.name, vertex.number, pose)), vertex.span)


def _comparable(facts: Iterable[Fact], rates: Rates) -> Iterator[tuple[Fact, str, str]]:
    """Yield facts with their relationship, "" if of none, and text: exact rates, no identifiers."""
    facts = tuple(facts)
    identifiers = {f.atom.arguments[0] for f in facts if f.atom.name == "place"}
    of = {
        fact.atom.arguments[0]: " ".join(map(str, (fact.atom.name, *fact.atom.arguments[1:])))
        for fact in facts
        if _is_line(fact)
    }
    for fact in facts:
        if fact.atom.name in _OBSERVED:
            continue
        first, *rest = fact.atom.arguments
        numbered = isinstance(first, int) and first in identifiers
        if fact.atom.name in _RATES and isinstance(rest[-1], int):
            rest[-1] = str(Fraction(rates.hertz(rest[-1])))
        words = map(str, rest if numbered else (first, *rest))
        of_line = of.get(first, "") if numbered else ""
        yield fact, of_line, f"{fact.atom.name}({','.join(words)})"


def _is_line(fact: Fact) -> bool:
    """Whether a fact is a relationship: of its number and its two ends."""
    return fact.atom.name in VERBS


def _changes(
    before: _Side, after: _Side, old: Iterable[_DiffEntry[Item]], new: Iterable[_DiffEntry[Item]]
) -> Iterator[Change[Item]]:
    """Yield the changes from `old` to `new` entries, paired by key, with their causes."""
    pairs = tuple(_pairs(old, new))
    old_traces = before.explainer.why([gone.atom for _, gone, _ in pairs if gone is not None])
    new_traces = after.explainer.why([come.atom for _, _, come in pairs if come is not None])
    for how, gone, come in pairs:
        old_lines: set[Span] = set()
        new_lines: set[Span] = set()
        if gone is not None:
            old_lines |= before.given(old_traces[gone.atom]) | {*gone.spans}
            new_lines |= _preventing(old_traces[gone.atom], after)
        if come is not None:
            new_lines |= after.given(new_traces[come.atom]) | {*come.spans}
            old_lines |= _preventing(new_traces[come.atom], before)
        # A relationship that only gained or lost a detail is shown as it was and as it is.
        old_lines |= before.counterparts(new_lines, after)
        new_lines |= after.counterparts(old_lines, before)
        unchanged = new_lines & after.unchanged or old_lines & before.unchanged
        yield Change(
            how,
            None if gone is None else gone.item,
            None if come is None else come.item,
            tuple(sorted(after.cited(new_lines))),
            tuple(sorted(before.cited(old_lines))),
            tuple(sorted(unchanged)),
        )


def _changed_findings(before: _Side, after: _Side) -> Iterator[Change[Consequence]]:
    """Yield the differing findings in launch trees, with the differing lines that caused them."""
    old, new = before.tree_lines, after.tree_lines
    pairs = tuple(_pairs(before.launch_findings(), after.launch_findings()))
    old_traces = old.traces_of([gone.atom for _, gone, _ in pairs if gone is not None])
    new_traces = new.traces_of([come.atom for _, _, come in pairs if come is not None])
    for how, gone, come in pairs:
        was, now = (None if each is None else each.item for each in (gone, come))
        found = [each for each in (was, now) if each is not None]
        old_trace = None if gone is None else old_traces[gone.atom]
        new_trace = None if come is None else new_traces[come.atom]
        old_spans, new_spans = ({*(each.spans if each else ())} for each in (was, now))
        old_facts = old.causes(old_trace, new_trace, new)
        new_facts = new.causes(new_trace, old_trace, old)
        old_causes = {each.span for each in old_facts} | old.alike_spans(old_facts | new_facts, new)
        new_causes = {each.span for each in new_facts} | new.alike_spans(old_facts | new_facts, old)
        removed, left = old.split(old_spans | old_causes, before.differing)
        added, stay = new.split(new_spans | new_causes, after.differing)
        unchanged = stay & new_causes or left & old_causes or stay or left
        added |= new.counterparts(removed, old, after.differing)
        removed |= old.counterparts(added, new, before.differing)
        if not removed and not added:
            variables = {test.variable for each in found for test in each.conditions}
            removed = old.naming(variables, before.differing)
            added = new.naming(variables, after.differing)
        if not removed and not added:
            # No fact holds the line that installs a file.
            removed = old.of_builds(found[0].subject, before.differing)
            added = new.of_builds(found[0].subject, after.differing)
        yield Change(how, was, now, *map(_in_order, (added, removed, unchanged)))


def _in_order(spans: Iterable[Span]) -> tuple[Span, ...]:
    return tuple(sorted(spans))


def _blamed(
    changes: Sequence[Change[Consequence]], before: _Side, after: _Side
) -> tuple[Change[Consequence], ...]:
    """Return changes; those without lines get the lines that prevent them on the other side."""
    prevented: dict[tuple[How, str, str], tuple[tuple[Span, ...], ...]] = {}
    others: tuple[tuple[How, _Side], ...] = (("appeared", before), ("vanished", after))
    for how, side in others:
        unexplained = [each.item for each in changes if each.how == how and not each.cited]
        kinds, names = ({c.kind for c in unexplained}, {c.subject for c in unexplained})
        found = reasons(side.project, side.rulebook, sorted(kinds), sorted(names)) if names else ()
        for kind, name, blame in found:
            lines = tuple(sorted(side.cited(blame.evidence)))
            prevented[how, kind, name] = (lines, ()) if how == "vanished" else ((), lines)

    def with_lines(change: Change[Consequence]) -> Change[Consequence]:
        if change.cited:
            return change
        key = change.how, change.item.kind, change.item.subject
        added, removed = prevented.get(key, ((), ()))
        return replace(change, added=added, removed=removed)

    return tuple(map(with_lines, changes))


def _pairs(
    old: Iterable[_DiffEntry[Item]], new: Iterable[_DiffEntry[Item]]
) -> Iterator[tuple[How, _DiffEntry[Item] | None, _DiffEntry[Item] | None]]:
    """Yield the differing entries of two lists, paired by their keys."""
    old, new = tuple(old), tuple(new)
    was, now = _others(old, new), _others(new, old)
    for key in dict.fromkeys((*was, *now)):
        for gone, come in zip_longest(was.get(key, ()), now.get(key, ())):
            how: How = "appeared" if gone is None else "vanished" if come is None else "changed"
            yield how, gone, come


def _others(
    entries: Iterable[_DiffEntry[Item]], known: Iterable[_DiffEntry[Item]]
) -> dict[tuple[str, ...], list[_DiffEntry[Item]]]:
    """Return, by key, the entries that remain after each of `known` cancels one equal entry."""
    left = Counter(entry.value for entry in known)
    found: dict[tuple[str, ...], list[_DiffEntry[Item]]] = {}
    for entry in entries:
        if left[entry.value] > 0:
            left[entry.value] -= 1
        else:
            found.setdefault(entry.key, []).append(entry)
    return found


def _preventing(trace: Trace, other: _Side) -> set[Span]:
    """Return the lines that give the other side the atoms that are absent in a trace."""
    patterns = {step.atom for step in steps_of(trace) if isinstance(step, Absent)}
    atoms = {symbol for pattern in sorted(patterns) for symbol in other.matching(pattern)}
    found: set[Span] = set()
    for reason in other.explainer.why(sorted(atoms)).values():
        found |= other.given(reason)
    return found
