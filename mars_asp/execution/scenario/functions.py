"""Modules bound to what runs them: Python functions, simulated devices, and injected faults."""

import importlib.util
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.execution.executor import Behaviour
from mars_asp.execution.executor.behaviour import AskedError
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.scenario.read import Scenario
from mars_asp.model.declarations import Module

Clock = Callable[[], float]


class Functions:
    """The Python functions of one run; each file is imported once, afresh for every run.

    Module-level state of a behaviour therefore never leaks from one run into the next. Of several
    robots, the modules of each include have their own.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.loaded: dict[tuple[str, Path], ModuleType] = {}
        self.problems: list[Diagnostic] = []

    def function(self, path: Path, name: str, module: str) -> Callable[..., Any] | None:
        """Return a function of a file; note what is wrong with it."""
        several = len(self.scenario.robots) > 1
        key = module.partition("/")[0] if several and "/" in module else "", path
        try:
            if key not in self.loaded:
                self.loaded[key] = self._load(path)
        except (Exception, SystemExit) as error:  # a user's file may fail in any way
            self._note(module, f"`{path}:{name}` cannot be used: {type(error).__name__}: {error}")
            return None
        found = getattr(self.loaded[key], name, None)
        if found is None:
            self._note(module, f"`{path}` defines no function `{name}`")
            return None
        if not callable(found):
            self._note(module, f"`{path}:{name}` is not a function")
            return None
        return _staying(found)

    def _load(self, path: Path) -> ModuleType:
        specification = importlib.util.spec_from_file_location(f"_behaviour_{path.stem}", path)
        if specification is None or specification.loader is None:
            raise ImportError("it is not a Python file")
        module = importlib.util.module_from_spec(specification)
        # A behaviour that draws random numbers finds the run's seed here.
        module.__dict__["SEED"] = self.scenario.seed
        specification.loader.exec_module(module)
        return module

    def _note(self, module: str, message: str) -> None:
        self.problems.append(
            Diagnostic("binding", "error", f"`{module}`: {message}", self._place(module))
        )

    def _place(self, module: str) -> Span:
        """Return where the scenario binds a module; one that it does not is bound by its source."""
        return self.scenario.places.get(f"bindings.{module}", self.scenario.span)


def _staying(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that fails where the given one would end the program."""

    def call(*inputs: Any) -> Any:
        try:
            return function(*inputs)
        except SystemExit as error:
            raise RuntimeError(f"it called `exit({error.code})`") from None

    return call


def bind_functions(
    modules: Mapping[str, Module], scenario: Scenario, names: tuple[str, ...], clock: Clock
) -> dict[str, Behaviour]:
    """Return behaviours of the modules that Python functions run.

    A binding of the scenario names `FILE.py:FUNCTION`, relative to the scenario; without one an
    annotated Python function is its own implementation.

    Raises:
        MarsError: files or functions that cannot be used; all of them.
    """
    functions, bound = Functions(scenario), {}
    for name, place in bound_functions(modules, scenario, names):
        call = functions.function(*place, name)
        if call is not None:
            stated = scenario.bindings.get(name, {})
            bound[name] = Behaviour(
                call, _nanoseconds(stated.get("period")), _nanoseconds(stated.get("delay")) or 0
            )
    if functions.problems:
        raise MarsError(functions.problems)
    return {name: faulty(behaviour, scenario, name, clock) for name, behaviour in bound.items()}


def bound_functions(
    modules: Mapping[str, Module], scenario: Scenario, names: Iterable[str]
) -> Iterator[tuple[str, tuple[Path, str]]]:
    """Yield each module that a Python function runs, and the file and name of that.

    Nothing is imported. `names` are those of the specification's modules.
    """
    converters = [m.name for m in modules.values() if any(s.kind == "Converts" for s in m.services)]
    for name in dict.fromkeys([*names, *converters, *scenario.bindings]):
        place = _place(scenario.bindings.get(name, {}), modules.get(name), scenario)
        if name not in scenario.devices and place is not None:
            yield name, place


def _place(
    stated: Mapping[str, Any], module: Module | None, scenario: Scenario
) -> tuple[Path, str] | None:
    if "python" in stated:
        file, _, function = stated["python"].rpartition(":")
        return scenario.path.parent / file, function
    for service in module.services if module else ():
        if service.function and service.span.path.endswith(".py"):
            return Path(service.span.path), service.function.rpartition(".")[2]
    return None


def _nanoseconds(milliseconds: float | None) -> int | None:
    return None if milliseconds is None else round(milliseconds * MILLISECOND)


def faulty(behaviour: Behaviour, scenario: Scenario, name: str, clock: Clock) -> Behaviour:
    """Return a behaviour with the fault that the scenario injects, if any.

    `silent` returns nothing, `stuck` repeats its last result, `throwing` raises, from `from` to
    `until` seconds; `late` adds `by` ms to the delay and `babbling` runs every `by` ms, always.
    """
    fault = scenario.faults.get(name)
    if fault is None:
        return behaviour
    kind, by = fault.get("kind", "silent"), _nanoseconds(fault.get("by", 100.0))
    if kind == "late":
        return replace(behaviour, delay=behaviour.delay + (by or 0))
    if kind == "babbling":
        return replace(behaviour, period=by)
    start, end = fault.get("from", 0.0), fault.get("until", scenario.duration)
    last: list[Any] = [None]

    def call(*inputs: Any) -> Any:
        if not start <= clock() < end:
            last[0] = behaviour.call(*inputs)
            return last[0]
        if kind == "throwing":
            raise AskedError(f"`{name}` raises an exception, as the scenario demands")
        return last[0] if kind == "stuck" else None

    return replace(behaviour, call=call)
