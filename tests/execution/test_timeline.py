"""Runs with gates, locks, limits and strategies give what a simulation from the text gives.

    python -m tests.execution.test_timeline HOW_MANY [FIRST_SEED]

tries as many random robots as wanted.
"""

import math
import random
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pytest

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import Module
from tests.support.campaigns import seeds
from tests.support.execute_builders import ms
from tests.support.subjects import read, synthesised
from tests.support.timeline import Got, Scripts, Timeline

END = 900
FUNCTIONS = ("Rotn_Y", "Trans_Z")


def random_robot(seed: int) -> str:
    """Return a configuration with described modules: sources S, tellers B of truths, clients C,
    controllers D and effectors W.
    """
    rng = random.Random(f"timeline {seed}")
    sources = [f"S{n}" for n in range(4)]
    truths = ["B0", "B1"]
    drivers = [f"D{n}" for n in range(3)]
    lines: dict[str, None] = {}
    clients = [f"C{n}" for n in range(rng.randint(1, 4))]
    for client in clients:
        lines[f"{client}.i uses_data_from {rng.choice(sources)}"] = None
    strategies: dict[str, str] = {}
    steered: dict[str, set[str]] = {}
    for wheel in ("W0", "W1")[: rng.randint(1, 2)]:
        strategies[wheel] = rng.choice(["hierarchical"] * 3 + ["latest", "flat", "weighted"])
        for driver in rng.sample(drivers, rng.randint(1, 3)):
            hold = rng.choice([50, 120, 300])
            lines[f"{wheel} is_controlled_by {driver} {rng.randint(0, 3)} hold {hold}"] = None
            steered.setdefault(driver, set()).add(wheel)
        if strategies[wheel] != "hierarchical":
            period = " period 50" if strategies[wheel] in ("flat", "weighted") else ""
            lines[f"{wheel} is_arbitrated_by {strategies[wheel]}{period}"] = None
        if rng.random() < 0.5:
            below, silence = rng.choice(["", " 1", " 2"]), rng.choice(["", " hold 200"])
            lines[f"{wheel} is_locked_by {rng.choice(truths)}{below}{silence}"] = None
        if rng.random() < 0.3:
            lines[f"{wheel} is_limited_by L{rng.choice(['', ' hold 250'])}"] = None
    fed = {line.split()[2] for line in lines if "uses_data_from" in line}
    for _ in range(rng.randint(1, 4)):
        add_gate(rng, sources, truths, steered, fed, strategies, lines)
    kinds: dict[str, Sequence[str]] = {
        "@Sense NotifyWhenReady\nNum say();": sources,
        "@Sense NotifyWhenReady\nbool say();": truths,
        f"@ControlOut {', '.join(FUNCTIONS)}\nCommand act();": [*drivers, "L"],
        "".join(f"@{name}\n" for name in FUNCTIONS) + "void move();": ("W0", "W1"),
        "@DataIn\nvoid take(Num i);": clients,
    }
    used = {name.partition(".")[0] for line in lines for name in line.split()}
    named = {name: text for text, names in kinds.items() for name in names if name in used}
    blocks = [
        f"@module_start\n@module_name {name}\n{text}\n@module_end" for name, text in named.items()
    ]
    head = ["@configuration hierarchical", f"@modules {', '.join(named)}"]
    return "\n".join([*head, *lines, *blocks, ""])


def add_gate(
    rng: random.Random,
    sources: Sequence[str],
    truths: Sequence[str],
    steered: Mapping[str, set[str]],
    fed: set[str],
    strategies: Mapping[str, str],
    lines: dict[str, None],
) -> None:
    """Add a gate line; its trigger comes after what it gates by name, so there is no circle."""
    word = rng.choice(["is_suppressed_by", "is_inhibited_by"])
    time = rng.choice([20, 70, 150])
    if rng.random() < 0.4 and len(steered) > 1:
        gated, *others = sorted(rng.sample(sorted(steered), 2))
        means = any(strategies[wheel] in ("flat", "weighted") for wheel in steered[gated])
        if word == "is_inhibited_by":
            others = [*truths, *others]
        if not (means and word == "is_inhibited_by"):
            lines.setdefault(f"{gated} {word} {rng.choice(others)} {time}")
        return
    gated = rng.choice(sorted(fed))
    later = [source for source in sources if source > gated]
    if word == "is_inhibited_by":
        later = [*later, *truths, *sorted(steered)]
    entries = [line.split()[0] for line in lines if line.endswith(f"uses_data_from {gated}")]
    if word == "is_suppressed_by" and rng.random() < 0.4:
        gated = rng.choice(entries)
    if later:
        trigger = rng.choice(later)
        if not any(line.startswith(f"{gated} {word} {trigger} ") for line in lines):
            lines[f"{gated} {word} {trigger} {time}"] = None


