"""Scenario files: the world, robots, devices, bindings of modules, and requirements."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span, whole_file
from mars_asp.execution.scenario.contradictions import contradictions
from mars_asp.execution.scenario.schema import mistakes
from mars_asp.execution.scenario.vary import (
    CHANGED,
    UNCHANGED,
    Changes,
    changed,
    key_path,
    switched_off,
    written_change,
)
from mars_asp.execution.simulator.body import planar_functions
from mars_asp.language.parse import decode, read_bytes
from mars_asp.language.toml_text import Places, read_tables

#: Maximal number of reported problems.
_MOST_PROBLEMS = 200


@dataclass(frozen=True, slots=True)
class ScenarioRobot:
    """A robot: the effector that moves it, its properties and its goal; mm, degrees, seconds.

    `start` is forward, side and heading; `acceleration` and `deceleration` are by function.
    `places` has the locations of keys, limits and accelerations, `span` that of the robot.
    """

    name: str
    module: str
    span: Span
    radius: float = 200.0
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    limits: Mapping[str, float] = field(default_factory=dict)
    acceleration: Mapping[str, float] = field(default_factory=dict)
    deceleration: Mapping[str, float] = field(default_factory=dict)
    reach: Mapping[str, Any] | None = None
    places: Mapping[str, Span] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Scenario:
    """A checked scenario; tables are as in the file, lengths in mm, times mostly in seconds.

    `places` has the locations of requirements, devices, bindings, faults, names of links
    and `scatter`.
    """

    path: Path
    span: Span
    seed: int = 0
    duration: float = 60.0
    up: str = "y"
    command_timeout: float = 500.0
    world: Mapping[str, Any] = field(default_factory=dict)
    robots: tuple[ScenarioRobot, ...] = ()
    devices: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    bindings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    faults: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    links: Sequence[Mapping[str, Any]] = ()
    requirements: Mapping[str, Any] = field(default_factory=dict)
    places: Mapping[str, Span] = field(default_factory=dict)

    def called(self, robot: ScenarioRobot) -> str:
        """Return a robot's name for messages, `the robot` if it is the only one."""
        return "the robot" if len(self.robots) == 1 else f"`{robot.name}`"


def load_scenario(path: Path, changes: Changes = UNCHANGED) -> Scenario:
    """Return the checked scenario of a file, with changed values of keys.

    Raises:
        MarsError: the file cannot be read or is not TOML, or with all wrong keys and values.
    """
    return read_scenario(decode(read_bytes(path), str(path)), path, changes)


def read_scenario(text: str, path: Path, changes: Changes = UNCHANGED) -> Scenario:
    """Return the checked scenario of a text, with changed values of keys.

    `path` is the path in messages; bindings are relative to its folder.

    Raises:
        MarsError: the text is not TOML, or with all wrong keys and values.
    """
    tables = read_tables(text, str(path), "scenario")
    where = Places(text, str(path))
    wrong = list(islice(mistakes(tables), _MOST_PROBLEMS))
    if len(wrong) < _MOST_PROBLEMS:
        wrong += islice(contradictions(tables, wrong), _MOST_PROBLEMS - len(wrong))
    problems = [_problem(where.of(*each.path), each.message, each.help) for each in wrong]
    if problems:
        raise MarsError(problems)
    written, tables = tables, changed(tables, changes)

    paths = {key: key_path(key) for key in changes}

    def placed(*path: str | int) -> Span:
        words = tuple(map(str, path))
        for key, of in paths.items():
            if words == of[: len(words)] or of == words[: len(of)]:
                return whole_file(f"{CHANGED.path} {written_change(key, changes[key])}")
        return where.of(*path) if _stands(written, path) else CHANGED

    places = {key: placed("requirements", key) for key in tables.get("requirements", ())}
    for table in ("devices", "bindings", "faults"):
        named = tables.get(table, ())
        places |= {f"{table}.{module}": placed(table, module) for module in named}
    places["scatter"] = placed("world", "scatter")
    for number, _ in enumerate(tables.get("links", ())):
        ends = ("from", "to")
        places |= {f"links.{number}.{end}": placed("links", number, end) for end in ends}
    declared, up = tables["robot"], tables.get("up", "y")
    reach = tables.get("requirements", {}).get("reach")
    robots = tuple(
        _read_robot(table, "robot", reach, placed, ("robot",))
        if table is declared
        else _read_robot(table, table["module"], None, placed, ("robot", number))
        for number, table in enumerate(declared if isinstance(declared, list) else [declared])
    )
    problems = [*_unclear(robots, reach is not None, places), *_unmoved(robots, up)]
    if problems:
        raise MarsError(problems)
    places |= {f"faults.{module}": CHANGED for module in switched_off(changes)}
    others = {key: value for key, value in tables.items() if key != "robot"}
    return Scenario(path, whole_file(str(path)), **others, robots=robots, places=places)


def _stands(written: Any, path: Iterable[str | int]) -> bool:
    """Whether tables have a value at a path of keys and indices."""
    try:
        for part in path:
            written = written[part]
    except (LookupError, TypeError):
        return False
    return True


def _read_robot(
    table: Mapping[str, Any],
    name: str,
    reach: Mapping[str, Any] | None,
    placed: Callable[..., Span],
    path: tuple[str | int, ...],
) -> ScenarioRobot:
    """Return a checked robot; `name` is the default name."""
    settings = {key: value for key, value in table.items() if key not in ("name", "start")}
    x, y, heading = map(float, table.get("start", (0, 0, 0)))
    places = {key: placed(*path, key) for key in table}
    for key in ("limits", "acceleration", "deceleration"):
        declared = table.get(key, ())
        places |= {f"{key}.{function}": placed(*path, key, function) for function in declared}
    return ScenarioRobot(
        table.get("name", name),
        span=placed(*path),
        start=(x, y, heading),
        places=places,
        **{"reach": reach, **settings},
    )


def _unclear(
    robots: Sequence[ScenarioRobot], reach: bool, places: Mapping[str, Span]
) -> Iterator[Diagnostic]:
    """Yield errors for names, modules and `reach` goals that do not identify one robot."""
    for key in ("name", "module"):
        seen = set[str]()
        for robot in robots:
            word = robot.name if key == "name" else robot.module
            if word in seen:
                place = robot.places.get(key, robot.span)
                message = f"two robots have the {key} `{word}`"
                yield _problem(place, message, f"give each robot a `{key}` of its own")
            seen.add(word)
    if reach and len(robots) > 1:
        message = "`reach` does not state which of several robots is meant"
        yield _problem(places["reach"], message, "write it into the table of a robot")
    if reach and any("reach" in robot.places for robot in robots):
        message = "`reach` is also stated for the robot"
        yield _problem(places["reach"], message, "remove one of them")


def _unmoved(robots: Sequence[ScenarioRobot], up: str) -> Iterator[Diagnostic]:
    """Yield errors for accelerations of functions that no platform has, with axis `up` vertical."""
    able = planar_functions(up)
    for robot in robots:
        for key in ("acceleration", "deceleration"):
            for function in getattr(robot, key):
                place = robot.places[f"{key}.{function}"]
                if function not in able:
                    message = f'a platform does not carry out `{function}` with `up = "{up}"`'
                    yield _problem(place, message, f"one of {', '.join(able)}")
                elif key == "deceleration" and function not in robot.acceleration:
                    message = f"`{function}` has a deceleration, and no acceleration"
                    yield _problem(place, message, "state both, or the acceleration alone")


def _problem(span: Span, message: str, help_text: str | None = None) -> Diagnostic:
    return Diagnostic("scenario", "error", message, span, (), help_text)
