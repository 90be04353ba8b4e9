"""What a picture of a run says beside its lines: the verdict, goal, contacts, the least clearance.

In the plane there are signs alone; their texts are listed below it, so none covers another.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from mars_asp.asp.units import measured
from mars_asp.draw.shapes import escaped, text_width
from mars_asp.execution.judgement import Judgement
from mars_asp.execution.recording.frame import LINE, MARGIN, SIZE, TEXT, Frame
from mars_asp.execution.recording.lanes import round_step
from mars_asp.execution.simulator.approach import Approach, approach_at, least_approach, pose_at
from mars_asp.execution.trial import Trial

_GOAL, _CONTACT, _LEAST, _INK = "#117733", "#cc0000", "#6a3d9a", "#333333"
_VERDICTS = {"pass": _GOAL, "fail": _CONTACT, "not decided": "#9a6700"}
#: As many instants of contacts are listed.
_MOST = 6
#: Pixels of a sign before its text, and after a text.
_SIGN, _GAP = 20.0, 18.0


@dataclass(frozen=True)
class Signs:
    """What there is to show of a run; of one that goes on, what is known by now."""

    trial: Trial
    judgement: Judgement | None

    @cached_property
    def contacts(self) -> list[Approach]:
        """Return where the robot was, and what it touched, at each contact."""
        return [approach_at(self.trial.body, at) for at in self.trial.body.contacts]

    @cached_property
    def least(self) -> Approach | None:
        """Return where the clearance was least; nothing where there was contact."""
        body = self.trial.body
        return None if body.contacts or self.judgement is None else least_approach(body)

    @cached_property
    def came(self) -> tuple[float, float, bool] | None:
        """Return when (s) and how near (mm) the robot came to its goal, and whether it is there."""
        goal = self.trial.scenario.requirements.get("reach")
        if not goal:
            return None
        at = self.trial.reached
        distance, when = self.trial.nearest
        return (when, distance, False) if at is None else (at, goal.get("radius", 200.0), True)

    @property
    def instants(self) -> Iterator[tuple[float, str]]:
        """Yield when (s) something happened, with its colour."""
        if self.least:
            yield self.least.at, _LEAST
        if self.came and self.came[2]:
            yield self.came[0], _GOAL
        for contact in self.contacts:
            yield contact.at, _CONTACT

    @cached_property
    def head(self) -> list[tuple[str, str]]:
        """Return lines and their colours: the verdict, then what does not hold."""
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
        """Return each sign, drawn around (0, 0), and its text."""
        found = [('<circle r="3.5" fill="#333"/>', "start")]
        goal, came = self.trial.scenario.requirements.get("reach"), self.came
        if goal and came:
            at, distance, there = came
            x, y = goal["at"]
            told = f"goal: {_length(goal.get('radius', 200.0))} around ({x:g}, {y:g})"
            instant = f"at {_time(at)}"
            told += f", reached {instant}" if there else ", not reached"
            found.append((_ring(6), told))
            if not there:
                found.append((_NEAREST, f"nearest to it: {_length(distance)}, {instant}"))
        if self.least:
            text = f"least clearance: {_length(self.least.gap)}, at {_time(self.least.at)}"
            found.append(
                (f'<path d="M-6 0H6M-6 -4V4M6 -4V4" stroke="{_LEAST}" fill="none"/>', text)
            )
        if self.contacts:
            instants = ", ".join(f"{each.at:.2f}" for each in self.contacts[:_MOST])
            more = len(self.contacts) - _MOST
            rest = f" and {more} more" if more > 0 else ""
            word = "contact" if len(self.contacts) == 1 else f"{len(self.contacts)} contacts"
            found.append((_CROSS, f"{word}: at {instants} s{rest}"))
        return found

    def listed(self, scale: float) -> list[tuple[float, int, str, str]]:
        """Return items by x and line, with a bar of a round length at a scale (pixels per mm)."""
        length = _round_below(SIZE / 4 / scale)
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
    """Yield the verdict, above the plane."""
    for number, (text, colour) in enumerate(signs.head):
        bold = ' font-weight="bold" font-size="14"' if not number else ""
        y = MARGIN + LINE * number + 4
        yield f'<text x="{MARGIN:g}" y="{y:g}" fill="{colour}"{bold}>{escaped(text)}</text>'


def draw_list(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield the scale and what the signs are, below the plane."""
    for x, line, sign, text in signs.listed(frame.scale):
        y = frame.floor + LINE * line + 14
        yield f'<g transform="translate({x:.1f} {y:.1f})">{sign}{text}</g>'


def draw_goal(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield the place that is to be reached, below what moves."""
    goal = signs.trial.scenario.requirements.get("reach")
    if goal:
        x, y = frame.at(*goal["at"])
        radius = goal.get("radius", 200.0) * frame.scale
        yield f'<g class="goal" transform="translate({x:.1f} {y:.1f})">{_ring(radius)}</g>'


def draw_signs(signs: Signs, frame: Frame) -> Iterator[str]:
    """Yield what happened where, in the plane."""
    body = signs.trial.body
    start = body.motion[0].pose
    x, y = frame.at(start.forward, start.side)
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="#333"/>'
    if signs.least:
        yield from _least(signs.least, frame, body.radius)
    if signs.came:
        at, _, there = signs.came
        pose = pose_at(body, at)
        x, y = frame.at(pose.forward, pose.side)
        sign = f'<circle r="3.5" fill="{_GOAL}"/>' if there else _NEAREST
        yield f'<g transform="translate({x:.1f} {y:.1f})">{sign}</g>'
    for contact in signs.contacts:
        x, y = frame.at(*contact.thing)
        title = f"<title>contact at {_time(contact.at)}</title>"
        yield f'<g transform="translate({x:.1f} {y:.1f})">{title}{_CROSS}</g>'


def _least(least: Approach, frame: Frame, radius: float) -> Iterator[str]:
    """Yield the robot as it was then, and a line from its rim to the thing."""
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


def _round_below(most: float) -> float:
    """Return the greatest of 1, 2 and 5 times powers of ten that is not above a number."""
    return 1.0 / round_step(1.0 / most)


def _length(millimetres: float) -> str:
    """Return a length as it is read: whole millimetres where there are ten of them."""
    rounded = round(millimetres) if millimetres >= 10 else round(millimetres, 1)
    return measured(round(rounded * 1000), "micrometres")


def _time(seconds: float) -> str:
    return f"{seconds:.2f} s"


def _wrapped(head: str, names: list[str]) -> Iterator[str]:
    """Yield lines of names that are no wider than the picture."""
    line = head
    for number, name in enumerate(names):
        part = f"{name}, " if number < len(names) - 1 else name
        if text_width(line + part, TEXT) > SIZE and line != head:
            yield line
            line = ""
        line += part
    if names:
        yield line
