"""The JSON Schema of scenarios; `docs/reference/scenarios.md` gives the meaning of each key."""

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeAlias

from jsonschema_rs import Draft4Validator, ValidationError
from jsonschema_rs import ValidationErrorKind as Kind

from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from mars_asp.spelling import suggestion

_Schema: TypeAlias = dict[str, Any]
#: Keys of tables and indices of lists, from the top of a scenario.
_Path: TypeAlias = tuple[str | int, ...]


def _number_schema(least: float | None = -1e9, most: float | None = 1e9) -> _Schema:
    return {"type": "number"} | _range_schema(least, most)


def _integer_schema(least: int, most: int) -> _Schema:
    return {"type": "integer"} | _range_schema(least, most)


def _range_schema(least: float | None, most: float | None) -> _Schema:
    declared = {"minimum": least, "maximum": most}
    return {key: bound for key, bound in declared.items() if bound is not None}


def _table_schema(keys: Mapping[str, _Schema], *required: str) -> _Schema:
    needed = {"required": list(required)} if required else {}
    return {"type": "object", "properties": dict(keys), "additionalProperties": False} | needed


def _table_by_module(table: _Schema) -> _Schema:
    """Return the schema of a table whose keys are modules and whose values are tables."""
    return {"type": "object", "additionalProperties": table}


def _row(*entries: _Schema) -> _Schema:
    """Return the schema of a list with exactly these entries."""
    size = len(entries)
    return {"type": "array", "items": list(entries), "minItems": size, "maxItems": size}


def _list(entry: _Schema) -> _Schema:
    return {"type": "array", "items": entry}


def _one_of(kinds: Mapping[str, str], *required: str) -> _Schema:
    """Return the schema of a table with a `kind`; `kinds` has the keys of each.

    The default is the first kind, unless `kind` is required.
    """
    first = next(iter(kinds))
    return {
        "oneOf": [
            _table_schema(
                {"kind": {"enum": [kind]}} | {key: _KEYS[key] for key in keys.split()},
                *(required if kind == first else ["kind"]),
            )
            for kind, keys in kinds.items()
        ]
    }


def _with_description(words: str, schema: _Schema) -> _Schema:
    """Return a schema with the description of a valid value, which messages show."""
    return {"description": words} | schema


