"""Which outputs an input may be meant for: by their names, as the plain way finds them."""

from difflib import SequenceMatcher
from random import Random

import pytest

from mars_asp.diagnostic import point
from mars_asp.reasoning.facts.loose_ends import MOST, Port, nearest

HERE = point("c.mars", 1, 1)
WORDS = ("left", "right", "image", "raw", "map", "in", "out", "7", "12")


def ports(random: Random, many: int, first: int) -> list[Port]:
    return [
        Port(
            first + number,
            0,
            HERE,
            f"M{random.randrange(many)}",
            "_".join(random.choices(WORDS, k=random.randint(1, 3))),
            random.choice("AB"),
        )
        for number in range(many)
    ]


def plainly(entry: Port, outputs: list[Port]) -> list[Port]:
    def likeness(output: Port) -> float:
        one, other = (set(port.port.split("_")) for port in (entry, output))
        letters = SequenceMatcher(None, entry.port, output.port, autojunk=False).ratio()
        return len(one & other) / len(one | other) + letters

    others = [o for o in outputs if o.module != entry.module]
    same = [o for o in others if o.representation == entry.representation]
    return sorted(same, key=lambda output: (-likeness(output), output))[:MOST]


@pytest.mark.parametrize("seed", range(20))
def test_of_few_outputs_the_nearest_are_found(seed: int) -> None:
    random = Random(seed)
    inputs, outputs = ports(random, 8, 0), ports(random, 12, 8)
    found: dict[Port, list[Port]] = {entry: [] for entry in inputs}
    for entry, output, rank in nearest(inputs, outputs):
        assert rank == len(found[entry])
        found[entry].append(output)
    assert found == {entry: plainly(entry, outputs) for entry in inputs}


@pytest.mark.parametrize("seed", range(5))
def test_of_many_each_input_gets_what_it_gets_alone(seed: int) -> None:
    random = Random(seed)
    inputs, outputs = ports(random, 40, 0), ports(random, 120, 40)
    alone = [found for entry in inputs for found in nearest([entry], outputs)]
    assert list(nearest(inputs, outputs)) == alone
