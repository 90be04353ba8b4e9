r"""The file of a campaign: a header, a line for each run that has ended, and a summary at the end.

Every line is JSON and ends with `\n`. A command that continues a campaign reads the file: a last
line without its end is cut off, and so is a summary.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import isfinite
from types import UnionType
from typing import Any, NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.execution.campaign.grid import Run, run_name
from mars_asp.execution.campaign.summary import FAIL, NOT_DECIDED, PASS
from mars_asp.language.toml_text import unusable_part

FORMAT, VERSION = "mars-campaign", 1
#: Further keys of a run that are compared and counted.
COUNTED = ("collisions", "min_clearance_mm", "control_time", "turn_while_driving_s", "error")


class FinishedRun(NamedTuple):
    """A finished run: its line in the journal, with line feed, and the values to count."""

    line: bytes
    result: Mapping[str, Any]


@dataclass(frozen=True)
class Journal:
    """The contents of a file: the runs by their names, in order.

    The header and runs are the first `kept` bytes of the `size` bytes.
    """

    ended: Mapping[str, FinishedRun] = field(default_factory=dict)
    kept: int = 0
    size: int = 0


def header_of(configuration: str, scenario: str, tool: str) -> bytes:
    """Return the first line: hashes of configuration and scenario, and the tool's version."""
    return _json_line(
        {
            "format": FORMAT,
            "version": VERSION,
            "configuration": configuration,
            "scenario": scenario,
            "mars_asp": tool,
        }
    )


def ended_run(run: Run, result: Mapping[str, Any]) -> FinishedRun:
    """Return the journal line of a run; `result` is the JSON that `run` prints."""
    # The seed is first, so that it is easy to find.
    whole = {"seed": run.seed, "vary": run.vary, **result}
    return FinishedRun(_json_line(whole), _counted_values(whole))


def read_journal(raw: bytes, header: bytes, path: str) -> Journal:
    """Return the finished runs in the content `raw` of a campaign's file.

    Raises:
        MarsError: the file is not of a campaign, or has another header.
    """
    *lines, torn = raw.split(b"\n")
    if not lines:
        if header.startswith(torn):
            return Journal(size=len(raw))
        raise _journal_error(path, 1, "this is not the file of a campaign")
    _check_header(lines[0], header, path)
    ended: dict[str, FinishedRun] = {}
    kept = len(lines[0]) + 1
    for number, line in enumerate(lines[1:], 2):
        found = _object(line)
        if found is None or not ("runs" in found or _is_run(found)):
            text = "remove the line, and its run is carried out again; or begin anew with --fresh"
            raise _journal_error(path, number, "this line is not a run", text)
        if "runs" in found:
            if number < len(lines):
                raise _journal_error(path, number, "a summary is the last line")
            break
        ended.setdefault(
            run_name(found["seed"], found["vary"]),
            FinishedRun(line + b"\n", _counted_values(found)),
        )
        kept += len(line) + 1
    return Journal(ended, kept, len(raw))


def in_order(runs: Iterable[Run], ended: Mapping[str, FinishedRun]) -> list[FinishedRun]:
    """Return the finished runs in the order of `runs`, then runs that are no longer requested."""
    names = dict.fromkeys((*(run.name for run in runs), *ended))
    return [ended[name] for name in names if name in ended]


def whole_text(header: bytes, ended: Iterable[FinishedRun], summary: Mapping[str, Any]) -> bytes:
    """Return the content of the file of a finished campaign."""
    return b"".join((header, *(each.line for each in ended), _json_line(summary)))


def _check_header(line: bytes, header: bytes, path: str) -> None:
    found, ours = _object(line), json.loads(header)
    if found is None or found.get("format") != FORMAT:
        raise _journal_error(path, 1, "this is not the file of a campaign")
    if found.get("version") != VERSION:
        text = f"this file has version {found.get('version')!r:.20} of its format, not {VERSION}"
        raise _journal_error(path, 1, text)
    for key, what in (
        ("configuration", "another configuration: its files or sources have changed"),
        ("scenario", "another scenario: it or the code that it binds has changed"),
        ("mars_asp", "another version of mars-asp"),
    ):
        if found.get(key) != ours[key]:
            raise _journal_error(path, 1, f"the runs in this file are of {what}")


def _is_run(found: Mapping[str, Any]) -> bool:
    """Whether a JSON object has all values that are counted, with valid types."""
    robots, warnings = found.get("robots", []), found.get("warnings", [])
    return (
        _has_types(
            found,
            seed=int,
            vary=dict,
            collisions=int | None,
            control_time=dict,
            requirements=list,
            turn_while_driving_s=int | float | None,
        )
        and found.get("verdict") in (PASS, FAIL, NOT_DECIDED)
        and all(map(_is_finite, found["control_time"].values()))
        and _is_finite(found.get("min_clearance_mm") or 0)
        and all(_has_types(each, name=str, holds=bool | None) for each in found["requirements"])
        and isinstance(robots, list)
        and all(
            _has_types(
                each,
                name=str,
                reached_s=int | float | None,
                nearest_to_place_mm=int | float | None,
            )
            for each in robots
        )
        and isinstance(warnings, list)
        and all(_has_types(each, kind=str, subject=str) for each in warnings)
    )


def _has_types(found: object, **types: type | UnionType) -> bool:
    """Whether a value is an object whose keys have these types; an absent key counts as None."""
    return isinstance(found, dict) and all(
        isinstance(found.get(key), wanted) for key, wanted in types.items()
    )


def _is_finite(found: object) -> bool:
    return isinstance(found, int | float) and isfinite(found)


def _counted_values(whole: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a journal line that summaries need, to save memory.

    `places` has for each robot with a `reach` goal the time in seconds at which it was reached, or
    None, and the minimal distance (mm).
    """
    judged = [{"name": r["name"], "holds": r["holds"]} for r in whole["requirements"]]
    kept = {key: whole.get(key) for key in ("seed", "vary", "verdict", *COUNTED)}
    places = {
        each["name"]: (each["reached_s"], each["nearest_to_place_mm"])
        for each in whole.get("robots", [])
        if each["nearest_to_place_mm"] is not None
    }
    warnings = sorted({f"{each['kind']}({each['subject']})" for each in whole.get("warnings", [])})
    return {**kept, "requirements": judged, "places": places, "warnings": warnings}


def _object(line: bytes) -> dict[str, Any] | None:
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) and unusable_part(found) is None else None


def _json_line(value: Mapping[str, Any]) -> bytes:
    return json.dumps(value).encode() + b"\n"


def _journal_error(
    path: str, line: int, message: str, help_text: str = "--fresh begins the file anew"
) -> MarsError:
    span = point(path, line, 1)
    # Without an excerpt, as the line is very long.
    return MarsError([Diagnostic("campaign", "error", message, span, help=help_text, excerpt="")])
