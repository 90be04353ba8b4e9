"""Grounding without the rules that cannot fire derives the same facts as with all rules."""

import random
from collections.abc import Sequence

import pytest

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.messages import saying
from mars_asp.asp.rules.premises import premises_of
from mars_asp.asp.rules.statements import Piece, pieces
from mars_asp.asp.solve.grounding import Grounding, NoAnswerError
from mars_asp.asp.solve.term_ids import text
from mars_asp.reasoning.facts.compile import given
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import STAGES, load_rulebook
from mars_asp.reasoning.verification import specification_facts
from tests.support.campaigns import seeds
from tests.support.mutants import mutant
from tests.support.random_configurations import (
    random_configuration,
    random_control,
    random_faults,
    random_mounts,
    random_ports,
    random_twins,
)
from tests.support.subjects import read, synthesised

RULEBOOK = load_rulebook(stages=STAGES)
MAKERS = (
    random_configuration,
    random_control,
    random_faults,
    random_mounts,
    random_ports,
    random_twins,
)
#: What is derived of consequences without more facts.
DETERMINISTIC = ("account", "absence", "repair")


def test_the_build_has_read_all_rules_and_nothing_else_is_lost() -> None:
    for _, written in RULEBOOK.texts:
        found = premises_of(written)
        assert found is not None
        pairs = zip(found.rest, (*found.rules, ""), strict=True)
        whole = "".join(part for pair in pairs for part in pair)
        assert statements_in(whole) == statements_in(written)
        assert whole.count("\n") == written.count("\n")


def statements_in(written: str) -> Sequence[Piece]:
    return [each for each in pieces(written) if each.sort != "comment"]


@pytest.mark.parametrize("number", seeds(1, 60))
def test_idle_rules_change_nothing(number: int) -> None:
    project = read(MAKERS[number % len(MAKERS)](number))
    for stage in DETERMINISTIC:
        assert_equal(derived(project, stage, True), derived(project, stage, False))
    assert resolved(project, True) == resolved(project, False)
    found = synthesised(project)
    if found is not None:
        _, wrong = mutant(found.specification.configuration, random.Random(number))
        facts = given(specification_facts(wrong, project, RULEBOOK))
        assert_equal(*(derived(project, "verify", able, facts) for able in (True, False)))


def derived(project: Project, stage: str, able: bool, *more: Fragment) -> Sequence[str]:
    """Return the sorted facts of a grounding of the base and a stage, sentences included."""
    grounding = Grounding(program(project, able))
    speakers = [rule for rule in RULEBOOK.rules if rule.stage == stage and rule.because]
    rules = [*RULEBOOK.fragments(stage), *saying(stage, speakers), *more]
    grounding.derive(rules if able else unread(rules))
    return sorted(str(each.symbol) for each in grounding.control.symbolic_atoms if each.is_fact)


def resolved(project: Project, able: bool) -> object:
    """Return the least answer and all that is known of its cost."""
    grounding = Grounding(program(project, able))
    rules = RULEBOOK.fragments("resolve")
    try:
        found = grounding.resolve(rules if able else unread(rules))
    except NoAnswerError:
        return None
    taken = sorted(map(text, found.taken))
    return taken, found.cost, found.bound, found.proven, found.count


def program(project: Project, able: bool) -> Sequence[Fragment]:
    whole = [*RULEBOOK.fragments("base"), given(project_facts(project))]
    return whole if able else unread(whole)


def unread(rules: Sequence[Fragment]) -> Sequence[Fragment]:
    """Return the rules with their premises unknown, so that all rules stay."""
    return [each._replace(premises=None) for each in rules]


def assert_equal(one: Sequence[str], other: Sequence[str]) -> None:
    assert one == other, set(one) ^ set(other)
