"""Growth of `analyse` and `synthesise` with independent components, against clingo alone.

    python benchmarks/growth.py [MODULES ...]

Prints seconds, the growth per step and the ratio to clingo alone on the same facts and rules, all
measured in one run.
"""

import random
import sys
import time
from collections.abc import Iterator

import clingo

from mars_asp.analysis import analyse
from mars_asp.facts import configuration_facts, facts_text
from mars_asp.language import parse_text
from mars_asp.model import Configuration
from mars_asp.resolve import NODES, synthesise
from mars_asp.rulebook import load_rulebook

PER_ROBOT = 10


def robots(modules: int, seed: int = 1) -> Configuration:
    """Return independent robots of ten modules each, unequal among themselves."""
    return parse_text(
        "\n".join(robot_lines(modules, random.Random(seed))), "robots.mars"
    ).configuration


def robot_lines(modules: int, rng: random.Random) -> Iterator[str]:
    names, lines, blocks = [], [], []
    for robot in range(modules // PER_ROBOT):
        own = [f"M{robot}_{index}" for index in range(PER_ROBOT)]
        names += own
        blocks.append(_block(own[0], "@Sense NotifyAtFrequency 25", "Raw grab()"))
        for client in own[1:5]:
            accepted = rng.choice(["Raw", "Lines", "Map"])
            blocks.append(_block(client, "@ControlOut", f"Motion act({accepted} x)"))
            service = rng.choice(["", "", " NotifyAtFrequency 10", " RequestWhenReady"])
            lines.append(f"{client} uses_data_from {own[0]}{service}")
        for wheel in own[5:7]:
            for rank, controller in enumerate(rng.sample(own[1:5], rng.choice([1, 2, 3]))):
                lines.append(f"{wheel} is_controlled_by {controller} {rank}")
    blocks.append(_block("Hough", "@Converts 2", "Edges f(Raw x)"))
    blocks.append(_block("Joining", "@Converts", "Lines f(Edges x)"))
    blocks.append(_block("Mapping", "@Converts", "Map f(Edges x)"))
    yield "@configuration hierarchical"
    yield "@modules " + ", ".join(names)
    yield from lines
    yield from blocks


def _block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end"


def measure(modules: int) -> tuple[float, float, float, int]:
    """Return seconds of clingo alone, of an analysis and of a synthesis, and the nodes found."""
    configuration = robots(modules)
    rulebook = load_rulebook()
    facts = configuration_facts(configuration)
    started = time.perf_counter()
    control = clingo.Control(["--warn=none"])
    control.add("base", [], rulebook.text("base") + facts_text(facts))
    control.ground()
    control.solve()
    alone = time.perf_counter() - started
    started = time.perf_counter()
    analysis = analyse(configuration_facts(configuration), rulebook, configuration.span)
    analysed = time.perf_counter() - started
    started = time.perf_counter()
    found = synthesise(configuration, {}, analysis, rulebook)
    assert found is not None
    assert found.resolution.proven
    return alone, analysed, time.perf_counter() - started, found.cost(NODES)


def main() -> None:
    sizes = [int(word) for word in sys.argv[1:]] or [100, 1000, 10000]
    previous: tuple[float, ...] | None = None
    print("modules  clingo alone   analyse (ratio)   synthesise  growth of both  nodes")
    for size in sizes:
        alone, analysed, synthesised, nodes = measure(size)
        total = analysed + synthesised
        growth = "" if previous is None else f"{total / sum(previous):.1f}"
        print(
            f"{size:7}  {alone:10.2f} s  {analysed:7.2f} s ({analysed / alone:.1f})"
            f"  {synthesised:9.2f} s  {growth:>14}  {nodes}"
        )
        previous = (analysed, synthesised)


if __name__ == "__main__":
    main()
