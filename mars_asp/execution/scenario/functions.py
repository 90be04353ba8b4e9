"""Bindings of modules to Python functions and classes, and injected faults."""

import ast
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from os.path import normpath
from pathlib import Path
from types import ModuleType
from typing import Any

from mars_asp.behaviour.calls import EntryPoint, Made, UnfitError, made, method_of, prepared
from mars_asp.behaviour.context import Context
from mars_asp.behaviour.imports import Folder, folder_of, place_of
from mars_asp.behaviour.values import copied
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.execution.executor import Behaviour
from mars_asp.execution.executor.behaviour import InjectedError
from mars_asp.execution.executor.plan import Plan, Slot
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.scenario.read import Scenario
from mars_asp.model.declarations import Configuration, Module, Service
from mars_asp.model.ports import inputs, parameter_names
from mars_asp.spelling import suggestion

Clock = Callable[[], float]


@dataclass
class Functions:
    """The Python functions and classes of one run.

    Each file is imported anew for every run, so that no state leaks into the next run. Each module
    has its own object of a class, which the parts of the module share. If there are several robots,
    each include has its own imports.
    """

    plan: Plan
    scenario: Scenario
    clock: Clock
    folders: dict[tuple[str, Path], Folder] = field(default_factory=dict)
    made: dict[tuple[str, type], Made] = field(default_factory=dict)
    contexts: dict[str, Context] = field(default_factory=dict)
    problems: list[Diagnostic] = field(default_factory=list)

    def behaviour(
        self,
        name: str,
        path: Path,
        called: str,
        given: tuple[EntryPoint, ...] | None = None,
    ) -> Behaviour | None:
        """Return the behaviour by a function or class of a file, or None and a new problem.

        `given` are the inputs of a function for resets.
        """
        declared = binding_of(name, self.plan.modules, self.scenario)
        shown = f"{normpath(path)}:{called}"
        try:
            folder = self._folder(path, name)
            call, place = self._find_function(name, folder, path.resolve(), called, given)
        except UnfitError as error:
            message, help_text = error.args[0], error.help.replace("NAME", name)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a user's file may fail in any way
            text = f"{type(error).__name__}: {error}"
            raised = place_of(error)
            if raised is not None:
                text = f"{_seen_from_here(raised[0])}:{raised[1]}: {text}"
            message, help_text = f"`{shown}` cannot be used: {text}", None
        else:
            period, delay = (_nanoseconds(declared.get(key)) for key in ("period", "delay"))
            return Behaviour(_staying(call, folder), period, delay or 0, place=place)
        # At the binding of the module, or at its annotated function.
        module, message = self.plan.modules.get(name), f"`{name}`: {message}"
        annotated = module.services[0].span if module and module.services else self.scenario.span
        span = self.scenario.places.get(f"bindings.{name}", annotated)
        self.problems.append(Diagnostic("binding", "error", message, span, (), help_text))
        return None

    def resetting(self, name: str, path: Path, called: str) -> Callable[..., Any] | None:
        """Return the function `@Reset` of a module, a method beside its function, or None."""
        module = self.plan.modules.get(name)
        services = module.services if module is not None else ()
        service = next((each for each in services if each.kind == "Reset"), None)
        if service is None or service.function is None:
            return None
        if not is_in_source(service):
            owner = _class_in(path, called)
            called = f"{owner}.{service.function}" if owner else service.function
        else:
            path, called = Path(service.span.path), _qualified(service)
        given = (EntryPoint("the reset"),) if service.inputs else ()
        behaviour = self.behaviour(name, path, called, given)
        if behaviour is None:
            return None
        call = behaviour.call
        return call if given else lambda message: call()

    def _folder(self, path: Path, name: str) -> Folder:
        several = len(self.scenario.robots) > 1 and "/" in name
        key = name.partition("/")[0] if several else "", folder_of(path.resolve())
        if key not in self.folders:
            self.folders[key] = Folder(key[1])
        return self.folders[key]

    def _find_function(
        self,
        name: str,
        folder: Folder,
        path: Path,
        called: str,
        given: tuple[EntryPoint, ...] | None,
    ) -> tuple[Callable[..., Any], tuple[str, int] | None]:
        """Return the callable that `called` names in a file, and its location if known."""
        if not path.is_file():
            text = f"`{_seen_from_here(str(path))}` is not a file"
            raise UnfitError(text, "name a file, relative to the scenario")
        # The name under which behaviours find the run's seed for random numbers.
        target: Any = folder.load(path, SEED=self.scenario.seed)
        context, knows = self._context(name), False
        with folder:
            for part in called.split("."):
                target, knows = self._part(target, part, context, knows)
            if isinstance(target, type):
                target, knows = self._made(target, context)
                target = method_of(target, self._annotated(name, target))
            if not callable(target):
                raise UnfitError(f"`{called}` is not a function", "name a function or a class")
            inputs_of_module = entries(self.plan, name) if given is None else given
            call = prepared(target, context, self.clock, inputs_of_module, knows=knows)
            return call, _place_of(target)

    def _part(self, target: Any, part: str, context: Context, knows: bool) -> tuple[Any, bool]:
        """Return the attribute `part`, and whether its object got the context (`knows`)."""
        if isinstance(target, type) and not isinstance(getattr(target, part, None), type):
            made, knows = self._made(target, context)
            return method_of(made, part), knows
        if not hasattr(target, part):
            defined = [n for n in dir(target) if callable(getattr(target, n, None))]
            owner = Path(str(target.__file__)).name if isinstance(target, ModuleType) else "it"
            help_text = suggestion(part, defined, "name a function or a class of it")
            raise UnfitError(f"`{owner}` defines no function `{part}`", help_text)
        return getattr(target, part), knows

    def _made(self, kind: type, context: Context) -> Made:
        if (context.module, kind) not in self.made:
            self.made[context.module, kind] = made(kind, context)
        return self.made[context.module, kind]

    def _context(self, name: str) -> Context:
        """Return the context of a module; parts without own parameters share that of the module."""
        declared = self.scenario.bindings.get(name, {})
        owner = name if "parameters" in declared else name.partition(".")[0]
        if owner not in self.contexts:
            given = self.scenario.bindings.get(owner, {}).get("parameters", {})
            self.contexts[owner] = Context(owner, self.scenario.seed, copied(given))
        return self.contexts[owner]

    def _annotated(self, name: str, instance: object) -> str | None:
        """Return the annotated method of an object, or None if the annotations name none."""
        module = self.plan.modules.get(name)
        services = module.services if module else ()
        named = [service.function for service in services if service.kind != "Reset"]
        return next((each for each in named if each and hasattr(instance, each)), None)


