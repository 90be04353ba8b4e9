"""The tuple of a mount: (axis, degrees) pairs, then a translation in mm."""

from collections.abc import Sequence
from decimal import Decimal

from mars_asp.model.declarations import Transformation
from mars_asp.model.ranges import ANGLE, LENGTH, NumberRange, Problem

AXES = ("x", "y", "z")
NONE = "_"
_MOST_SLOTS = 7


def read_transformation(slots: Sequence[str]) -> Transformation | tuple[Problem, ...]:
    """Return the transformation in the slots of a tuple, or all errors in them.

    The last three slots are the translation. If an odd number of slots precedes them, the last or
    first of these must be `_`.
    """
    if not 3 <= len(slots) <= _MOST_SLOTS:
        return (
            Problem(
                f"a tuple of {len(slots)} slots",
                "write `(axis, degrees, axis, degrees, x, y, z)` with `_` for none",
                len(slots) - 1,
            ),
        )
    before, after = list(slots[:-3]), slots[-3:]
    offset = 0
    if len(before) % 2:
        if before[-1] == NONE:
            before.pop()
        elif before[0] == NONE:
            before.pop(0)
            offset = 1
        else:
            message = f"`{before[-1]}` is only half of a rotation"
            return (Problem(message, "write axis and degrees", len(before) - 1),)
    problems: list[Problem] = []

    def number(place: int, wanted: NumberRange) -> Decimal:
        found = wanted.read(slots[place])
        if isinstance(found, Problem):
            problems.append(found._replace(begin=place))
            return Decimal(0)
        return found

    rotations = []
    for place in range(offset, offset + len(before), 2):
        axis = slots[place]
        if axis == slots[place + 1] == NONE:
            continue
        if axis not in AXES:
            message = f"expected an axis, found `{axis}`"
            problems.append(Problem(message, "write `x`, `y`, `z` or `_`", place))
        rotations.append((axis, number(place + 1, ANGLE)))
    x, y, z = (
        Decimal(0) if slot == NONE else number(place, LENGTH)
        for place, slot in enumerate(after, len(slots) - 3)
    )
    return tuple(problems) or Transformation(tuple(rotations), (x, y, z))


def normalized(transformation: Transformation) -> Transformation:
    """Return an equal transformation in a unique form.

    Turns are above -180 and at most 180 degrees. None is 0, and no two consecutive ones share an
    axis.
    """
    turns: list[tuple[str, Decimal]] = []
    for axis, degrees in transformation.rotations:
        before = turns.pop()[1] if turns and turns[-1][0] == axis else 0
        turn = (before + degrees) % 360  # with the sign of the sum
        turn += 360 if turn <= -180 else -360 if turn > 180 else 0
        if turn:
            turns.append((axis, turn))
    return Transformation(tuple(turns), transformation.translation)
