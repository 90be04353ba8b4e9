"""Capability queries: the functions that a robot can perform at one time, decided by `rules/can`.

`rules/account/capability.lp` derives the explanation of each demand.

>>> answer = capability(load_project("config.mars"), rulebook, "Rotn_Y of Camera")
>>> answer.able
True
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import clingo

from mars_asp.asp.messages import fill, shown
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.asp.trace import Derived, Trace
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from mars_asp.model.names import read_name
from mars_asp.reasoning.analysis import Key, analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.questions.account import (
    Account,
    explanations,
    names_of,
    speakers,
    true_atoms,
)
from mars_asp.reasoning.session import Evidence
from mars_asp.reasoning.synthesis.synthesise import costs_of
from mars_asp.spelling import suggestion

#: The shown file name of locations in a query.
QUERY = "<query>"
MOST_DEMANDS = 64
_FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
#: A function and a module, in the syntax of a configuration.
_DEMAND = re.compile(r"\s*(\w+)\s+of\s+(\S.*?)\s*", re.DOTALL)
#: Between demands, outside of quotes.
_WHILE = re.compile(r'(?<!\S)while(?!\S)(?=(?:[^"]*"[^"]*")*[^"]*$)')
#: The kind and case of explanations of demands.
_KIND, _CASE = as_term(clingo.Function("capability")), as_term(clingo.Function("demand"))
_VERDICTS = (("able", 3), ("lacking", 3), ("busy", 5), ("stopped", 5))


@dataclass(frozen=True, slots=True)
class Demand:
    """One function of one module in a query, and its location in the query."""

    function: str
    module: str
    span: Span


@dataclass(frozen=True, slots=True)
class CapabilityVerdict:
    """Whether a demand can be met, with the reason as a sentence and as traces."""

    demand: Demand
    able: bool
    account: Account
    traces: tuple[Trace, ...]

    @property
    def rule(self) -> str | None:
        """Return the id of the rule that decides the verdict, or None if it is unknown."""
        return next((t.rule.id for t in self.traces if isinstance(t, Derived)), None)

    @property
    def missing(self) -> tuple[str, ...]:
        """Return the missing conditions, from the help of the rules that deny the demand."""
        if self.able:
            return ()
        helps = (
            fill(t.rule.help, t.bindings, shown) for t in self.traces if isinstance(t, Derived)
        )
        return tuple(dict.fromkeys(help_text for help_text in helps if help_text))


@dataclass(frozen=True, slots=True)
class CapabilityAnswer:
    """The verdict on each demand of a query, in its order."""

    query: str
    verdicts: tuple[CapabilityVerdict, ...]

    @property
    def able(self) -> bool:
        """Whether all demands can be met at one time."""
        return all(verdict.able for verdict in self.verdicts)


def capability(project: Project, rulebook: Rulebook, query: str) -> CapabilityAnswer:
    """Return whether a robot can meet all demands of a query at one time.

    A query is `FUNCTION of MODULE`, several of them joined by `while`; `rulebook` contains the
    stages `can` and `account`.

    Raises:
        MarsError: the query cannot be read, or names unknown functions or modules.
    """
    demands = tuple(_demands(query, project))
    queries = [
        Fact(Atom("requested", (number, demand.function, demand.module)), demand.span)
        for number, demand in enumerate(demands, 1)
    ]
    wanted = [(demand.function, demand.module) for demand in demands]
    facts = (*project_facts(project, wanted), *queries)
    analysis = analyse(facts, rulebook, project.configuration.span)
    with costs_of(facts):
        resolution = analysis.grounding.resolve(rulebook.fragments("can"))
    found = [
        symbol
        for name, arity in _VERDICTS
        for symbol, is_fact in analysis.grounding.atoms(name, arity)
        if is_fact or as_term(symbol) in resolution.taken
    ]
    evidence = Evidence(rulebook, facts, analysis, resolution)
    accounts = _accounts(project, evidence, len(demands))
    traces = evidence.explainer.why(found)
    return CapabilityAnswer(
        query,
        tuple(
            CapabilityVerdict(
                demand,
                any(s.name == "able" and s.arguments[0].number == number for s in found),
                accounts[number - 1],
                tuple(traces[s] for s in sorted(found) if s.arguments[0].number == number),
            )
            for number, demand in enumerate(demands, 1)
        ),
    )


def _accounts(project: Project, evidence: Evidence, count: int) -> Sequence[Account]:
    """Return the explanations of the demands 1 to `count`."""
    keys: list[Key] = [(_KIND, as_term(clingo.Number(i)), _CASE) for i in range(1, count + 1)]
    rules, atoms_of = speakers(evidence.rulebook, ["capability"]), partial(true_atoms, evidence)
    accounts = explanations(
        rules, (), atoms_of, names_of(project, evidence.facts, ()), set(keys)
    ).accounts
    return [accounts.get(key, Account(None, (), ())) for key in keys]


def _demands(query: str, project: Project) -> Iterator[Demand]:
    names = {name.text for name in project.configuration.modules}
    problems: list[Diagnostic] = []
    column = 1
    parts = _WHILE.split(query)
    for part in parts[:MOST_DEMANDS]:
        begin = column + len(part) - len(part.lstrip())
        span = Span(QUERY, 1, begin, 1, begin + len(part.strip()))
        column += len(part) + len("while")
        match = _DEMAND.fullmatch(part)
        module = None if match is None else read_name(match[2])
        if match is None or module is None:
            found = f"`{part.strip()}`" if part.strip() else "nothing"
            message = f"found {found}, expected `FUNCTION of MODULE`"
            help_text = "such as `Rotn_Y of Camera while Trans_Z of MobilePlatform`"
            problems.append(Diagnostic("query", "error", message, span, (), help_text, query))
            continue
        for word, known, what in (
            (match[1], _FUNCTIONS, "a function"),
            (module, names, "a module of this configuration"),
        ):
            if word not in known:
                message = f"`{word}` is not {what}"
                help_text = suggestion(word, known, f"one of {', '.join(sorted(known))}")
                problems.append(Diagnostic("query", "error", message, span, (), help_text, query))
        yield Demand(match[1], module, span)
    if len(parts) > MOST_DEMANDS:
        span = Span(QUERY, 1, column, 1, column + 1)
        message = f"more than {MOST_DEMANDS} functions in one question"
        problems.append(Diagnostic("query", "error", message, span, help="ask for fewer"))
    if problems:
        raise MarsError(problems)
