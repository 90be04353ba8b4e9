"""Law: a node of a pack is on each way that its rule names, and on no other.

The pack `ports` of `tests/node_kinds` places a node of each of the six shapes by tags. Its rules,
read by hand, are compared with the lines of the specification, read as text.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from random import Random
from typing import NamedTuple

import pytest

from mars_asp.language import print_configuration
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.verification import judge_specification
from tests.support.campaigns import seeds
from tests.support.documents import ROOT

PACK = ROOT / "tests" / "node_kinds" / "packs" / "ports"
DATA = re.compile(r"^(\S+) uses_data_from (\S+)$", re.MULTILINE)
KIND = re.compile(r"(Gauge|Probe|Tee|Blend|Mesh|Recorder|DataSplitter)\d+$")


class Robot(NamedTuple):
    """Sources by client and input, where a client without named inputs has several, and tags."""

    lines: Sequence[tuple[str, str]]
    tags: Mapping[str, Sequence[str]]

    @property
    def text(self) -> str:
        """A configuration of modules that nothing describes."""
        ends = [end.partition(".")[0] for line in self.lines for end in line]
        return "\n".join(
            [
                "@configuration",
                f"@modules {', '.join(dict.fromkeys(ends))}",
                *(f"{taker} uses_data_from {giver}" for taker, giver in self.lines),
                *(f"{module} @Tag {tag}" for module in self.tags for tag in self.tags[module]),
                "",
            ]
        )


def random_robot(seed: int) -> Robot:
    random = Random(seed)
    outputs = [f"S{n}.o{k}" for n in range(random.randint(1, 3)) for k in range(2)]
    lines: list[tuple[str, str]] = []
    tags: dict[str, Sequence[str]] = {}
    for client in (f"C{n}" for n in range(random.randint(1, 4))):
        joined = [tag for tag in ("blended", "meshed") if random.random() < 0.2][:1]
        given = random.sample(outputs, random.randint(1, min(3, len(outputs))))
        takers = [client] * len(given) if joined else [f"{client}.i{k}" for k in range(len(given))]
        lines += zip(takers, given, strict=True)
        tags[client] = joined or [tag for tag in ("gauged", "probed") if random.random() < 0.5]
    for source in {giver.partition(".")[0] for _, giver in lines}:
        tags[source] = [tag for tag in ("teed", "recorded") if random.random() < 0.5]
    random.shuffle(lines)
    return Robot(lines, {module: tags[module] for module in sorted(tags)})


@cache
def synthesised(seed: int) -> tuple[Robot, str, Sequence[str]]:
    """Return a robot, its specification, and the violations of that."""
    robot = random_robot(seed)
    rulebook = load_rulebook((PACK,), stages=("resolve", "verify", "cost"))
    reasoner = Reasoner(load_project("config.mars", text=robot.text), rulebook)
    assert reasoner.synthesis is not None
    found = reasoner.synthesis.specification.configuration
    verified = judge_specification(found, reasoner.project, reasoner.rulebook)
    text = re.sub(r"//.*\n", "", print_configuration(found))
    return robot, text, [each.message for each in verified.violations]


def kind(end: str) -> str | None:
    found = KIND.match(end)
    return found and found[1]


def ways(end: str, feeds: Mapping[str, Sequence[str]]) -> list[tuple[str, tuple[str, ...]]]:
    """Return each output from which data come to an end of a line, with the nodes on the way."""
    return [
        (output, (*before, *((giver,) if kind(giver) else ())))
        for giver in feeds.get(end, ())
        for output, before in (ways(giver, feeds) if kind(giver) else [(giver, ())])
    ]


@pytest.mark.parametrize("seed", seeds(3, 200))
def test_nodes_of_a_pack_are_where_its_rules_place_them(seed: int) -> None:
    robot, text, refused = synthesised(seed)
    assert refused == []
    feeds: dict[str, list[str]] = {}
    for taker, giver in DATA.findall(text):
        feeds.setdefault(taker, []).append(giver)
    nodes = [taker for taker in feeds if kind(taker)]

    def tagged(end: str, tag: str) -> bool:
        return tag in robot.tags.get(end.partition(".")[0], ())

    # Each output reaches the inputs that the configuration names, through the nodes of both ends.
    for taker in {taker for taker, _ in robot.lines}:
        expected = {giver for end, giver in robot.lines if end == taker}
        found = ways(taker, feeds)
        assert sorted(output for output, _ in found) == sorted(expected), (taker, robot.text, text)
        for output, through in found:
            between = [name for node in through if (name := kind(node)) != "DataSplitter"]
            assert between == [
                *(["Tee"] if tagged(output, "teed") else []),
                *(["Gauge"] if tagged(taker, "gauged") else []),
                *(["Blend"] if tagged(taker, "blended") else []),
                *(["Mesh"] if tagged(taker, "meshed") else []),
            ], (robot.text, text)
        assert len(feeds[taker]) == 1 or kind(feeds[taker][0]) != "Blend", text

    # What only listens takes a copy of what comes to the input, or of all that the module delivers.
    heard = [
        sorted(output for output, _ in ways(node, feeds)) for node in nodes if is_listener(node)
    ]
    used = sorted({giver for _, giver in robot.lines})
    modules = sorted({output.partition(".")[0] for output in used})
    copies = [[giver] for taker, giver in robot.lines if tagged(taker, "probed")]
    copies += [
        [output for output in used if output.startswith(f"{module}.")]
        for module in modules
        if tagged(module, "recorded")
    ]
    assert sorted(heard) == sorted(copies), (robot.text, text)
    given = Counter(giver for givers in feeds.values() for giver in givers)
    assert not [node for node in nodes if is_listener(node) and given[node]]

    # One node for each place, and a splitter only where an output has several takers and no tee.
    takers = Counter(output for listed in copies for output in listed)
    takers.update(giver for _, giver in robot.lines)
    assert Counter(kind(node) for node in nodes if not is_listener(node)) == +Counter[str | None](
        Tee=sum(tagged(output, "teed") for output in used),
        Gauge=sum(tagged(taker, "gauged") for taker, _ in robot.lines),
        Blend=len({taker for taker, _ in robot.lines if tagged(taker, "blended")}),
        Mesh=len({taker for taker, _ in robot.lines if tagged(taker, "meshed")}),
        DataSplitter=sum(takers[output] > 1 and not tagged(output, "teed") for output in used),
    ), (robot.text, text)
    several = ("Tee", "Mesh", "DataSplitter")
    assert not [end for end, n in given.items() if n > 1 and kind(end) not in several], text


def is_listener(node: str) -> bool:
    return kind(node) in ("Probe", "Recorder")
