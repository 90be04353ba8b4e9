"""A campaign with `--workers N` beside a plain pool of N processes, over the same runs.

    python benchmarks/workers.py [RUNS] [WORKERS] [PAIRS] [SECONDS]

The pool (`multiprocessing`) synthesises the specification once, then runs, judges and writes each
run as JSON, without a limit or a process for each run. Both take turns. Prints the medians of
processor and wall time, and the medians of the ratios of the pairs, campaign over pool.
"""

import argparse
import json
import multiprocessing
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from mars_asp.cli.perform import performed
from mars_asp.cli.run_json import run_json
from mars_asp.execution.judgement import run_rulebook
from mars_asp.execution.scenario.read import load_scenario
from mars_asp.language import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise

HERE = Path(__file__).parent.parent
LEVEL0 = HERE / "examples" / "level0"
FILES = (str(LEVEL0 / "config.mars"), "--scenario", str(LEVEL0 / "scenario.toml"))


def pool(runs: int, workers: int, seconds: float, out: str) -> None:
    """Carry out the runs by a plain pool, and write a line for each."""
    text = (LEVEL0 / "config.mars").read_text()
    configuration = parse_text(text, "config.mars").configuration
    rulebook = load_rulebook()
    analysis = analyse(configuration_facts(configuration, {}), rulebook, configuration.span)
    found = synthesise(Project(configuration, {}, ()), analysis, rulebook)
    assert found is not None
    specification = found.specification.configuration
    scenario = replace(load_scenario(LEVEL0 / "scenario.toml"), duration=seconds)
    judging = run_rulebook()

    def work(seed: int) -> dict[str, object]:
        done = performed(specification, {}, replace(scenario, seed=seed), rulebook=judging)
        return run_json(*done)

    _inherited.append(work)

    with multiprocessing.get_context("fork").Pool(workers) as processes, Path(out).open("w") as to:
        for result in processes.imap_unordered(_work, range(1, runs + 1)):
            to.write(json.dumps(result) + "\n")


#: The function that the processes of the pool inherit.
_inherited: list[Callable[[int], dict[str, object]]] = []


def _work(seed: int) -> dict[str, object]:
    return _inherited[0](seed)


def taken(words: Sequence[str]) -> tuple[float, float]:
    """Return the processor and wall time that a command takes with all its processes."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([sys.executable, *words], check=False, capture_output=True)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - start
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main() -> None:
    """Measure as the command line says."""
    parser = argparse.ArgumentParser()
    for name, default in (("runs", 100), ("workers", 2), ("pairs", 5), ("seconds", 20)):
        parser.add_argument(name, type=int, nargs="?", default=default)
    parser.add_argument("--pool", metavar="OUT")
    given = parser.parse_args()
    if given.pool:
        pool(given.runs, given.workers, given.seconds, given.pool)
        return
    numbers = [str(each) for each in (given.runs, given.workers, given.pairs, given.seconds)]
    both: list[tuple[tuple[float, float], tuple[float, float]]] = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(given.pairs):
            campaign = ["-m", "mars_asp", "campaign", *FILES, "--seeds", f"1-{given.runs}"]
            campaign += ["--vary", f"duration={given.seconds}", "--workers", str(given.workers)]
            campaign += ["-o", f"{folder}/o.jsonl", "--fresh"]
            both.append(
                (taken(campaign), taken([__file__, *numbers, "--pool", f"{folder}/p.jsonl"]))
            )
    for kind, name in enumerate(("processor", "wall")):
        ours, plain = ([each[side][kind] for each in both] for side in (0, 1))
        ratio = statistics.median(a / b for a, b in zip(ours, plain, strict=True))
        print(
            f"{name:9} campaign {statistics.median(ours):.2f} s, "
            f"pool {statistics.median(plain):.2f} s, ratio {ratio:.2f}"
        )


if __name__ == "__main__":
    main()
