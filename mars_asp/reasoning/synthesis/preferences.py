"""The preferences of rule packs that a specification does not meet, with their cost."""

from typing import NamedTuple

from mars_asp.asp.messages import heard, predicate_of, saying
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.grounding import ChosenAnswer, Grounding
from mars_asp.asp.solve.term_ids import arguments, as_symbol, atoms
from mars_asp.reasoning.findings import PREFERENCE

_STAGE = "preferences"


class Preference(NamedTuple):
    """An unmet preference: its weight at a level below that of lines, and its rule."""

    level: int
    weight: int
    message: str
    rule: Rule


def preferences(rulebook: Rulebook, answer: ChosenAnswer) -> tuple[Preference, ...]:
    """Return the preferences that an answer does not meet, the highest level first.

    Raises:
        MarsError: clingo refuses the rules.
    """
    rules = [rule for rule in rulebook.rules if rule.derives(PREFERENCE)]
    if not rules:
        return ()
    read = frozenset({PREFERENCE}).union(*(rule.reads for rule in rules))
    grounding = Grounding((), answer.true_of(sorted(read)))
    grounding.derive(saying(_STAGE, rules))
    predicate = Signature(predicate_of(_STAGE), 3)
    found: dict[object, Preference] = {}
    for instance in (heard(atom, rules) for atom in atoms(grounding.control, *predicate)):
        level, weight = (as_symbol(term).number for term in arguments(instance.head)[:2])
        message = instance.message or str(as_symbol(instance.head))
        found.setdefault(instance.head, Preference(level, weight, message, instance.rule))
    return tuple(sorted(found.values(), key=lambda each: (-each.level, each.message)))