def random_scripts(seed: int, modules: Mapping[str, Module]) -> Scripts:
    """Return the messages of modules; of controllers never two in one instant."""
    rng = random.Random(f"scripts {seed}")
    scripts: dict[str, dict[int, Any]] = {}
    value = 0
    for name in sorted(modules):
        if name[0] in "CW":
            continue
        script = scripts[name] = {}
        late = {"D0": 1, "D1": 2, "D2": 3, "L": 4}.get(name)
        often = rng.choice([0.05, 0.2, 0.6])
        for tick in range(0, END, 10):
            if rng.random() < often:
                value += 1
                now = tick + (rng.choice([0, 1, 2]) if late is None else late)
                script[now] = {"B": rng.random() < 0.5, "S": value}.get(
                    name[0], random_command(rng, value)
                )
    return scripts


def random_command(rng: random.Random, value: int) -> dict[str, float]:
    """Return a command with one function or both."""
    named = rng.sample(FUNCTIONS, rng.randint(1, len(FUNCTIONS)))
    return {name: float(rng.choice([0, value, -value])) for name in named}


def scripted(script: Mapping[int, Any]) -> Behaviour:
    times = iter(range(10**9))

    return Behaviour(lambda: script.get(next(times)), ms(1))


def last_of_each_instant(got: Got) -> Got:
    return list(dict(got).items())


def finished_run(seed: int) -> Executor:
    """Return a run of a random robot that a specification realises."""
    project = read(random_robot(seed))
    found = synthesised(project)
    assert found is not None
    modules = {module.name: module for module in project.configuration.declared}
    scripts = random_scripts(seed, modules)
    behaviours = {name: Behaviour(lambda value: None) for name in modules}
    behaviours |= {name: scripted(script) for name, script in scripts.items()}
    text = print_configuration(found.specification.configuration)
    specification = parse_text(text, "s.mars").configuration
    executor = Executor(specification, modules, behaviours, command_timeout=ms(10**6))
    executor.step_until(ms(END))
    return executor


def compare(seed: int) -> str | None:
    """Return the first difference between a run and the text, or None."""
    project = read(random_robot(seed))
    found = synthesised(project)
    if found is None:
        return "nothing realises it"
    modules = {module.name: module for module in project.configuration.declared}
    scripts = random_scripts(seed, modules)
    timeline = Timeline(project.configuration, scripts)
    timeline.run(END)
    given: dict[str, Got] = {name: [] for name in modules if name not in scripts}

    def observe(now: int, kind: str, where: str, value: Any) -> None:
        client = where.rpartition(" -> ")[2]
        if kind in ("data", "control") and client in given:
            given[client].append((now // ms(1), value))

    behaviours = {name: Behaviour(lambda value: None) for name in given}
    behaviours |= {name: scripted(script) for name, script in scripts.items()}
    text = print_configuration(found.specification.configuration)
    specification = parse_text(text, "s.mars").configuration
    executor = Executor(
        specification, modules, behaviours, command_timeout=ms(10**6), observe=observe
    )
    executor.step_until(ms(END))
    for name, messages in given.items():
        if name in timeline.arbiters:
            got = last_of_each_instant(messages)
            wanted = last_of_each_instant(timeline.arbiters[name].got)
        else:
            got, wanted = messages, timeline.clients.get(name, [])
        for number, (one, other) in enumerate(zip([*got, None], [*wanted, None], strict=False)):
            if not alike(one, other):
                before = got[max(0, number - 2) : number]
                return f"{name}: {one}, not {other}, after {before}"
    return None


def alike(one: tuple[int, Any] | None, other: tuple[int, Any] | None) -> bool:
    """Whether two timed values are equal; a mean depends on the order of its sum."""
    if one is None or other is None or not isinstance(one[1], dict):
        return one == other
    (when, rates), (then, others) = one, other
    close: Callable[[Any, Any], bool] = lambda a, b: math.isclose(a, b, rel_tol=1e-9)  # noqa: E731
    return when == then and (
        rates.keys() == others.keys() and all(close(rates[f], others[f]) for f in rates)
    )


@pytest.mark.parametrize("seed", seeds(8, 100))
def test_a_run_equals_the_interpreted_text(seed: int) -> None:
    assert compare(seed) is None


def main(words: Sequence[str]) -> int:
    many, first = (int(word) for word in (*words, "0")[:2])
    wrong = 0
    for seed in range(first, first + many):
        if difference := compare(seed):
            wrong += 1
            print(f"seed {seed}: {difference}", flush=True)
    print(f"{many} robots from seed {first}, {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
