"""Why there is no consequence or node of a kind for a module, and the least change that gives one.

The rules of `rules/absence` say why and propose changes; each is made to the configuration, from
which all follows anew, before it is told.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import clingo

from mars_asp.asp.messages import RenderedMessage, fill, said, saying, shown
from mars_asp.asp.rules.rule import HOLE
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol
from mars_asp.diagnostic import MarsError, Span
from mars_asp.model.described import described_modules
from mars_asp.model.names import written
from mars_asp.model.ports import inputs
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import given
from mars_asp.reasoning.facts.identifiers import annotation_numbers
from mars_asp.reasoning.findings import ABSENT
from mars_asp.reasoning.project import Project, port_names, project_facts
from mars_asp.reasoning.questions.changes import changed
from mars_asp.reasoning.rules import load_rulebook

_STAGE = "absence"
_CHANGE, _RELATED_EDGE = Signature("change", 4), Signature("related_edge", 3)
#: Of the changes that rules propose so many are tried.
MOST_TRIED = 8


@dataclass(frozen=True, slots=True)
class Blame:
    """Why there is none, as a clause; `evidence` are the lines that it speaks of.

    `to_get` is what would give one, and `beside` what may have been looked for, each a clause or
    `None`.
    """

    because: str
    evidence: tuple[Span, ...] = ()
    to_get: str | None = None
    beside: str | None = None


def blame(
    project: Project,
    rulebook: Rulebook,
    kind: str,
    module: str | None,
    gives: Callable[[Project], bool],
) -> Blame | None:
    """Return why there is nothing of a kind for a module, or for any; None if no rule states it.

    `gives` is whether there is one in a project.

    Raises:
        MarsError: clingo refuses the rules.
    """
    subject = _sought(kind, module) if module is not None else _sought_everywhere(kind)
    result = _Told(project, rulebook, (subject,))
    reason = min(result.of(ABSENT), key=_order, default=None)
    if reason is None:
        return None
    change = next(_that_give(result, project, gives), None)
    beside = min(result.of(_RELATED_EDGE), key=_order, default=None)
    return Blame(
        result.text(reason),
        result.evidence(as_symbol(reason.head)),
        None if change is None else result.text(change),
        None if change is None or beside is None else result.text(beside),
    )


def reasons(
    project: Project, rulebook: Rulebook, kinds: Iterable[str], modules: Iterable[str]
) -> Iterator[tuple[str, str, Blame]]:
    """Yield why there is nothing of each kind for each module, if a rule states it, in any order.

    All are asked in one grounding; no change is proposed or tried. What is there may have a reason
    as well, which then means nothing.

    Raises:
        MarsError: clingo refuses the rules.
    """
    names = tuple(modules)
    questions = [_sought(kind, name) for kind in kinds for name in names]
    result = _Told(project, rulebook, questions, (ABSENT,))
    first: dict[tuple[TermId, ...], RenderedMessage] = {}
    for each in result.of(ABSENT):
        key = tuple(arguments(each.head)[:2])
        if key not in first or _order(each) < _order(first[key]):
            first[key] = each
    for each in first.values():
        head = as_symbol(each.head)
        kind, module, _ = head.arguments
        yield kind.name, module.string, Blame(result.text(each), result.evidence(head))


def _sought(kind: str, module: str) -> Atom:
    return Atom("sought", (Atom(kind), module))


def _sought_everywhere(kind: str) -> Atom:
    return Atom("sought_everywhere", (Atom(kind),))


def _sought_ports(project: Project, questions: Iterable[Atom]) -> Iterator[Atom]:
    """Yield the locations of the inputs and outputs in question."""
    queries = {str(name) for question in questions for name in question.arguments[1:]}
    ports = {name: port for name, port in port_names(project).items() if name in queries}
    if not ports:
        return
    described = described_modules(project.configuration, project.modules)
    numbers = annotation_numbers(project.configuration, described)
    for name, (module, port) in ports.items():
        yield Atom("sought_port", (name, module))
        entry = inputs(described[module]).get(port) if module in described else None
        for at, index in () if entry is None else entry.parameters:
            number, _ = numbers[module, id(described[module].services[at])]
            yield Atom("sought_input", (name, number, index))


def _that_give(
    told: "_Told", project: Project, gives: Callable[[Project], bool]
) -> Iterator[RenderedMessage]:
    """Yield the changes after which there is one, the least first."""
    proposed = sorted(
        told.of(_CHANGE), key=lambda each: (as_symbol(each.head).arguments[3].number, _order(each))
    )
    for each in proposed[:MOST_TRIED]:
        term = as_symbol(each.head).arguments[2]
        if term.match("anywhere", 0):
            yield each
            continue
        try:
            revised = changed(project, term)
            if gives(revised):
                yield each
        except MarsError:  # what nothing can be made of is no answer
            continue


def _order(told: RenderedMessage) -> tuple[int, str]:
    return told.number, str(as_symbol(told.values))


class _Told:
    """What the rules of the stage say of questions, or only those that derive some predicates."""

    def __init__(
        self,
        project: Project,
        rulebook: Rulebook,
        questions: Sequence[Atom],
        only: Sequence[Signature] = (ABSENT, _CHANGE, _RELATED_EDGE),
    ) -> None:
        rules = load_rulebook(stages=(_STAGE,))
        self._speakers = [
            rule
            for rule in rules.rules
            if rule.stage == _STAGE and rule.listed is None and rule.because is not None
            if any(map(rule.derives, only))
        ]
        facts = project_facts(project)
        analysis = analyse(facts, rulebook, project.configuration.span)
        self._ports = port_names(project)
        atoms = [*questions, *_sought_ports(project, questions)]
        asked = given(Fact(each, project.configuration.span) for each in atoms)
        self._grounding = analysis.grounding
        self._grounding.derive([*rules.fragments(_STAGE), asked, *saying(_STAGE, self._speakers)])
        self._every = tuple(said(self._grounding.control, _STAGE, self._speakers))
        self._header = project.configuration.span
        self._span_of: Mapping[object, Span] = {
            fact.atom.arguments[0]: fact.span for fact in facts if fact.atom.name == "place"
        }

    def of(self, signature: Signature) -> Iterator[RenderedMessage]:
        """Yield the messages of rules that derive a predicate."""
        return (each for each in self._every if each.rule.derives(signature))

    def text(self, told: RenderedMessage) -> str:
        """Return what a rule says, with places for `at(I)`, and names in lines as these write them.

        A line is what is between backticks, unless that is nothing but a name.
        """
        values = dict(zip(told.rule.holes, map(as_symbol, arguments(told.values)), strict=True))
        parts = (told.rule.because or "").split("`")
        return "`".join(
            fill(
                part,
                values,
                self._in_line if at % 2 and not HOLE.fullmatch(part) else self._symbol_text,
            )
            or ""
            for at, part in enumerate(parts)
        )

    def evidence(self, reason: clingo.Symbol) -> tuple[Span, ...]:
        """Return the places that a reason cites, in the order of the file."""
        cited = self._cited.get(reason, ())
        return tuple(sorted({self._span_of_identifier(identifier) for identifier in cited}))

    @cached_property
    def _cited(self) -> Mapping[clingo.Symbol, Sequence[clingo.Symbol]]:
        """Return the lines that each reason cites."""
        cited: dict[clingo.Symbol, list[clingo.Symbol]] = {}
        for each in self._grounding.symbols("cites", 4):
            *reason, identifier = each.arguments
            cited.setdefault(clingo.Function(ABSENT.name, reason), []).append(identifier)
        return cited

    def _span_of_identifier(self, identifier: clingo.Symbol) -> Span:
        if identifier.type == clingo.SymbolType.Number:
            return self._span_of[identifier.number]
        return self._span_of.get(shown(identifier), self._header)

    def _symbol_text(self, value: clingo.Symbol) -> str:
        if value.match("at", 1):
            span = self._span_of_identifier(value.arguments[0])
            return f"{span.path}:{span.line}"
        return shown(value)

    def _in_line(self, value: clingo.Symbol) -> str:
        """Return a term as a line of a configuration writes it; ports are called so already."""
        if value.type != clingo.SymbolType.String or value.string in self._ports:
            return shown(value)
        return written(value.string)
