"""Ports mean what modules apart would: one for each output and one for each input that is named.

Both texts are written from the same draft, neither from the other, so nothing here depends on the
facts that describe ports to the rules.
"""

from dataclasses import replace
from random import Random
from typing import NamedTuple

import pytest

from mars_asp.model.declarations import Data
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import seeds

TYPES = ("Image", "Depth", "Map")
RATES = ("NotifyWhenReady", "NotifyAtFrequency 50", "NotifyAtFrequency every 30 ms")
WANTED = ("", " NotifyAtFrequency 20", " NotifyAtFrequency every 70 ms")


class Line(NamedTuple):
    client: int
    entry: int
    source: int
    output: int
    wanted: str


class Robot(NamedTuple):
    """Sources with the types and modes of their outputs, clients with the types of their inputs."""

    sources: list[list[tuple[str, str]]]
    clients: list[list[str]]
    lines: list[Line]


def robot(seed: int) -> Robot:
    random = Random(seed)
    sources = [
        [(random.choice(TYPES), random.choice(RATES)) for _ in range(random.randint(2, 3))]
        for _ in range(random.randint(1, 2))
    ]
    clients = [
        [random.choice(TYPES) for _ in range(random.randint(1, 3))]
        for _ in range(random.randint(1, 3))
    ]
    entries = [(c, e) for c, types in enumerate(clients) for e in range(len(types))]
    lines = []
    for client, entry in random.sample(entries, random.randint(1, len(entries))):
        source = random.randrange(len(sources))
        output = random.randrange(len(sources[source]))
        # Nothing slows a source down enough to be asked for more than it has.
        lines.append(Line(client, entry, source, output, random.choice(WANTED)))
    return Robot(sources, clients, lines)


CONVERTERS = (
    "@module_start\n@module_name Warp\n@Converts 2\nDepth warp(Image);\n@module_end\n"
    "@module_start\n@module_name Fold\n@Converts 3\nMap fold(Depth);\n@module_end\n"
)


def block(name: str, functions: list[str]) -> str:
    return f"@module_start\n@module_name {name}\n{''.join(functions)}@module_end\n"


def with_ports(drawn: Robot) -> str:
    names = [f"S{s}" for s in range(len(drawn.sources))] + [
        f"C{c}" for c in range(len(drawn.clients))
    ]
    lines = [f"C{c}.in{e} uses_data_from S{s}.out{o}{w}" for c, e, s, o, w in drawn.lines]
    blocks = [
        block(f"S{s}", [f"@Sense {mode}\n{t} out{o}();\n" for o, (t, mode) in enumerate(outputs)])
        for s, outputs in enumerate(drawn.sources)
    ]
    blocks += [
        block(
            f"C{c}",
            [f"@DataIn\nvoid take({', '.join(f'{t} in{e}' for e, t in enumerate(types))});\n"],
        )
        for c, types in enumerate(drawn.clients)
    ]
    return "\n".join(
        ["@configuration", f"@modules {', '.join(names)}", *lines, CONVERTERS, *blocks]
    )


def apart(drawn: Robot) -> str:
    outputs = {(s, o): each for s, own in enumerate(drawn.sources) for o, each in enumerate(own)}
    entries = {(c, e): kind for c, own in enumerate(drawn.clients) for e, kind in enumerate(own)}
    names = [f"S{s}_{o}" for s, o in outputs] + [f"C{c}_{e}" for c, e in entries]
    lines = [f"C{c}_{e} uses_data_from S{s}_{o}{w}" for c, e, s, o, w in drawn.lines]
    blocks = [
        block(f"S{s}_{o}", [f"@Sense {mode}\n{kind} get();\n"])
        for (s, o), (kind, mode) in outputs.items()
    ]
    blocks += [
        block(f"C{c}_{e}", [f"@DataIn\nvoid take({kind} in);\n"])
        for (c, e), kind in entries.items()
    ]
    return "\n".join(
        ["@configuration", f"@modules {', '.join(names)}", *lines, CONVERTERS, *blocks]
    )


@pytest.mark.parametrize("seed", seeds(4, 16))
def test_ports_cost_as_much_as_separate_modules(seed: int) -> None:
    rulebook = load_rulebook(stages=("resolve", "verify"))
    entries: list[tuple[object, ...] | None] = []
    for text in (with_ports(robot(seed)), apart(robot(seed))):
        reasoner = Reasoner(load_project("robot.mars", text=text), rulebook)
        synthesis = reasoner.synthesis
        if synthesis is None:
            entries.append(None)
            continue
        specification = synthesis.specification
        assert reasoner.verify(specification.configuration) == ()
        kinds = sorted(node.kind for node in specification.nodes)
        entries.append((synthesis.resolution.cost, synthesis.resolution.count, kinds))
    assert entries[0] == entries[1]


@pytest.mark.parametrize("seed", seeds(2, 6))
def test_a_port_of_a_specification_is_not_taken_for_another(seed: int) -> None:
    drawn = robot(seed)
    rulebook = load_rulebook(stages=("resolve", "verify"))
    reasoner = Reasoner(load_project("robot.mars", text=with_ports(drawn)), rulebook)
    assert reasoner.synthesis is not None
    configuration = reasoner.synthesis.specification.configuration
    swapped = 0
    for at, line in enumerate(configuration.relationships):
        assert isinstance(line, Data)
        # A line without an input may mean the same input, so only its output is changed.
        others = [replace(line, source_port=None)]
        for port in (f"out{o}" for o in range(3) if line.source_port not in (None, f"out{o}")):
            others.append(replace(line, source_port=port))
        for port in (f"in{e}" for e in range(3) if line.client_port not in (None, f"in{e}")):
            others.append(replace(line, client_port=port))
        for other in others:
            if other != line:
                lines = list(configuration.relationships)
                lines[at] = other
                edited = replace(configuration, relationships=tuple(lines))
                assert reasoner.verify(edited) != (), other
                swapped += 1
    assert swapped > 0
