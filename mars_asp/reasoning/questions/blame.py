"""Why there is no consequence or node of a kind for a module, and the least change that gives one.

The rules of `rules/absence` say why and propose changes; each is made to the configuration, from
which all follows anew, before it is told.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import clingo

from mars_asp.asp.fragments import joined
from mars_asp.asp.messages import Said, fill, said, saying, shown
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import arguments, as_symbol
from mars_asp.diagnostic import MarsError, Span
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.findings import ABSENT
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.questions.changes import changed
from mars_asp.reasoning.rules import load_rulebook

_STAGE = "absence"
_CHANGE, _BESIDE = Signature("change", 4), Signature("beside", 3)
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
    """Return why there is nothing of a kind for a module, or for any; `None` where no rule says.

    `gives` is whether there is one in a project.

    Raises:
        MarsError: clingo refuses the rules.
    """
    told = _Told(project, rulebook, kind, module)
    reason = min(told.of(ABSENT), key=_order, default=None)
    if reason is None:
        return None
    change = next(_that_give(told, project, gives), None)
    beside = min(told.of(_BESIDE), key=_order, default=None)
    return Blame(
        told.text(reason),
        told.evidence(as_symbol(reason.head)),
        None if change is None else told.text(change),
        None if change is None or beside is None else told.text(beside),
    )


def _that_give(told: "_Told", project: Project, gives: Callable[[Project], bool]) -> Iterator[Said]:
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


def _order(told: Said) -> tuple[int, str]:
    return told.number, str(as_symbol(told.values))


class _Told:
    """What the rules of the stage say of one question."""

    def __init__(self, project: Project, rulebook: Rulebook, kind: str, module: str | None) -> None:
        rules = load_rulebook(stages=(_STAGE,))
        self._speakers = [
            rule
            for rule in rules.rules
            if rule.stage == _STAGE and rule.listed is None and rule.because is not None
        ]
        facts = project_facts(project)
        analysis = analyse(facts, rulebook, project.configuration.span)
        subject: Mapping[bool, Atom] = {
            True: Atom("sought_everywhere", (Atom(kind),)),
            False: Atom("sought", (Atom(kind), module or "")),
        }
        asked = facts_text([Fact(subject[module is None], project.configuration.span)])
        self._grounding = analysis.grounding
        self._grounding.derive(
            f"{rules.text(_STAGE)}\n{asked}\n{joined(saying(_STAGE, self._speakers))}"
        )
        self._every = tuple(said(self._grounding.control, _STAGE, self._speakers))
        self._header = project.configuration.span
        self._span_of: Mapping[object, Span] = {
            fact.atom.arguments[0]: fact.span for fact in facts if fact.atom.name == "place"
        }

    def of(self, signature: Signature) -> Iterator[Said]:
        """Yield what rules that derive a predicate say."""
        return (each for each in self._every if each.rule.derives(signature))

    def text(self, told: Said) -> str:
        """Return what a rule says, with places for `at(I)`."""
        values = zip(told.rule.holes, map(as_symbol, arguments(told.values)), strict=True)
        return fill(told.rule.because, dict(values), self._shown) or ""

    def evidence(self, reason: clingo.Symbol) -> tuple[Span, ...]:
        """Return the places that a reason cites, in the order of the file."""
        cited = self._grounding.symbols("cites", 4)
        mine = (each.arguments for each in cited if each.arguments[:3] == reason.arguments)
        return tuple(sorted({self._place(identifier) for *_, identifier in mine}))

    def _place(self, identifier: clingo.Symbol) -> Span:
        if identifier.type == clingo.SymbolType.Number:
            return self._span_of[identifier.number]
        return self._span_of.get(shown(identifier), self._header)

    def _shown(self, value: clingo.Symbol) -> str:
        if value.match("at", 1):
            span = self._place(value.arguments[0])
            return f"{span.path}:{span.line}"
        return shown(value)
