"""The layout of the diagram of a run: the plane, and lanes along an axis of time."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mars_asp.draw.shapes import text_width
from mars_asp.execution.executor.arbitration import HierarchicalArbitration
from mars_asp.execution.executor.schedule import SECOND
from mars_asp.execution.judgement import Judgement
from mars_asp.execution.scenario.read import ScenarioRobot
from mars_asp.execution.trial import Trial

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666")
#: In pixels: the margin, the longer side of the plane, a lane and the font size.
MARGIN, SIZE, LANE, TEXT = 20.0, 640.0, 22.0, 12.0
#: Pixels of a line of text.
LINE = 18.0
#: Minimal and maximal width of the names of lanes, in pixels.
_LEFT = 130.0, 230.0


@dataclass(frozen=True)
class Frame:
    """The layout of the diagram of a run, in pixels.

    `head` and `signs` are the numbers of text lines above and below the plane. While a run goes on,
    it has no judgement.
    """

    trial: Trial
    judgement: Judgement | None = None
    head: int = 0
    signs: int = 0

    @cached_property
    def corner(self) -> tuple[float, float]:
        """Return the maximal (forward, side) in mm, which is at the top left.

        The plane is seen from above, so headings grow counter-clockwise.
        """
        return float(self._extent[1][0]), float(self._extent[1][1])

    @cached_property
    def scale(self) -> float:
        """Return pixels per millimetre."""
        low, high = self._extent
        return float(SIZE / (high - low).max())

    @cached_property
    def _extent(self) -> tuple["np.ndarray[tuple[int], np.dtype[np.float64]]", ...]:
        """Return the minimal and maximal (forward, side) of walls or circles, goals and paths."""
        world = self.trial.bodies[0].world
        discs = [] if len(world.segments) else [world.circles]
        for robot, body in self.trial.robots:
            discs.append(np.array([[p.forward, p.side, body.radius] for _, p in body.way]))
            if robot.reach:
                discs.append(np.array([[*robot.reach["at"], robot.reach.get("radius", 200.0)]]))
        places = [disc[:, :2] + sign * disc[:, 2:] for disc in discs for sign in (-1, 1)]
        every = np.concatenate([*places, world.segments.reshape(-1, 2)])
        return every.min(axis=0) - 100, every.max(axis=0) + 100

    @property
    def ceiling(self) -> float:
        """Return the y coordinate of the top of the plane."""
        return MARGIN + LINE * self.head

    @cached_property
    def height(self) -> float:
        """Return the height of the plane in pixels."""
        low, high = self._extent
        return float((high - low)[0]) * self.scale

    def at(self, forward: float, side: float) -> tuple[float, float]:
        """Return the pixel coordinates of a point of the plane."""
        ahead, aside = self.corner
        return MARGIN + (aside - side) * self.scale, self.ceiling + (ahead - forward) * self.scale

    @property
    def floor(self) -> float:
        """Return the y coordinate of the bottom of the plane."""
        return self.ceiling + self.height

    @property
    def top(self) -> float:
        """Return the y coordinate of the first lane."""
        return self.floor + LINE * self.signs + 18

    @property
    def bottom(self) -> float:
        """Return the y coordinate of the end of the last lane."""
        return self.top + LANE * len(self.colours)

    @cached_property
    def left(self) -> float:
        """Return the x coordinate at which lanes begin."""
        least, most = _LEFT
        wide = max((text_width(name, TEXT) for name in self.colours), default=0.0)
        return min(most, max(least, MARGIN / 2 + wide + 8))

    @property
    def wide(self) -> float:
        """Return pixels per second on the time axis."""
        return (SIZE + MARGIN - self.left) / self.trial.scenario.duration

    @cached_property
    def held(self) -> tuple[tuple[float, float, str], ...]:
        """Return begin, end (seconds) and module of each period in which a robot obeyed one."""
        return tuple(span for robot in self.trial.scenario.robots for span in self.held_by(robot))

    def held_by(self, robot: ScenarioRobot) -> Iterator[tuple[float, float, str]]:
        """Yield begin, end (seconds) and module of each period in which one robot obeyed one."""
        for since, until, name, _ in self.trial.commands(robot):
            if name:
                yield since, until, name

    @cached_property
    def wanted(self) -> tuple[tuple[float, float, str], ...]:
        """Return begin, end and module of each period (seconds) in which a message was in force."""
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
    def silent(self) -> frozenset[str]:
        """Return the controllers whose commands never arrived."""
        executor = self.trial.executor
        spoke: dict[str, bool] = {}
        for link in executor.links:
            if link.kind == "control" and executor.plan.kind(link.source) == "control_out":
                spoke[link.source] = spoke.get(link.source, False) or link.delivered > 0
        return frozenset(name for name, any_arrived in spoke.items() if not any_arrived)

    @cached_property
    def colours(self) -> dict[str, str]:
        """Return the colour of every module that held control, wanted it, or was silent."""
        names = {name for _, _, name in (*self.held, *self.wanted)} | self.silent
        return {name: _COLOURS[k % len(_COLOURS)] for k, name in enumerate(sorted(names))}
