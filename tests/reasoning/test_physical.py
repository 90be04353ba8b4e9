"""Inherited functions: the rules against a numeric rank test that shares nothing with them."""

import random
from collections import Counter
from typing import TypeAlias

import clingo
import numpy as np
import pytest

from mars_asp.model.declarations import MOTION_FUNCTIONS, Configuration, Mount
from mars_asp.reasoning.facts.compile import configuration_facts, facts_text
from mars_asp.reasoning.facts.motion import frame_facts
from mars_asp.reasoning.rules import load_rulebook
from tests.support.campaigns import examples
from tests.support.motions import Motions, all_motions
from tests.support.robots import HERE, module, placed, random_chain, robot

Verdict: TypeAlias = set[tuple[str, str]]
CHAINS = examples(150, 700)


@pytest.fixture(scope="module")
def rules() -> str:
    return load_rulebook().text("base")


def verdicts(configuration: Configuration, rules: str, subject: str = "M0") -> Verdict:
    return all_verdicts(configuration, rules).get(subject, set())


def all_verdicts(configuration: Configuration, rules: str) -> dict[str, Verdict]:
    facts = (*configuration_facts(configuration), *frame_facts(configuration, {}))
    control = clingo.Control(["--warn=none"])
    control.add("base", [], rules + facts_text(facts))
    control.ground()
    found: dict[str, Verdict] = {}
    for atom in control.symbolic_atoms.by_signature("consequence", 4):
        kind, _, name, case = atom.symbol.arguments
        if case.type == clingo.SymbolType.String:
            found.setdefault(name.string, set()).add((kind.name, case.string))
    appearances = control.symbolic_atoms.by_signature("appears", 5)
    aligned = {tuple(atom.symbol.arguments[at] for at in (0, 1, 3)) for atom in appearances}
    for atom in control.symbolic_atoms.by_signature("on_arc", 4):
        heir, provider, function, _ = atom.symbol.arguments
        arc = f"{provider.string} {function.string}"
        alone = (heir, provider, function) in aligned
        found.setdefault(heir.string, set()).add(("arc" if alone else "combined arc", arc))
    return found


def shifts(motions: Motions, provider: str, function: str) -> bool:
    """Whether the provider's turns that make up one about an axis also shift the module."""
    turning = [t for j, t in motions.rest.items() if j[0] == provider and "Rotn" in j[1]]
    matrix = np.array(turning).T
    axis = np.eye(3)[MOTION_FUNCTIONS.index(function)]
    shares, *_ = np.linalg.lstsq(matrix[:3], axis, rcond=1e-6)
    return bool(np.linalg.norm(matrix[3:] @ shares) > 1e-4)


def expected(chain: Configuration, subject: str) -> Verdict:
    """Return the verdicts of the reference on the sensor at the end of a chain."""
    found: Verdict = set()
    motions = all_motions(chain, 99)[subject]
    for index, function in enumerate(MOTION_FUNCTIONS):
        givers = motions.givers(function)
        if givers:
            kind = "simple_inheritance" if len(givers) == 1 else "similar_inheritance"
            found.add((kind, function))
        elif motions.emergent(function):
            found.add(("emergent_functionality", function))
        for provider in givers if index < 3 else ():
            if shifts(motions, provider, function):
                own = [twist for joint, twist in motions.rest.items() if joint[0] == provider]
                straight = max(abs(float(twist[index])) for twist in own) > 1 - 1e-6
                found.add(("arc" if straight else "combined arc", f"{provider} {function}"))
    return found


def test_random_chains(rules: str) -> None:
    """All chains are in one configuration, in which they are independent."""
    chooser = random.Random(2026)
    chains = [random_chain(chooser, f"C{number}M", 0.7 * (number % 2)) for number in range(CHAINS)]
    mounts = [r for chain in chains for r in chain.relationships if isinstance(r, Mount)]
    together = robot(mounts, [m for chain in chains for m in chain.declared])
    found = all_verdicts(together, rules)
    seen: Counter[str] = Counter()
    for number, chain in enumerate(chains):
        should = expected(chain, f"C{number}M0")
        does = found.get(f"C{number}M0", set())
        assert does == should, f"chain {number}"
        seen.update(kind for kind, _ in does)
        seen.update(f"oblique {kind}" for kind, _ in does if number % 2)
    assert min(seen.values()) * 15 > CHAINS, seen
    assert len(seen) == 10, seen


