"""The outputs that an input may be meant for: compared one by one, as `near/5` is documented."""

from collections import Counter
from random import Random

import pytest

from mars_asp.diagnostic import point
from mars_asp.reasoning.facts.loose_ends import MOST, PortEnd, nearest

HERE = point("c.mars", 1, 1)
WORDS = ("left", "right", "image", "raw", "map", "in", "out", "7", "12")
SPACES = ("", "", "a/", "b/", "a/c/", "b/c/", "/a/")


def ports(random: Random, many: int, first: int) -> list[PortEnd]:
    return [
        PortEnd(
            first + number,
            0,
            HERE,
            f"{random.choice(SPACES)}M{random.randrange(many)}",
            "_".join(random.choices(WORDS, k=random.randint(1, 3))),
            random.choice("AB"),
        )
        for number in range(many)
    ]


def features(name: str) -> Counter[str]:
    words = name.split("_")
    pairs = [f"^{word}$"[at : at + 2] for word in words for at in range(len(word) + 1)]
    return Counter([*(f"{word} " for word in words * 4), *"".join(words), *pairs])


def one_by_one(entry: PortEnd, outputs: list[PortEnd], free: list[PortEnd]) -> list[PortEnd]:
    def is_of_another_part(output: PortEnd) -> bool:
        """Whether the part of the input has such an output as well."""
        own, other = entry.module.split("/"), output.module.split("/")
        shared = next(
            (n for n, two in enumerate(zip(own, other, strict=False)) if two[0] != two[1]), None
        )
        if shared is None or shared >= min(len(own), len(other)) - 1:
            return False
        twin = "/".join([*own[: shared + 1], *other[shared + 1 :]])
        names = {(o.module, o.port, o.representation) for o in outputs}
        return (twin, output.port, output.representation) in names

    def apart(output: PortEnd) -> int:
        own, other = entry.module.split("/")[:-1], output.module.split("/")[:-1]
        while own and other and own[0] == other[0]:
            own, other = own[1:], other[1:]
        return len(own) + len(other)

    def likeness(output: PortEnd) -> float:
        one, other = features(entry.port), features(output.port)
        return 2 * (one & other).total() / (one.total() + other.total()) - 0.25 * apart(output)

    same = [
        o
        for o in free
        if o.module != entry.module
        and o.representation == entry.representation
        and not is_of_another_part(o)
    ]
    return sorted(same, key=lambda o: (-likeness(o), o.module, o.port, o.annotation))[:MOST]


@pytest.mark.parametrize("seed", range(10))
def test_the_nearest_of_all_free_outputs_are_found(seed: int) -> None:
    random = Random(seed)
    inputs, outputs = ports(random, 20, 0), ports(random, random.choice([8, 200]), 20)
    free = [output for output in outputs if random.random() < 0.7]
    found: dict[PortEnd, list[PortEnd]] = {entry: [] for entry in inputs}
    for entry, output, rank in nearest(inputs, outputs, frozenset(free)):
        assert rank == len(found[entry])
        found[entry].append(output)
    assert found == {entry: one_by_one(entry, outputs, free) for entry in inputs}


def test_common_words_count_more_than_letters_of_others() -> None:
    """`bias` and `compass` have `as` and `s` at the end in common, which brings them no nearer."""
    entry = PortEnd(0, 0, HERE, "M", "imu/data_compass", "A")
    outputs = [
        PortEnd(n, 0, HERE, "N", name, "A") for n, name in ((1, "imu/data/bias"), (2, "imu/data"))
    ]
    found = [output.port for _, output, _ in nearest([entry], outputs, frozenset(outputs))]
    assert found == ["imu/data", "imu/data/bias"]
