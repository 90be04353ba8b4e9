"""Small builders of specifications, modules and behaviours for the executor's tests."""

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

from mars_asp.diagnostic import point
from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration, Function, Mode, Module, Service
from mars_asp.model.modes import parse_mode

HERE = point("test", 1, 1)


def specification(text: str, kind: str = "specification hierarchical") -> Configuration:
    """Read relationships; the modules are those they name."""
    lines = [line.strip() for line in text.strip().splitlines()]
    names = dict.fromkeys(word for line in lines for word in (line.split()[0], line.split()[2]))
    body = "\n".join([f"@{kind}", "@modules " + ", ".join(names), *lines])
    return parse_text(body, "test.mars").configuration


def mode(text: str) -> Mode:
    found = parse_mode(text)
    assert isinstance(found, Mode)
    return found


def sensor(name: str, modes: str = "NotifyWhenReady", hz: float | None = None) -> Module:
    return _with_service(name, "Sense", modes, hz)


def data_out(name: str, modes: str = "NotifyWhenReady", hz: float | None = None) -> Module:
    return _with_service(name, "DataOut", modes, hz)


def control_out(name: str, *commands: str) -> Module:
    return Module(name, HERE, (Service("ControlOut", HERE, commands=commands),))


def sink(name: str) -> Module:
    return Module(name, HERE, (Service("DataIn", HERE),))


def effector(name: str, *functions: str) -> Module:
    return Module(name, HERE, functions=tuple(Function(f, HERE) for f in functions))


def _with_service(name: str, kind: Any, modes: str, hz: float | None) -> Module:
    found = tuple(mode(text) for text in modes.split(" | "))
    rate = None if hz is None else Fraction(str(hz))
    return Module(name, HERE, (Service(kind, HERE, modes=found, hz=rate),))


def counter() -> Callable[[], int]:
    """Return a reading that counts 0, 1, 2, ..."""
    numbers = iter(range(10**9))
    return lambda: next(numbers)


def replay(values: Iterable[Any]) -> Callable[[], Any]:
    left = iter(values)
    return lambda: next(left)


class Inbox:
    """A sink, a converter or an effector that keeps each received value with its time (ms)."""

    def __init__(self) -> None:
        self.executor: Executor | None = None
        self.got: list[tuple[float, Any]] = []

    def __call__(self, value: Any) -> None:
        assert self.executor is not None
        self.got.append((self.executor.schedule.now / MILLISECOND, value))

    @property
    def values(self) -> list[Any]:
        return [value for _, value in self.got]


def executed(
    text: str,
    modules: Iterable[Module],
    behaviours: dict[str, Any],
    seconds: float,
    kind: str = "specification hierarchical",
    **options: Any,
) -> Executor:
    """Run for some seconds; callables become behaviours, inboxes learn the time."""
    bound = {
        name: b if isinstance(b, Behaviour) else Behaviour(b) for name, b in behaviours.items()
    }
    executor = Executor(specification(text, kind), {m.name: m for m in modules}, bound, **options)
    for behaviour in bound.values():
        if isinstance(behaviour.call, Inbox):
            behaviour.call.executor = executor
    executor.step_until(round(seconds * SECOND))
    return executor


def ms(value: float) -> int:
    return round(value * MILLISECOND)
