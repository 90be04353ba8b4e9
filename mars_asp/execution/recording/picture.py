"""The diagram of a run: paths coloured by controller, obstacles, and markers of events."""

from collections.abc import Iterator
from itertools import pairwise

from mars_asp.draw.shapes import FONT, escaped
from mars_asp.execution.judgement import Judgement
from mars_asp.execution.recording.frame import MARGIN, SIZE, TEXT, Frame
from mars_asp.execution.recording.lanes import draw_lanes
from mars_asp.execution.recording.signs import Signs, draw_goals, draw_head, draw_list, draw_signs
from mars_asp.execution.scenario.read import ScenarioRobot
from mars_asp.execution.simulator import Body
from mars_asp.execution.trial import Trial
from mars_asp.output import visible

#: Minimal radius of a drawn robot, in pixels.
_LEAST = 3.0


def framed(trial: Trial, judgement: Judgement | None) -> tuple[Frame, Signs]:
    """Return the layout of a diagram, with the lines of text that it needs, and its markers."""
    signs = Signs(trial, judgement)
    # The number of lines depends on the scale, and the scale only on world and paths.
    lines = signs.listed(Frame(trial).scale)[-1][1] + 1
    return Frame(trial, judgement, len(signs.head), lines), signs


def plot_run(trial: Trial, judgement: Judgement | None = None) -> str:
    """Return the SVG diagram of a run; without a judgement it is still running."""
    frame, signs = framed(trial, judgement)
    width, height = SIZE + 2 * MARGIN, frame.bottom + 28
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="{FONT}" font-size="{TEXT:g}">',
        '<rect width="100%" height="100%" fill="white"/>',
        *draw_head(signs),
        f'<clipPath id="plane"><rect x="{MARGIN:g}" y="{frame.ceiling:g}" width="{SIZE:g}" '
        f'height="{frame.height:.1f}"/></clipPath>',
        '<g clip-path="url(#plane)">',
        *draw_goals(signs, frame),
        *_world(frame),
        *(part for each in trial.robots for part in _way(frame, *each)),
        *draw_signs(signs, frame),
        *(part for k in range(len(trial.bodies)) for part in _draw_robot(frame, k)),
        "</g>",
        *draw_list(signs, frame),
        *draw_lanes(frame, signs.instants),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _world(frame: Frame) -> Iterator[str]:
    world = frame.trial.bodies[0].world
    for a, b, c, d in world.segments:
        (x, y), (u, v) = frame.at(a, b), frame.at(c, d)
        yield f'<path d="M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" stroke="#333" stroke-width="2"/>'
    now = frame.trial.bodies[0].seconds
    for cx, cy, radius in world.circles:
        yield _circle(frame, cx, cy, radius, 'fill="#999"')
    for moving in world.moving:
        yield _circle(frame, *moving.at(now), moving.radius, 'class="moving" fill="#d98"')
    for mark in world.marks:
        colour = escaped(visible(mark.colour))
        yield _circle(frame, *mark.at, 4 / frame.scale, f'fill="{colour}"')


def _circle(frame: Frame, cx: float, cy: float, radius: float, look: str) -> str:
    x, y = frame.at(cx, cy)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius * frame.scale:.1f}" {look}/>'


def _way(frame: Frame, robot: ScenarioRobot, body: Body) -> Iterator[str]:
    """Yield the path of a robot as SVG, one line for each period in which it obeyed a module."""
    left = frame.held_by(robot)
    span = next(left, None)
    colour, points = "", list[str]()
    for (since, p), (_, q) in pairwise(body.way):
        while span is not None and span[1] < since:
            span = next(left, None)
        held = span is not None and span[0] <= since
        now = frame.colours[span[2]] if held and span is not None else "#bbb"
        if now != colour:
            yield from _polyline(points, colour)
            colour, points = now, [_point(frame, p.forward, p.side)]
        if (p.forward, p.side) != (q.forward, q.side):
            points.append(_point(frame, q.forward, q.side))
    yield from _polyline(points, colour)


def _point(frame: Frame, forward: float, side: float) -> str:
    x, y = frame.at(forward, side)
    return f"{x:.1f},{y:.1f}"


def _polyline(points: list[str], colour: str) -> Iterator[str]:
    if len(points) > 1:
        way = " ".join(points)
        yield f'<polyline points="{way}" fill="none" stroke="{colour}" stroke-width="3"/>'


def _draw_robot(frame: Frame, number: int) -> Iterator[str]:
    trial = frame.trial
    body = trial.bodies[number]
    x, y = frame.at(body.pose.forward, body.pose.side)
    radius = max(body.radius * frame.scale, _LEAST)
    # The line from centre to rim shows the heading.
    turn = f"translate({x:.1f} {y:.1f}) rotate({-body.pose.heading:.1f})"
    yield f'<g id="robot{number + 1 if number else ""}" transform="{turn}">'
    if len(trial.bodies) > 1:
        yield f"<title>{escaped(visible(body.name))}</title>"
    yield f'<circle r="{radius:.1f}" fill="none" stroke="black" stroke-width="1.5"/>'
    yield f'<path d="M0 0V{-radius:.1f}" stroke="black" stroke-width="1.5"/></g>'
