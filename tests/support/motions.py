"""Combined motions of mounted modules by brute force, from sections 3 and 5 of the reference alone.

Nothing here uses `mars_asp.kinematics` or reads `rules/`. Frames are 4x4 matrices in mm. A twist is
angular, then linear, in the frame of the module that is moved: of one radian, or of `UNIT` mm, so
that turns and shifts weigh alike.
"""

import itertools
import math
import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mars_asp.model.declarations import (
    MOTION_FUNCTIONS,
    Configuration,
    Module,
    Mount,
    Transformation,
)

Matrix: TypeAlias = NDArray[np.float64]
#: A module and one of its motion functions.
Joint: TypeAlias = tuple[str, str]
#: The positions of joints, in degrees or mm.
Values: TypeAlias = Mapping[Joint, float]
UNIT = 100.0
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


class UnclearError(Exception):
    """Floating point cannot decide whether carriers provide a motion."""


def measure(function: str) -> float:
    """Return how many degrees are a radian, or how many mm are `UNIT`."""
    return math.degrees(1) if function.startswith("Rotn") else UNIT


def direction(function: str) -> Matrix:
    return np.array(AXES[function[-1].lower()], dtype=float)


# ---- Frames --------------------------------------------------------------------------------------


def turned(axis: str, degrees: float) -> Matrix:
    """Return the 4x4 turn about an axis (Rodrigues)."""
    x, y, z = AXES[axis]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
    angle = math.radians(degrees)
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return matrix


def moved(shift: Sequence[float] | Matrix) -> Matrix:
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
    if function.startswith("Rotn"):
        return turned(function[-1].lower(), value)
    return moved(value * direction(function))


def motions_of(module: Module | None) -> tuple[str, ...]:
    found = module.functions if module else ()
    return tuple(each.name for each in found if each.name in MOTION_FUNCTIONS)


def twists(
    name: str, mounts: Mapping[str, Mount], modules: Mapping[str, Module], values: Values
) -> Iterator[tuple[Joint, Matrix]]:
    """Yield the twist of each joint that carries a module, nearest first."""
    way = np.eye(4)  # from the module's frame to the one that is looked at
    while name in mounts:
        mount = mounts[name]
        at = vertex(modules.get(name), mount.mounting_vertex)
        on = vertex(modules.get(mount.mounted), mount.mounted_vertex)
        way = on @ placed(mount.transformation) @ np.linalg.inv(at) @ way
        name = mount.mounted
        # The first declared function acts nearest to the carrier, so from here it comes last.
        for function in reversed(motions_of(modules.get(name))):
            along, turn = direction(function), way[:3, :3].T
            if function.startswith("Rotn"):
                lever = np.cross(along, way[:3, 3]) / UNIT
                yield (name, function), np.hstack([turn @ along, turn @ lever])
            else:
                yield (name, function), np.hstack([np.zeros(3), turn @ along])
            way = acted(function, values.get((name, function), 0.0)) @ way


def generic_values(configuration: Configuration, seed: int) -> Values:
    """Return positions of all joints, in which no motion is lost by chance."""
    chooser = random.Random(f"posture {seed}")
    joints = [(module.name, f) for module in configuration.declared for f in motions_of(module)]
    return {
        joint: chooser.uniform(0.4, 2.5) * chooser.choice((-1, 1)) * measure(joint[1])
        for joint in joints
    }


def combines(given: Iterable[Matrix], function: str, rows: int = 6) -> bool:
    """Whether twists combine to the unit twist of a function, in its first rows.

    Raises:
        UnclearError: they nearly do.
    """
    matrix = np.array(list(given)).T[:rows]
    wanted = np.eye(6)[MOTION_FUNCTIONS.index(function)][:rows]
    lengths = np.linalg.norm(matrix, axis=0) if matrix.size else np.zeros(0)
    if not np.any(lengths > 1e-9):
        return False
    matrix = matrix[:, lengths > 1e-9] / lengths[lengths > 1e-9]
    shares = np.linalg.lstsq(matrix, wanted, rcond=1e-9)[0]
    missing = float(np.linalg.norm(matrix @ shares - wanted))
    if 1e-8 < missing < 1e-4:
        raise UnclearError(f"{function}: {missing}")
    return missing <= 1e-8


# ---- The motions that the reference calls given, emergent and able -------------------------------


class Motions:
    """The effect on one module of the motions that carry it, at rest and at a generic posture."""

    def __init__(
        self, name: str, mounts: Mapping[str, Mount], modules: Mapping[str, Module], values: Values
    ) -> None:
        self.name, self.module = name, modules.get(name)
        self.carriers: list[str] = []
        while name in mounts:
            name = mounts[name].mounted
            self.carriers.append(name)
        self.rest = dict(twists(self.name, mounts, modules, {}))
        self.there = dict(twists(self.name, mounts, modules, values))
        self.joints = frozenset(self.rest)
        self.movers = [b for b in self.carriers if any(b == module for module, _ in self.rest)]

    def alone(self, carrier: str, function: str, posture: Mapping[Joint, Matrix]) -> bool:
        """Whether one carrier gives a function; a rotation may come with a translation."""
        rows = 3 if function.startswith("Rotn") else 6
        return combines([posture[j] for j in posture if j[0] == carrier], function, rows)

    def givers(self, function: str) -> list[str]:
        """Return the carriers that alone provide a function at rest, nearest first."""
        return [b for b in self.movers if self.alone(b, function, self.rest)]

    def together(self, joints: Iterable[Joint], function: str) -> bool:
        return combines([self.there[joint] for joint in joints], function)

    def emergent(self, function: str) -> bool:
        return self.together(self.joints, function) and not any(
            self.alone(b, function, posture)
            for b in self.movers
            for posture in (self.rest, self.there)
        )

    def supports(self, function: str) -> list[frozenset[str]]:
        """Return all supports of the fewest modules, the one that is named first."""
        for size in range(1, len(self.movers) + 1):
            found = [
                modules
                for modules in itertools.combinations(self.movers, size)
                if self.together([j for j in self.joints if j[0] in modules], function)
            ]
            if found:
                found.sort(key=lambda s: (sum(map(self.carriers.index, s)), sorted(s)))
                return [frozenset(modules) for modules in found]
        return []

    def able(self, function: str, free: frozenset[Joint]) -> bool:
        """Whether the free joints suffice for a function of the module, its own or inherited."""
        joints = self.joints & free
        return (
            (self.name, function) in free
            or self.together(joints, function)
            or any(
                self.alone(b, function, {j: posture[j] for j in joints})
                for b in self.movers
                for posture in (self.rest, self.there)
            )
        )

    def usable(self) -> frozenset[Joint]:
        """Return the joints of the module and of all that carries it."""
        return self.joints | {(self.name, f) for f in motions_of(self.module)}


