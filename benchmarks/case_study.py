"""Measure the paper's case study over seeded worlds: `python benchmarks/case_study.py [WORLDS]`."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from math import sqrt
from multiprocessing import Pool
from pathlib import Path
from statistics import mean, stdev

from mars_asp.analysis import analyse
from mars_asp.facts import configuration_facts
from mars_asp.language import parse_text
from mars_asp.model import Configuration
from mars_asp.resolve import synthesise
from mars_asp.rulebook import load_rulebook
from mars_asp.scenario import load_scenario
from mars_asp.trial import stage_trial, with_seed

EXAMPLES = Path("examples")
LEVEL0 = ("Forward", "Turn", "Collide")
SECONDS = 30.0
Row = tuple[int, float, float, float]


def variants() -> dict[str, str]:
    """Return the texts of all systems that are compared, by name."""
    level0 = (EXAMPLES / "level0/config.mars").read_text()
    level1 = (EXAMPLES / "level1/config.mars").read_text()
    cascade = (EXAMPLES / "level1/cascade.mars").read_text()
    swapped = cascade.replace("Wander 0", "Wander 1").replace(
        "Node2 is_controlled_by ArbitrationNode 1", "Node2 is_controlled_by ArbitrationNode 0"
    )
    ranked = {f"one arbiter, Wander at rank {k} of 0-3": _ranked(level1, k) for k in range(4)}
    return {
        "level 0, hierarchical": level0,
        "level 0, flat": level0.replace("hierarchical", "flat"),
        **ranked,
        "level 1, flat": level1.replace("hierarchical", "flat"),
        "cascade, Wander below level 0": cascade,
        "cascade, Wander above level 0": swapped,
        "Avoid and Collide": (EXAMPLES / "level1/avoid.mars").read_text(),
    }


def _ranked(text: str, rank: int) -> str:
    order = [*LEVEL0[:rank], "Wander", *LEVEL0[rank:]]
    lines = [line for line in text.splitlines() if "MobilePlatform is_controlled_by" not in line]
    lines += [f"MobilePlatform is_controlled_by {name} {k}" for k, name in enumerate(order)]
    return "\n".join(lines)


def specified(text: str) -> Configuration:
    """Return a text's specification, synthesised where it is a configuration."""
    configuration = parse_text(text, "case.mars").configuration
    if configuration.kind == "specification":
        return configuration
    rulebook = load_rulebook()
    facts = configuration_facts(configuration, {})
    found = synthesise(configuration, {}, analyse(facts, rulebook, configuration.span), rulebook)
    assert found is not None
    return found.specification.configuration


def one_world(task: tuple[Configuration, int]) -> Row:
    """Return collisions, least clearance, mm driven and seconds of turning while driving."""
    specification, seed = task
    scenario = load_scenario(EXAMPLES / "level1/scenario.toml")
    trial = stage_trial(specification, {}, with_seed(replace(scenario, duration=SECONDS), seed))
    trial.run_until(SECONDS)
    body = trial.body
    return body.collisions, body.clearance, body.driven, body.both


def wilson(hits: int, n: int) -> tuple[float, float]:
    """Return the 95 % score interval of a share (Wilson 1927)."""
    z, p = 1.96, hits / n
    centre, scale = (p + z * z / (2 * n)), 1 + z * z / n
    half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return max(0.0, (centre - half) / scale), min(1.0, (centre + half) / scale)


def row(name: str, rows: Sequence[Row]) -> str:
    """Return one line of the table."""
    n = len(rows)
    struck = sum(collisions > 0 for collisions, *_ in rows)
    low, high = wilson(struck, n)
    driven = [r[2] / 1000 for r in rows]
    half = 1.96 * stdev(driven) / sqrt(n)
    return (
        f"| {name} | {struck} of {n} ({100 * low:.1f}-{100 * high:.1f} %) "
        f"| {mean(min(r[1], 3000.0) for r in rows):.0f} "
        f"| {mean(driven):.2f} ± {half:.2f} | {mean(r[3] for r in rows):.2f} |"
    )


def main() -> None:
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    print("| system | worlds with a collision (95 %) | clearance, mm | driven, m | s both |")
    print("|---|---|---|---|---|")
    with Pool(2) as pool:
        for name, text in variants().items():
            specification = specified(text)
            tasks = [(specification, seed) for seed in range(worlds)]
            print(row(name, pool.map(one_world, tasks, 10)), flush=True)


if __name__ == "__main__":
    main()
