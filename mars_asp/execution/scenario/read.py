"""Scenario files: the world, the robot, its devices, what runs each module, and requirements."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from math import inf
from pathlib import Path
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.execution.scenario.schema import REQUIRED, disordered, parts, unfit
from mars_asp.execution.scenario.toml_places import Places
from mars_asp.language.parse import decode, read_bytes
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from mars_asp.spelling import nearest

_NUMBER: tuple[type, ...] = (int, float)
#: The keys of each table and the types of their values; `docs/scenarios.md` says what they mean.
SCHEMA: Mapping[str, Mapping[str, tuple[type, ...]]] = {
    "": {
        "seed": (int,),
        "duration": _NUMBER,
        "up": (str,),
        "command_timeout": _NUMBER,
        "world": (dict,),
        "robot": (dict,),
        "devices": (dict,),
        "bindings": (dict,),
        "faults": (dict,),
        "requirements": (dict,),
    },
    "world": {
        "walls": (list,),
        "polygons": (list,),
        "circles": (list,),
        "moving": (list,),
        "marks": (list,),
        "scatter": (dict,),
    },
    "world.moving": {"from": (list,), "to": (list,), "radius": _NUMBER, "speed": _NUMBER},
    "world.marks": {"at": (list,), "colour": (str,)},
    "world.scatter": {
        "count": (int,),
        "radius": (list,),
        "within": _NUMBER,
        "free": _NUMBER,
        "moving": (int,),
        "speed": _NUMBER,
    },
    "robot": {"module": (str,), "radius": _NUMBER, "start": (list,), "limits": (dict,)},
    "robot.limits": dict.fromkeys((*MOTION_FUNCTIONS, GRASP), _NUMBER),
    "devices": {
        "kind": (str,),
        "period": _NUMBER,
        "beams": (int,),
        "cone": _NUMBER,
        "rays": (int,),
        "reach": _NUMBER,
        "view": _NUMBER,
        "sigma": _NUMBER,
        "script": (list,),
        "function": (str,),
        "low": _NUMBER,
        "high": _NUMBER,
        "rate": _NUMBER,
        "value": _NUMBER,
    },
    "bindings": {"python": (str,), "period": _NUMBER, "delay": _NUMBER},
    "faults": {"kind": (str,), "from": _NUMBER, "until": _NUMBER, "by": _NUMBER},
    "requirements": {
        "no_collision": (bool,),
        "clearance": _NUMBER,
        "reach": (dict,),
        "exclusive": (list,),
        "coverage": _NUMBER,
    },
    "requirements.reach": {"at": (list,), "radius": _NUMBER, "within": _NUMBER},
}
CHOICES = {
    ("", "up"): ("y", "z"),
    ("devices", "kind"): (
        "sonar",
        "lidar",
        "bumper",
        "odometry",
        "marks",
        "joystick",
        "platform",
        "joint",
        "gripper",
    ),
    ("faults", "kind"): ("silent", "late", "stuck", "throwing", "babbling"),
    ("devices", "function"): (*MOTION_FUNCTIONS, GRASP),
}
#: The least and the most that numbers of a key can be; for any other key they are +-1e9.
_RANGES: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(("duration", "period", "by"), (0.001, 1e9)),
    **dict.fromkeys(("beams", "rays"), (1, 100_000)),
    **dict.fromkeys(("count", "moving"), (0, 100_000)),
    **dict.fromkeys(("command_timeout", "delay", "sigma", "speed", "free"), (0, 1e9)),
    **dict.fromkeys(("radius", "reach", "clearance", "limits"), (0, 1e9)),
    "coverage": (0, 1),
    **dict.fromkeys(("low", "high"), (-inf, inf)),
    **dict.fromkeys(("rate", "until"), (0, inf)),
    "within": (0, 1e9),
    "seed": (-(2**63), 2**63 - 1),
}
_NAMED = ("devices", "bindings", "faults")
_NESTED = ("world", "robot", "requirements")
#: Whoever mends these reads no more.
_MOST_PROBLEMS = 200
#: A key of so many parts is none of ours, and takes its reader a time that grows as their square.
_DEEP = re.compile(r"(?<![\w.\"'-])(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}")


@dataclass(frozen=True, slots=True)
class Scenario:
    """A checked scenario; tables are as in the file, lengths in mm, times in s unless said.

    `places` says where requirements, the robot's module and limits, bindings and faults stand.
    """

    path: Path
    span: Span
    seed: int = 0
    duration: float = 60.0
    up: str = "y"
    command_timeout: float = 500.0
    world: Mapping[str, Any] = field(default_factory=dict)
    robot: Mapping[str, Any] = field(default_factory=dict)
    devices: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    bindings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    faults: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    requirements: Mapping[str, Any] = field(default_factory=dict)
    places: Mapping[str, Span] = field(default_factory=dict)


def load_scenario(path: Path) -> Scenario:
    """Read and check a scenario file.

    Raises:
        MarsError: it cannot be read, is no TOML, or has wrong keys or values; all of them.
    """
    return read_scenario(decode(read_bytes(path), str(path)), path)


def read_scenario(text: str, path: Path) -> Scenario:
    """Check the text of a scenario; `path` is what places show and bindings are relative to.

    Raises:
        MarsError: it is no TOML, or has wrong keys or values; all of them.
    """
    deep = _DEEP.search(text)
    if deep is not None:
        line = text.count("\n", 0, deep.start()) + 1
        raise MarsError([_problem(point(str(path), line, 1), "a key of more than 100 parts")])
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (text.count("\n") + 1, 1)
        message = str(error).split(" (at")[0]
        raise MarsError([_problem(point(str(path), line, column), message)]) from None
    except RecursionError:
        message = "its lists and tables are too deep to be read"
        raise MarsError([_problem(point(str(path), 1, 1), message)]) from None
    except ValueError as error:  # a number of more digits than Python reads
        raise MarsError([_problem(point(str(path), 1, 1), str(error).split(";")[0])]) from None
    where = Places(text, str(path))
    problems = list(islice(_Check(where, str(path)).scenario(tables), _MOST_PROBLEMS))
    if problems:
        raise MarsError(problems)
    places = {key: where.of(key, ("requirements",)) for key in tables.get("requirements", ())}
    limits = tables["robot"].get("limits", ())
    places |= {function: where.of(function, ("robot", "limits")) for function in limits}
    places["robot"] = where.of("module", ("robot",))
    for table in ("bindings", "faults"):
        named = tables.get(table, ())
        places |= {f"{table}.{module}": where.of(module, (table,)) for module in named}
    return Scenario(path, point(str(path), 1, 1), **tables, places=places)


def _problem(span: Span, message: str, help_text: str | None = None) -> Diagnostic:
    return Diagnostic("scenario", "error", message, span, (), help_text)


def _numbers(value: Any) -> Iterator[float]:
    """Yield the numbers in a value's lists; how deep these are, TOML's reader bounds."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        yield value
    for part in value if isinstance(value, list) else ():
        yield from _numbers(part)


