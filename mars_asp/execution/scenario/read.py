"""Scenario files: the world, the robot, its devices, what runs each module, and requirements."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.execution.scenario.schema import mistakes
from mars_asp.execution.scenario.toml_places import Places
from mars_asp.language.parse import decode, read_bytes

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
        raise MarsError([_problem(point(str(path), line, 1), "a key with more than 100 parts")])
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (text.count("\n") + 1, 1)
        message = str(error).split(" (at")[0]
        raise MarsError([_problem(point(str(path), line, column), message)]) from None
    except RecursionError:
        message = "its lists and tables are nested too deep"
        raise MarsError([_problem(point(str(path), 1, 1), message)]) from None
    except ValueError as error:  # a number of more digits than Python reads
        raise MarsError([_problem(point(str(path), 1, 1), str(error).split(";")[0])]) from None
    where = Places(text, str(path))
    problems = [
        _problem(where.of(*wrong.path), wrong.message, wrong.help)
        for wrong in islice(mistakes(tables), _MOST_PROBLEMS)
    ]
    if problems:
        raise MarsError(problems)
    places = {key: where.of("requirements", key) for key in tables.get("requirements", ())}
    limits = tables["robot"].get("limits", ())
    places |= {function: where.of("robot", "limits", function) for function in limits}
    places["robot"] = where.of("robot", "module")
    for table in ("bindings", "faults"):
        named = tables.get(table, ())
        places |= {f"{table}.{module}": where.of(table, module) for module in named}
    return Scenario(path, point(str(path), 1, 1), **tables, places=places)


def _problem(span: Span, message: str, help_text: str | None = None) -> Diagnostic:
    return Diagnostic("scenario", "error", message, span, (), help_text)
