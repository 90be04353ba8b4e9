"""The behaviours of the patrol robot."""

from collections.abc import Sequence

from sectors import nearest

from mars_asp.behaviour import Command, Context


def cruise(ranges: Sequence[float]) -> Command:
    """Drive ahead, the slower the nearer something is: 250 mm/s at most."""
    return Command("Trans_Z", min(250.0, nearest(ranges, 0, 60) / 2))


def steer(left: float, right: float, ctx: Context) -> Command | None:
    """Turn away from the nearer side while one is nearer than `near`."""
    if min(left, right) > ctx.parameters["near"]:
        return None
    rate = ctx.parameters["rate"]
    return Command("Rotn_Y", -rate if left < right else rate)


class Side:
    """Watch one side of the robot; serves `Left` and `Right`, each with an object of its own."""

    def __init__(self, bearing: float, keep: float = 0.5) -> None:
        self.bearing, self.keep = bearing, keep
        self.seen = 3000.0

    def __call__(self, ranges: Sequence[float]) -> float:
        """Return the range at this side, smoothed: `keep` is the share of what was seen before."""
        now = min(3000.0, nearest(ranges, self.bearing, 70))
        self.seen = self.keep * self.seen + (1 - self.keep) * now
        return self.seen


class Retreat:
    """Back away for a second once something ahead is near."""

    until = 0.0

    def step(self, ranges: Sequence[float], ctx: Context) -> Command | None:
        if nearest(ranges, 0, 60) < 450:
            self.until = ctx.now + 1.0
        return Command("Trans_Z", -120) if ctx.now < self.until else None


def broken(ranges: Sequence[float]) -> Command:
    """Do what page "Write behaviours" shows an error of: the ring has 24 beams."""
    return Command("Trans_Z", ranges[24] / 5)
