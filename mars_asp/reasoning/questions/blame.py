"""Why a module has no consequence or node of a kind, and the smallest change that gives one.

The rules of `rules/absence` state reasons and propose changes; a change is reported only if the
rules give the consequence or node after it.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import clingo

from mars_asp.asp.messages import RenderedMessage, fill, rendered_messages, saying, shown
from mars_asp.asp.rules.rule import HOLE
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term
from mars_asp.diagnostic import MarsError, Span
from mars_asp.model.names import written
from mars_asp.model.ports import inputs
from mars_asp.reasoning.analysis import analyse, locations
from mars_asp.reasoning.facts.compile import given
from mars_asp.reasoning.facts.identifiers import annotation_numbers
from mars_asp.reasoning.findings import ABSENT
from mars_asp.reasoning.project import Project, port_names, project_facts
from mars_asp.reasoning.questions.changes import changed
from mars_asp.reasoning.rules import load_rulebook

_STAGE = "absence"
_CHANGE, _RELATED_EDGE = Signature("change", 4), Signature("related_edge", 3)
#: At most this many of the proposed changes are tried.
MOST_TRIED = 8


@dataclass(frozen=True, slots=True)
class Blame:
    """The reason of an absence, as a clause; `evidence` are the lines that it cites.

    `to_get` is the change that gives one, and `beside` an existing one that the user may mean, each
    a clause or `None`.
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
    """Return the reason why a module lacks a consequence or node; None if no rule states one.

    `module` is None for all modules. `gives` returns whether a changed project has such a
    consequence or node; a change is proposed only if so.

    Raises:
        MarsError: clingo refuses the rules.
    """
    sought = (
        Atom("sought_everywhere", (Atom(kind),))
        if module is None
        else Atom("sought", (Atom(kind), module))
    )
    result = _Messages(project, rulebook, (sought,))
    reason = min(result.of(ABSENT), key=_order, default=None)
    if reason is None:
        return None
    found = result.blame(reason)
    proposed = sorted(
        result.of(_CHANGE),
        key=lambda each: (as_symbol(each.head).arguments[3].number, _order(each)),
    )
    change = next((each for each in proposed[:MOST_TRIED] if _helps(each, project, gives)), None)
    if change is None:
        return found
    beside = min(result.of(_RELATED_EDGE), key=_order, default=None)
    return replace(
        found,
        to_get=result.text(change),
        beside=None if beside is None else result.text(beside),
    )


def reasons(
    project: Project, rulebook: Rulebook, kinds: Iterable[str], modules: Iterable[str]
) -> Iterator[tuple[str, str, Blame]]:
    """Yield kind, module and reason for each lacking kind of which a rule states a reason.

    One grounding answers all; no change is proposed or tried. The reason of a consequence or
    node that exists is to be ignored.

    Raises:
        MarsError: clingo refuses the rules.
    """
    names = tuple(modules)
    questions = [Atom("sought", (Atom(kind), name)) for kind in kinds for name in names]
    result = _Messages(project, rulebook, questions, (ABSENT,))
    first: dict[tuple[TermId, ...], RenderedMessage] = {}
    for each in sorted(result.of(ABSENT), key=_order):
        first.setdefault(tuple(arguments(each.head)[:2]), each)
    for each in first.values():
        kind, module, _ = as_symbol(each.head).arguments
        yield kind.name, module.string, result.blame(each)


def _sought_ports(project: Project, questions: Iterable[Atom]) -> Iterator[Atom]:
    """Yield facts on the ports that questions name: their modules and annotations."""
    queries = {str(name) for question in questions for name in question.arguments[1:]}
    ports = {name: port for name, port in port_names(project).items() if name in queries}
    if not ports:
        return
    described = project.described
    numbers = annotation_numbers(project.configuration, described)
    for name, (module, port) in ports.items():
        yield Atom("sought_port", (name, module))
        entry = inputs(described[module]).get(port) if module in described else None
        for at, index in () if entry is None else entry.parameters:
            number, _ = numbers[module, id(described[module].services[at])]
            yield Atom("sought_input", (name, number, index))


def _helps(change: RenderedMessage, project: Project, gives: Callable[[Project], bool]) -> bool:
    """Whether a change gives the missing consequence or node; one `anywhere` counts untried."""
    term = as_symbol(change.head).arguments[2]
    try:
        return term.match("anywhere", 0) or gives(changed(project, term))
    except MarsError:
        return False


def _order(message: RenderedMessage) -> tuple[int, str]:
    return message.number, str(as_symbol(message.values))


class _Messages:
    """The messages of the rules that answer questions about absences."""

    def __init__(
        self,
        project: Project,
        rulebook: Rulebook,
        questions: Sequence[Atom],
        only: Sequence[Signature] = (ABSENT, _CHANGE, _RELATED_EDGE),
    ) -> None:
        rules = load_rulebook(stages=(_STAGE,))
        speakers = [
            rule
            for rule in rules.rules
            if rule.stage == _STAGE and rule.listed is None and rule.because is not None
            if any(map(rule.derives, only))
        ]
        facts = project_facts(project)
        analysis = analyse(facts, rulebook, project.configuration.span)
        self._ports = port_names(project)
        atoms = [*questions, *_sought_ports(project, questions)]
        sought = given(Fact(each, project.configuration.span) for each in atoms)
        self._grounding = analysis.grounding
        self._grounding.derive([*rules.fragments(_STAGE), sought, *saying(_STAGE, speakers)])
        self._every = tuple(rendered_messages(self._grounding.control, _STAGE, speakers))
        self._header = project.configuration.span
        self._locations = locations(facts)

    def of(self, signature: Signature) -> Iterator[RenderedMessage]:
        """Yield the messages of rules that derive a predicate."""
        return (each for each in self._every if each.rule.derives(signature))

    def blame(self, reason: RenderedMessage) -> Blame:
        """Return a reason as a clause, with the lines that it cites in the order of the file."""
        cited = self._cited.get(as_symbol(reason.head), ())
        evidence = tuple(sorted(set(map(self._location, cited))))
        return Blame(self.text(reason), evidence)

    def text(self, message: RenderedMessage) -> str:
        """Return the message of a rule, with locations for `at(I)`, and names as users write them.

        A line is a text between backticks that is more than a name.
        """
        values = dict(
            zip(message.rule.holes, map(as_symbol, arguments(message.values)), strict=True)
        )
        parts = (message.rule.because or "").split("`")
        return "`".join(
            fill(
                part,
                values,
                self._in_line if at % 2 and not HOLE.fullmatch(part) else self._symbol_text,
            )
            or ""
            for at, part in enumerate(parts)
        )

    @cached_property
    def _cited(self) -> Mapping[clingo.Symbol, Sequence[clingo.Symbol]]:
        """Return the lines that each reason cites, by the atom of the reason."""
        cited: dict[clingo.Symbol, list[clingo.Symbol]] = {}
        for each in self._grounding.symbols("cites", 4):
            *reason, identifier = each.arguments
            cited.setdefault(clingo.Function(ABSENT.name, reason), []).append(identifier)
        return cited

    def _location(self, thing: clingo.Symbol) -> Span:
        return self._locations.get(as_term(thing), self._header)

    def _symbol_text(self, value: clingo.Symbol) -> str:
        if value.match("at", 1):
            span = self._location(value.arguments[0])
            return f"{span.path}:{span.line}"
        return shown(value)

    def _in_line(self, value: clingo.Symbol) -> str:
        """Return a term in the syntax of a configuration; ports have this syntax already."""
        if value.type != clingo.SymbolType.String or value.string in self._ports:
            return shown(value)
        return written(value.string)
