"""Least supports: what rules make of combined motions, against brute force over subsets.

    python -m tests.reasoning.test_combinations HOW_MANY [FIRST_SEED]

does the same for as many random mount trees as wanted.
"""

import random
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import combinations, product

import pytest

from mars_asp.language import parse_text
from mars_asp.model.declarations import MOTION_FUNCTIONS, Configuration, Control
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.questions.capability import capability
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import verify
from tests.support.campaigns import seeds
from tests.support.motions import Motions, able_at_once, all_motions, block, random_tree
from tests.support.subjects import read

RULEBOOK = load_rulebook(stages=("resolve", "verify", "can"))
CONTROLLER = "@module_start\n@module_name Pilot\n@ControlOut {}\nCommand go();\n@module_end"


def commanding(tree: str, functions: tuple[str, ...]) -> str:
    """Return a configuration in which a pilot commands functions of the camera."""
    text = tree.replace("@modules ", "@modules Pilot, ", 1)
    return f"{text}\nCam is_controlled_by Pilot\n{CONTROLLER.format(', '.join(functions))}"


def specifying(tree: str, fed: frozenset[str]) -> Configuration:
    """Return the specification in which an InheritanceNode feeds modules what a pilot commands."""
    _, modules, *lines = tree.split("\n")
    lines = [
        "@specification",
        f"{modules}, Pilot, InheritanceNode1",
        *(line for line in lines if " is_mounted_on " in line),
        "InheritanceNode1 is_controlled_by Pilot",
        *(f"{name} is_controlled_by InheritanceNode1" for name in sorted(fed)),
    ]
    return parse_text("\n".join(lines), "s.mars").configuration


def expected_target(motions: Motions, function: str) -> frozenset[str] | None:
    """Return the modules that carry out an inherited function, or None if it is not inherited."""
    if givers := motions.givers(function):
        return frozenset(givers[:1])
    return motions.supports(function)[0] if motions.emergent(function) else None


def differences(seed: int, seen: Counter[str]) -> Iterator[str]:
    """Yield each difference for a random mount tree; count the cases that it covers in `seen`."""
    tree, chooser = random_tree(seed), random.Random(f"commands {seed}")
    motions = all_motions(read(tree).configuration, seed)
    camera = motions["Cam"]
    functions = tuple(chooser.sample(MOTION_FUNCTIONS, chooser.choice((1, 1, 2, 2, 3))))
    emergent = [f for f in MOTION_FUNCTIONS if camera.emergent(f)]
    if emergent and chooser.random() < 0.7:
        functions = (chooser.choice(emergent), *functions[1:])
    functions = tuple(dict.fromkeys(functions))
    project = read(commanding(tree, functions))
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)

    # Emergent functionality and who has a part in it.
    for name in ("Cam", "Eye"):
        if name in motions:
            for function in MOTION_FUNCTIONS:
                found = {
                    atom.arguments[4].string
                    for atom, _ in analysis.grounding.atoms("participant", 5)
                    if [str(a) for a in atom.arguments[:3]]
                    == ["emergent_functionality", f'"{name}"', f'"{function}"']
                } - {function}
                here = motions[name]
                wanted = here.supports(function)[0] if here.emergent(function) else frozenset()
                seen["emergent"] += bool(wanted)
                if found != wanted:
                    yield f"{function} of {name} emerges from {sorted(found)}, not {sorted(wanted)}"

    # Whom the InheritanceNode feeds, and what verification accepts.
    targets = [t for f in functions if (t := expected_target(camera, f)) is not None]
    fed = frozenset[str]().union(*targets)
    synthesis = synthesise(project, analysis, RULEBOOK)
    if synthesis is not None and fed:
        lines = synthesis.specification.configuration.relationships
        found = {
            line.controlled
            for line in lines
            if isinstance(line, Control) and line.controller.startswith("InheritanceNode")
        }
        if found != fed:
            yield f"the node feeds {sorted(found)}, not {sorted(fed)}, for {functions}"
        seen["node"] += 1
        yield from _verified(tree, camera, functions, fed, project, chooser, seen)
    yield from _able(tree, motions, chooser, seen)


def _verified(
    tree: str,
    camera: Motions,
    functions: tuple[str, ...],
    fed: frozenset[str],
    project: Project,
    chooser: random.Random,
    seen: Counter[str],
) -> Iterator[str]:
    movers = camera.movers
    choices = [
        camera.supports(f) if camera.emergent(f) else [t]
        for f in functions
        if (t := expected_target(camera, f)) is not None
    ]
    unions = {frozenset[str]().union(*some) for some in product(*choices)}
    near = [fed, *(fed ^ {name} for name in movers)]
    alike = [frozenset(some) for some in combinations(movers, len(fed))]
    others = chooser.sample(sorted(unions, key=sorted), min(4, len(unions)))
    chosen = [*near, *others, *chooser.sample(alike, min(2, len(alike)))]
    for given in dict.fromkeys(chosen):
        right = given == fed
        seen["accepted" if right else "refused"] += 1
        seen["another support"] += given in unions and not right
        if bool(verify(specifying(tree, given), project, RULEBOOK)) == right:
            yield f"verify {'refuses' if right else 'accepts'} {sorted(given)} for {functions}"


