"""Clients that no mode of their source serves together, judged a second time from the language.

The service table of the language is written again in Python. Each set of clients of a source is
tried with each mode of the source, the smallest sets first.
"""

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations

import pytest

from mars_asp.language.parse import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.verification import verify

CONDITIONS = ("NotifyOnMax", "NotifyOnMax(80)", "NotifyOnMin(3)", "NotifyOnChange")
RATES = ("5", "12.5", "20", "58.8235")
READY, REQUEST, PERIODIC = "NotifyWhenReady", "RequestWhenReady", "NotifyAtFrequency"


def serves(offer: str, need: str) -> bool:
    """Whether a mode of a source serves a need, directly or by a splitter."""
    if need == offer:
        return True
    (offered, *rate), (needed, *wanted) = offer.split(), need.split()
    if needed == PERIODIC and not wanted:
        return offered == PERIODIC
    if offered == PERIODIC and needed == PERIODIC:
        return Fraction(wanted[0]) <= Fraction(rate[0])
    if needed in (PERIODIC, REQUEST):
        return True
    if needed == READY:
        return offered == PERIODIC
    return offered in (READY, PERIODIC)


def least_conflict(offers: Sequence[str], needs: Sequence[str]) -> tuple[int, ...]:
    """Return the first smallest set of needs, each served, that no mode serves; () if none."""
    served = [n for n, need in enumerate(needs) if any(serves(o, need) for o in offers)]
    for size in range(2, len(served) + 1):
        for chosen in combinations(served, size):
            if not any(all(serves(offer, needs[n]) for n in chosen) for offer in offers):
                return chosen
    return ()


def sources(rng: random.Random, count: int) -> Iterator[tuple[list[str], list[str]]]:
    """Yield the offers of sources and the needs of their clients."""
    for _ in range(count):
        modes = rng.sample([READY, REQUEST, PERIODIC, *CONDITIONS], rng.randint(1, 4))
        offers = [f"{m} {rng.choice(RATES)}" if m == PERIODIC else m for m in modes]
        needs = [
            rng.choice([READY, REQUEST, PERIODIC, *(f"{PERIODIC} {r}" for r in RATES), *CONDITIONS])
            for _ in range(rng.randint(1, 5))
        ]
        needs += rng.sample(offers, rng.randint(0, len(offers)))
        yield offers, needs


def text(robots: Sequence[tuple[Sequence[str], Sequence[str]]]) -> str:
    """Return a configuration of sources S0, S1, ... and their clients S0C0, S0C1, ..."""
    names, lines, blocks = [], [], []
    for number, (offers, needs) in enumerate(robots):
        names.append(f"S{number}")
        for client, need in enumerate(needs):
            names.append(f"S{number}C{client}")
            lines.append(f"S{number}C{client} uses_data_from S{number} {need}")
        sense = f"@Sense {', '.join(offers)}\nImg f();"
        blocks.append(f"@module_start\n@module_name S{number}\n{sense}\n@module_end")
    return "\n".join(["@configuration", f"@modules {', '.join(names)}", *lines, *blocks, ""])


def project(robots: Sequence[tuple[Sequence[str], Sequence[str]]]) -> Project:
    parsed = parse_text(text(robots), "robot.mars")
    assert parsed.configuration is not None
    return Project(parsed.configuration, {}, ())


def test_joint_infeasibility_is_a_least_set_of_clients_and_the_rest_is_infeasible_alone() -> None:
    robots = list(sources(random.Random(36), 400))
    made = project(robots)
    analysis = analyse(project_facts(made), load_rulebook(), made.configuration.span)
    joint: dict[str, tuple[str, ...]] = {}
    alone: set[str] = set()
    for found in analysis.consequences:
        if found.kind == "joint_infeasibility":
            assert found.subject not in joint
            joint[found.subject] = tuple(found.participants)
            assert len(found.spans) == len(found.participants) + 1
        if found.kind == "service_infeasible":
            alone.add(found.subject)
    sizes = set()
    expected: dict[str, tuple[str, ...]] = {}
    for number, (offers, needs) in enumerate(robots):
        conflict = least_conflict(offers, needs)
        sizes.add(len(conflict))
        if conflict:
            expected[f"S{number}"] = tuple(f"S{number}C{n}" for n in conflict)
    assert sizes == {0, 2, 3}
    assert joint == expected
    assert alone == {
        f"S{number}C{n}"
        for number, (offers, needs) in enumerate(robots)
        for n, need in enumerate(needs)
        if not any(serves(offer, need) for offer in offers)
    }


JOINT = [
    (["NotifyWhenReady", "NotifyAtFrequency 10"], [PERIODIC, f"{PERIODIC} 20", f"{PERIODIC} 30"]),
    (
        ["NotifyOnMax", "NotifyOnMin(3)", f"{PERIODIC} 5"],
        ["NotifyOnMin(3)", f"{PERIODIC} 6", "NotifyOnMax"],
    ),
]


@pytest.mark.parametrize("robot", JOINT, ids=["pair", "three"])
def test_jointly_infeasible_lines_have_no_specification(robot: tuple[list[str], list[str]]) -> None:
    offers, needs = robot
    made = project([robot])
    reasoner = Reasoner(made, load_rulebook())
    assert reasoner.synthesis is None
    verifying = load_rulebook(stages=("verify",))
    for offer in offers:
        lines = [f"S0C{n} uses_data_from DataSplitter1 {need}" for n, need in enumerate(needs)]
        body = text([robot]).replace("@configuration", "@specification").split("\n")
        kept = [line for line in body if " uses_data_from " not in line]
        kept[1] += ", DataSplitter1"
        kept[2:2] = [f"DataSplitter1 uses_data_from S0 {offer}", *lines]
        specification = parse_text("\n".join(kept), "specification.mars").configuration
        assert specification is not None
        violations = verify(specification, made, verifying)
        assert {violation.clause for violation in violations} == {3}
