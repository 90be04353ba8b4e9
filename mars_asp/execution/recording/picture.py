"""The picture of a run: the way coloured by controller, obstacles, and who held control when."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from html import escape
from itertools import pairwise

import numpy as np

from mars_asp.draw.shapes import FONT
from mars_asp.execution.executor.arbitration import HierarchicalArbitration
from mars_asp.execution.executor.schedule import SECOND
from mars_asp.execution.scenario.read import Robot
from mars_asp.execution.simulator import Body
from mars_asp.execution.trial import Trial
from mars_asp.output import visible

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666")
#: Pixels before the time axis, and around everything.
LEFT, MARGIN = 130.0, 20.0
_SIZE, _LANE = 640.0, 22.0


@dataclass(frozen=True)
class Picture:
    """Where things stand in the picture of a run: pixels of millimetres and of seconds."""

    trial: Trial

    @cached_property
    def corner(self) -> tuple[float, float]:
        """Return what is shown first (mm): the greatest forward, which is up, and side, left.

        Seen from above, as headings grow from forward towards side: counter-clockwise.
        """
        return float(self._bounds[1][0]), float(self._bounds[1][1])

    @cached_property
    def scale(self) -> float:
        """Return pixels per millimetre."""
        low, high = self._bounds
        return float(_SIZE / (high - low).max())

    @cached_property
    def _bounds(self) -> tuple["np.ndarray[tuple[int], np.dtype[np.float64]]", ...]:
        """Return the least and the greatest (forward, side): walls, else obstacles, and the way."""
        world, places = self.trial.bodies[0].world, []
        for body in self.trial.bodies:
            way = np.array([[p.forward, p.side] for _, p in body.way])
            places += [way - body.radius, way + body.radius]
        if not len(world.segments):
            sizes = world.circles[:, 2:]
            places += [world.circles[:, :2] - sizes, world.circles[:, :2] + sizes]
        every = np.concatenate([*places, world.segments.reshape(-1, 2)])
        return every.min(axis=0) - 100, every.max(axis=0) + 100

    @cached_property
    def height(self) -> float:
        """Return how high the plane is shown."""
        low, high = self._bounds
        return float((high - low)[0]) * self.scale

    def at(self, forward: float, side: float) -> tuple[float, float]:
        """Return where a point of the plane is shown."""
        ahead, aside = self.corner
        return MARGIN + (aside - side) * self.scale, MARGIN + (ahead - forward) * self.scale

    @property
    def top(self) -> float:
        """Return where the first lane begins."""
        return MARGIN + self.height + 15

    @property
    def bottom(self) -> float:
        """Return where the last lane ends."""
        return self.top + _LANE * len(self.colours)

    @property
    def wide(self) -> float:
        """Return pixels per second on the time axis."""
        return (_SIZE + MARGIN - LEFT) / self.trial.scenario.duration

    @cached_property
    def held(self) -> tuple[tuple[float, float, str], ...]:
        """Return from when until when (s) a robot obeyed whom."""
        return tuple(span for robot in self.trial.scenario.robots for span in self.held_by(robot))

    def held_by(self, robot: Robot) -> Iterator[tuple[float, float, str]]:
        """Yield from when until when (s) one robot obeyed whom."""
        for since, until, name, _ in self.trial.commands(robot):
            if name:
                yield since, until, name

    @cached_property
    def wanted(self) -> tuple[tuple[float, float, str], ...]:
        """Return from when until when (s) a module's message was in force at an arbiter."""
        executor = self.trial.executor
        end = executor.schedule.now
        return tuple(
            (since / SECOND, min(until, end) / SECOND, link.source)
            for arbiter in executor.arbiters.values()
            if isinstance(arbiter, HierarchicalArbitration)
            for link, stretches in arbiter.in_force
            if link.source not in executor.arbiters
            for since, until in stretches
        )

    @cached_property
    def colours(self) -> dict[str, str]:
        """Return the colour of every module that held control or wanted it; one lane each."""
        names = sorted({name for _, _, name in (*self.held, *self.wanted)})
        return {name: _COLOURS[k % len(_COLOURS)] for k, name in enumerate(names)}


