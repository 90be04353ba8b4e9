"""Texts and markers in the diagram of a run: verdict, goals, contacts, minimal clearance.

The plane has only markers; their texts are listed below it, so that texts do not overlap.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from mars_asp.asp.units import measured
from mars_asp.draw.shapes import escaped, text_width
from mars_asp.execution.judgement import Judgement
from mars_asp.execution.recording.frame import LINE, MARGIN, SIZE, TEXT, Frame
from mars_asp.execution.recording.lanes import cut, round_step
from mars_asp.execution.simulator.approach import Approach, approach_at, least_approach, pose_at
from mars_asp.execution.simulator.body import THING, Body
from mars_asp.execution.simulator.motion import Point
from mars_asp.execution.trial import Trial

_GOAL, _CONTACT, _LEAST, _INK = "#117733", "#cc0000", "#6a3d9a", "#333333"
_VERDICTS = {"pass": _GOAL, "fail": _CONTACT, "not decided": "#9a6700"}
#: Maximal number of listed pairs, and of contacts of one robot; of contacts of a pair.
_MOST, _MOST_OF = 6, 3
#: Pixels from a marker to its text, and after a text.
_SIGN, _GAP = 20.0, 18.0
#: Maximal width of a robot's name in a text, in pixels.
_NAME = 110.0


class Contact(NamedTuple):
    """A contact: the words ` of ROBOT and ROBOT` for its text, and its location."""

    of: str
    approach: Approach


class Goal(NamedTuple):
    """The goal of a robot: a circle (mm), and whether it was reached.

    If it was reached (`there`), `when` is the time in seconds, else that of the minimal `distance`
    (mm).
    """

    body: Body
    place: Point
    radius: float
    when: float
    distance: float
    there: bool


@dataclass(frozen=True)
class Signs:
    """The lines above the diagram of a run, and its markers with their texts, up to now."""

    trial: Trial
    judgement: Judgement | None

    @cached_property
    def contacts(self) -> list[Contact]:
        """Return all contacts; one of two robots with each other counts once."""
        return [
            Contact(self._of(body, other), approach_at(body, at, other))
            for at, body, other in self.trial.contacts
        ]

    @cached_property
    def nearest(self) -> Body:
        """Return the robot with the minimal clearance."""
        return min(self.trial.bodies, key=lambda body: body.clearance)

    @cached_property
    def least(self) -> Approach | None:
        """Return the approach with the minimal clearance; None after a contact or during a run."""
        if self.contacts or self.judgement is None:
            return None
        return least_approach(self.nearest)

    @cached_property
    def goals(self) -> list[Goal]:
        """Return the place that each robot should reach, with how near it came and when."""
        found = []
        for robot, body in self.trial.robots:
            if robot.reach:
                reached, (distance, at) = self.trial.reached(robot), self.trial.nearest(robot)
                there = reached is not None
                radius, when = robot.reach.get("radius", 200.0), at if reached is None else reached
                found.append(Goal(body, tuple(robot.reach["at"]), radius, when, distance, there))
        return found

    def _of(self, *those: Body | str) -> str:
        """Return ` of ROBOT and ROBOT` for names or bodies, "" if the run has only one robot."""
        if len(self.trial.bodies) == 1:
            return ""
        names = [each if isinstance(each, str) else each.name for each in those]
        return f" of {' and '.join(cut(name, _NAME) for name in names if name != THING)}"

    @property
    def instants(self) -> Iterator[tuple[float, str]]:
        """Yield the time in seconds and the colour of each marker."""
        if self.least:
            yield self.least.at, _LEAST
        for goal in self.goals:
            if goal.there:
                yield goal.when, _GOAL
        for contact in self.contacts:
            yield contact.approach.at, _CONTACT

    @cached_property
    def head(self) -> list[tuple[str, str]]:
        """Return lines with colours: the time during a run, then verdict and unmet requirements."""
        if self.judgement is None:
            now = self.trial.executor.schedule.now / 1e9
            return [(f"running: {now:.1f} of {self.trial.scenario.duration:g} s", _INK)]
        every, verdict = self.judgement.requirements, self.judgement.verdict
        lines = [(str(verdict), _VERDICTS[verdict])]
        for state, word in ((False, "violated"), (None, "not decided")):
            names = [each.name for each in every if each.holds is state]
            lines += [(line, _INK) for line in _wrapped(f"{word}: ", names)]
        if verdict == "pass":
            lines = [(f"pass: all {len(every)} requirements hold", _VERDICTS[verdict])]
        return lines

    @cached_property
    def items(self) -> list[tuple[str, str]]:
        """Return each marker as SVG around (0, 0), with its text."""
        found = [('<circle r="3.5" fill="#333"/>', "start")]
        for goal in self.goals:
            (x, y), instant = goal.place, f"at {_time(goal.when)}"
            message = f"goal{self._of(goal.body)}: {_length(goal.radius)} around ({x:g}, {y:g})"
            message += f", reached {instant}" if goal.there else ", not reached"
            found.append((_ring(6), message))
            if not goal.there:
                found.append((_NEAREST, f"nearest to it: {_length(goal.distance)}, {instant}"))
        if self.least:
            of = self._of(self.nearest, self.nearest.beside)
            text = f"least clearance{of}: {_length(self.least.gap)}, at {_time(self.least.at)}"
            found.append(
                (f'<path d="M-6 0H6M-6 -4V4M6 -4V4" stroke="{_LEAST}" fill="none"/>', text)
            )
        touched: dict[str, list[str]] = {}
        for contact in self.contacts:
            touched.setdefault(contact.of, []).append(f"{contact.approach.at:.2f}")
        for of, instants in [*touched.items()][:_MOST]:
            listed = instants[: _MOST_OF if of else _MOST]
            more = len(instants) - len(listed)
            rest = f" and {more} more" if more else ""
            found.append(
                (_CROSS, f"{_contacts(len(instants))}{of}: at {', '.join(listed)} s{rest}")
            )
        if more := sum(map(len, [*touched.values()][_MOST:])):
            found.append((_CROSS, f"{_contacts(more)} of others"))
        return found

    def listed(self, scale: float) -> list[tuple[float, int, str, str]]:
        """Return the items below the plane as (x, line, marker, text), with a scale bar first.

        `scale` is in pixels per mm.
        """
        # The bar is at most a quarter of the diagram wide.
        length = 1.0 / round_step(1.0 / (SIZE / 4 / scale))
        wide = length * scale
        bar = f'<path d="M-8 -4v8M-8 0h{wide:.1f}m0 -4v8" stroke="{_INK}" fill="none"/>'
        x, line, found = MARGIN + 8, 0, []
        for sign, text, before in (
            (bar, _length(length), wide),
            *((sign, text, _SIGN - 6) for sign, text in self.items),
        ):
            need = before + text_width(text, TEXT)
            if x + need > SIZE + MARGIN and x > MARGIN + 8:
                x, line = MARGIN + 8, line + 1
            found.append((x, line, sign, f'<text x="{before:.1f}" y="4">{escaped(text)}</text>'))
            x += need + _GAP
        return found


def draw_head(signs: Signs) -> Iterator[str]:
    """Yield SVG of the verdict, above the plane."""
    for number, (text, colour) in enumerate(signs.head):
        bold = ' font-weight="bold" font-size="14"' if not number else ""
        y = MARGIN + LINE * number + 4
        yield f'<text x="{MARGIN:g}" y="{y:g}" fill="{colour}"{bold}>{escaped(text)}</text>'


def draw_list(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield SVG of the scale and of the texts of markers, below the plane."""
    for x, line, sign, text in signs.listed(frame.scale):
        y = frame.floor + LINE * line + 14
        yield f'<g transform="translate({x:.1f} {y:.1f})">{sign}{text}</g>'


