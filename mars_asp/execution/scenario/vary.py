"""Changed values of the keys of a scenario, as in `--vary`.

A key is dotted as in TOML; a number is an index of a list, as in `world.moving.0.speed`. The key
`modules.NAME` is `on` or `off`: a module that is off sends nothing.
"""

import copy
import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from math import inf, isfinite
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

from mars_asp.diagnostic import MarsError, refusal, whole_file
from mars_asp.execution.scenario.contradictions import contradictions
from mars_asp.execution.scenario.schema import Mistake, mistakes
from mars_asp.language.toml_text import unusable_part
from mars_asp.output import encodable
from mars_asp.spelling import nearest, suggestion

#: Values by their dotted keys.
Changes: TypeAlias = Mapping[str, Any]
UNCHANGED: Changes = MappingProxyType({})
#: The location of values that are not in the text of the scenario.
CHANGED = whole_file("--vary")
#: The first part of the keys that switch modules; scenarios do not have this key.
MODULES = "modules"
ON, OFF = "on", "off"
#: Maximal number of parts of a key, above that of any valid key.
_MOST_PARTS = 100
#: The fault of a module that is off: it is silent in the whole run.
_SILENT = {"kind": "silent", "from": 0, "until": inf}
_HELP = (
    "write KEY=VALUE, as in `robot.radius=150` or `modules.Collide=off`; values are as in TOML, so "
    "text is in quotes"
)


class Axis(NamedTuple):
    """A key of the scenario, and the values that runs use for it."""

    key: str
    values: tuple[Any, ...]

    @property
    def only(self) -> Any:
        """The only value.

        Raises:
            MarsError: there are several values.
        """
        if len(self.values) > 1:
            help_text = "give it one; `mars-asp campaign` runs all of them"
            raise _variation_error(f"`{self.key}` has {len(self.values)} values", help_text)
        return self.values[0]


def read_axes(texts: Iterable[str]) -> tuple[Axis, ...]:
    """Return the axes of several `--vary` options.

    Raises:
        MarsError: an option is malformed, or two have the same key.
    """
    axes: dict[tuple[str, ...], Axis] = {}
    for text in texts:
        axis = read_axis(text)
        if axes.setdefault(key_path(axis.key), axis) is not axis:
            raise _variation_error(
                f"`{axis.key}` is varied twice", "give all values at once: KEY=A,B"
            )
    return tuple(axes.values())


def read_axis(text: str) -> Axis:
    """Return the axis of `KEY=VALUE,VALUE,...`; values are as in TOML.

    Raises:
        MarsError: the text does not have this form.
    """
    key, equals, written = text.partition("=")
    key = key.strip()
    if encodable(text) != text:
        raise _variation_error(f"`{text}` is not UTF-8", _HELP)
    if key.count(".") > _MOST_PARTS:
        raise _variation_error(f"`{key}` has more than {_MOST_PARTS} parts", _HELP)
    try:
        path = key_path(key)
        if path[0] == MODULES:
            values = [word.strip() for word in written.split(",")]
        else:
            tables = tomllib.loads(f"values = [{written}\n]")
            values = tables["values"] if tables.keys() == {"values"} else []
    except (ValueError, RecursionError):
        path, values = (), []
    if (unusable := unusable_part(values)) is not None:
        raise _variation_error(f"`{key}` has {unusable[1]}", _HELP)
    if not equals or not path or not values:
        raise _variation_error(f"`{text}` is not a key and its values", _HELP)
    if key == "seed":
        raise _variation_error(
            "the seed is not a key to vary", "use --seeds, or --seed for one run"
        )
    if path[0] == MODULES and (len(path) != 2 or not {*values} <= {ON, OFF}):
        message = f"`{text}` does not switch a module"
        raise _variation_error(message, "write `modules.NAME=off` or `modules.NAME=on,off`")
    if any(map(_is_endless, values)):
        raise _variation_error(f"`{text}` has a value without an end", "leave out `inf` and `nan`")
    for number, value in enumerate(values):
        # 100 and 100.0 are one value, true and 1 are two.
        kind = isinstance(value, bool)
        if any(value == each and kind == isinstance(each, bool) for each in values[:number]):
            raise _variation_error(f"`{key}` has the value {written_value(value)} twice", None)
    return Axis(key, tuple(values))


def _is_endless(value: Any) -> bool:
    """Whether a value contains an infinite number or NaN, which JSON cannot express."""
    if isinstance(value, dict | list):
        return any(map(_is_endless, value.values() if isinstance(value, dict) else value))
    return isinstance(value, float) and not isfinite(value)


