"""How fast a run is, as ratios measured in one run: `python benchmarks/run.py`.

Times are processor time of the one thread, so that what else a machine does matters less.
"""

import heapq
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

from mars_asp.execution.executor import Behaviour, Executor, modules
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.scenario.read import load_scenario
from mars_asp.execution.trial import stage_trial
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise

LEVEL0 = Path("examples/level0")


def specified(text: str) -> Configuration:
    """Return the specification of a configuration."""
    configuration = parse_text(text, "case.mars").configuration
    rulebook = load_rulebook()
    facts = configuration_facts(configuration, {})
    analysis = analyse(facts, rulebook, configuration.span)
    found = synthesise(Project(configuration, {}, ()), analysis, rulebook)
    assert found is not None
    return found.specification.configuration


def best_of_three(action: Callable[[], object]) -> float:
    times = []
    for _ in range(3):
        started = time.process_time()
        action()
        times.append(time.process_time() - started)
    return min(times)


def level0(specification: Configuration, obstacles: int) -> float:
    """Return simulated seconds per second; the density of obstacles is the same for all."""
    scenario = load_scenario(LEVEL0 / "scenario.toml")
    within = 1000.0 * (obstacles / 2) ** 0.5
    scatter = {"count": obstacles, "radius": [100, 300], "within": within, "free": 600}
    crowded = replace(scenario, world={"scatter": scatter})
    trials = [stage_trial(specification, {}, crowded) for _ in range(3)]
    return 60.0 / best_of_three(lambda: trials.pop().run_until(60.0))


def copying(specification: Configuration) -> float:
    """Return how many times as fast a run of level 0 is whose messages are not copied."""

    def shared() -> float:
        with patch.object(modules, "copied", lambda value: value):
            return level0(specification, 20)

    pairs = [(shared(), level0(specification, 20)) for _ in range(5)]
    return max(s for s, _ in pairs) / max(c for _, c in pairs)


def activations() -> float:
    """Return activations a second of 50 sensors at 50 Hz, each with one algorithm."""
    names = [(f"S{k}", f"D{k}") for k in range(50)]
    lines = [f"{client} uses_data_from {source}" for source, client in names]
    modules = ", ".join(name for pair in names for name in pair)
    text = "\n".join(["@specification", f"@modules {modules}", *lines])
    configuration = parse_text(text, "bench.mars").configuration
    behaviours = {s: Behaviour(lambda: 0, 20 * MILLISECOND) for s, _ in names}
    behaviours |= {d: Behaviour(lambda x: None) for _, d in names}
    executors = [Executor(configuration, {}, behaviours) for _ in range(3)]
    events: list[int] = []

    def run() -> None:
        executor = executors.pop()
        executor.step_until(20 * SECOND)
        events.append(executor.schedule.events)

    seconds = best_of_three(run)
    return events[0] / seconds


def floor() -> float:
    """Return calls a second of 100 functions at 50 Hz by a heap and a queue, and nothing else."""
    actions: list[Callable[[], object]] = [lambda: 0] * 100

    def run() -> None:
        timers, queue = [0], deque[Callable[[], object]]()
        for tick in range(1, 1001):
            heapq.heappop(timers)
            queue.extend(actions)
            heapq.heappush(timers, tick * 20 * MILLISECOND)
            take = queue.popleft
            while queue:
                take()()

    return 100 * 1000 / best_of_three(run)


def peer() -> None:
    try:
        from ir_sim import compare  # noqa: PLC0415
    except ImportError:
        print("IR-SIM: not installed; pip install -e '.[benchmarks]'")
        return
    for count in (20, 200, 2000):
        they, we = compare(count)
        print(f"{count:,} obstacles, a step: IR-SIM {they:.2f} ms, ours {we:.3f}: {they / we:.0f}")


def main() -> None:
    specification = specified((LEVEL0 / "config.mars").read_text())
    few, many = level0(specification, 200), level0(specification, 2000)
    print(f"level 0, 24 beams at 10 Hz, 200 obstacles: {few:.0f} times real time (goal: 300)")
    print(f"the same with 2,000 obstacles: {many / few:.2f} of that (goal: 0.5)")
    shared = copying(specification)
    print(
        f"20 obstacles, with messages that are shared instead of copied: {shared:.2f} times as fast"
    )
    done, bare = activations() / 1e6, floor() / 1e6
    print(f"100 modules at 50 Hz: {done:.2f} M activations a second (goal: 1)")
    print(f"bare calls by a heap and a queue: {bare:.2f} M a second ({bare / done:.1f} times)")
    peer()


if __name__ == "__main__":
    main()
