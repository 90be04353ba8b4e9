"""Scenario files: the world, the robot, its devices, what runs each module, and requirements."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.execution.scenario.contradictions import contradictions
from mars_asp.execution.scenario.schema import mistakes
from mars_asp.execution.scenario.toml_places import Places
from mars_asp.execution.scenario.toml_tables import read_tables
from mars_asp.execution.scenario.vary import CHANGED, UNCHANGED, Changes, changed, switched_off
from mars_asp.language.parse import decode, read_bytes

#: Whoever mends these reads no more.
_MOST_PROBLEMS = 200


@dataclass(frozen=True, slots=True)
class Scenario:
    """A checked scenario; tables are as in the file, lengths in mm, times in s unless said.

    `places` has those of requirements, the robot's module, start and limits, and of the tables of
    bindings, devices and faults.
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


def load_scenario(path: Path, changes: Changes = UNCHANGED) -> Scenario:
    """Read and check a scenario file, some keys of which may have other values.

    Raises:
        MarsError: it cannot be read, is no TOML, or has wrong keys or values; all of them.
    """
    return read_scenario(decode(read_bytes(path), str(path)), path, changes)


def read_scenario(text: str, path: Path, changes: Changes = UNCHANGED) -> Scenario:
    """Check the text of a scenario; `path` is what places show and bindings are relative to.

    `changes` are the values of keys that have others than in the text.

    Raises:
        MarsError: it is no TOML, or has wrong keys or values; all of them.
    """
    tables = read_tables(text, str(path), "scenario")
    where = Places(text, str(path))
    wrong = list(islice(mistakes(tables), _MOST_PROBLEMS))
    if len(wrong) < _MOST_PROBLEMS:
        wrong += islice(contradictions(tables, wrong), _MOST_PROBLEMS - len(wrong))
    problems = [_problem(where.of(*each.path), each.message, each.help) for each in wrong]
    if problems:
        raise MarsError(problems)
    tables = changed(tables, changes)
    places = {key: where.of("requirements", key) for key in tables.get("requirements", ())}
    limits = tables["robot"].get("limits", ())
    places |= {function: where.of("robot", "limits", function) for function in limits}
    places["robot"] = where.of("robot", "module")
    if "start" in tables["robot"]:
        places["start"] = where.of("robot", "start")
    for table in ("bindings", "devices", "faults"):
        named = tables.get(table, ())
        places |= {f"{table}.{module}": where.of(table, module) for module in named}
    places |= {f"faults.{module}": CHANGED for module in switched_off(changes)}
    return Scenario(path, point(str(path), 1, 1), **tables, places=places)


def _problem(span: Span, message: str, help_text: str | None = None) -> Diagnostic:
    return Diagnostic("scenario", "error", message, span, (), help_text)