def _usable(number: float, key: str) -> bool:
    least, most = _RANGES.get(key, (-1e9, 1e9))
    return least <= number <= most


def _range_of(key: str) -> str:
    least, most = _RANGES.get(key, (-1e9, 1e9))
    return f"from {least:g} to {most:g}"


class _Check:
    """Compares tables with the schema."""

    def __init__(self, places: Places, path: str) -> None:
        self.places, self.path = places, path

    def scenario(self, tables: Mapping[str, Any]) -> Iterator[Diagnostic]:
        yield from self.table("", tables, ())
        for name in _NESTED:
            table = tables.get(name)
            if isinstance(table, dict):
                yield from self.table(name, table, (name,))
                yield from self.inner(name, table)
        for name in _NAMED:
            table = tables.get(name)
            for module, entry in table.items() if isinstance(table, dict) else ():
                if isinstance(entry, dict):
                    yield from self.table(name, entry, (name, module))
                else:
                    yield _problem(self.places.of(module, (name,)), f"`{module}` is no table")
                if name == "devices" and isinstance(entry, dict) and "kind" not in entry:
                    kinds = ", ".join(CHOICES["devices", "kind"])
                    place = self.places.of(module, (name,))
                    yield _problem(place, f"`{module}` has no `kind`", f"one of {kinds}")
        for name in ("robot", "duration"):
            if name not in tables:
                yield _problem(point(self.path, 1, 1), f"the scenario has no `{name}`")
        if isinstance(tables.get("robot"), dict) and "module" not in tables["robot"]:
            yield _problem(self.places.of("robot", ()), "the robot has no `module`")

    def inner(self, name: str, table: Mapping[str, Any]) -> Iterator[Diagnostic]:
        for key, value in table.items():
            schema = f"{name}.{key}"
            if schema not in SCHEMA:
                continue
            if isinstance(value, dict):
                yield from self.table(schema, value, (name, key))
            for index, entry in enumerate(value if isinstance(value, list) else ()):
                if isinstance(entry, dict):
                    yield from self.table(schema, entry, (name, key), index)

    def table(
        self,
        schema: str,
        table: Mapping[str, Any],
        under: tuple[str, ...],
        entry: int | None = None,
    ) -> Iterator[Diagnostic]:
        """Check a table; with `entry` it has that index in the list `under`."""
        known = SCHEMA[schema]
        for key in REQUIRED.get(schema, ()):
            if key not in table:
                yield _problem(self.stands(under, entry), f"`{under[-1]}` without `{key}`")
        for key, value in table.items():
            if key not in known:
                near = nearest(key, known)
                hint = f"did you mean `{near}`?" if near else f"one of {', '.join(known)}"
                yield _problem(self.places.of(key, under, entry), f"`{key}` is no key here", hint)
            else:
                yield from self.value(schema, key, value, (under, entry))
        for first, second in disordered(schema, table):
            message = f"`{first}` is {table[first]}, above `{second}`, which is {table[second]}"
            yield _problem(self.places.of(first, under, entry), message, "exchange or change them")

    def value(
        self, schema: str, key: str, value: Any, at: tuple[tuple[str, ...], int | None]
    ) -> Iterator[Diagnostic]:
        """Check a value of a table that stands `at` a path of keys and an index in their list."""
        under, entry = at
        kinds = SCHEMA[schema][key]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            words = " or ".join(kind.__name__ for kind in kinds)
            yield _problem(self.places.of(key, under, entry), f"`{key}` is no {words}")
        elif (schema, key) in CHOICES and value not in CHOICES[schema, key]:
            choices = CHOICES[schema, key]
            near = nearest(str(value), choices)
            hint = f"did you mean `{near}`?" if near else f"one of {', '.join(choices)}"
            yield _problem(self.places.of(key, under, entry), f"`{value}` is no `{key}`", hint)
        else:
            wrong = False
            for index, form in unfit(schema, key, value):
                wrong = True
                owner = f"`{key}` is" if index is None else f"an entry of `{key}` is"
                yield _problem(self.part(key, at, index), f"{owner} not {form.words}")
            for index, part in () if wrong else parts(schema, key, value):
                for number in islice((n for n in _numbers(part) if not _usable(n, key)), 1):
                    message = f"`{number}` is no number for `{key}`"
                    yield _problem(self.part(key, at, index), message, _range_of(key))

    def part(self, key: str, at: tuple[tuple[str, ...], int | None], index: int | None) -> Span:
        """Return where a value stands, or with `index` an entry of it."""
        under, entry = at
        if index is None:
            return self.places.of(key, under, entry)
        return self.places.of_entry((*under, key), index)

    def stands(self, under: tuple[str, ...], entry: int | None) -> Span:
        """Return where a table stands."""
        if entry is None:
            return self.places.of(under[-1], under[:-1])
        return self.places.of_entry(under, entry)