def _able(
    tree: str, motions: Mapping[str, Motions], chooser: random.Random, seen: Counter[str]
) -> Iterator[str]:
    project = read(tree)
    possible = [
        (name, function)
        for name, here in motions.items()
        for function in MOTION_FUNCTIONS
        if here.able(function, here.usable())
    ]
    name, function = chooser.choice(list(motions)), chooser.choice(MOTION_FUNCTIONS)
    answer = capability(project, RULEBOOK, f"{function} of {name}").able
    seen[f"single {answer}"] += 1
    if answer != ((name, function) in possible):
        yield f"can {function} of {name}: {answer}"
    for _ in range(3):
        if len(possible) > 1:
            (one, f), (two, g) = chooser.sample(possible, 2)
            answer = capability(project, RULEBOOK, f"{f} of {one} while {g} of {two}").able
            seen[f"pair {answer}"] += 1
            if answer != able_at_once(motions[one], motions[two], (f, g)):
                yield f"can {f} of {one} while {g} of {two}: {answer}"


#: Three hinges on a lift carry a camera.
ARM = "\n".join(
    [
        "@configuration\n@modules Lift, S1, S2, S3, Cam",
        "S1 is_mounted_on Lift",
        "S2 is_mounted_on S1 (_,_,300,0,0)",
        "S3 is_mounted_on S2 (_,_,200,0,0)",
        "Cam is_mounted_on S3 (_,_,100,0,0)",
        block("Lift", "Trans_Z"),
        *(block(name, "Rotn_Z") for name in ("S1", "S2", "S3")),
        block("Cam"),
    ]
)
#: A platform carries one camera turned by 45 degrees about z, and another straight.
PLATFORM = "\n".join(
    [
        "@configuration\n@modules Plat, Cam, Eye",
        "Cam is_mounted_on Plat (z,45,0,0,0)",
        "Eye is_mounted_on Plat",
        block("Plat", "Trans_X", "Trans_Y", "Trans_Z"),
        block("Cam"),
        block("Eye"),
    ]
)


def test_a_lift_below_an_arm_has_no_share_in_motions_of_the_hinges() -> None:
    project = read(commanding(ARM, ("Trans_X",)))
    hinges = frozenset({"S1", "S2", "S3"})
    camera = all_motions(project.configuration, 0)["Cam"]
    assert expected_target(camera, "Trans_X") == hinges
    assert verify(specifying(ARM, hinges), project, RULEBOOK) == ()
    clauses = {v.clause for v in verify(specifying(ARM, hinges | {"Lift"}), project, RULEBOOK)}
    assert clauses == {5}
    assert is_compatible(ARM, "Trans_X of Cam while Trans_Y of Cam while Trans_Z of Lift")
    assert not is_compatible(ARM, "Trans_X of Cam while Rotn_Z of S2")


def test_only_motions_with_a_share_are_busy() -> None:
    assert is_compatible(PLATFORM, "Trans_X of Cam while Trans_Z of Plat")
    assert is_compatible(PLATFORM, "Trans_X of Cam while Trans_Y of Cam")
    assert is_compatible(PLATFORM, "Trans_X of Cam while Trans_Z of Eye")
    assert not is_compatible(PLATFORM, "Trans_X of Cam while Trans_X of Plat")
    assert not is_compatible(PLATFORM, "Trans_X of Cam while Trans_Y of Eye")


def is_compatible(tree: str, query: str) -> bool:
    return capability(read(tree), RULEBOOK, query).able


@pytest.mark.parametrize("first", [3 * each for each in seeds(1, 5)])
def test_random_mount_trees(first: int) -> None:
    seen: Counter[str] = Counter()
    found = {seed: list(differences(seed, seen)) for seed in range(first, first + 3)}
    assert {seed: item for seed, item in found.items() if item} == {}
    assert seen["accepted"] and seen["refused"] and seen["pair True"], seen


def main() -> None:
    many, first = (int(word) for word in (*sys.argv[1:], "0")[:2])
    wrong, seen = 0, Counter[str]()
    for seed in range(first, first + many):
        entries = list(differences(seed, seen))
        wrong += bool(entries)
        for difference in entries:
            print(f"seed {seed}: {difference}", flush=True)
    print(f"{many} mount trees, {wrong} differ: {dict(seen)}")


if __name__ == "__main__":
    main()
