"""The tuple of a mount: (axis, degrees) pairs, then a translation in mm."""

from collections.abc import Sequence
from decimal import Decimal

from mars_asp.model import Transformation
from mars_asp.modes import parse_number

AXES = ("x", "y", "z")
NONE = "_"
_MOST_SLOTS = 7
#: Rules reason with micrometres in whole 32 bit numbers.
_FARTHEST = 2_147_483


def read_transformation(slots: Sequence[str]) -> Transformation | tuple[int, str, str]:
    """Read the slots of a tuple, or return (slot, message, help) of what is wrong first.

    The last three slots are always the translation. Of an odd number before them one, the last
    or the first, must be `_`.
    """
    if not 3 <= len(slots) <= _MOST_SLOTS:
        return (
            len(slots) - 1,
            f"a tuple of {len(slots)} slots",
            "write `(axis, degrees, axis, degrees, x, y, z)` with `_` for none",
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
            return (
                len(before) - 1,
                f"`{before[-1]}` is half of a rotation",
                "write axis and degrees",
            )
    rotations = []
    for index in range(0, len(before), 2):
        axis, degrees = before[index : index + 2]
        angle = parse_number(degrees)
        if axis == degrees == NONE:
            continue
        if axis not in AXES:
            return (offset + index, f"`{axis}` is no axis", "write `x`, `y`, `z` or `_`")
        if angle is None:
            return (offset + index + 1, f"`{degrees}` is no angle", "write a number of degrees")
        rotations.append((axis, angle))
    translation = [Decimal(0) if slot == NONE else parse_number(slot) for slot in after]
    for index, length in enumerate(translation):
        place = len(slots) - 3 + index
        if length is None:
            return (place, f"`{slots[place]}` is no length", "write a number of mm or `_`")
        if abs(length) > _FARTHEST:
            message = f"`{slots[place]}` mm is farther than rules can reason about"
            return (place, message, f"write a number of mm from -{_FARTHEST} to {_FARTHEST}")
    x, y, z = (length for length in translation if length is not None)
    return Transformation(tuple(rotations), (x, y, z))
