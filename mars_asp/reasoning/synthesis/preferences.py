"""What rule packs would rather not have, and a specification has nevertheless."""

from typing import NamedTuple

from mars_asp.asp.messages import heard, predicate_of, saying
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.grounding import Answer, Grounding
from mars_asp.asp.solve.term_ids import arguments, as_symbol, atoms
from mars_asp.reasoning.findings import PREFERENCE

_STAGE = "preferences"


class Preference(NamedTuple):
    """What costs `weight` at a level below that of lines, with the rule that says so."""

    level: int
    weight: int
    message: str
    rule: Rule


def preferences(rulebook: Rulebook, answer: Answer) -> tuple[Preference, ...]:
    """Return what the preferences of packs cost in an answer, the highest level first.

    Raises:
        MarsError: clingo refuses the rules.
    """
    rules = [rule for rule in rulebook.rules if rule.derives(PREFERENCE)]
    if not rules:
        return ()
    read = frozenset({PREFERENCE}).union(*(rule.reads for rule in rules))
    grounding = Grounding((), answer.true_of(sorted(read)))
    grounding.derive(saying(_STAGE, rules))
    told = Signature(predicate_of(_STAGE), 3)
    found: dict[object, Preference] = {}
    for said in (heard(atom, rules) for atom in atoms(grounding.control, *told)):
        level, weight = (as_symbol(term).number for term in arguments(said.head)[:2])
        message = said.message or str(as_symbol(said.head))
        found.setdefault(said.head, Preference(level, weight, message, said.rule))
    return tuple(sorted(found.values(), key=lambda each: (-each.level, each.message)))
