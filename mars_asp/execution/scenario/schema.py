"""What stands in the lists of a scenario: points, circles, entries of a script."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS


@dataclass(frozen=True, slots=True)
class Form:
    """What a value should be, in words, and whether it is."""

    words: str
    fits: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _are_numbers(value: Any, count: int) -> bool:
    return isinstance(value, list) and len(value) == count and all(map(_is_number, value))


def _is_line(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(_are_numbers(at, 2) for at in value)


def _is_circle(value: Any) -> bool:
    return _are_numbers(value, 3) and value[2] > 0


def _is_function(value: Any) -> bool:
    return isinstance(value, str) and value in {*MOTION_FUNCTIONS, GRASP}


def _is_entry(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 3
        and _is_number(value[0])
        and _is_function(value[1])
        and _is_number(value[2])
    )


def _is_pair(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_function, value))


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


_POINT = Form("a point `[forward, side]`", lambda value: _are_numbers(value, 2))
_LINE = Form("a list of points `[forward, side]`", _is_line)
_FUNCTIONS = ", ".join((*MOTION_FUNCTIONS, GRASP))
#: The form of a list as a whole, by its table and key.
WHOLE: Mapping[tuple[str, str], Form] = {
    ("robot", "start"): Form("`[forward, side, heading]`", lambda value: _are_numbers(value, 3)),
    ("world.moving", "from"): _POINT,
    ("world.moving", "to"): _POINT,
    ("world.marks", "at"): _POINT,
    ("world.scatter", "radius"): Form("`[least, most]`", lambda value: _are_numbers(value, 2)),
    ("requirements.reach", "at"): _POINT,
}
#: The form of each entry of a list.
EACH: Mapping[tuple[str, str], Form] = {
    ("world", "walls"): _LINE,
    ("world", "polygons"): _LINE,
    ("world", "circles"): Form("`[forward, side, radius]`, the radius above 0", _is_circle),
    ("world", "moving"): Form("a table `{ from, to, radius, speed }`", _is_table),
    ("world", "marks"): Form("a table `{ at, colour }`", _is_table),
    ("devices", "script"): Form(f"`[second, function, rate]` of {_FUNCTIONS}", _is_entry),
    ("requirements", "exclusive"): Form(f"two functions of {_FUNCTIONS}", _is_pair),
}
#: The keys that a table cannot do without.
REQUIRED: Mapping[str, tuple[str, ...]] = {
    "world.moving": ("from", "to", "radius", "speed"),
    "world.marks": ("at", "colour"),
    "requirements.reach": ("at",),
}


def parts(table: str, key: str, value: Any) -> Iterator[tuple[int | None, Any]]:
    """Yield what is judged by itself: each entry of a list with its index, or the whole value."""
    if (table, key) in EACH:
        yield from enumerate(value)
    else:
        yield None, value


def unfit(table: str, key: str, value: Any) -> Iterator[tuple[int | None, Form]]:
    """Yield the index of each entry that has not its form, or `None` where the value has not."""
    form = EACH.get((table, key), WHOLE.get((table, key)))
    for index, part in parts(table, key, value) if form else ():
        if form and not form.fits(part):
            yield index, form


#: Keys of one table of which the first is at most as great as the second.
ORDERED: Mapping[str, tuple[tuple[str, str], ...]] = {
    "devices": (("low", "high"), ("low", "value"), ("value", "high")),
    "faults": (("from", "until"),),
}


def disordered(schema: str, table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the keys of a table whose numbers are in the wrong order."""
    for first, second in ORDERED.get(schema, ()):
        stated = [table[key] for key in (first, second) if _is_number(table.get(key))]
        if len(stated) == 2 and stated[0] > stated[1]:
            yield first, second
