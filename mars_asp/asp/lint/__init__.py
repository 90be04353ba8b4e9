"""Lint: a function from rules and declarations to diagnostics.

Each family of lints has a file; `catalogue` documents each lint with its reason.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import chain

from mars_asp.asp.lint.aggregates import wrong_aggregates
from mars_asp.asp.lint.allow import allowed
from mars_asp.asp.lint.arithmetic import risks
from mars_asp.asp.lint.bodies import wrong_bodies
from mars_asp.asp.lint.clauses import Clause, ClauseAtom, clauses_of, name_of
from mars_asp.asp.lint.copies import superfluous
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.lint.joins import paired
from mars_asp.asp.lint.keys import apart_by_keys
from mars_asp.asp.lint.messages import (
    MessageFunctions,
    missing_examples,
    open_messages,
    rival_messages,
    wrong_holes,
)
from mars_asp.asp.lint.names import declared_in, shared_names
from mars_asp.asp.lint.predicates import documented_in_vain, undefined, unfounded, unknown, unused
from mars_asp.asp.lint.recursion import wrong_recursion
from mars_asp.asp.lint.roles import demands, described_anew, silent, unplaced, words_as_numbers
from mars_asp.asp.lint.sorts import mixed_units, wrong_values
from mars_asp.asp.lint.values import Form, KnownValue
from mars_asp.asp.lint.variables import single_variables
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import read_by_costs, shown
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.cyclic import cyclic_components


@dataclass(frozen=True)
class Host:
    """The properties of the host program that lint cannot read from the rules.

    `finding` is the predicate of findings. `forms` maps each sort to the form of its values, and
    `things` are the sorts with many values. `unbounded` has the positions (from 0) of numbers that
    users state. `kinds` maps a sort to the argument that has all its derived values. `exists`
    returns whether a rule's example exists. Constraints belong in `demanding` stages; over chosen
    atoms they may also be in `choosing` stages. `placing` maps a predicate that introduces a thing
    to those that give the thing a place.
    """

    finding: Signature | None = None
    forms: Mapping[str, Form] = field(default_factory=dict)
    things: frozenset[str] = frozenset()
    unbounded: Mapping[Signature, Iterable[int]] = field(default_factory=dict)
    kinds: Mapping[str, tuple[Signature, int]] = field(default_factory=dict)
    exists: Callable[[Rule], bool] = lambda rule: True
    demanding: frozenset[str] = frozenset()
    choosing: frozenset[str] = frozenset()
    placing: Mapping[Signature, frozenset[Signature]] = field(default_factory=dict)


def lint(rulebook: Rulebook, host: Host) -> tuple[LintFinding, ...]:
    """Return the findings about the rules of packs, or about all rules if there are no packs.

    They are in the order of their locations, without the findings that a rule allows.
    """
    first = len(rulebook.rules) - rulebook.pack_rules if rulebook.packs else 0
    own = rulebook.rules[first:]
    stages = {"base", *(rule.stage for rule in own)}
    rules = [rule for rule in rulebook.rules[:first] if rule.stage in stages]
    begin = len(rules)
    rules += own
    found = {
        (each.diagnostic.span, each.diagnostic.code, each.diagnostic.message): each
        for each in _found(rulebook, host, rules, begin)
    }
    result = allowed(own, tuple(found.values()))
    return tuple(sorted(result, key=lambda each: (each.diagnostic.span, each.diagnostic.code)))


def _found(rulebook: Rulebook, host: Host, rules: list[Rule], begin: int) -> Iterator[LintFinding]:
    """Yield the findings about the rules from index `begin` on; earlier ones are context."""
    read = clauses_of(rules)
    clauses = [clause for number in range(len(rules)) for clause in read[number]]
    after = sum(len(read[number]) for number in range(begin))
    judged = frozenset(range(after, len(clauses)))
    declared, replaced = rulebook.declarations, rulebook.replaced
    known = KnownValue(clauses, declared, host.forms, replaced, host.kinds)
    # Predicates with and without the sign of classical negation are different ones.
    circle = cyclic_components(
        (head.signature, atom.signature)
        for clause in clauses
        for head, _ in clause.heads
        for atom in clause.read
    )
    functions = MessageFunctions(clauses, declared)
    reported = frozenset({host.finding} if host.finding else ())
    # The predicates that rules of choosing stages derive, by stage.
    decided = {
        stage: {s.unsigned for rule in rules if rule.stage == stage for s in rule.heads}
        for stage in host.choosing
    }
    is_large = partial(_is_large, known=known, things=host.things)
    entries: set[tuple[str, str]] = set()
    for number in range(begin, len(rules)):
        rule, listed = rules[number], _expanded_clauses(rules, read, number)
        if rule.listed is None:
            entries = set()
            yield from single_variables(read[number], listed)
            yield from missing_examples(rule, host.exists)
        for clause in read[number]:
            for each in wrong_values(clause, known, declared):
                what = each.diagnostic.code, each.diagnostic.message
                if rule.listed is None or what not in entries:
                    yield each
                entries.add(what)
            if rule.listed is not None:
                # Its body is judged at the rule whose metadata it comes from.
                continue
            yield from chain(
                wrong_bodies(clause, replaced),
                apart_by_keys(clause, declared, replaced),
                wrong_aggregates(clause),
                wrong_recursion(clause, circle),
                paired(clause, is_large),
                open_messages(clause, reported, functions),
                wrong_holes(clause, known, host.things),
                words_as_numbers(clause, known),
                silent(clause, reported),
                demands(clause, host.demanding, decided),
            )
    yield from rival_messages(clauses, judged, reported)
    yield from mixed_units(clauses, judged, known)
    yield from superfluous(clauses, judged)
    yield from unplaced(clauses, judged, host.placing)
    yield from unused(clauses, judged, _public(rulebook), circle)
    yield from unfounded(clauses, judged, circle)
    # Without packs the slice from 0 has all texts.
    at = declared_in(rulebook, rulebook.texts[-rulebook.packs :])
    documented = {s for s, each in declared.items() if each.words or each.origin}
    if rulebook.packs:
        files = rulebook.documented[len(rulebook.documented) - rulebook.packs :]
        here = [each for file in files for each in file.declarations]
        known_before = {*at, *rulebook.built_in.declarations}
        yield from documented_in_vain(clauses, here, known_before)
        yield from described_anew(here, rulebook.built_in.declarations)
    else:
        yield from unknown(clauses, {*at, *documented})
    attributes = {s for s, each in declared.items() if each.attribution and not each.public}
    yield from undefined(clauses, at, documented, attributes)
    yield from risks([read[number] for number in range(begin, len(rules))], host.unbounded)
    yield from shared_names(rulebook)


def _expanded_clauses(
    rules: list[Rule], read: Mapping[int, tuple[Clause, ...]], number: int
) -> list[Clause]:
    """Return the clauses of the rules that the metadata of rule `number` expand to."""
    found: list[Clause] = []
    while (number := number + 1) < len(rules) and rules[number].listed is not None:
        found += read[number]
    return found


def _public(rulebook: Rulebook) -> set[Signature]:
    """Return the predicates that are shown, read by costs, or declared public."""
    found = {each.signature for each in rulebook.declarations.values() if each.public}
    for _, text in rulebook.texts:
        found |= read_by_costs(text)
        found |= {each.unsigned for each in shown(text)}
    return found


def _is_large(atom: ClauseAtom, known: KnownValue, things: frozenset[str]) -> bool:
    """Whether a variable of an atom has a sort with many values (`things`)."""
    return any(
        values is not None and name_of(term) and any(each.sort in things for each in values)
        for term, values in zip(atom.terms, known.arguments(atom.signature), strict=False)
    )