#: The entry of a script that releases a joystick, instead of a function and its rate.
RELEASE = "release"
_ANY = _number_schema(None, None)
_POSITIVE = _number_schema(0)
_WORD = {"type": "string"}
_FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
_FUNCTION = {"enum": list(_FUNCTIONS)}
_PAIR = _row(_number_schema(), _number_schema())
_POINT = _with_description("a point `[forward, side]`", _PAIR)
_WALL = _with_description(
    "a list of 2 or more points `[forward, side]`", _list(_PAIR) | {"minItems": 2}
)
_POLYGON = _with_description(
    "a list of 3 or more points `[forward, side]`", _list(_PAIR) | {"minItems": 3}
)
_CIRCLE = _with_description(
    "`[forward, side, radius]`, the radius above 0",
    _row(_number_schema(), _number_schema(), _number_schema(0) | {"exclusiveMinimum": True}),
)
_ENTRY = _with_description(
    f'`[second, function, rate]` of {", ".join(_FUNCTIONS)}, or `[second, "{RELEASE}"]`',
    {
        "anyOf": [
            _row(_number_schema(0), _FUNCTION, _number_schema()),
            _row(_number_schema(0), {"enum": [RELEASE]}),
        ]
    },
)
_MOVING = _with_description(
    "a table `{ from, to, radius, speed }`, or `{ way, radius, speed }` with a way of points",
    _table_schema(
        {
            "from": _POINT,
            "to": _POINT,
            "way": _with_description(
                "a list of at least two points", _list(_PAIR) | {"minItems": 2}
            ),
            "radius": _POSITIVE,
            "speed": _POSITIVE,
        },
        *("radius", "speed"),
    )
    | {
        "anyOf": [{"required": ["from", "to"]}, {"required": ["way"]}],
        "not": {"anyOf": [{"required": [end, "way"]} for end in ("from", "to")]},
    },
)
_MARK = _with_description(
    "a table `{ at, colour }`", _table_schema({"at": _POINT, "colour": _WORD}, "at", "colour")
)
_SCATTER = _table_schema(
    {
        "count": _integer_schema(0, 100_000),
        "radius": _with_description("`[least, most]`", _row(_POSITIVE, _POSITIVE)),
        "within": _POSITIVE,
        "free": _POSITIVE,
        "moving": _integer_schema(0, 100_000),
        # It turns every 2000 mm, so at most as often as obstacles of `moving`.
        "speed": _number_schema(0, 2e6),
    }
)
_WORLD = _table_schema(
    {
        "walls": _list(_WALL),
        "polygons": _list(_POLYGON),
        "circles": _list(_CIRCLE),
        "moving": _list(_MOVING),
        "marks": _list(_MARK),
        "scatter": _SCATTER,
    }
)
_REACH = _table_schema({"at": _POINT, "radius": _POSITIVE, "within": _POSITIVE}, "at")
_GRADUAL = _table_schema(dict.fromkeys(MOTION_FUNCTIONS, _number_schema(0.001)))
_ROBOT = _table_schema(
    {
        "name": _with_description("a name of at least one character", _WORD | {"minLength": 1}),
        "module": _WORD,
        "radius": _POSITIVE,
        "start": _with_description("`[forward, side, heading]`", _row(*3 * [_number_schema()])),
        "limits": _table_schema(dict.fromkeys(_FUNCTIONS, _number_schema())),
        "acceleration": _GRADUAL,
        "deceleration": _GRADUAL,
        "reach": _REACH,
    },
    "module",
)
_KEYS: Mapping[str, _Schema] = {
    "period": _number_schema(0.001),
    "beams": _integer_schema(1, 100_000),
    "cone": _number_schema(),
    "rays": _integer_schema(1, 100_000),
    "reach": _POSITIVE,
    "view": _number_schema(),
    "sigma": _POSITIVE,
    "script": _list(_ENTRY),
    "function": _FUNCTION,
    "low": _ANY,
    "high": _ANY,
    "rate": _number_schema(0, None),
    "value": _number_schema(),
    "from": _number_schema(),
    "until": _number_schema(0, None),
    "by": _number_schema(0.001),
}
_MOVED = "function low high rate value"
_DEVICE = _one_of(
    {
        "sonar": "period beams cone rays reach sigma",
        "lidar": "period beams view reach sigma",
        "bumper": "period",
        "odometry": "period sigma",
        "marks": "period view reach",
        "joystick": "period script",
        "platform": "",
        "joint": _MOVED,
        "gripper": _MOVED,
    },
    "kind",
)
_BINDING = _table_schema(
    {
        "python": _with_description(
            '`"FILE.py:FUNCTION"`, `"FILE.py:CLASS"` or `"FILE.py:CLASS.METHOD"`',
            {"type": "string", "pattern": r"^[^\n]+\.py:[^:.\s]+(\.[^:.\s]+)*$"},
        ),
        "period": _number_schema(0.001),
        "delay": _POSITIVE,
        "parameters": {"type": "object"},
    }
)
_FAULT = _one_of(
    {
        "silent": "from until",
        "stuck": "from until",
        "throwing": "from until",
        "late": "by",
        "babbling": "by",
    },
)
_REQUIREMENTS = _table_schema(
    {
        "no_collision": {"type": "boolean"},
        "clearance": _POSITIVE,
        "reach": _REACH,
        "exclusive": _list(
            _with_description(
                f"two functions of {', '.join(_FUNCTIONS)}", _row(_FUNCTION, _FUNCTION)
            )
        ),
        "coverage": _number_schema(0, 1),
    }
)


