"""Polygons of worlds."""

from math import cos, pi, sin

from mars_asp.execution.simulator.motion import Point


def regular_polygon(centre: Point, radius: float, corners: int) -> list[Point]:
    """Return the corners of a regular polygon."""
    angles = [2 * pi * k / corners for k in range(corners)]
    return [(centre[0] + radius * cos(a), centre[1] + radius * sin(a)) for a in angles]