def _staying(call: Callable[..., Any], folder: Folder) -> Callable[..., Any]:
    """Return a function that imports from its folder and cannot exit the process."""

    def run(*inputs: Any) -> Any:
        try:
            with folder:
                return call(*inputs)
        except (Exception, KeyboardInterrupt):
            raise
        except SystemExit as error:
            raise RuntimeError(f"it called `exit({error.code})`") from None
        except BaseException as error:
            raise RuntimeError(f"it raised {type(error).__name__}") from None

    return run


def _seen_from_here(file: str) -> str:
    """Return a path relative to the current folder, or the file name of a path outside."""
    path, here = Path(file), Path.cwd()
    return path.relative_to(here).as_posix() if path.is_relative_to(here) else path.name


def entries(plan: Plan, name: str) -> tuple[EntryPoint, ...] | None:
    """Return the inputs of a module in a run, or None if the module does not run."""
    if name not in plan.names:
        return (EntryPoint("what it converts"),)
    kind = plan.kind(name)
    if kind in ("effector", "data_transformer"):
        return (EntryPoint("a command" if kind == "effector" else "what it converts"),)
    slots = plan.slots.get(name, ())
    if not (slots or plan.data_out[name] or plan.control_out[name]):
        return None  # it does not run
    if kind == "sensor":
        return ()
    return tuple(
        EntryPoint(
            " or ".join(dict.fromkeys(plan.origin_of(link) for link in slot.links)),
            _parameter_name(plan, name, slot),
            slot.place,
        )
        for slot in slots
    )


