"""The two behaviours of the tutorial's robot. A command is a pair: a function and its rate."""

from collections.abc import Sequence


def cruise(ranges: Sequence[float]) -> tuple[str, float]:
    """Drive forward at 200 mm/s."""
    return ("Trans_Z", 200)


def avoid(ranges: Sequence[float]) -> tuple[str, float] | None:
    """Turn at 60 degrees/s while something ahead is nearer than 700 mm; else command nothing."""
    ahead = min(ranges[0], ranges[1], ranges[-1])
    return ("Rotn_Y", 60) if ahead < 700 else None