def draw_goals(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield SVG of the goals' circles, to be drawn before paths and robots."""
    for goal in signs.goals:
        x, y = frame.at(*goal.place)
        ring = _ring(goal.radius * frame.scale)
        yield f'<g class="goal" transform="translate({x:.1f} {y:.1f})">{ring}</g>'


def draw_signs(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield SVG of the markers in the plane."""
    for body in signs.trial.bodies:
        start = body.motion[0].pose
        x, y = frame.at(start.forward, start.side)
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="#333"/>'
    if signs.least:
        yield from _least(signs.least, frame, signs.nearest.radius)
    for goal in signs.goals:
        pose = pose_at(goal.body, goal.when)
        x, y = frame.at(pose.forward, pose.side)
        sign = f'<circle r="3.5" fill="{_GOAL}"/>' if goal.there else _NEAREST
        yield f'<g transform="translate({x:.1f} {y:.1f})">{sign}</g>'
    for of, approach in signs.contacts:
        x, y = frame.at(*approach.thing)
        title = f"<title>{escaped(f'contact{of} at {_time(approach.at)}')}</title>"
        yield f'<g transform="translate({x:.1f} {y:.1f})">{title}{_CROSS}</g>'


def _least(least: Approach, frame: Frame, radius: float) -> Iterator[str]:
    """Yield SVG of the minimal clearance: the robot, and a line from its rim to the obstacle."""
    x, y = frame.at(least.pose.forward, least.pose.side)
    u, v = frame.at(*least.thing)
    whole = (least.gap + radius) or 1.0
    rim = x + (u - x) * radius / whole, y + (v - y) * radius / whole
    yield (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius * frame.scale:.1f}" fill="none" '
        f'stroke="{_LEAST}" stroke-dasharray="3 3"/>'
        f'<path class="least" d="M{rim[0]:.1f} {rim[1]:.1f}L{u:.1f} {v:.1f}" stroke="{_LEAST}" '
        'stroke-width="2"/>'
    )


_CROSS = (
    f'<path class="contact" d="M-5 -5l10 10m-10 0l10 -10" stroke="{_CONTACT}" stroke-width="2"/>'
)
_NEAREST = f'<path d="M0 -5L5 0L0 5L-5 0Z" fill="white" stroke="{_GOAL}" stroke-width="1.5"/>'


def _ring(radius: float) -> str:
    return (
        f'<circle r="{radius:.1f}" fill="{_GOAL}" fill-opacity="0.12" stroke="{_GOAL}" '
        'stroke-dasharray="4 2"/>'
    )


def _contacts(count: int) -> str:
    return "contact" if count == 1 else f"{count} contacts"


def _length(millimetres: float) -> str:
    """Return a length as a text, in whole millimetres from 10 mm on."""
    rounded = round(millimetres) if millimetres >= 10 else round(millimetres, 1)
    return measured(round(rounded * 1000), "micrometres")


def _time(seconds: float) -> str:
    return f"{seconds:.2f} s"


def _wrapped(head: str, names: list[str]) -> Iterator[str]:
    """Yield names in lines that fit into the diagram, the first line with `head`."""
    line = head
    for number, name in enumerate(names):
        part = f"{name}, " if number < len(names) - 1 else name
        if text_width(line + part, TEXT) > SIZE and line != head:
            yield line
            line = ""
        line += part
    if names:
        yield line