def _parameter_name(plan: Plan, name: str, slot: Slot) -> str | None:
    """Return the name of the function's parameter that an input feeds, None if unknown."""
    if slot.name is None or name not in plan.modules:
        return slot.name
    known = inputs(plan.modules[name]).get(slot.name)
    if known is None:
        return slot.name
    number, index = known.parameters[0]
    return tuple(parameter_names(plan.modules[name].services[number]))[index]


def _place_of(target: Any) -> tuple[str, int] | None:
    """Return the file and line of a function or an object's `__call__`, or None."""
    routine: Any = target if inspect.isroutine(target) else getattr(target, "__call__", None)  # noqa: B004
    code = getattr(inspect.unwrap(getattr(routine, "__func__", routine)), "__code__", None)
    return None if code is None else (code.co_filename, code.co_firstlineno)


def bind_functions(plan: Plan, scenario: Scenario, clock: Clock) -> dict[str, Behaviour]:
    """Return the behaviours of the modules that Python functions and classes run.

    A binding of the scenario names `FILE.py:FUNCTION`, `FILE.py:CLASS` or `FILE.py:CLASS.METHOD`,
    relative to the scenario; a module without a binding runs its annotated Python function.

    Raises:
        MarsError: with all files and functions that cannot be used.
    """
    functions = Functions(plan, scenario, clock)
    known = {*plan.names, *converting(plan)}
    bound: dict[str, Behaviour | None] = {}
    for name, place in bound_functions(plan.modules, scenario, plan.names):
        if name not in known:
            continue
        only_reset = name in plan.names and plan.kind(name) == "reset"
        behaviour = Behaviour(lambda: None) if only_reset else functions.behaviour(name, *place)
        if behaviour is not None:
            behaviour = replace(behaviour, reset=functions.resetting(name, *place))
        bound[name] = behaviour
    if functions.problems:
        raise MarsError(functions.problems)
    return {n: faulty(each, scenario, n, clock) for n, each in bound.items() if each is not None}


def converting(plan: Plan) -> Iterator[str]:
    """Yield the modules and introduced nodes that convert messages."""
    yield from (name for name in plan.names if plan.kind(name) == "data_transformer")
    yield from (each.converter for each in plan.configuration.conversions if each.converter)
    for module in plan.modules.values():
        if any(service.kind == "Converts" for service in module.services):
            yield module.name


def bind_kinds(scenario: Scenario, specification: Configuration) -> Scenario:
    """Return a scenario with bindings of nodes instead of bindings of kinds of nodes.

    A binding of a node by its name has precedence.
    """
    kinds = {each.kind for each in specification.kinds}
    names = {name.text for name in specification.modules}
    bound_kinds = [name for name in scenario.bindings if name in kinds - names]
    bindings = {n: declared for n, declared in scenario.bindings.items() if n not in bound_kinds}
    places = dict(scenario.places)
    for kind in bound_kinds:
        for name in (n.text for n in specification.modules):
            found = specification.pack_kind(name)
            if found is not None and found.kind == kind and name not in scenario.bindings:
                bindings[name] = scenario.bindings[kind]
                places[f"bindings.{name}"] = places[f"bindings.{kind}"]
    return replace(scenario, bindings=bindings, places=places) if bound_kinds else scenario


