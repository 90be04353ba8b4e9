"""Sectors of a sonar ring: beam k of n looks at k * 360 / n degrees, counter-clockwise."""

from collections.abc import Sequence
from math import inf


def nearest(ranges: Sequence[float], bearing: float, width: float) -> float:
    """Return the least range (mm) of the beams within `width` degrees around a bearing."""
    step = 360 / len(ranges)
    off = (abs((k * step - bearing + 180) % 360 - 180) for k in range(len(ranges)))
    return min((far for far, angle in zip(ranges, off) if angle <= width / 2), default=inf)