def all_motions(configuration: Configuration, seed: int) -> dict[str, Motions]:
    """Return the motions of each declared module of a configuration."""
    mounts = {m.mounting: m for m in configuration.relationships if isinstance(m, Mount)}
    modules = {module.name: module for module in configuration.declared}
    values = generic_values(configuration, seed)
    return {name: Motions(name, mounts, modules, values) for name in modules}


def able_at_once(first: Motions, second: Motions, functions: tuple[str, str]) -> bool:
    """Whether two demands can be met at one time, by any division of the joints."""
    one, two = first.usable(), second.usable()
    if first.name == second.name:
        return all(first.able(function, one) for function in functions)
    shared = sorted(one & two)
    return any(
        first.able(functions[0], (one - two) | set(part))
        and second.able(functions[1], two - set(part))
        for size in range(len(shared) + 1)
        for part in itertools.combinations(shared, size)
    )


def least_supports(
    name: str, mounts: Mapping[str, Mount], modules: Mapping[str, Module]
) -> dict[str, tuple[str, ...]]:
    """Return for each function that a module inherits the modules that provide it.

    Raises:
        UnclearError: floating point cannot decide.
    """
    generic = []
    for seed in range(3):
        drawn = np.random.default_rng(seed + 77)
        joints = [(m, f) for m in modules for f in MOTION_FUNCTIONS]
        values = {joint: float(drawn.uniform(20, 160)) for joint in joints}
        generic.append(Motions(name, mounts, modules, values))
    found: dict[str, tuple[str, ...]] = {}
    for function in MOTION_FUNCTIONS:
        if alone := generic[0].givers(function):
            found[function] = (alone[0],)
            continue
        entries = {frozenset().union(*each.supports(function)[:1]) for each in generic}
        if len(entries) > 1:
            raise UnclearError(f"{function}: {entries}")
        (least,) = entries
        if len(least) == 1:
            raise UnclearError(f"{function}: {least} gives it at a generic posture alone")
        if least:
            found[function] = tuple(b for b in generic[0].carriers if b in least)
    return found


# ---- Random trees --------------------------------------------------------------------------------


def random_placing(chooser: random.Random, oblique: float) -> str:
    turns = [
        f"{chooser.choice('xyz')},"
        + str(
            chooser.choice((30, 45, 20, -70))
            if chooser.random() < oblique
            else chooser.choice((-90, 90, 180))
        )
        for _ in range(chooser.choice((0, 0, 1, 2)))
    ]
    shift = [str(chooser.choice((0, 0, 50, -120, 300))) for _ in range(3)]
    return f"({','.join([*(turns or ['_,_']), *shift])})"


def random_tree(seed: int, *, eye: bool = True) -> str:
    """Return movers up to six deep, with sensors at their end and, if wanted, between them."""
    chooser = random.Random(seed)
    oblique = chooser.choice((0.0, 0.3, 0.7))
    every = MOTION_FUNCTIONS
    few = chooser.choice((every, ("Rotn_Z", "Trans_X"), ("Rotn_Z", "Rotn_Y"), every[3:]))
    names, mounts, blocks = list[str](), list[str](), list[str]()
    # Two on one vertex would be a conflict of mounts.
    taken = set[str | None]()

    def add(name: str, functions: Sequence[str], carrier: str | None) -> None:
        vertex = random_placing(chooser, oblique)
        at, on = (chooser.choice((0, 0, 1)) for _ in range(2))
        placing = random_placing(chooser, oblique)
        names.append(name)
        blocks.append(block(name, *functions, vertex=vertex))
        if carrier is not None:
            on = 0 if carrier in taken else on
            taken.update([carrier] if on else [])
            mounts.append(f"{name} {at or ''} is_mounted_on {carrier} {on or ''} {placing}")

    depth = chooser.randint(2, 6)
    for level in range(depth):
        count = min(len(few), chooser.choice((1, 1, 1, 2, 3) if depth < 5 else (1, 1, 1, 2)))
        add(f"M{level}", chooser.sample(few, count), f"M{level - 1}" if level else None)
    add("Cam", (), f"M{depth - 1}")
    if eye and chooser.random() < 0.6:
        add("Eye", (), f"M{chooser.randrange(depth)}")
    return "\n".join(["@configuration", f"@modules {', '.join(names)}", *mounts, *blocks])


def block(name: str, *functions: str, vertex: str = "(_,_,_,_,_)") -> str:
    """Return the block of a module with functions, of a sensor if it has none."""
    body = [f"@{each}" for each in functions] or ["@Sense NotifyWhenReady", "Image grab(void);"]
    head = ["@module_start", f"@module_name {name}", f"@Vertex 1 {vertex}"]
    return "\n".join([*head, *body, "@module_end"])
