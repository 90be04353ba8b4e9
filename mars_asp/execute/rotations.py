"""Rotations between the frames of modules, with exact quarter turns, and commands through them."""

from collections.abc import Sequence
from math import cos, radians, sin

from mars_asp.model import GRASP, Transformation

#: Rows of a rotation that takes vectors of the commanding frame into the provider's.
Rotation = Sequence[Sequence[float]]
IDENTITY: Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def map_function(function: str, rate: float, rotation: Rotation) -> dict[str, float]:
    """Return what a function and its rate are in another frame; a grasp has no direction."""
    if function == GRASP:
        return {function: rate}
    kind, axis = function.split("_")
    column = "XYZ".index(axis)
    parts = {f"{kind}_{name}": row[column] for name, row in zip("XYZ", rotation, strict=True)}
    return {name: part * rate for name, part in parts.items() if abs(part) > 1e-9}


def rotation_of(transformation: Transformation | None) -> Rotation:
    """Return the rotation of a tuple; none is the identity."""
    rotation = IDENTITY
    for axis, degrees in transformation.rotations if transformation else ():
        rotation = times(_turn(axis.lower(), float(degrees)), rotation)
    return rotation


def _turn(axis: str, degrees: float) -> Rotation:
    quarters = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    angle = radians(degrees)
    c, s = quarters.get(degrees % 360, (cos(angle), sin(angle)))
    if axis == "x":
        return ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))
    if axis == "y":
        return ((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def times(a: Rotation, b: Rotation) -> Rotation:
    """Return the rotation that does `b` and then `a`."""
    return tuple(
        tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3)
    )
