"""Specifications proven minimal have the cost that an exhaustive search finds.

    python -m tests.reasoning.synthesis.test_exhaustive HOW_MANY [FIRST_SEED [PART ...]]

does the same for as many random configurations of each part as wanted: `wiring`, `ports` (several
outputs, named inputs), `inputs` (of several representations), `mounts`, `carried` (through right
angles), `cascades`, `twins`, `run` (the winner at each module when a specification runs), `verify`
(a judge written from the text accepts and refuses the same: specifications and random mutants).
"""

import sys
import time
from collections.abc import Callable, Sequence

import pytest

from mars_asp.model.declarations import Configuration, Control, node_kind
from mars_asp.reasoning.rules import CONVERSION, NODES, RELATIONSHIPS
from mars_asp.reasoning.synthesis.synthesise import Synthesis
from mars_asp.reasoning.verification import verify
from tests.execution.executor.test_priorities import compare_run
from tests.reasoning.test_realises import compare_judged
from tests.support.campaigns import seeds
from tests.support.exhaustive import Cost, add, inheritance, minimal
from tests.support.motions import UnclearError
from tests.support.random_configurations import (
    random_carried,
    random_cascades,
    random_configuration,
    random_inputs,
    random_mounts,
    random_ports,
    random_twins,
)
from tests.support.subjects import RULEBOOK, read, synthesised


def cost_of(found: Synthesis) -> Cost:
    return (found.cost(NODES), found.cost(CONVERSION), found.cost(RELATIONSHIPS))


def compare(text: str) -> str | None:
    """Return the difference for a configuration, or None."""
    project = read(text)
    expected = minimal(project.configuration, {})
    found = synthesised(project)
    if found is None or expected is None:
        agree = found is None and expected is None
        return None if agree else f"{found and found.resolution}; exhaustive search {expected}"
    if (cost_of(found), found.resolution.count) != expected:
        message = f"{cost_of(found)}, {found.resolution.count} optima"
        return f"{message}; exhaustive search {expected}"
    specification = found.specification.configuration
    if (fed := feeding(specification)) != (wanted := to_be_fed(project.configuration)):
        return f"InheritanceNodes {fed}; from the text {wanted}"
    violations = verify(specification, project, RULEBOOK)
    return violations[0].message if violations else None


def feeding(specification: Configuration) -> list[tuple[list[str], list[str]]]:
    """Return the inputs and the outputs of each InheritanceNode of a specification."""
    lines = [line for line in specification.relationships if isinstance(line, Control)]
    names = {line.controlled for line in lines} | {line.controller for line in lines}

    def ends(name: str, *, heard: bool) -> set[str]:
        found: set[str] = set()
        for line in lines:
            here, there = line.controller, line.controlled
            if heard:
                here, there = there, here
            if here == name:
                through = node_kind(there) is not None
                found |= ends(there, heard=heard) if through else {there}
        return found

    return sorted(
        (sorted(ends(name, heard=True)), sorted(ends(name, heard=False)))
        for name in names
        if node_kind(name) == "inheritance_node"
    )


def to_be_fed(configuration: Configuration) -> list[tuple[list[str], list[str]]]:
    """Return the same from the text of the reference."""
    nodes = inheritance(configuration, {module.name: module for module in configuration.declared})
    return sorted(
        (sorted(line.controller for line in node.lines), sorted(node.providers))
        for node in nodes.values()
    )


def compare_twins(seed: int) -> str | None:
    """Return a difference, or None; twins have to cost twice as much as one of them."""
    text = random_twins(seed)
    once, twice = (minimal(read(t).configuration, {}) for t in (one_of(text), text))
    if once is not None and twice != (add(once[0], once[0]), once[1] ** 2):
        return f"the exhaustive search says {once} once and {twice} twice"
    return compare(text)


def one_of(text: str) -> str:
    """Return a configuration without its twin."""
    blocks = text.split("@module_start\n")
    lines = [line for line in blocks[0].split("\n") if not line.startswith("Twin")]
    modules = [name for name in lines[1].split(", ") if not name.startswith("Twin")]
    kept = [block for block in blocks[1:] if "@module_name Twin" not in block]
    head = "\n".join([lines[0], ", ".join(modules), *lines[2:]])
    return "@module_start\n".join([head, *kept])


PARTS: dict[str, Callable[[int], str | None]] = {
    "wiring": lambda seed: compare(random_configuration(seed)),
    "ports": lambda seed: compare(random_ports(seed)),
    "inputs": lambda seed: compare(random_inputs(seed)),
    "mounts": lambda seed: compare(random_mounts(seed)),
    "carried": lambda seed: compare(random_carried(seed)),
    "cascades": lambda seed: compare(random_cascades(seed)),
    "twins": compare_twins,
    "run": compare_run,
    "verify": compare_judged,
}
#: The seeds of each part that costs something, and how many more a campaign tries.
TRIED = {
    "wiring": (5, 30),
    "ports": (2, 12),
    "inputs": (3, 40),
    "mounts": (2, 10),
    "carried": (3, 40),
    "cascades": (3, 40),
    "twins": (2, 12),
}


@pytest.mark.parametrize(
    ("part", "seed"), [(part, seed) for part, many in TRIED.items() for seed in seeds(*many)]
)
def test_the_cost_is_that_of_an_exhaustive_search(part: str, seed: int) -> None:
    assert PARTS[part](seed) is None


def main(words: Sequence[str]) -> int:
    many, first = (int(word) for word in (*words, "0")[:2])
    wrong = 0
    for part in words[2:] or PARTS:
        begun, differ, skipped = time.monotonic(), 0, 0
        for seed in range(first, first + many):
            try:
                difference = PARTS[part](seed)
            except UnclearError:
                skipped += 1
                continue
            if difference:
                differ += 1
                print(f"{part}, seed {seed}: {difference}", flush=True)
            if (seed - first) % 100 == 99:
                print(f"{part}: {seed - first + 1} of {many}, {differ} differ", flush=True)
        seconds = time.monotonic() - begun
        print(
            f"{part}: {many} from seed {first}, {skipped} skipped, {differ} differ, {seconds:.0f} s"
        )
        wrong += differ
    print(f"{wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
