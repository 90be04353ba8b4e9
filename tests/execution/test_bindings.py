"""Each parameter of a function is given the messages of the sources that its lines name.

The expectation is read from the text by `tests.support.readings`.
"""

import random
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import pytest

from mars_asp.behaviour.calls import prepared
from mars_asp.behaviour.context import Context
from mars_asp.diagnostic import MarsError
from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.parts import in_parts
from mars_asp.execution.scenario.functions import entries
from mars_asp.model.declarations import Data, Module
from mars_asp.reasoning.session import Reasoner
from tests.support.readings import delivered, inputs_of, reachable, readings
from tests.support.subjects import RULEBOOK, read

TYPES = ("Scan", "Odom", "Image")
#: A campaign tries more: `benchmarks/bindings.py`.
SEEDS = range(10)


@pytest.mark.parametrize("seed", SEEDS)
def test_parameters_are_given_the_messages_of_their_lines(seed: int) -> None:
    assert_bound_as_written(seed)


@pytest.mark.parametrize("seed", SEEDS[:2])
def test_lines_of_other_clients_change_no_input_and_no_message(seed: int) -> None:
    assert_order_of_clients_is_free(seed)


@dataclass(frozen=True)
class Robot:
    """A configuration in parts."""

    names: tuple[str, ...]
    lines: tuple[str, ...]
    blocks: tuple[str, ...]

    @property
    def text(self) -> str:
        heading = ("@configuration", f"@modules {', '.join(self.names)}")
        return "\n".join((*heading, *self.lines, "", *self.blocks))


def random_robot(seed: int) -> Robot:
    """Return clients of two or three inputs, some of one type, and a logger of each source."""
    rng = random.Random(seed)
    sources = {f"S{n}": rng.choice((*TYPES, *TYPES, "Raw", None)) for n in range(rng.randint(2, 5))}
    clients = {f"C{n}": rng.choices(TYPES, k=rng.randint(2, 3)) for n in range(rng.randint(1, 3))}
    lines = []
    for client, types in clients.items():
        for number in range(rng.randint(1, len(types))):
            port = f".p{number}" if rng.random() < 0.25 else ""
            lines.append(f"{client}{port} uses_data_from {rng.choice(list(sources))}")
    lines += [f"Log{name} uses_data_from {name}" for name in sources]
    rng.shuffle(lines)
    blocks = [
        block(name, "@Sense NotifyWhenReady", f"{kind} sense();")
        for name, kind in sources.items()
        if kind is not None
    ]
    for name, types in clients.items():
        inputs = ", ".join(f"{kind} p{n}" for n, kind in enumerate(types))
        blocks.append(block(name, "@DataIn", f"void take({inputs});"))
    for kind in rng.sample(TYPES, rng.randint(0, 2)):
        blocks.append(block(f"To{kind}", f"@Converts {rng.randint(1, 2)}", f"{kind} to(Raw x);"))
    names = (*sources, *clients, *(f"Log{name}" for name in sources))
    return Robot(names, tuple(lines), tuple(blocks))


def block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration}\n@module_end"


def assert_bound_as_written(seed: int) -> None:
    """Compare a run with the text of its configuration; of an open one, the errors."""
    text = random_robot(seed).text
    project = read(text)
    known = {module.name: module for module in project.configuration.declared}
    meant = readings(project.configuration, known)
    lines = [line for line in project.configuration.relationships if isinstance(line, Data)]
    still_open = [line for line in lines if meant.get(id(line)) == ()]
    found = Reasoner(project, RULEBOOK).analysis.consequences
    # Data that nothing converts is `no_conversion`, whichever input it is for.
    reported = {line.client for line in still_open if not is_unconverted(line, lines, known)}
    assert {c.subject for c in found if c.kind == "ambiguous_input"} == reported, text
    if still_open:
        return
    given = given_in_a_run(text)
    assert given is not None
    for client, each in known.items():
        own = [line for line in lines if line.client == client]
        for name in inputs_of(each) if own else ():
            sure = {line.source for line in own if meant[id(line)] == (name,)}
            possible = {line.source for line in own if name in meant[id(line)]}
            assert sure <= given[client][name] <= possible, (client, name, text)


def is_unconverted(line: Data, lines: list[Data], known: Mapping[str, Module]) -> bool:
    """Whether no input of a client accepts the known data of a line, directly or converted."""
    start = delivered(line, known)
    named = {each.client_port for each in lines if each.client == line.client}
    entries = inputs_of(known[line.client])
    types = set(entries.values())
    is_untyped = any(each is None and name not in named for name, each in entries.items())
    return start is not None and not is_untyped and not ({start, *reachable(start, known)} & types)


def assert_order_of_clients_is_free(seed: int) -> None:
    """Move the lines of clients after each other; the lines of each client keep their order."""
    robot = random_robot(seed)
    order = list(dict.fromkeys(client_of(line) for line in robot.lines))
    random.Random(seed).shuffle(order)
    lines = sorted(robot.lines, key=lambda line: order.index(client_of(line)))
    moved = replace(robot, lines=tuple(lines))
    messages = [
        sorted(each.message for each in Reasoner(read(text), RULEBOOK).analysis.consequences)
        for text in (robot.text, moved.text)
    ]
    assert messages[0] == messages[1], robot.text
    assert given_in_a_run(robot.text) == given_in_a_run(moved.text), robot.text


def client_of(line: str) -> str:
    return line.split(maxsplit=1)[0].partition(".")[0]


def given_in_a_run(text: str) -> Mapping[str, Mapping[str, set[str]]] | None:
    """Return the sources whose messages a run passes to each parameter, or None if one is open."""
    project = read(text)
    reasoner = Reasoner(project, RULEBOOK)
    if reasoner.analysis.has_errors:
        return None
    assert reasoner.synthesis is not None
    printed = reasoner.synthesis.specification.configuration
    known = {module.name: module for module in project.configuration.declared}
    specification, modules = in_parts(printed, known)
    given: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    nodes = (each.transformer for each in specification.conversions)
    behaviours = {name: Behaviour(lambda x: x) for name in (*nodes, *known)}
    for number, name in enumerate(each.text for each in specification.modules):
        if name.startswith("S"):
            # Each source is read at instants of its own.
            behaviours[name] = source_of(name, (7 + number) * MILLISECOND)
    plan = Plan(specification, modules, behaviours)
    for name, module in known.items():
        if name.startswith("C"):
            call = recorder(given[name], len(inputs_of(module)))
            context = Context(name, 0, {})
            inputs = entries(plan, name)
            behaviours[name] = Behaviour(prepared(call, context, lambda: 0.0, inputs))
    try:
        Executor(specification, modules, behaviours).step_until(300 * MILLISECOND)
    except MarsError:
        return None
    return given


def source_of(name: str, period: int) -> Behaviour:
    return Behaviour(lambda: name, period=period)


def recorder(given: dict[str, set[str]], count: int) -> Callable[..., None]:
    """Return a function with parameters p0, p1, ... that notes the messages of each."""

    def note(**values: str | None) -> None:
        for name, value in values.items():
            if value is not None:
                given[name].add(value)

    def two(p0: str | None = None, p1: str | None = None) -> None:
        note(p0=p0, p1=p1)

    def three(p2: str | None = None, p0: str | None = None, p1: str | None = None) -> None:
        note(p0=p0, p1=p1, p2=p2)

    return two if count == 2 else three
