"""Growth of frames, their facts and the physical rules with modules and depth.

    python benchmarks/frames.py

A chain of mounts with one camera at its end, and a robot with many mounted cameras. Prints seconds
of the numbers and of clingo, and how much more a step of twice the size takes (2 is linear).
"""

import time

import clingo

from mars_asp.facts import configuration_facts, facts_text
from mars_asp.model import Configuration, Function, Module, Mount, Name, Service, Transformation
from mars_asp.physical import frame_facts
from mars_asp.rulebook import load_rulebook
from mars_asp.source import point

HERE = point("benchmark.mars", 1, 1)
FUNCTIONS = ("Rotn_Y", "Trans_Z", "Rotn_X")
CAMERA = (Service("Sense", HERE),)


def robot(mounts: list[tuple[str, str]]) -> Configuration:
    """Return a robot whose leaves are cameras and whose other modules have one function each."""
    names = list(dict.fromkeys(name for pair in mounts for name in pair))
    carriers = {mounted for _, mounted in mounts}
    modules = (
        Module(name, HERE, functions=(Function(FUNCTIONS[number % 3], HERE),))
        if name in carriers
        else Module(name, HERE, CAMERA)
        for number, name in enumerate(names)
    )
    return Configuration(
        "benchmark.mars",
        HERE,
        modules=tuple(Name(name, HERE) for name in names),
        relationships=tuple(Mount(a, b, HERE, transformation=Transformation()) for a, b in mounts),
        declared=tuple(modules),
    )


def chain(depth: int) -> Configuration:
    """Return one camera over `depth` mounts."""
    return robot([(f"M{n}", f"M{n + 1}") for n in range(depth)])


def tree(modules: int, arm: int = 4) -> Configuration:
    """Return arms of `arm` mounts on one platform, each with a camera at its end."""
    mounts = []
    for number in range(modules // arm):
        links = [f"A{number}_{n}" for n in range(arm)]
        mounts += list(zip(links, [*links[1:], "Platform"], strict=True))
    return robot(mounts)


def measure(configuration: Configuration, rules: str) -> tuple[float, float]:
    """Return seconds of the facts and of grounding the rules over them."""
    start = time.perf_counter()
    facts = frame_facts(configuration, {})
    middle = time.perf_counter()
    control = clingo.Control(["--warn=none"])
    control.add("base", [], rules + facts_text((*configuration_facts(configuration), *facts)))
    control.ground()
    return middle - start, time.perf_counter() - middle


def main() -> None:
    """Measure both shapes at growing sizes."""
    rules = load_rulebook().text("base")
    for name, shape, sizes in (
        ("chain", chain, (250, 500, 1000, 2000)),
        ("robot", tree, (250, 500, 1000, 2000)),
    ):
        before = 0.0
        for size in sizes:
            numbers, clingo_seconds = measure(shape(size), rules)
            total = numbers + clingo_seconds
            growth = f"x{total / before:.2f}" if before else ""
            print(
                f"{name} {size:5d}  frames {numbers:.3f} s  rules {clingo_seconds:.3f} s  {growth}"
            )
            before = total


if __name__ == "__main__":
    main()
