"""Measure the paper's case study over seeded worlds: `python benchmarks/case_study.py [WORLDS]`.

Prints a table and, with `--picture OUT.svg`, draws it.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape
from math import sqrt
from multiprocessing import Pool
from pathlib import Path
from statistics import mean, stdev

from mars_asp.execution.campaign.summary import Share
from mars_asp.execution.scenario.read import load_scenario
from mars_asp.execution.trial import stage_trial
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise

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
    analysis = analyse(facts, rulebook, configuration.span)
    found = synthesise(Project(configuration, {}, ()), analysis, rulebook)
    assert found is not None
    return found.specification.configuration


def one_world(task: tuple[Configuration, int]) -> Row:
    """Return collisions, least clearance, mm driven and seconds of turning while driving."""
    specification, seed = task
    scenario = load_scenario(EXAMPLES / "level1/scenario.toml")
    trial = stage_trial(specification, {}, replace(scenario, duration=SECONDS, seed=seed))
    trial.run_until(SECONDS)
    body = trial.bodies[0]
    return body.collisions, body.clearance, body.driven, body.both


@dataclass(frozen=True)
class Result:
    """One system over all worlds; shares in percent, ways in m, intervals of 95 %."""

    name: str
    rows: Sequence[Row]

    @property
    def struck(self) -> int:
        return sum(collisions > 0 for collisions, *_ in self.rows)

    @property
    def share(self) -> tuple[float, float, float]:
        """Return the share of worlds with a collision, between its bounds."""
        low, high = Share(self.struck, len(self.rows)).interval
        return 100 * low, 100 * self.struck / len(self.rows), 100 * high

    @property
    def driven(self) -> tuple[float, float, float]:
        """Return the mean way, between its bounds."""
        ways = [row[2] / 1000 for row in self.rows]
        half = 1.96 * stdev(ways) / sqrt(len(ways))
        return mean(ways) - half, mean(ways), mean(ways) + half

    def line(self) -> str:
        """Return one line of the table."""
        low, _, high = self.share
        least, way, _ = self.driven
        return (
            f"| {self.name} | {self.struck} of {len(self.rows)} ({low:.1f}-{high:.1f} %) "
            f"| {mean(min(row[1], 3000.0) for row in self.rows):.0f} "
            f"| {way:.2f} ± {way - least:.2f} | {mean(row[3] for row in self.rows):.2f} |"
        )


def picture(results: Sequence[Result]) -> str:
    """Return an SVG: two columns of points with their intervals, one row for each system."""
    height = 24 * len(results) + 70
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="880" height="{height}" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
        *(
            f'<text x="10" y="{24 * k + 48}">{escape(result.name)}</text>'
            for k, result in enumerate(results)
        ),
        *_column(280, "worlds with a collision, %", 60, [r.share for r in results]),
        *_column(600, "driven in 30 s, m", 5, [r.driven for r in results]),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _column(
    left: int, title: str, most: int, intervals: Sequence[tuple[float, float, float]]
) -> Iterator[str]:
    """Yield an axis from 0 to `most`, and a point with a bar for each interval."""
    scale, bottom = 250 / most, 24 * len(intervals) + 36
    yield f'<text x="{left}" y="18" font-weight="bold">{title}</text>'
    for tick in range(0, most + 1, max(1, most // 6)):
        x = left + tick * scale
        yield f'<path d="M{x:.1f} 28V{bottom}" stroke="#ddd"/>'
        yield f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle">{tick}</text>'
    for k, (low, middle, high) in enumerate(intervals):
        y, from_, at, to = 24 * k + 44, *(left + value * scale for value in (low, middle, high))
        yield f'<path d="M{from_:.1f} {y}H{to:.1f}" stroke="#0072b2" stroke-width="3"/>'
        yield f'<circle cx="{at:.1f}" cy="{y}" r="4" fill="#d55e00"/>'


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("worlds", nargs="?", type=int, default=200)
    parser.add_argument("--picture", type=Path, metavar="OUT.svg")
    arguments = parser.parse_args()
    print("| system | worlds with a collision (95 %) | clearance, mm | driven, m | s both |")
    print("|---|---|---|---|---|")
    results = []
    with Pool(2) as pool:
        for name, text in variants().items():
            specification = specified(text)
            tasks = [(specification, seed) for seed in range(arguments.worlds)]
            results.append(Result(name, pool.map(one_world, tasks, 10)))
            print(results[-1].line(), flush=True)
    if arguments.picture:
        arguments.picture.write_text(picture(results), encoding="utf-8")


if __name__ == "__main__":
    main()
