"""Rotations and numbers of URDF, and those of the language."""

import math
from collections.abc import Iterable
from decimal import Decimal
from typing import TypeAlias

import numpy as np

from mars_asp.kinematics.frames import Matrix, rotation

#: (axis, degrees) in order about fixed axes.
Turns: TypeAlias = tuple[tuple[str, Decimal], ...]

#: The number that represents an open bound, in metres, radians, or either per second.
OPEN = 1_000_000
#: The greatest number of a position or of an axis: metres of which micrometres fit the language.
FARTHEST = 2147
QUARTER = math.pi / 2
#: A millionth of a microdegree: rounding of products of sines, far below any stated angle.
_ROUNDING = 1e-12
_DIGITS, _DECIMALS = 16, 13
#: An angle of so many significant digits is rounded to its own precision.
_MANY_DIGITS = 10


def degrees_of(radians: float) -> Decimal:
    """Return an angle in degrees; multiples of a quarter turn within rounding become exact."""
    degrees = math.degrees(radians)
    nearest = round(degrees / 90) * 90
    return writable(Decimal(nearest if abs(degrees - nearest) < _ROUNDING else degrees))


def degrees_of_written(radians: Decimal) -> Decimal:
    """Return an angle in degrees, with the fewest digits that give its digits in radians again.

    3.14159265359 is 180, not 180.0000000000119. An angle of few digits is used as written: 1.5708
    may mean itself or a right angle.
    """
    exact = degrees_of(float(radians))
    _, digits, last = radians.as_tuple()
    if len(digits) < _MANY_DIGITS or not isinstance(last, int):
        return exact
    error = Decimal(5).scaleb(last - 1)
    rounded = (round(exact, places) for places in range(_DECIMALS))
    return next((d for d in rounded if abs(Decimal(math.radians(d)) - radians) <= error), exact) + 0


def writable(value: Decimal) -> Decimal:
    """Return the nearest number that the language can write; magnitudes are below 10**12."""
    whole = max(value.adjusted() + 1, 1)
    places = min(_DECIMALS, _DIGITS - whole)
    return value.quantize(Decimal(1).scaleb(-places)) + 0


def rotation_of(turns: Turns) -> Matrix:
    """Return the 3x3 rotation of turns in order about fixed axes."""
    matrix = np.eye(3)
    for axis, degrees in turns:
        matrix = rotation(axis, degrees) @ matrix
    return matrix + 0.0


def turns_of(matrix: Matrix) -> Turns:
    """Return the fewest turns in order about fixed axes that make up a 3x3 rotation.

    Two turns, about `a` and then `b`, are enough if the rotated `a` is orthogonal to `b`: the first
    turn does not change `a`, and the second moves it around `b`.
    """
    found: list[Turns] = [_turning(zip("xyz", roll_pitch_yaw(matrix), strict=True))]
    for first in range(3):
        for second in range(3):
            if first != second and abs(matrix[second, first]) < 1e-15:
                about = -_angle_about(first, second, matrix[second])
                then = _angle_about(second, first, matrix[:, first])
                found.append(_turning((("xyz"[first], about), ("xyz"[second], then))))
    return min(found, key=len)


def roll_pitch_yaw(matrix: Matrix) -> tuple[float, float, float]:
    """Return the angles in radians about the fixed x, y and z, in this order.

    Roll is measured after yaw is undone, so that it compensates the error of yaw where the rotated
    x is nearly along z.
    """
    yaw = math.atan2(matrix[1, 0], matrix[0, 0])
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    side = math.cos(yaw) * matrix[1] - math.sin(yaw) * matrix[0]
    return math.atan2(-side[2], side[1]), pitch, yaw


def main_axis(axis: Matrix) -> str | None:
    """Return `X`, `Y` or `Z` if a direction is exactly that axis, else None."""
    for letter, unit in zip("XYZ", np.eye(3), strict=True):
        if (axis > 0).tolist() == (unit > 0).tolist() and not (axis < 0).any():
            return letter
    return None


def turns_to(axis: Matrix) -> Turns:
    """Return the turns that rotate z to a direction."""
    x, y, z = axis / np.linalg.norm(axis)
    tilt = degrees_of(math.atan2(math.hypot(x, y), z))
    return ("y", tilt), ("z", degrees_of(math.atan2(y, x)))


def _angle_about(axis: int, arm: int, image: Matrix) -> float:
    """Return the angle of the turn about an axis that moves unit vector `arm` to `image`."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    if arm == one:
        return math.atan2(image[other], image[one])
    return math.atan2(-image[one], image[other])


def _turning(turns: Iterable[tuple[str, float]]) -> Turns:
    """Return turns in degrees, without turns by 0."""
    in_degrees = ((axis, degrees_of(angle)) for axis, angle in turns)
    return tuple((axis, degrees) for axis, degrees in in_degrees if degrees)
