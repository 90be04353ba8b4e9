"""Growth of the analysis of mounts with modules and depth.

    python benchmarks/frames.py

Three shapes: a chain with one camera at its end, arms of four mounts on one platform with a camera
at each end, and a chain with a camera on every link. A step is one mount below one camera: modules
times depth. Prints processor seconds of the facts and of the whole analysis, and the seconds for a
step as a ratio to those at the smallest size: at most 1 is growth no faster than the steps.
"""

import time
from collections.abc import Sequence

from mars_asp.diagnostic import point
from mars_asp.model.declarations import (
    Configuration,
    Function,
    Module,
    Mount,
    Name,
    Service,
    Transformation,
)
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import load_rulebook

HERE = point("benchmark.mars", 1, 1)
FUNCTIONS = ("Rotn_Y", "Trans_Z", "Rotn_X")
CAMERA = (Service("Sense", HERE),)
REPEATS = 3


def robot(mounts: Sequence[tuple[str, str]]) -> Configuration:
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


def chain(mounts: int) -> tuple[Configuration, int]:
    """Return one camera over so many mounts, and the steps below it."""
    return robot([(f"M{n}", f"M{n + 1}") for n in range(mounts)]), mounts


def arms(modules: int, arm: int = 4) -> tuple[Configuration, int]:
    """Return arms of `arm` mounts on one platform, each with a camera at its end."""
    mounts = []
    for number in range(modules // arm):
        links = [f"A{number}_{n}" for n in range(arm)]
        mounts += list(zip(links, [*links[1:], "Platform"], strict=True))
    return robot(mounts), modules


def cameras(links: int) -> tuple[Configuration, int]:
    """Return a chain with a camera on every link: depth grows with the modules."""
    mounts = [(f"M{n}", f"M{n + 1}") for n in range(links)]
    mounts += [(f"Camera{n}", f"M{n}") for n in range(1, links + 1)]
    return robot(mounts), links * (links + 1) // 2


def measure(configuration: Configuration) -> tuple[float, float]:
    """Return the least processor seconds of the facts, and of these and the analysis."""
    rulebook = load_rulebook()
    project = Project(configuration, {}, ())
    found = []
    for _ in range(REPEATS):
        start = time.process_time()
        facts = project_facts(project)
        middle = time.process_time()
        analyse(facts, rulebook, configuration.span)
        found.append((time.process_time() - start, middle - start))
    total, facts_alone = min(found)
    return facts_alone, total


def main() -> None:
    """Measure each shape at growing sizes."""
    print(
        f"{'shape':8} {'modules':>8} {'steps':>8} {'facts':>8} {'analysis':>9} {'for a step':>11}"
    )
    for shape, sizes in (
        (chain, (250, 500, 1000, 2000)),
        (arms, (250, 500, 1000, 2000)),
        (cameras, (30, 60, 120, 240)),
    ):
        first = 0.0
        for size in sizes:
            configuration, steps = shape(size)
            facts, total = measure(configuration)
            first = first or total / steps
            print(
                f"{shape.__name__:8} {len(configuration.modules):8} {steps:8}"
                f" {facts:6.2f} s {total:7.2f} s {total / steps / first:11.2f}"
            )


if __name__ == "__main__":
    main()
