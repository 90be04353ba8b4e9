"""The winner at each module is the one by declared priorities, for any introduced nodes.

`python -m tests.reasoning.synthesis.test_exhaustive HOW_MANY FIRST_SEED run` tries as many
as wanted.
"""

import math
import random
from collections.abc import Mapping

import pytest

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import Configuration, Module
from tests.support.campaigns import seeds
from tests.support.execute_builders import Inbox, ms
from tests.support.in_force import Commands, Reading, Script
from tests.support.random_configurations import random_control
from tests.support.subjects import read, synthesised

END = 700
FUNCTION = "Trans_Z"


def scripts(seed: int, configuration: Configuration) -> tuple[dict[str, Script], dict[str, int]]:
    """Return the messages of controllers and their periods; with priorities one at a time."""
    rng = random.Random(seed)
    apart = configuration.architecture == "hierarchical"
    sent: dict[str, Script] = {}
    periods: dict[str, int] = {}
    drivers = sorted(m.name for m in configuration.declared if m.name.startswith("D"))
    for index, driver in enumerate(drivers):
        periods[driver] = rng.choice([10, 20, 40])
        late = index + 1 if apart else rng.choice([0, 0, 3])
        often = rng.choice([0.1, 0.3, 0.8])
        times = [t for t in range(late, END, periods[driver]) if rng.random() < often]
        quiet = rng.randrange(END)
        sent[driver] = {t: 1000 * (index + 1) + t for t in times if not quiet < t < quiet + 250}
    return sent, periods


def executed(
    specification: Configuration,
    modules: Mapping[str, Module],
    sent: dict[str, Script],
    periods: dict[str, int],
) -> dict[str, Commands]:
    """Run a specification; return the commands of each effector, in ms."""
    boxes = {name: Inbox() for name in modules if name not in sent}
    behaviours = {name: Behaviour(box) for name, box in boxes.items()}
    for name, script in sent.items():
        behaviours[name] = scripted(script, periods[name])
    executor = Executor(specification, modules, behaviours, command_timeout=ms(10**6))
    for box in boxes.values():
        box.executor = executor
    executor.step_until(ms(END))
    return {
        name: changes([(time, command.get(FUNCTION)) for time, command in box.got])
        for name, box in boxes.items()
    }


def changes(commands: Commands) -> Commands:
    """Omit repeated commands: the same message may arrive on two paths."""
    return [each for k, each in enumerate(commands) if k == 0 or each[1] != commands[k - 1][1]]


def alike(one: tuple[float, float | None], other: tuple[float, float | None]) -> bool:
    """Whether two timed commands are equal; a mean depends on the order of its sum."""
    (when, what), (then, that) = one, other
    if what is None or that is None:
        return one == other
    return when == then and math.isclose(what, that, rel_tol=1e-12)


def scripted(script: Script, period: int) -> Behaviour:
    """Return a controller that sends the values of a script at its times."""
    late = min(script, default=0) % period
    times = iter(range(late, 10**9, period))

    def send() -> tuple[str, float] | None:
        value = script.get(next(times))
        return None if value is None else (FUNCTION, value)

    return Behaviour(send, ms(period), ms(late))


def compare_run(seed: int) -> str | None:
    """Return the first difference between a run and the declared priorities, or None."""
    text = random_control(seed)
    project = read(text)
    found = synthesised(project)
    if found is None:
        return "nothing realises it"
    sent, periods = scripts(seed, project.configuration)
    reading = Reading(project.configuration, sent, periods)
    modules = {module.name: module for module in project.configuration.declared}
    # Read from its text, which has to state the modules of InheritanceNodes.
    text = print_configuration(found.specification.configuration)
    result = executed(parse_text(text, "s.mars").configuration, modules, sent, periods)
    for name, got in result.items():
        wanted = changes(reading.commands_until(name, END)) if name in reading.heard else []
        if got != wanted:
            where = 0
            while where < min(len(got), len(wanted)) and alike(got[where], wanted[where]):
                where += 1
            if where == len(got) == len(wanted):
                continue
            return f"{name}: told {got[where : where + 2]}, not {wanted[where : where + 2]}"
    return None


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_winners_at_each_module_follow_from_declared_priorities(seed: int) -> None:
    assert compare_run(seed) is None