def plot_run(trial: Trial) -> str:
    """Return an SVG; the same run gives the same bytes."""
    picture = Picture(trial)
    width, height = _SIZE + 2 * MARGIN, picture.bottom + 25
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="{FONT}" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
        f'<clipPath id="plane"><rect x="{MARGIN:g}" y="{MARGIN:g}" width="{_SIZE:g}" '
        f'height="{picture.height:.1f}"/></clipPath>',
        '<g clip-path="url(#plane)">',
        *_world(picture),
        *(part for robot, body in trial.robots for part in _way(picture, robot, body)),
        *(part for robot, body in trial.robots for part in _robot(picture, robot, body)),
        "</g>",
        *_lanes(picture),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _world(picture: Picture) -> Iterator[str]:
    world = picture.trial.bodies[0].world
    for a, b, c, d in world.segments:
        (x, y), (u, v) = picture.at(a, b), picture.at(c, d)
        yield f'<path d="M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" stroke="#333" stroke-width="2"/>'
    now = picture.trial.bodies[0].seconds
    for cx, cy, radius in world.circles:
        yield _circle(picture, cx, cy, radius, 'fill="#999"')
    for moving in world.moving:
        yield _circle(picture, *moving.at(now), moving.radius, 'class="moving" fill="#d98"')
    for mark in world.marks:
        colour = escape(visible(mark.colour), quote=True)
        yield _circle(picture, *mark.at, 4 / picture.scale, f'fill="{colour}"')


def _circle(picture: Picture, cx: float, cy: float, radius: float, look: str) -> str:
    x, y = picture.at(cx, cy)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius * picture.scale:.1f}" {look}/>'


def _way(picture: Picture, robot: Robot, body: Body) -> Iterator[str]:
    """Yield a line for each stretch of the way in which a robot obeyed one module."""
    left = picture.held_by(robot)
    span = next(left, None)
    colour, points = "", list[str]()
    for (since, p), (_, q) in pairwise(body.way):
        while span is not None and span[1] < since:
            span = next(left, None)
        held = span is not None and span[0] <= since
        now = picture.colours[span[2]] if held and span is not None else "#bbb"
        if now != colour:
            yield from _line(points, colour)
            colour, points = now, [_point(picture, p.forward, p.side)]
        if (p.forward, p.side) != (q.forward, q.side):
            points.append(_point(picture, q.forward, q.side))
    yield from _line(points, colour)
    for at in body.contacts:
        pose = next((pose for time, pose in body.way if time >= at), None)
        if pose is not None:
            x, y = picture.at(pose.forward, pose.side)
            yield f'<path d="M{x - 5:.1f} {y - 5:.1f}l10 10m-10 0l10 -10" stroke="#c00"/>'


def _point(picture: Picture, forward: float, side: float) -> str:
    x, y = picture.at(forward, side)
    return f"{x:.1f},{y:.1f}"


def _line(points: list[str], colour: str) -> Iterator[str]:
    if len(points) > 1:
        way = " ".join(points)
        yield f'<polyline points="{way}" fill="none" stroke="{colour}" stroke-width="3"/>'


def _robot(picture: Picture, robot: Robot, body: Body) -> Iterator[str]:
    x, y = picture.at(body.pose.forward, body.pose.side)
    radius = body.radius * picture.scale
    # Turned so that the line to the rim points where the robot heads.
    turn = f"translate({x:.1f} {y:.1f}) rotate({-body.pose.heading:.1f})"
    yield f'<g class="robot" transform="{turn}"><title>{escape(visible(robot.name))}</title>'
    yield f'<circle r="{radius:.1f}" fill="none" stroke="black" stroke-width="1.5"/>'
    yield f'<path d="M0 0V{-radius:.1f}" stroke="black" stroke-width="1.5"/></g>'


def _lanes(picture: Picture) -> Iterator[str]:
    """Yield a lane for each module: pale while its message is in force, full while it is obeyed."""
    rows = {name: picture.top + row * _LANE for row, name in enumerate(picture.colours)}
    end = _SIZE + MARGIN
    for name, y in rows.items():
        label = escape(visible(name), quote=True)
        yield f'<text x="{MARGIN / 2:g}" y="{y + 12:g}">{label}</text>'
        yield (
            f'<rect class="lane" data-name="{label}" x="{LEFT:g}" y="{y:g}" '
            f'width="{end - LEFT:g}" height="{_LANE - 6:g}" fill="#f4f4f4"/>'
        )
    for spans, opacity in ((picture.wanted, 0.3), (picture.held, 1)):
        yield f'<g opacity="{opacity:g}" pointer-events="none">'
        for since, until, name in spans:
            x, width = LEFT + since * picture.wide, (until - since) * picture.wide
            yield (
                f'<rect x="{x:.2f}" y="{rows[name]:g}" width="{max(width, 0.3):.2f}" '
                f'height="{_LANE - 6:g}" fill="{picture.colours[name]}"/>'
            )
        yield "</g>"
    y = picture.bottom + 8
    yield f'<text x="{LEFT:g}" y="{y:g}">0 s</text>'
    duration = picture.trial.scenario.duration
    yield f'<text x="{end:g}" y="{y:g}" text-anchor="end">{duration:g} s</text>'