def written_value(value: Any) -> str:
    """Return a value as TOML."""
    match value:
        case bool():
            return str(value).lower()
        case dict():
            parts = (f"{_toml_string(key)} = {written_value(each)}" for key, each in value.items())
            return f"{{ {', '.join(parts)} }}"
        case list():
            return f"[{', '.join(map(written_value, value))}]"
        case str():
            return _toml_string(value)
    return str(value)


def written_change(key: str, value: Any) -> str:
    """Return a key and its value as `--vary` expects them."""
    word = value if key.startswith(f"{MODULES}.") else written_value(value)
    return f"{key}={word}"


def _toml_string(text: str) -> str:
    """Return a text as a basic string of TOML, whose escapes include those of JSON."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key_path(key: str) -> tuple[str, ...]:
    """Return the parts of a dotted key.

    Raises:
        ValueError: the key is malformed.
    """
    parts: list[str] = []
    tables: Any = tomllib.loads(f"{key} = 0")
    while isinstance(tables, dict):
        if len(tables) != 1:
            raise ValueError(key)
        ((part, tables),) = tables.items()
        parts.append(part)
    return tuple(parts)


def changed(tables: dict[str, Any], changes: Changes) -> dict[str, Any]:
    """Return a copy of the tables of a scenario with changed values.

    Raises:
        MarsError: with all invalid keys and values.
    """
    if not changes:
        return tables
    tables = copy.deepcopy(tables)
    wrong: list[Mistake] = []
    places: dict[tuple[str | int, ...], str] = {}
    for key, value in changes.items():
        path, switch = key_path(key), None
        if path[0] == MODULES:
            if value == ON:
                continue
            path, switch = ("faults", path[1]), _SILENT
        try:
            place = _set(tables, path, switch or value)
            if (first := places.setdefault(place, key)) != key:
                raise _NoSuchKeyError(f"this is the same key as `{first}`", "state it once")
        except _NoSuchKeyError as error:
            wrong.append(Mistake((), f"`{key}`: {error.message}", error.help))
    # The tables without changes were valid.
    wrong = wrong or list(mistakes(tables)) or list(contradictions(tables, ()))
    found = [_variation_error(each.message, each.help) for each in wrong]
    if found:
        raise MarsError(each.diagnostics[0] for each in found)
    return tables


def switched_off(changes: Changes) -> Iterator[str]:
    """Yield the names of the modules that are switched off."""
    for key, value in changes.items():
        path = key_path(key)
        if path[0] == MODULES and value == OFF:
            yield path[1]


class _NoSuchKeyError(Exception):
    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.message, self.help = message, help


def _set(tables: dict[str, Any], path: tuple[str, ...], value: Any) -> tuple[str | int, ...]:
    """Set the value at a path of tables, in which robots may be named.

    Return the path with indices instead of names. Missing tables are created, except for devices:
    an unknown device is an error.
    """
    at: Any = tables
    found: list[str | int] = []
    for part in path[:-1]:
        step = _next_key(at, part, found)
        if isinstance(at, dict) and step not in at:
            if found == ["devices"]:
                hint = suggestion(part, at, f"one of {', '.join(at)}")
                raise _NoSuchKeyError(f"the scenario has no device `{part}`", hint if at else None)
            at[step] = {}
        found.append(step)
        at = at[step]
    last = _next_key(at, path[-1], found)
    at[last] = copy.deepcopy(value)
    return *found, last


def _next_key(at: Any, part: str, found: list[str | int]) -> str | int:
    """Return the key or list index that `part` means in a table or list; `found` is its path."""
    name = ".".join(map(str, found))
    if isinstance(at, dict):
        return part
    if not isinstance(at, list):
        raise _NoSuchKeyError(f"`{name}` is {written_value(at)}, not a table")
    if not (part.isdecimal() and part.isascii() and int(part) < len(at)):
        if found == ["robot"]:
            return _robot_number(at, part)
        count = len(at)
        last = f"its entries are 0 to {count - 1}" if count > 1 else "its one entry is 0"
        entries = last if count else "it is empty"
        raise _NoSuchKeyError(f"`{part}` is not an entry of the list `{name}`", entries)
    return int(part)


def _robot_number(robots: list[Any], part: str) -> int:
    """Return the index of the robot with a name."""
    names = [str(robot.get("name", robot["module"])) for robot in robots]
    if part in names:
        return names.index(part)
    written = [
        name if re.fullmatch(r"[\w-]+", name, re.ASCII) else _toml_string(name) for name in names
    ]
    near = nearest(part, names)
    result = written[names.index(near)] if near else written[0]
    shown = f"one of {', '.join(written)}, as in `robot.{result}.radius`"
    raise _NoSuchKeyError(f"there are several robots, and none is named `{part}`", shown)


def _variation_error(message: str, help_text: str | None) -> MarsError:
    return refusal("scenario", message, CHANGED.path, help_text)
