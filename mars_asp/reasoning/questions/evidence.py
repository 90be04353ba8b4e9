"""The rules and facts that one question needs: a splitting set (Lifschitz and Turner 1994).

What a rule of the base reads is derived by rules of the base alone, so the rules behind an atom,
grounded without the others, give it as all of them together do. Of their instances and of the
facts, `mars_asp.asp.slice.magic` says which the question can need.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import clingo

from mars_asp.asp.cache import digest, made_of
from mars_asp.asp.rules import statements
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import BASE, Rulebook
from mars_asp.asp.rules.statements import Statement, has_rules_alone, statements_of
from mars_asp.asp.rules.symbols import symbol_in, symbol_of, term_of
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.slice import magic
from mars_asp.asp.slice.magic import Asked, Demand, are_forced, negates_itself
from mars_asp.asp.slice.reach import Outline, outlines_of, reachable_rules, reads
from mars_asp.asp.solve.atoms import Fact
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.index import Lookup
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.findings import CONSEQUENCE, consequence_kinds
from mars_asp.reasoning.project import project_facts, project_lookup
from mars_asp.reasoning.questions.account import ACCOUNT, CONCERNS, speakers
from mars_asp.reasoning.questions.behind import is_read, kinds_read
from mars_asp.reasoning.session import Evidence, Reasoner

#: A rule and its outlines.
_Outlined: TypeAlias = tuple[Rule, tuple[Outline, ...]]


def sliced_evidence(reasoner: Reasoner, subject: str) -> Evidence | None:
    """Return what a question about consequences or an atom needs; `None` where that is not told.

    Raises:
        MarsError: clingo refuses the rules.
    """
    project, rulebook = reasoner.project, reasoner.rulebook
    part = slice_for(
        subject,
        rulebook,
        lambda names: project_facts(project, wanted=names),
        lambda names: project_lookup(project, names, vocabulary(rulebook)),
    )
    if part is None:
        return None
    analysis = analyse(part.facts, part.rulebook, project.configuration.span, subject)
    return Evidence(part.rulebook, part.facts, analysis)


@dataclass(frozen=True, slots=True)
class Slice:
    """A part of the rules and of the facts, which answers a question as the whole does."""

    rulebook: Rulebook
    facts: tuple[Fact, ...]


def slice_for(
    subject: str,
    rulebook: Rulebook,
    facts_of: Callable[[Set[str]], Iterable[Fact]],
    lookup_of: Callable[[Set[str]], Lookup],
) -> Slice | None:
    """Return what `KIND(NAME)` of a consequence or an atom needs, or `None` for anything else.

    That is so where the subject is no such term, or where no rule of the base derives it, and with
    rule packs that could leave no answer at all or several, or compute what does not fit, by rules
    that the question does not read. By the names of predicates, `facts_of` gives all their facts,
    `lookup_of` those that are looked for.
    """
    name, first = _asked(subject, rulebook)
    if not name:
        return None
    rules = [rule for rule in rulebook.rules if rule.stage == "base"]
    # What is told of a consequence, and what it concerns, is asked with it.
    telling = speakers(rulebook, [first]) if name == CONSEQUENCE.name else ()
    if rulebook.packs and (rulebook.asked or not _has_one_answer(rules, rulebook)):
        return None
    rules += telling
    if name == CONSEQUENCE.name:
        rules = _of_kinds(rules, {first})
    base = list(zip(rules, outlines_of(rule.text for rule in rules), strict=True))
    if not any(name == head.name for rule in rules for head in rule.heads):
        return None
    predicates = (
        name,
        f"-{name}",
        *([ACCOUNT.name, CONCERNS.name] if name == CONSEQUENCE.name else []),
    )
    asked = dict.fromkeys(predicates, frozenset({first}))
    # What could matter says which facts to make, and these which rules can fire at all.
    possible = _behind(base, asked, None)
    demand = _demand(subject, name, [rule for rule, _ in possible], vocabulary(rulebook).keys)
    if demand is None:
        facts = tuple(facts_of(_read(possible, name)))
        text = None
    else:
        facts, text = _needed(*demand, facts_of, lookup_of)
    derived = {head.signed for _, variants in base for one in variants for head in one.derives}
    behind = _behind(base, asked, derived | {fact.atom.name for fact in facts})
    names = _read(behind, name)
    needed = tuple(fact for fact in facts if fact.atom.name in names)
    sliced = tuple(rule for rule, _ in behind)
    if text is None:
        text = "\n".join(rule.text for rule in sliced)
    return Slice(Rulebook(sliced, (("base", text),), documented=rulebook.documented), needed)


def _of_kinds(rules: Sequence[Rule], kinds: Set[str]) -> list[Rule]:
    """Return rules without those that only derive consequences of kinds that none of them reads.

    Those of some kinds are asked for.
    """
    asked = dict.fromkeys((CONSEQUENCE.name, ACCOUNT.name, CONCERNS.name), frozenset(kinds))
    while True:
        kept = [rule for rule in rules if is_read(rule, kinds)]
        outlines = outlines_of(rule.text for rule in kept)
        behind = [kept[number] for number in reachable_rules(outlines, asked, None)]
        read = kinds_read(behind)
        if read is None:
            return list(rules)
        if read <= kinds:
            return kept
        kinds |= read


def _statements(rules: Iterable[Rule]) -> list[Statement]:
    read = statements_of(rule.text for rule in rules)
    return [statement for variants in read.values() for statement in variants]


def _has_one_answer(base: Iterable[Rule], rulebook: Rulebook) -> bool:
    """Say whether rules with packs have just one answer, whatever the facts are.

    So it is where packs hold rules alone, each of which forces one atom, and recursion leads
    through no negation: they are stratified (Apt, Blair and Walker 1988).
    """
    if any(not has_rules_alone(text) for text in rulebook.pack_texts(BASE)):
        return False
    every = _statements(base)
    if not are_forced(every) or negates_itself(every):
        return False
    # What is classically negated excludes what is not.
    return not any(statement.head.is_negated for statement in every)


def _demand(
    subject: str,
    name: str,
    rules: Sequence[Rule],
    keys: Mapping[Signature, Sequence[int]],
) -> tuple[Demand, str] | None:
    """Return how to find out which instances a question needs, and the program that does so.

    `None` where that cannot be told. Consequences of one kind are asked for alike, so a build keeps
    what is made of the rules behind them.
    """
    symbol = _term(subject)
    if name == CONSEQUENCE.name and (symbol is None or symbol.name != name):
        kind, _, rest = subject.partition("(")
        about = rest.removesuffix(")")
        # A name is shown without quotes, any other term as it is written.
        subjects = {str(clingo.String(about)), str(symbol_in(about) or clingo.String(about))}
        values: list[tuple[str, ...]] = [(kind, each) for each in sorted(subjects)]
        derived = frozenset[Signature]().union(*(rule.heads for rule in rules))
        told = (Asked(each, (0, 1)) for each in (ACCOUNT, CONCERNS) if each in derived)
        wanted = (Asked(CONSEQUENCE, (0, 2)), *told)
    elif symbol is None or not symbol.arguments:
        return None
    else:
        wanted = (Asked(signature_of(symbol), tuple(range(len(symbol.arguments)))),)
        values = [tuple(map(str, symbol.arguments))]
    texts = "\n".join(rule.text for rule in rules)
    given = repr(sorted((*signature, *places) for signature, places in keys.items()))
    key = (digest(texts.encode()), digest(given.encode()), wanted)
    makers = (Path(__file__), Path(magic.__file__), Path(statements.__file__))
    made = made_of(
        "demands", makers, [key], lambda _: magic.demand_of(_statements(rules), wanted, keys)
    )
    demand = made[key]
    return None if demand is None else (demand, demand.asking(values))


def _needed(
    demand: Demand,
    program: str,
    facts_of: Callable[[Set[str]], Iterable[Fact]],
    lookup_of: Callable[[Set[str]], Lookup],
) -> tuple[tuple[Fact, ...], str]:
    """Return the facts that are needed, and the rules with what says so."""
    lookup = lookup_of(demand.found)
    control = clingo.Control(["--warn=none"])
    control.add("demand", [], program)
    control.ground([("demand", [])], _Context(lookup))
    atoms = (str(atom.symbol) for atom in control.symbolic_atoms)
    needs = (f"{atom}." for atom in atoms if atom.startswith("_need"))
    whole = tuple(facts_of(demand.whole)) if demand.whole else ()
    found = (fact for fact in lookup.facts if fact.atom.name not in demand.whole)
    return (*whole, *found), "\n".join((demand.guarded, *needs))


class _Context:
    """What a demand program calls."""

    def __init__(self, lookup: Lookup) -> None:
        self._lookup = lookup

    def given(
        self, name: clingo.Symbol, positions: clingo.Symbol, values: clingo.Symbol
    ) -> Sequence[clingo.Symbol]:
        """Return the arguments of the given facts with values at positions, as tuples."""
        places = tuple(place.number for place in positions.arguments)
        found = self._lookup.find(name.string, places, tuple(map(term_of, values.arguments)))
        return [clingo.Function("", symbol_of(fact.atom).arguments) for fact in found]


def _behind(
    rules: Sequence[_Outlined], asked: Mapping[str, frozenset[str]], present: Set[str] | None
) -> tuple[_Outlined, ...]:
    found = reachable_rules([variants for _, variants in rules], asked, present)
    return tuple(rules[number] for number in found)


def _read(rules: Iterable[_Outlined], asked: str) -> frozenset[str]:
    names = (each.signed for _, variants in rules for each in reads(variants))
    return frozenset({asked, *names})


def _asked(subject: str, rulebook: Rulebook) -> tuple[str, str]:
    """Return the predicate and the first argument that a subject names; none are empty."""
    kind, bracket, _ = subject.partition("(")
    if not bracket:
        return "", ""
    if kind in consequence_kinds(rulebook):
        return CONSEQUENCE[0], kind
    symbol = _term(subject)
    return ("", "") if symbol is None else (symbol.name, str((*symbol.arguments, "")[0]))


def _term(text: str) -> clingo.Symbol | None:
    """Return what a text says, if it is a function term."""
    symbol = symbol_in(text)
    return symbol if symbol is not None and symbol.type == clingo.SymbolType.Function else None
