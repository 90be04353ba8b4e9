"""A campaign with `--workers N` beside plain pools of N processes, over the same runs.

    python benchmarks/workers.py [RUNS] [WORKERS] [PAIRS] [SECONDS]

A pool (`multiprocessing`) synthesises the specification once, then runs, judges and writes each
run as JSON, without limits. The `pool` carries out all runs in the same processes, the
`pool of children` each run in a process of its own, as the campaign does. All take turns. Prints
the medians of processor and wall time, and the medians of the ratios, campaign over pool.
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

from mars_asp.cli.run_json import run_json
from mars_asp.cli.trials import run_trial
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


def pool(runs: int, workers: int, seconds: float, out: str, most: int | None) -> None:
    """Write a line for each run; a process of the pool carries out at most so many."""
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
        done = run_trial(specification, {}, replace(scenario, seed=seed), rulebook=judging)
        return run_json(*done)

    _inherited.append(work)

    fork = multiprocessing.get_context("fork")
    with fork.Pool(workers, maxtasksperchild=most) as processes, Path(out).open("w") as to:
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
    parser.add_argument("--children", action="store_true")
    given = parser.parse_args()
    if given.pool:
        most = 1 if given.children else None
        pool(given.runs, given.workers, given.seconds, given.pool, most)
        return
    numbers = [str(each) for each in (given.runs, given.workers, given.pairs, given.seconds)]
    times: dict[str, list[tuple[float, float]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        campaign = ["-m", "mars_asp", "campaign", *FILES, "--seeds", f"1-{given.runs}"]
        campaign += ["--vary", f"duration={given.seconds}", "--workers", str(given.workers)]
        campaign += ["-o", f"{folder}/o.jsonl", "--fresh"]
        plain = [__file__, *numbers, "--pool", f"{folder}/p.jsonl"]
        commands = {"campaign": campaign, "pool": plain}
        commands["pool of children"] = [*plain, "--children"]
        for _ in range(given.pairs):
            for name, words in commands.items():
                times.setdefault(name, []).append(taken(words))
    for name, measured in times.items():
        for kind, time_of in enumerate(("processor", "wall")):
            median = statistics.median(each[kind] for each in measured)
            both = zip(times["campaign"], measured, strict=True)
            ratio = statistics.median(a[kind] / b[kind] for a, b in both)
            print(f"{name:16} {time_of:9} {median:6.2f} s, campaign / this {ratio:.2f}")


if __name__ == "__main__":
    main()