@pytest.mark.parametrize(
    "kind",
    ["similar_inheritance", "emergent_functionality", "module_conflict", "global_functionality"],
)
def test_help_marks_a_definition_as_ours(kind: str) -> None:
    entries = [r.help for r in load_rulebook().rules if r.text.startswith(f"consequence({kind},")]
    assert entries
    assert all(help_ and "our definition" in help_ for help_ in entries)


def test_signs_and_names_through_right_angles() -> None:
    mount = Mount("M0", "P", HERE, transformation=placed([("y", 90)]))
    configuration = robot([mount], [module("M0", sensor=True), module("P", "Trans_Z", "Rotn_X")])
    entries = {str(fact.atom) for fact in frame_facts(configuration, {})}
    assert {
        'appears("M0","P","Trans_Z","Trans_X",-1)',
        'appears("M0","P","Rotn_X","Rotn_Z",1)',
        'rooted("M0","P",1)',
    } <= entries


def test_two_oblique_slides_together_give_a_motion_that_neither_gives(rules: str) -> None:
    mounts = [Mount("M0", "A", HERE, transformation=placed([("y", 30)])), Mount("A", "B", HERE)]
    slides = [module("M0", sensor=True), module("A", "Trans_X"), module("B", "Trans_Z")]
    emergent = {("emergent_functionality", "Trans_X"), ("emergent_functionality", "Trans_Z")}
    assert verdicts(robot(mounts, slides), rules) == emergent
    table = [module("M0", sensor=True), module("A", "Trans_X", "Trans_Z")]
    simple = {("simple_inheritance", "Trans_X"), ("simple_inheritance", "Trans_Z")}
    assert verdicts(robot(mounts[:1], table), rules) == simple


def test_a_lever_arm_alone_lets_nothing_emerge(rules: str) -> None:
    mount = Mount("M0", "Head", HERE, transformation=placed((), 0, 0, 100))
    chain = robot([mount], [module("M0", sensor=True), module("Head", "Rotn_Y")])
    assert verdicts(chain, rules) == {("simple_inheritance", "Rotn_Y"), ("arc", "Head Rotn_Y")}


def test_modules_without_description_carry_frames_and_give_nothing(rules: str) -> None:
    mounts = [
        Mount("M0", "Plate", HERE, transformation=placed([("z", 90)])),
        Mount("Plate", "Head", HERE),
    ]
    chain = robot(mounts, [module("M0", sensor=True), module("Head", "Rotn_Y")])
    assert verdicts(chain, rules) == {("simple_inheritance", "Rotn_X")}


def test_functions_of_the_module_itself_are_not_inherited(rules: str) -> None:
    mount = Mount("M0", "Head", HERE)
    chain = robot([mount], [module("M0", "Rotn_X", sensor=True), module("Head", "Trans_Z")])
    assert verdicts(chain, rules) == {("simple_inheritance", "Trans_Z")}


def test_cycles_and_double_mounts_are_findings(rules: str) -> None:
    mounts = [
        Mount("M0", "B", HERE),
        Mount("B", "C", HERE),
        Mount("C", "B", HERE),
        Mount("D", "D", HERE),
        Mount("E", "P", HERE),
        Mount("E", "Q", HERE),
    ]
    modules = [module("M0", sensor=True), module("C", "Rotn_X"), module("E", sensor=True)]
    configuration = robot(mounts, modules)
    control = clingo.Control(["--warn=none"])
    facts = (*configuration_facts(configuration), *frame_facts(configuration, {}))
    control.add("base", [], rules + facts_text(facts))
    control.ground()
    found = {str(a.symbol) for a in control.symbolic_atoms.by_signature("consequence", 4)}
    assert {
        'consequence(module_conflict,error,"B",cycle)',
        'consequence(module_conflict,error,"D",cycle)',
        'consequence(module_conflict,error,"E",mounts)',
    } <= found
