"""Mistakes in scenarios by their JSON Schema, `scenario.schema.json`.

`docs/reference/scenarios.md` gives the meaning of each key. A description in the schema is that of
a valid value, which messages show.
"""

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from jsonschema_rs import Draft4Validator, ValidationError
from jsonschema_rs import ValidationErrorKind as Kind

from mars_asp.spelling import suggestion

_Schema: TypeAlias = dict[str, Any]
#: Keys of tables and indices of lists, from the top of a scenario.
_Path: TypeAlias = tuple[str | int, ...]


def _inlined(schema: Any, definitions: Mapping[str, _Schema]) -> Any:
    """Return a schema with definitions in place of references, so that paths lead through it."""
    if isinstance(schema, list):
        return [_inlined(each, definitions) for each in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        return _inlined(definitions[schema["$ref"].removeprefix("#/definitions/")], definitions)
    return {key: _inlined(each, definitions) for key, each in schema.items()}


_FILE = json.loads(Path(__file__).with_name("scenario.schema.json").read_bytes())
_DEFINITIONS = _FILE.pop("definitions")
SCHEMA: _Schema = _inlined(_FILE, _DEFINITIONS)


def _with_robot(robot: _Schema) -> _Schema:
    """Return the schema of scenarios in which `robot` has this schema."""
    return SCHEMA | {"properties": SCHEMA["properties"] | {"robot": robot}}


#: Of one robot, or of several.
_ONE, _SEVERAL = map(_with_robot, SCHEMA["properties"]["robot"]["anyOf"])
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
    """Yield each violation of the schema by a scenario, without duplicates."""
    entries: set[Mistake] = set()
    for error in Draft4Validator(_whole_schema(tables)).iter_errors(_as_json(tables)):
        path = tuple(error.instance_path)
        for mistake in _mistakes(error, path, tables):
            if mistake not in entries:  # several parts of one value can be wrong
                entries.add(mistake)
                yield mistake


def _as_json(value: Any, depth: int = 0) -> Any:
    """Return a TOML value as JSON, where dates, NaN and infinity become invalid values."""
    if isinstance(value, dict | list) and depth < _DEEPEST:
        if isinstance(value, list):
            return [_as_json(each, depth + 1) for each in value]
        return {key: _as_json(each, depth + 1) for key, each in value.items()}
    if isinstance(value, float) and math.isinf(value):
        return math.copysign(_ENDLESS, value)
    return value if isinstance(value, str | int | float) and not _is_nan(value) else None


def _mistakes(error: ValidationError, path: _Path, tables: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield the mistakes for an error that the validator reports at a path."""
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
    """Return the schema for one robot or for several, which gives clearer errors than `SCHEMA`."""
    return _SEVERAL if isinstance(tables.get("robot"), list) else _ONE


def _unknown_key(
    path: _Path, key: str, known: Mapping[str, _Schema], tables: Mapping[str, Any]
) -> Mistake:
    """Return the mistake that a key is unknown, or belongs to another kind of table."""
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
    """Return the schema of the value at a path; tables have that of their stated kind."""
    schema = _plain_schema(path, tables)
    return _of_kind(schema, _value_at(path, tables)) if "oneOf" in schema else schema


def _plain_schema(path: _Path, tables: Mapping[str, Any]) -> _Schema:
    """Return the schema of the value at a path; tables have one with all their kinds."""
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
    """Return the schema of the kind that a table states, or one with all kinds and keys."""
    first, *_ = kinds = schema["oneOf"]
    declared = value.get("kind") if isinstance(value, dict) else None
    if declared is None and "required" not in first and isinstance(value, dict):
        return dict(first)
    for each in kinds:
        if each["properties"]["kind"]["enum"] == [declared]:
            return dict(each)
    named = [each["properties"]["kind"]["enum"][0] for each in kinds]
    keys = {key: inner for each in kinds for key, inner in each["properties"].items()}
    return dict(first) | {"properties": keys | {"kind": {"enum": named}}}


def _value_at(path: _Path, value: Any) -> Any:
    """Return the value at a path in a scenario."""
    for part in path:
        value = value[part]
    return value


def _misformed_value(path: _Path, tables: Mapping[str, Any]) -> _Path | None:
    """Return the path of a wrong value or nearest list around it with a description, or None."""
    for count in range(len(path), 0, -1):
        if "description" in _schema(path[:count], tables):
            return path[:count]
        if isinstance(path[count - 1], str):
            return None
    return None


def _is_beyond(kind: Kind, schema: _Schema, value: object) -> bool:
    """Whether an error of the validator is a number out of range, not a wrong type."""
    if isinstance(kind, Kind.Minimum | Kind.Maximum):
        return schema["type"] == "number" or isinstance(value, int)
    return _is_nan(value)


def _is_nan(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _plainly(bound: float) -> str:
    """Return a bound as text: a whole number in all its digits, 1e9 as `1000000000`."""
    return str(int(bound)) if float(bound).is_integer() else f"{bound:g}"