def _scenario(robot: _Schema) -> _Schema:
    """Return the schema of scenarios with this schema of `robot`."""
    keys = {
        "seed": _integer_schema(-(2**63), 2**63 - 1),
        "duration": _number_schema(0.001),
        "up": {"enum": ["y", "z"]},
        # With 0, commands that no arbiter holds would never be obeyed.
        "command_timeout": _number_schema(0.001),
        "world": _WORLD,
        "robot": robot,
        "devices": _table_by_module(_DEVICE),
        "bindings": _table_by_module(_BINDING),
        "faults": _table_by_module(_FAULT),
        "requirements": _REQUIREMENTS,
    }
    draft = "http://json-schema.org/draft-04/schema#"
    title = "A scenario of mars-asp"
    return {"$schema": draft, "title": title, **_table_schema(keys, "robot", "duration")}


_ROBOTS = _with_description(
    "a table or a list of tables, at least one", _list(_ROBOT) | {"minItems": 1}
)
#: The schemas for one robot and for several.
_ONE, _SEVERAL = _scenario(_ROBOT), _scenario(_ROBOTS)
SCHEMA = _scenario({"anyOf": [_ROBOT, _ROBOTS]})
#: Types of the schema, as messages name them.
_TYPES = {
    "object": "a table",
    "array": "a list",
    "number": "a number",
    "integer": "a whole number",
    "string": "a string",
    "boolean": "true or false",
}
#: Replaces infinite numbers, which JSON cannot express.
_ENDLESS = 1.7e308
#: Maximal depth of tables and lists, above that of any valid scenario.
_DEEPEST = 10


class Mistake(NamedTuple):
    """A mistake in a scenario: its path, a message and help."""

    path: _Path
    message: str
    help: str | None = None


