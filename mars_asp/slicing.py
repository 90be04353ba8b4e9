"""The rules and facts that one question needs: a splitting set (Lifschitz and Turner 1994).

What a rule of the base reads is derived by rules of the base alone, so the rules behind an atom,
grounded without the others, give it as all of them together do.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass

import clingo

from mars_asp.atom import Fact
from mars_asp.rulebook import Rule, Rulebook
from mars_asp.trace.demand import names_read, reachable_rules


@dataclass(frozen=True, slots=True)
class Slice:
    """A part of the rules and of the facts, which answers a question as the whole does."""

    rulebook: Rulebook
    facts: tuple[Fact, ...]


def slice_for(
    subject: str, rulebook: Rulebook, facts_of: Callable[[Set[str]], Iterable[Fact]]
) -> Slice | None:
    """Return what `KIND(NAME)` of a consequence or an atom needs, or `None` for anything else.

    That is so where the subject is no such term, or where no rule of the base derives it, and
    with rule packs: rules that the question does not read could leave no answer at all.
    `facts_of` gives the facts of predicates, by their names.
    """
    if rulebook.packs:
        return None
    name, first = _asked(subject, rulebook)
    base = [rule for rule in rulebook.rules if rule.stage == "base"]
    if not any(name == head for rule in base for head, _ in rule.heads):
        return None
    asked = {name: frozenset({first})}
    derived = {head for rule in base for head, _ in rule.heads}
    every = derived.union(*(names_read(rule.text) for rule in base))
    # What could matter says which facts to make, and these which rules can fire at all.
    facts = tuple(facts_of(_read(_behind(base, asked, every), name)))
    rules = _behind(base, asked, derived | {fact.atom.name for fact in facts})
    read = _read(rules, name)
    text = "\n".join(rule.text for rule in rules)
    needed = tuple(fact for fact in facts if fact.atom.name in read)
    return Slice(Rulebook(rules, (("base", text),)), needed)


def _behind(
    rules: Sequence[Rule], asked: Mapping[str, frozenset[str]], present: Set[str]
) -> tuple[Rule, ...]:
    return tuple(rules[number] for number in reachable_rules(rules, asked, present))


def _read(rules: Iterable[Rule], asked: str) -> frozenset[str]:
    return frozenset({asked}).union(*(names_read(rule.text) for rule in rules))


def _asked(subject: str, rulebook: Rulebook) -> tuple[str, str]:
    """Return the predicate and the first argument that a subject names; none are empty."""
    kind, bracket, _ = subject.partition("(")
    if not bracket:
        return "", ""
    if any(rule.text.startswith(f"consequence({kind},") for rule in rulebook.rules):
        return "consequence", kind
    try:
        symbol = clingo.parse_term(subject, logger=lambda *_: None)
    except RuntimeError:
        return "", ""
    if symbol.type != clingo.SymbolType.Function:
        return "", ""
    return symbol.name, str(symbol.arguments[0]) if symbol.arguments else ""
