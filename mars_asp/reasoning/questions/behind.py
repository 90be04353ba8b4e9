"""The rules of the base that those of the resolution rest on, or a portion of these."""

from collections.abc import Iterable, Sequence, Set

from mars_asp.asp.fragments import firing
from mars_asp.asp.rules.premises import premises_of_rule
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import BASE, Rulebook
from mars_asp.asp.rules.statements import statements_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import Portion
from mars_asp.model.declarations import NODE_NAMES
from mars_asp.reasoning.findings import CONSEQUENCE, kinds_of
from mars_asp.reasoning.questions.account import speakers
from mars_asp.reasoning.rules import FOLLOWING
from mars_asp.reasoning.synthesis.synthesise import UNRESOLVABLE

_STAGES = ("resolve", FOLLOWING["resolve"])


def for_resolution(rulebook: Rulebook) -> Rulebook:
    """Return the rules that resolve, those that tell of nodes, and what these need of the base.

    That includes what no specification can resolve, which is not theirs to say.
    """
    resolving = tuple(rule for rule in rulebook.rules if rule.stage in _STAGES)
    readers = (*resolving, *speakers(rulebook, NODE_NAMES))
    read = frozenset({UNRESOLVABLE}).union(*(rule.reads for rule in readers))
    base = _behind(rulebook, read, readers)
    texts = (each for each in rulebook.texts if each[0] in _STAGES)
    return Rulebook((*base, *readers), (*_texts(base), *texts), documented=rulebook.documented)


def for_counting(rulebook: Rulebook, counting: Portion) -> Rulebook:
    """Return the rules of the base behind a portion."""
    readers = tuple(
        rule
        for rule in rulebook.rules
        if rule.stage in _STAGES and not counting.derived.isdisjoint(rule.heads | rule.reads)
    )
    base = _behind(rulebook, portion_reads(counting), readers)
    return Rulebook(base, _texts(base), documented=rulebook.documented)


def for_unresolvable(rulebook: Rulebook) -> Rulebook:
    """Return the rules of the base behind what nothing can resolve."""
    base = _behind(rulebook, {UNRESOLVABLE}, ())
    return Rulebook(base, _texts(base), documented=rulebook.documented)


def able_to_fire(rulebook: Rulebook, absent: Set[str]) -> Rulebook:
    """Return rules without those that need a predicate which has no atom, however indirectly.

    `absent` are the names of given predicates of which there is no fact.
    """
    told = [premises_of_rule(rule) for rule in rulebook.rules]
    rules = [(each.needs[0], each.gives[0]) for each in told]
    derived = frozenset[str]().union(*(gives for _, gives in rules))
    able = firing(rules, names_read(rulebook) - absent - derived)
    base = tuple(rule for number, rule in enumerate(rulebook.rules) if number in able)
    return Rulebook(base, _texts(base), documented=rulebook.documented)


def still_read(rulebook: Rulebook, read: Set[Signature]) -> Rulebook:
    """Return the rules that derive what is read, however indirectly, and those without a head."""
    needed: frozenset[Signature] = frozenset(read)
    kept: Sequence[Rule] = ()
    while True:
        found = [r for r in rulebook.rules if not r.heads or not needed.isdisjoint(r.heads)]
        if len(found) == len(kept):
            return Rulebook(tuple(found), _texts(found), documented=rulebook.documented)
        kept, needed = found, needed.union(*(rule.reads for rule in found))


def portion_reads(portion: Portion) -> frozenset[Signature]:
    """Return what the rules of a portion read and do not derive."""
    return portion.of_all.union(portion.of_parts)


def names_read(rulebook: Rulebook) -> frozenset[str]:
    """Return the names of the predicates that rules read."""
    return frozenset(each.name for rule in rulebook.rules for each in rule.reads)


def _behind(rulebook: Rulebook, read: Set[Signature], readers: Sequence[Rule]) -> tuple[Rule, ...]:
    """Return the rules of the base that derive what is read, however indirectly.

    Of consequences they are those of the kinds that the readers name, or all.
    """
    base = [rule for rule in rulebook.rules if rule.stage == "base"]
    behind: dict[str, Rule] = {}
    new: Sequence[Rule] | None = None
    while new is None or new:
        kinds = kinds_read((*behind.values(), *readers))
        new = tuple(
            rule
            for rule in base
            if rule.text not in behind
            and not rule.heads.isdisjoint(read)
            and (kinds is None or is_read(rule, kinds))
        )
        behind.update((rule.text, rule) for rule in new)
        read = {*read, *(each for rule in new for each in rule.reads)}
    return tuple(rule for rule in base if rule.text in behind)


def _texts(base: Iterable[Rule]) -> tuple[tuple[str, str], ...]:
    return tuple((BASE, rule.text) for rule in base if rule.listed is None)


def kinds_read(rules: Iterable[Rule]) -> frozenset[str] | None:
    """Return the kinds of consequence that rules read by name; `None` where they read any."""
    texts = [rule.text for rule in rules if CONSEQUENCE in rule.reads]
    kinds = {
        literal.terms[0].constant
        for variants in statements_of(texts).values()
        for statement in variants
        for literal in statement.read
        if literal.signature == CONSEQUENCE
    }
    return None if None in kinds else frozenset(kind for kind in kinds if kind is not None)


def is_read(rule: Rule, kinds: Set[str]) -> bool:
    """Whether a rule derives anything besides consequences of other kinds."""
    named = kinds_of(rule)
    return named is None or not named or not named.isdisjoint(kinds)
