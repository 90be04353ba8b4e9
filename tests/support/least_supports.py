"""The inherited functions of a mounted module and their providers, from sections 3 and 5 alone.

Nothing here uses `mars_asp.kinematics` or reads `rules/`. Frames are 4x4 matrices, lengths in mm; a
twist is angular (radians), then linear, each in the frame of the module that inherits.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mars_asp.model.declarations import Module, Mount, Transformation

Matrix: TypeAlias = NDArray[np.float64]
#: The provider of a column (6,), and the column.
Column: TypeAlias = tuple[str, Matrix]
Values: TypeAlias = Mapping[tuple[str, str], float]
FUNCTIONS = ("Rotn_X", "Rotn_Y", "Rotn_Z", "Trans_X", "Trans_Y", "Trans_Z")
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


class UnclearError(Exception):
    """Floating point cannot decide whether carriers provide a motion."""


def turned(axis: str, degrees: float) -> Matrix:
    """Return the 4x4 turn about an axis (Rodrigues)."""
    x, y, z = AXES[axis]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
    angle = math.radians(degrees)
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return matrix


def moved(shift: Sequence[float]) -> Matrix:
    matrix = np.eye(4)
    matrix[:3, 3] = shift
    return matrix


def placed(tuple_: Transformation | None) -> Matrix:
    """Return where a tuple takes a point: its turns in order about fixed axes, then its shift."""
    matrix = np.eye(4)
    if tuple_ is None:
        return matrix
    for axis, degrees in tuple_.rotations:
        matrix = turned(axis, float(degrees)) @ matrix
    return moved([float(length) for length in tuple_.translation]) @ matrix


def vertex(module: Module | None, number: int | None) -> Matrix:
    found = [v for v in (module.vertices if module else ()) if v.number == (number or 0)]
    return placed(found[0].transformation) if found else np.eye(4)


def acted(function: str, value: float) -> Matrix:
    """Return the 4x4 transformation of a motion function by a value in degrees or mm."""
    kind, axis = function.split("_")
    if kind == "Rotn":
        return turned(axis.lower(), value)
    return moved([value * part for part in AXES[axis.lower()]])


def columns(
    name: str, mounts: Mapping[str, Mount], modules: Mapping[str, Module], values: Values
) -> Iterator[Column]:
    """Yield the twist of each motion of the carriers of a module, nearest first."""
    way = np.eye(4)  # from the module's frame to the one that is looked at
    while name in mounts:
        mount = mounts[name]
        at = vertex(modules.get(name), mount.mounting_vertex)
        on = vertex(modules.get(mount.mounted), mount.mounted_vertex)
        way = on @ placed(mount.transformation) @ np.linalg.inv(at) @ way
        name = mount.mounted
        # The first declared function acts nearest to the carrier, so from here it comes last.
        for function in reversed(motions(modules.get(name))):
            kind, axis = function.split("_")
            direction = np.array(AXES[axis.lower()], dtype=float)
            turn = way[:3, :3].T
            none = np.zeros(3)
            if kind == "Rotn":
                yield name, np.hstack([turn @ direction, turn @ np.cross(direction, way[:3, 3])])
            else:
                yield name, np.hstack([none, turn @ direction])
            way = acted(function, values.get((name, function), 0.0)) @ way


def motions(module: Module | None) -> tuple[str, ...]:
    return tuple(f.name for f in module.functions if f.name in FUNCTIONS) if module else ()


def carriers(name: str, mounts: Mapping[str, Mount]) -> list[str]:
    """Return the carriers of a module, nearest first."""
    found = []
    while name in mounts:
        name = mounts[name].mounted
        found.append(name)
    return found


def combines(given: Sequence[Matrix], function: str, rows: int) -> bool:
    """Whether columns combine to the unit twist of a function, in its first rows.

    Raises:
        UnclearError: they nearly do.
    """
    wanted = np.zeros(6)
    wanted[FUNCTIONS.index(function)] = 1.0
    if not given:
        return False
    matrix = np.array(given).T
    matrix[3:] /= 100.0  # a lever arm is then about as long as an axis
    wanted[3:] /= 100.0
    matrix, wanted = matrix[:rows], wanted[:rows] / np.linalg.norm(wanted)
    lengths = np.linalg.norm(matrix, axis=0)
    matrix = matrix[:, lengths > 1e-9] / lengths[lengths > 1e-9]
    if not matrix.size:
        return False
    shares = np.linalg.lstsq(matrix, wanted, rcond=1e-9)[0]
    missing = float(np.linalg.norm(matrix @ shares - wanted))
    if 1e-8 < missing < 1e-4:
        raise UnclearError(f"{function}: {missing}")
    return missing <= 1e-8


def gives(given: Sequence[Column], carrier: str, function: str) -> bool:
    """Whether one carrier alone provides a function; a rotation may come with a translation."""
    rows = 3 if function.startswith("Rotn") else 6
    return combines([column for name, column in given if name == carrier], function, rows)


def least_supports(
    name: str, mounts: Mapping[str, Mount], modules: Mapping[str, Module]
) -> dict[str, tuple[str, ...]]:
    """Return for each function that a module inherits the modules that provide it.

    Raises:
        UnclearError: floating point cannot decide.
    """
    above = carriers(name, mounts)
    rest = list(columns(name, mounts, modules, {}))
    generic = []
    for seed in range(3):
        drawn = np.random.default_rng(seed + 77)
        values = {(m, f): float(drawn.uniform(20, 160)) for m in above for f in FUNCTIONS}
        generic.append(list(columns(name, mounts, modules, values)))
    found: dict[str, tuple[str, ...]] = {}
    for function in FUNCTIONS:
        alone = [carrier for carrier in above if gives(rest, carrier, function)]
        if alone:
            found[function] = (alone[0],)
            continue
        entries = {support(given, above, function) for given in generic}
        if len(entries) > 1:
            raise UnclearError(f"{function}: {entries}")
        (least,) = entries
        if len(least) == 1:
            raise UnclearError(f"{function}: {least} gives it at a generic posture alone")
        if least:
            found[function] = least
    return found


def support(given: Sequence[Column], above: Sequence[str], function: str) -> tuple[str, ...]:
    """Return the least support of a function; empty where all carriers do not give it."""
    for size in range(1, len(above) + 1):
        able = [
            some
            for some in itertools.combinations(above, size)
            if combines([column for name, column in given if name in some], function, 6)
        ]
        if able:
            return min(able, key=lambda some: (sum(map(above.index, some)), sorted(some)))
    return ()
