"""A run as an HTML report: verdict, diagram, requirements, and winners at arbiters."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import Any
from urllib.parse import quote

from mars_asp.cli.winners import Row, in_turn
from mars_asp.draw.page import whole_page
from mars_asp.output import counted, visible

#: Longer tables are cut, with a note.
MOST_ROWS = 1_000
#: The title of the effects of side lines.
_ASIDE = "Gates, locks and limits"
_HOLDS = {True: "holds", False: "violated", None: "not decided"}
#: The class and sign of each verdict, and the state of the requirements that it lists.
_VERDICTS: Mapping[str, tuple[str, str, bool | None]] = {
    "pass": ("passed", "✔", True),
    "fail": ("failed", "✖", False),
    "not decided": ("undecided", "?", None),
}


def report_page(
    run: Mapping[str, Any],
    picture: str,
    title: str,
    replay: str | None,
    reasons: Sequence[tuple[str, str]] = (),
) -> str:
    """Return an HTML report of a run; `run` is its JSON, `replay` a link to its replay or None.

    `reasons` are the effects of Gates, locks and limits, each with its line. The report runs no
    script and fetches nothing.
    """
    style, page = (
        (files("mars_asp.cli") / f"run_report.{each}").read_text("utf-8")
        for each in ("css", "html")
    )
    title = f"{title}: {run['verdict']}"
    body = Template(page).substitute(
        title=_html_text(title),
        verdict=_verdict(run),
        summary=_html_text(_summary(run)),
        replay=f'<p><a href="{escape(replay)}">Play it</a></p>' if replay else "",
        sections="\n".join((*_sections(run), *_html_table(_ASIDE, ("", "line"), reasons))),
        picture=picture,
    )
    return whole_page(title, style, body)


def replay_seen_from(report: str, replay: str) -> str:
    """Return the link from a report to a replay, both given by path."""
    folder = os.path.dirname(os.path.abspath(report))  # noqa: PTH100, PTH120 -- a path of others
    return quote(os.fsencode(os.path.relpath(replay, folder)))


def _verdict(run: Mapping[str, Any]) -> str:
    """Return the verdict with its sign and the requirements that decide it."""
    kind, sign, state = _VERDICTS[run["verdict"]]
    names = [each["name"] for each in run["requirements"] if each["holds"] is state]
    count = len(run["requirements"])
    holds = "holds" if count == 1 else "hold"
    which = (
        f"{len(names)} of {counted(count, 'requirement')} {_HOLDS[state] if not state else holds}"
    )
    if not state:
        which += f": {', '.join(names)}"
    return f'<p class="verdict {kind}">{sign} {kind.capitalize()}: {_html_text(which)}</p>'


def _summary(run: Mapping[str, Any]) -> str:
    clearance = run["min_clearance_mm"]
    near = "" if clearance is None else f", least clearance {clearance:.0f} mm"
    count = run["collisions"]
    return (
        f"{run['seconds']:g} s, seed {run['seed']}: {counted(count, 'collision')}{near}, "
        f"{run['driven_mm']:.0f} mm driven"
    )


def _sections(run: Mapping[str, Any]) -> Iterator[str]:
    requirements = [(_HOLDS[r["holds"]], r["name"], r["message"]) for r in run["requirements"]]
    yield from _html_table("Requirements", ("", "requirement", ""), requirements)
    warnings = [(each["kind"], each["message"]) for each in run["warnings"]]
    yield from _html_table("Warnings", ("kind", ""), warnings)
    shares = sorted(run["control_time"].items(), key=lambda share: -share[1])
    times = [
        (name, f"{seconds:.2f} s", f"{100 * seconds / run['seconds']:.1f} %")
        for name, seconds in shares
    ]
    if len(run["robots"]) > 1:
        heads = ("robot", "contacts", "least clearance", "driven", "place to reach", "obeyed")
        yield from _html_table(
            "Robots", heads, [_robot_cells(each, run["seconds"]) for each in run["robots"]]
        )
    yield from _html_table("In control", ("controller", "time", "share"), times)
    winners: dict[str, list[Row]] = {}
    for held in run["control"]:
        row = held["seconds"], held["holder"] or "no controller", held["why"]
        winners.setdefault(held["node"], []).append(row)
    for node, rows in winners.items():
        entries = [(f"{since:.3f} s", holder, why) for since, holder, why in in_turn(rows)]
        yield from _html_table(f"Who won at {node}", ("from", "winner", "because"), entries)
    failures = [
        (each["name"], f"{each['count']} times", f"first at {each['seconds']:g} s: {each['first']}")
        for each in run["failures"]
    ]
    yield from _html_table("Failures", ("behaviour", "", ""), failures)


def _robot_cells(robot: Mapping[str, Any], seconds: float) -> tuple[str, ...]:
    """Return the table cells of a robot; `seconds` is the duration of the run."""
    struck = robot["collisions"]
    contacts = f"{len(struck)}, first at {struck[0]['seconds']:.2f} s" if struck else "none"
    clearance, beside = robot["min_clearance_mm"], robot["nearest"]
    clear = "" if clearance is None else f"{clearance:.0f} mm"
    near = f"{clear} from {beside}" if beside else clear
    reached, missing = robot["reached_s"], robot["nearest_to_place_mm"]
    place = "" if missing is None else f"nearest {missing:.0f} mm"
    if reached is not None:
        place = f"reached at {reached:.2f} s"
    shares = sorted(robot["control_time"].items(), key=lambda share: -share[1])
    obeyed = ", ".join(f"{name} {100 * time / seconds:.1f} %" for name, time in shares)
    return robot["name"], contacts, near, f"{robot['driven_mm']:.0f} mm", place, obeyed


def _html_table(title: str, heads: Iterable[str], rows: Sequence[Iterable[str]]) -> Iterator[str]:
    if not rows:
        return
    yield f"<section><h2>{_html_text(title)}</h2><table><thead><tr>"
    yield "".join(f'<th scope="col">{head}</th>' if head else "<td></td>" for head in heads)
    yield "</tr></thead><tbody>"
    for row in rows[:MOST_ROWS]:
        yield f"<tr>{''.join(f'<td>{_html_text(cell)}</td>' for cell in row)}</tr>"
    yield "</tbody></table>"
    if len(rows) > MOST_ROWS:
        yield f"<p>These are the first {MOST_ROWS} of {len(rows)}; `--format json` has all.</p>"
    yield "</section>"


def _html_text(text: str) -> str:
    return escape(visible(str(text)))
