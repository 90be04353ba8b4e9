"""Checks that a schema cannot express: contradictions and values without effect."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise, starmap
from math import dist, inf
from typing import Any

from mars_asp.execution.scenario.schema import Mistake

#: Pairs of keys of one table; the first value may not be greater than the second.
_ORDERED: Mapping[str, Sequence[tuple[str, str]]] = {
    "devices": (("low", "high"), ("low", "value"), ("value", "high")),
    "faults": (("from", "until"),),
}
#: Minimal number of different points of a wall and a polygon.
_POINTS = {"walls": 2, "polygons": 3}
#: Default number of circles of `scatter`.
SCATTERED = 10
#: Maximal number of turns of an obstacle in a second: each turn near a robot costs time.
_MOST_TURNS = 1000


def contradictions(tables: Mapping[str, Any], wrong: Iterable[Mistake]) -> Iterator[Mistake]:
    """Yield contradictory values of a scenario; the known mistakes `wrong` are skipped."""
    sound = tables
    for mistake in wrong:
        sound = _without(sound, mistake.path) if mistake.path else sound
    duration = sound.get("duration", inf)
    yield from _disordered(sound)
    for name in sound.get("bindings", {}).keys() & sound.get("devices", {}).keys():
        message = f"`{name}` has a binding and a device"
        yield Mistake(("bindings", name), message, "remove one: a device needs no function")
    for name, start in late_faults(sound.get("faults", {}), duration):
        message = f"the fault of `{name}` begins at {start:g} s, and the run ends at {duration:g} s"
        yield Mistake(("faults", name, "from"), message, "let it begin earlier")
    yield from _contradictory_links(sound.get("links", ()), duration)
    for name, device in sound.get("devices", {}).items():
        for number, entry_message, help_text in _misplaced(device.get("script", ()), duration):
            message = f"the script of `{name}` has {entry_message}"
            yield Mistake(("devices", name, "script", number), message, help_text)
    yield from _shapeless(sound.get("world", {}))
    if scatter := sound.get("world", {}).get("scatter"):
        # Do not compare with an invalid count.
        unknown = "count" in tables["world"]["scatter"]
        yield from _scattered({"count": inf if unknown else SCATTERED} | scatter)


def late_faults(faults: Mapping[str, Any], duration: float) -> Iterator[tuple[str, float]]:
    """Yield each module whose fault begins after the end of a run, with its begin in seconds."""
    for name, fault in faults.items():
        if fault.get("from", 0) >= duration:
            yield name, fault["from"]


def _without(table: Mapping[str, Any], path: Sequence[str | int]) -> Mapping[str, Any]:
    """Return a copy of a table without the value at a path; a list entry becomes None."""
    key, *rest = path
    inner = table.get(str(key))
    if not rest:
        return {name: value for name, value in table.items() if name != key}
    if isinstance(inner, list):
        kept = [None if number == rest[0] else entry for number, entry in enumerate(inner)]
        return {**table, str(key): kept}
    return {**table, str(key): _without(inner, rest)} if isinstance(inner, dict) else table


def _disordered(sound: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield the keys of a table whose numbers are in the wrong order."""
    for name, pairs in _ORDERED.items():
        for module, table in sound.get(name, {}).items():
            for first, second in pairs:
                low, high = table.get(first), table.get(second)
                if low is None or high is None:
                    continue
                if low > high:
                    message = f"`{first}` is {low}, above `{second}`, which is {high}"
                    yield Mistake((name, module, first), message, "swap or change them")
                elif low == high and name == "faults":
                    message = f"the fault of `{module}` ends at {high:g} s, when it begins"
                    yield Mistake((name, module, second), message, "let it end later")


def _contradictory_links(links: Sequence[Any], duration: float) -> Iterator[Mistake]:
    """Yield faults of links that end when they begin, begin after the end or overlap."""
    spans: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for number, entry in enumerate(links):
        if entry is None or not {"from", "to"} <= entry.keys():
            continue
        ends = entry["from"], entry["to"]
        since, until = entry.get("since", 0), entry.get("until", inf)
        link = "`{} -> {}`".format(*ends)
        if until <= since:
            message = f"the fault of {link} ends at {until:g} s, and begins at {since:g} s"
            yield Mistake(("links", number, "until"), message, "let it end later")
        elif since >= duration:
            message = (
                f"the fault of {link} begins at {since:g} s, and the run ends at {duration:g} s"
            )
            yield Mistake(("links", number, "since"), message, "let it begin earlier")
        elif any(since < end and begin < until for begin, end in spans.get(ends, ())):
            message = f"two faults of {link} are there at {since:g} s"
            help_text = "state one for each period, by `since` and `until`"
            yield Mistake(("links", number), message, help_text)
        spans.setdefault(ends, []).append((since, until))


def _misplaced(script: Sequence[Any], duration: float) -> Iterator[tuple[int, str, str]]:
    """Yield index, message and help of each entry of a script that is too early or too late."""
    timed = [(number, entry[0]) for number, entry in enumerate(script) if entry is not None]
    for (_, before), (number, at) in pairwise(timed):
        if at <= before:
            message = f"an entry at {at:g} s after one at {before:g} s"
            yield number, message, "list the entries by their times"
    for number, at in timed:
        if at > duration:
            message = f"an entry at {at:g} s, and the run ends at {duration:g} s"
            yield number, message, "remove it, or lengthen `duration`"


def _shapeless(world: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield walls and polygons with too few points, and obstacles whose motion is invalid."""
    for key, least in _POINTS.items():
        for number, line in enumerate(world.get(key, ())):
            if line is not None and len(set(map(tuple, line))) < least:
                message = f"an entry of `{key}` has fewer than {least} different points"
                yield Mistake(("world", key, number), message, "its corners, one after the other")
    for number, moving in enumerate(world.get("moving", ())):
        if moving is None:
            continue
        way = moving.get("way") or [moving[key] for key in ("from", "to") if key in moving]
        if all(point == way[0] for point in way):
            message = "an obstacle of `moving` ends where it begins"
            yield Mistake(("world", "moving", number), message, "list it under `circles`")
            continue
        turns = moving.get("speed", 0) * (len(way) - 1) / sum(starmap(dist, pairwise(way)))
        if turns > _MOST_TURNS:
            message = f"an obstacle of `moving` turns more than {_MOST_TURNS} times a second"
            help_text = "lower its `speed`, or let it go further"
            yield Mistake(("world", "moving", number), message, help_text)


def _scattered(scatter: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield the contradictions of `scatter`: too many moving circles, or radii out of order."""
    count, moving = scatter["count"], scatter.get("moving", 0)
    if moving > count:
        message = f"`moving` is {moving}, and `scatter` makes {count} obstacles"
        yield Mistake(("world", "scatter", "moving"), message, "raise `count`, or lower `moving`")
    least, most = scatter.get("radius", (0, inf))
    if None not in (least, most) and least > most:
        message = f"the least `radius` is {least}, above the greatest, which is {most}"
        yield Mistake(("world", "scatter", "radius"), message, "swap or change them")