def bound_functions(
    modules: Mapping[str, Module], scenario: Scenario, names: Iterable[str]
) -> Iterator[tuple[str, tuple[Path, str]]]:
    """Yield each module that a Python function runs, with the function's file and name.

    No file is imported. `names` are the modules of the specification.
    """
    converters = [m.name for m in modules.values() if any(s.kind == "Converts" for s in m.services)]
    for name in dict.fromkeys([*names, *converters, *scenario.bindings]):
        module = modules.get(name)
        place = _bound_location(binding_of(name, modules, scenario), module, scenario)
        if name not in scenario.devices and place is not None:
            yield name, place


def binding_of(name: str, modules: Mapping[str, Module], scenario: Scenario) -> Mapping[str, Any]:
    """Return the binding of a module; parts of one with `@Done` have that of the module."""
    own, owner = scenario.bindings.get(name, {}), modules.get(name.rpartition(".")[0])
    if "python" in own or owner is None or name not in modules:
        return own
    parts = [each for n, each in modules.items() if n.startswith(f"{owner.name}.")]
    family = [each for each in parts if each.span == owner.span]
    completes = any(s.kind == "Done" for each in family for s in each.services)
    return scenario.bindings.get(owner.name, own) if modules[name] in family and completes else own


def _bound_location(
    binding: Mapping[str, Any], module: Module | None, scenario: Scenario
) -> tuple[Path, str] | None:
    services = module.services if module else ()
    if "python" in binding:
        file, _, function = binding["python"].rpartition(":")
        path = scenario.path.parent / file
        done = [s.function for s in services if s.kind == "Done"]
        if done and len(services) == 1 and (owner := _class_in(path, function)):
            function = f"{owner}.{done[0]}"
        return path, function
    for service in services:
        if is_in_source(service) and (service.kind != "Reset" or services == (service,)):
            return Path(service.span.path), _qualified(service)
    return None


def is_in_source(service: Service) -> bool:
    """Whether a Python source has the function of a service."""
    return bool(service.function) and service.span.path.endswith(".py")


def _class_in(path: Path, called: str) -> str:
    """Return the class that `called` names in a file, or that of its method; "" for neither."""
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError):
        return ""  # the import reports the error
    classes = {node.name for node in tree.body if isinstance(node, ast.ClassDef)}
    first = called.partition(".")[0]
    return first if first in classes else ""


def _qualified(service: Service) -> str:
    """Return the qualified name of an annotated function, `CLASS.METHOD` for a method."""
    name = (service.function or "").rpartition(".")[2]
    try:
        tree = ast.parse(Path(service.span.path).read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError):
        return name  # the import reports the error
    found = [
        (node.lineno, qualified)
        for node, qualified in _definitions(tree.body, "")
        if node.name == name and node.lineno > service.span.line
    ]
    return min(found, default=(0, name))[1]


def _definitions(
    body: Sequence[ast.stmt], within: str
) -> Iterator[tuple[ast.FunctionDef | ast.AsyncFunctionDef, str]]:
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node, within + node.name
        elif isinstance(node, ast.ClassDef):
            yield from _definitions(node.body, f"{within}{node.name}.")


def _nanoseconds(milliseconds: float | None) -> int | None:
    return None if milliseconds is None else round(milliseconds * MILLISECOND)


def faulty(behaviour: Behaviour, scenario: Scenario, name: str, clock: Clock) -> Behaviour:
    """Return a behaviour with the fault that the scenario injects into the module `name`, if any.

    `silent` returns nothing, `stuck` repeats its last result, `throwing` raises, from `from` to
    `until` seconds; `late` adds `by` ms to the delay and `babbling` runs every `by` ms, always.
    """
    # The fault of a module applies to each of its parts.
    fault = scenario.faults.get(name) or scenario.faults.get(name.rpartition(".")[0])
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
            last[0] = copied(behaviour.call(*inputs))
            return last[0]
        if kind == "throwing":
            raise InjectedError(f"`{name}` raises an exception, as the scenario demands")
        return last[0] if kind == "stuck" else None

    return replace(behaviour, call=call)