def mistakes(tables: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield each violation of the schema by a scenario once."""
    entries: set[Mistake] = set()
    for error in Draft4Validator(_whole_schema(tables)).iter_errors(_as_json(tables)):
        path = tuple(error.instance_path)
        for mistake in _mistakes(error, path, tables):
            if mistake not in entries:  # several parts of one value can be wrong
                entries.add(mistake)
                yield mistake


def _as_json(value: Any, depth: int = 0) -> Any:
    """Return a value of TOML as JSON, with invalid substitutes for dates, NaN and infinity."""
    if isinstance(value, dict | list) and depth < _DEEPEST:
        if isinstance(value, list):
            return [_as_json(each, depth + 1) for each in value]
        return {key: _as_json(each, depth + 1) for key, each in value.items()}
    if isinstance(value, float) and math.isinf(value):
        return math.copysign(_ENDLESS, value)
    return value if isinstance(value, str | int | float) and not _is_nan(value) else None


def _mistakes(error: ValidationError, path: _Path, tables: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield the mistakes that cause an error of the validator at a path."""
    kind = error.kind
    key = str(next((part for part in reversed(path) if isinstance(part, str)), ""))
    schema, value = _schema(path, tables), _value_at(path, tables)
    form = _misformed_value(path, tables)
    if isinstance(kind, Kind.OneOfNotValid):
        for inner in Draft4Validator(schema).iter_errors(_as_json(value)):
            yield from _mistakes(inner, (*path, *inner.instance_path), tables)
    elif isinstance(kind, Kind.AdditionalProperties):
        for unknown in kind.unexpected:
            yield _unknown_key((*path, unknown), unknown, schema["properties"], tables)
    elif isinstance(kind, Kind.Required):
        missing, owner = kind.property, f"`{key}`" if path else "the scenario"
        choices = schema["properties"][missing].get("enum")
        help_text = f"one of {', '.join(choices)}" if choices else None
        yield Mistake(path, f"{owner} has no `{missing}`", help_text)
    elif _is_beyond(kind, schema, value):
        least, most = schema.get("minimum", -math.inf), schema.get("maximum", math.inf)
        message = f"`{value}` is out of range for `{key}`"
        yield Mistake(path, message, f"from {_plainly(least)} to {_plainly(most)}")
    elif form is not None:
        owner = f"`{key}`" if isinstance(form[-1], str) else f"an entry of `{key}`"
        yield Mistake(form, f"{owner} must be {_schema(form, tables)['description']}")
    elif isinstance(kind, Kind.Enum) and isinstance(value, str):
        choices = schema["enum"]
        message = f"`{key}` must be {', '.join(choices[:-1])} or {choices[-1]}, found `{value}`"
        yield Mistake(path, message, suggestion(value, choices, None))
    else:
        wanted = schema.get("type", "string")
        yield Mistake(path, f"`{key}` must be {_TYPES[wanted]}")


def _whole_schema(tables: Mapping[str, Any]) -> _Schema:
    """Return the schema for one robot or several: its errors are clearer than of `SCHEMA`."""
    return _SEVERAL if isinstance(tables.get("robot"), list) else _ONE


def _unknown_key(
    path: _Path, key: str, known: Mapping[str, _Schema], tables: Mapping[str, Any]
) -> Mistake:
    """Return the mistake for an unknown key, or a key of another kind of table."""
    table = path[:-1]
    kinds = _plain_schema(table, tables).get("oneOf", ())
    others = [each["properties"]["kind"]["enum"][0] for each in kinds if key in each["properties"]]
    own = known.get("kind", {}).get("enum", ())
    if others and len(own) == 1:
        message = f"`{key}` is not a key of the kind `{own[0]}`"
        return Mistake(path, message, f"it belongs to {', '.join(others)}")
    help_text = suggestion(key, known, f"one of {', '.join(known)}")
    return Mistake(path, f"unknown key `{key}`", help_text)


def _schema(path: _Path, tables: Mapping[str, Any]) -> _Schema:
    """Return the schema of a path in a scenario; of a table, that of the stated kind."""
    schema = _plain_schema(path, tables)
    return _of_kind(schema, _value_at(path, tables)) if "oneOf" in schema else schema


def _plain_schema(path: _Path, tables: Mapping[str, Any]) -> _Schema:
    """Return the schema of a path, with all kinds of a table."""
    schema = _whole_schema(tables)
    for count, part in enumerate(path, 1):
        if "oneOf" in schema:
            schema = _of_kind(schema, _value_at(path[: count - 1], tables))
        if isinstance(part, str):
            schema = schema.get("properties", {}).get(part) or schema["additionalProperties"]
        else:
            items = schema["items"]
            schema = items[part] if isinstance(items, list) else items
    return schema


def _of_kind(schema: _Schema, value: Any) -> _Schema:
    """Return the schema of the stated kind of table, or one with all kinds and all keys."""
    first, *_ = kinds = schema["oneOf"]
    declared = value.get("kind") if isinstance(value, dict) else None
    if declared is None and "required" not in first and isinstance(value, dict):
        return dict(first)
    for each in kinds:
        if each["properties"]["kind"]["enum"] == [declared]:
            return dict(each)
    named = [each["properties"]["kind"]["enum"][0] for each in kinds]
    keys = {key: inner for each in kinds for key, inner in each["properties"].items()}
    return _table_schema(keys | {"kind": {"enum": named}}, *first.get("required", ()))


def _value_at(path: _Path, value: Any) -> Any:
    """Return the value at a path in a scenario."""
    for part in path:
        value = value[part]
    return value


def _misformed_value(path: _Path, tables: Mapping[str, Any]) -> _Path | None:
    """Return the path of the described value that contains a wrong part, or None."""
    for count in range(len(path), 0, -1):
        if "description" in _schema(path[:count], tables):
            return path[:count]
        if isinstance(path[count - 1], str):
            return None
    return None


def _is_beyond(kind: Kind, schema: _Schema, value: object) -> bool:
    """Whether the error is a number out of range, rather than a wrong type."""
    if isinstance(kind, Kind.Minimum | Kind.Maximum):
        return schema["type"] == "number" or isinstance(value, int)
    return _is_nan(value)


def _is_nan(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _plainly(bound: float) -> str:
    """Return a bound without an exponent: 1e9 as `1000000000`."""
    return f"{bound:.0f}" if float(bound).is_integer() else f"{bound:g}"
