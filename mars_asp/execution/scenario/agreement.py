"""The cross-check of a scenario and a specification: do they have the same modules?"""

from collections.abc import Iterable, Iterator, Sequence

from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.scenario.functions import binding_of, bound_functions, converting
from mars_asp.execution.scenario.link_faults import absent_links
from mars_asp.execution.scenario.read import Scenario, ScenarioRobot
from mars_asp.execution.scenario.vary import CHANGED
from mars_asp.model.declarations import MOTION_FUNCTIONS, node_kind
from mars_asp.spelling import suggestion

#: Devices that obey commands; all others are sensors or platforms.
_OBEYING = ("joint", "gripper")


def disagreements(plan: Plan, scenario: Scenario) -> Iterator[Diagnostic]:
    """Yield the entries of a scenario that do not fit the specification.

    An unknown name is an error if it resembles a module without device or binding: a misspelling.
    Otherwise it is a warning: it may belong to another specification with the same scenario.
    """
    modules = [name for name in plan.names if name in plan.modules or node_kind(name) is None]
    unfit = [each for robot in scenario.robots for each in _unfit(plan, robot)]
    yield from unfit
    robots = [] if unfit else [robot.module for robot in scenario.robots]
    run = {name for name, _ in bound_functions(plan.modules, scenario, plan.names)}
    left = set(modules) - run - scenario.devices.keys() - {*robots}
    converters = {*converting(plan)}
    for name, device in scenario.devices.items():
        if name in converters:
            message = f"`{name}` is a converter, which no device can be"
            help_text = "bind it to a Python function under `bindings`"
            place = scenario.places[f"devices.{name}"]
            yield Diagnostic("scenario", "error", message, place, (), help_text)
        elif name not in modules:
            yield _unknown_name("devices", name, modules, left, scenario)
        elif wrong := _unlike(plan, robots, name, device["kind"]):
            place = scenario.places[f"devices.{name}"]
            yield Diagnostic("scenario", "error", wrong[0], place, (), wrong[1])
    bound = {*modules, *converters}
    for name, declared in scenario.bindings.items():
        parts = [each for each in modules if each.startswith(f"{name}.")]
        used = [binding_of(each, plan.modules, scenario) for each in parts]
        if name not in bound and not (parts and "python" not in declared) and declared not in used:
            yield _unknown_name("bindings", name, modules, left, scenario)
    yield from _faults(plan, scenario)
    yield from absent_links(plan, scenario)
    for robot in scenario.robots:
        within = (robot.reach or {}).get("within", 0)
        if within > scenario.duration:
            end = f"{scenario.duration:g} s"
            message = f"`within` is {within:g} s, and the run ends at {end}"
            help_text = "lengthen the duration: a place that is not reached by then is not decided"
            place = robot.places.get("reach") or scenario.places["reach"]
            yield Diagnostic("scenario", "warning", message, place, (), help_text)


def _unknown_name(
    table: str, name: str, modules: Iterable[str], left: Iterable[str], scenario: Scenario
) -> Diagnostic:
    """Return the diagnostic for an unknown name; `left` are modules without device or binding."""
    place = scenario.places[f"{table}.{name}"]
    message = f"`{table}` names `{name}`, which is not a module of the specification"
    if parts := sorted(each for each in modules if each.startswith(f"{name}.")):
        help_text = f"it runs in parts: {', '.join(parts)}"
        return Diagnostic("scenario", "error", message, place, (), help_text)
    # A misspelt key of `--vary` would have no effect.
    if place.path.startswith(CHANGED.path):
        help_text = suggestion(name, modules, f"one of {', '.join(sorted(modules))}")
        return Diagnostic("scenario", "error", message, place, (), help_text)
    advice = suggestion(name, left, None)
    severity: Severity = "error" if advice else "warning"
    named = scenario.devices.keys() | scenario.bindings.keys()
    others = sorted({*modules} - named)
    help_text = advice or suggestion(name, others, "remove it, or add the module")
    return Diagnostic("scenario", severity, message, place, (), help_text)


def _unlike(plan: Plan, robots: Sequence[str], name: str, device: str) -> tuple[str, str] | None:
    """Return message and help if a device does not suit the module `name`, else None.

    `robots` are the modules that move robots.
    """
    kind = plan.kind(name).replace("_", " ")
    if robots and (name in robots) != (device == "platform"):
        if name in robots:
            return f"`{name}` moves the robot, and a {device} does not", "remove the device"
        moving = "`, `".join(robots)
        text = f"`{moving}` moves the robot" if len(robots) == 1 else f"`{moving}` move the robots"
        return f"`{name}` is a platform, and {text}", "give it another kind"
    if device in _OBEYING and kind != "effector":
        return f"a {device} obeys commands, and `{name}` does not ({kind})", "give it another kind"
    if device in (*_OBEYING, "platform"):
        return None
    if kind == "effector" and plan.control_in[name]:
        return f"`{name}` obeys commands, and a {device} does not", "use a joint or a gripper"
    if plan.data_in[name]:
        source = plan.data_in[name][0].source
        message = f"`{name}` uses data from `{source}`, and a {device} has no inputs"
        return message, f"bind `{name}` to a function"
    if device != "joystick" and plan.control_out[name]:
        message = f"`{name}` sends commands, and a {device} measures"
        return message, f"describe `{name}` with `@Sense`, or bind it to a function"
    return None


def _unfit(plan: Plan, robot: ScenarioRobot) -> Iterator[Diagnostic]:
    """Yield an error if the module of a robot cannot move it."""
    name = robot.module
    kind = plan.kind(name).replace("_", " ")
    functions = plan.modules[name].functions if name in plan.modules else ()
    help_text = "name the effector that moves the robot"
    if name not in plan.names:
        message = f"`{name}` is not a module of the specification"
        help_text = suggestion(name, plan.names, help_text)
    elif kind != "effector":
        message = f"the robot's `module` is an effector, and `{name}` is not ({kind})"
    elif functions and not any(function.name in MOTION_FUNCTIONS for function in functions):
        message = f"the robot's `module` moves, and `{name}` has no motion function"
    else:
        return
    yield Diagnostic("scenario", "error", message, robot.places["module"], (), help_text)


def _faults(plan: Plan, scenario: Scenario) -> Iterator[Diagnostic]:
    """Yield an error for each fault that cannot be injected, as its trial would prove nothing."""
    able = {name for name, _ in bound_functions(plan.modules, scenario, plan.names)}
    reading = (n for n, d in scenario.devices.items() if d["kind"] not in (*_OBEYING, "platform"))
    able = (able | {*reading}) - {robot.module for robot in scenario.robots}
    for name in sorted(scenario.faults.keys() - able):
        hint = suggestion(name, able, f"one of {', '.join(sorted(able))}")
        message = f"`{name}` is not a module of the specification"
        if name in plan.names:
            message = f"`{name}` is not run by a Python function or a sensing device"
        place = scenario.places[f"faults.{name}"]
        yield Diagnostic("scenario", "error", message, place, (), hint)
