"""Combinations of motions by brute force over subsets, written from the text of the reference.

Nothing here comes from `mars_asp.kinematics`: rotations are Rodrigues' formula,
the twist of a joint in a module's frame is `X^-1 S X` with the joint's generator S (Lynch and Park,
5.1.4), and every subset of modules and of columns is tried by least squares.
"""

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Column = tuple[str, str]
FUNCTIONS = ("Rotn_X", "Rotn_Y", "Rotn_Z", "Trans_X", "Trans_Y", "Trans_Z")
#: Lengths are measured in this many mm, so that turns and shifts weigh alike.
UNIT = 100.0
Turns = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Placing:
    """A tuple: turns about fixed axes in order, then a shift in mm."""

    turns: Turns
    shift: tuple[float, float, float]

    def matrix(self) -> Matrix:
        pose = np.eye(4)
        for axis, degrees in self.turns:
            pose = turned("xyz".index(axis), np.radians(degrees)) @ pose
        pose[:3, 3] = self.shift
        return pose

    def text(self) -> str:
        slots = [f"{axis},{degrees}" for axis, degrees in self.turns] or ["_,_"]
        return f"({','.join((*slots, *map(str, self.shift)))})"


@dataclass(frozen=True)
class Part:
    """A module of a tree: its functions in order, its vertex 1, and how it is mounted."""

    name: str
    functions: tuple[str, ...]
    vertex: Placing
    carrier: str | None = None
    at: int = 0
    on: int = 0
    placing: Placing = Placing((), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Tree:
    parts: Mapping[str, Part]

    def above(self, name: str) -> list[str]:
        """Return the carriers of a module, nearest first."""
        found = []
        while (carrier := self.parts[name].carrier) is not None:
            found.append(name := carrier)
        return found

    def movers(self, name: str) -> list[str]:
        return [each for each in self.above(name) if self.parts[each].functions]

    def columns(self, name: str) -> list[Column]:
        return [(b, f) for b in self.above(name) for f in self.parts[b].functions]

    def lines(self) -> Iterator[str]:
        for part in self.parts.values():
            if part.carrier is not None:
                at, on = (f" {number}" if number else "" for number in (part.at, part.on))
                yield f"{part.name}{at} is_mounted_on {part.carrier}{on} {part.placing.text()}"

    def blocks(self) -> Iterator[str]:
        for part in self.parts.values():
            yield f"@module_start\n@module_name {part.name}"
            yield f"@Vertex 1 {part.vertex.text()}"
            yield from (f"@{function}" for function in part.functions)
            if not part.functions:
                yield "@Sense NotifyWhenReady\nImage grab(void);"
            yield "@module_end"


# ---- frames --------------------------------------------------------------------------------------


def generator(function: str) -> Matrix:
    """Return the 4x4 generator of a motion, of one radian or `UNIT` mm."""
    kind, axis = function.split("_")
    index = "XYZ".index(axis)
    found = np.zeros((4, 4))
    if kind == "Trans":
        found[index, 3] = UNIT
    else:
        found[(index + 2) % 3, (index + 1) % 3], found[(index + 1) % 3, (index + 2) % 3] = 1, -1
    return found


def turned(axis: int, radians: float) -> Matrix:
    """Rodrigues' formula, on homogeneous coordinates."""
    cross = generator(FUNCTIONS[axis])
    return np.asarray(np.eye(4) + np.sin(radians) * cross + (1 - np.cos(radians)) * cross @ cross)


def moved(function: str, value: float) -> Matrix:
    if function.startswith("Rotn"):
        return turned("XYZ".index(function[-1]), value)
    return np.asarray(np.eye(4) + value * generator(function))


def twists(tree: Tree, name: str, values: Mapping[Column, float]) -> dict[Column, Matrix]:
    """Return the twist of each joint that carries a module, in the module's frame."""
    way = np.eye(4)
    found: dict[Column, Matrix] = {}
    rider = tree.parts[name]
    while rider.carrier is not None:
        carrier = tree.parts[rider.carrier]
        at = rider.vertex.matrix() if rider.at else np.eye(4)
        on = carrier.vertex.matrix() if carrier.name and rider.on else np.eye(4)
        way = on @ rider.placing.matrix() @ np.linalg.inv(at) @ way
        for function in reversed(carrier.functions):
            column = (carrier.name, function)
            rate = np.linalg.inv(way) @ generator(function) @ way
            found[column] = np.array([rate[2, 1], rate[0, 2], rate[1, 0], *(rate[:3, 3] / UNIT)])
            way = moved(function, values.get(column, 0.0)) @ way
        rider = carrier
    return found


def generic_values(tree: Tree, seed: int) -> dict[Column, float]:
    chooser = random.Random(f"posture {seed}")
    joints = [(part.name, f) for part in tree.parts.values() for f in part.functions]
    return {joint: chooser.uniform(0.4, 2.5) * chooser.choice((-1, 1)) for joint in joints}


# ---- what the reference calls given, emergent and able ----------------------------------------


def reaches(columns: Iterable[Matrix], target: Matrix) -> bool:
    """Whether the columns combine to the target, by least squares."""
    matrix = np.array(list(columns)).T
    if not matrix.size:
        return False
    answer, *_ = np.linalg.lstsq(matrix, target, rcond=1e-9)
    return bool(np.abs(matrix @ answer - target).max() < 1e-6)


class Motions:
    """The effect on one module of the motions that carry it."""

    def __init__(self, tree: Tree, name: str, seed: int) -> None:
        self.tree, self.name = tree, name
        self.rest = twists(tree, name, {})
        self.there = twists(tree, name, generic_values(tree, seed))
        self.columns = frozenset(self.rest)

    def alone(self, module: str, function: str, posture: Mapping[Column, Matrix]) -> bool:
        return self.among([c for c in self.columns if c[0] == module], function, posture)

    @staticmethod
    def among(columns: Iterable[Column], function: str, posture: Mapping[Column, Matrix]) -> bool:
        """Whether columns combine to a function; a rotation may come with a translation."""
        rows = slice(0, 3) if function.startswith("Rotn") else slice(0, 6)
        unit = np.eye(6)[FUNCTIONS.index(function)]
        return reaches([posture[c][rows] for c in columns], unit[rows])

    def givers(self, function: str) -> list[str]:
        """Return the carriers that alone provide a function at rest, nearest first."""
        return [b for b in self.tree.movers(self.name) if self.alone(b, function, self.rest)]

    def together(self, columns: Iterable[Column], function: str) -> bool:
        unit = np.eye(6)[FUNCTIONS.index(function)]
        return reaches([self.there[c] for c in columns], unit)

    def emergent(self, function: str) -> bool:
        return self.together(self.columns, function) and not any(
            self.alone(b, function, posture)
            for b in self.tree.movers(self.name)
            for posture in (self.rest, self.there)
        )

    def supports(self, function: str) -> list[frozenset[str]]:
        """Return all supports of the fewest modules, the one that is named first."""
        above = self.tree.above(self.name)
        movers = self.tree.movers(self.name)
        for size in range(1, len(movers) + 1):
            found = [
                modules
                for modules in combinations(movers, size)
                if self.together([c for c in self.columns if c[0] in modules], function)
            ]
            if found:
                found.sort(key=lambda s: (sum(above.index(b) + 1 for b in s), sorted(s)))
                return [frozenset(modules) for modules in found]
        return []

    def shares(self, function: str, modules: frozenset[str]) -> frozenset[Column]:
        """Return the columns of modules whose removal loses the twist."""
        columns = [c for c in self.columns if c[0] in modules]
        return frozenset(
            c for c in columns if not self.together([d for d in columns if d != c], function)
        )

    def able(self, function: str, free: frozenset[Column]) -> bool:
        """Whether the free columns suffice for a function of the module, its own or inherited."""
        if (self.name, function) in free:
            return True
        columns = self.columns & free
        return self.together(columns, function) or any(
            self.among([c for c in columns if c[0] == b], function, posture)
            for b in self.tree.movers(self.name)
            for posture in (self.rest, self.there)
        )


def able_at_once(first: Motions, second: Motions, functions: tuple[str, str]) -> bool:
    """Whether two demands can be met at one time, by any division of the columns."""

    def needed(motions: Motions) -> frozenset[Column]:
        own = {(motions.name, f) for f in motions.tree.parts[motions.name].functions}
        return motions.columns | own

    one, two = needed(first), needed(second)
    if first.name == second.name:
        return all(first.able(function, one) for function in functions)
    shared = sorted(one & two)
    for size in range(len(shared) + 1):
        for part in combinations(shared, size):
            mine = (one - two) | set(part)
            if first.able(functions[0], mine) and second.able(functions[1], two - set(part)):
                return True
    return False


# ---- random trees --------------------------------------------------------------------------------


def random_placing(chooser: random.Random, oblique: float) -> Placing:
    turns = tuple(
        (
            chooser.choice("xyz"),
            chooser.choice((30, 45, 20, -70))
            if chooser.random() < oblique
            else chooser.choice((-90, 90, 180)),
        )
        for _ in range(chooser.choice((0, 0, 1, 2)))
    )
    x, y, z = (float(chooser.choice((0, 0, 50, -120, 300))) for _ in range(3))
    return Placing(turns, (x, y, z))


def random_tree(seed: int) -> Tree:
    """Return a tree of movers up to six deep, with sensors at its ends and between."""
    chooser = random.Random(seed)
    oblique = chooser.choice((0.0, 0.3, 0.7))
    few = chooser.choice((FUNCTIONS, ("Rotn_Z", "Trans_X"), ("Rotn_Z", "Rotn_Y"), FUNCTIONS[3:]))
    parts: dict[str, Part] = {}

    def add(name: str, functions: Sequence[str], carrier: str | None) -> None:
        vertex = random_placing(chooser, oblique)
        at, on = (chooser.choice((0, 0, 1)) for _ in range(2))
        placing = random_placing(chooser, oblique)
        if carrier is None:
            parts[name] = Part(name, tuple(functions), vertex)
        else:
            parts[name] = Part(name, tuple(functions), vertex, carrier, at, on, placing)

    depth = chooser.randint(2, 6)
    for level in range(depth):
        count = min(len(few), chooser.choice((1, 1, 1, 2, 3) if depth < 5 else (1, 1, 1, 2)))
        add(f"M{level}", chooser.sample(few, count), f"M{level - 1}" if level else None)
    add("Cam", (), f"M{depth - 1}")
    if chooser.random() < 0.6:
        add("Eye", (), f"M{chooser.randrange(depth)}")
    # Two on one vertex would be a conflict of mounts.
    taken: set[tuple[str | None, int]] = set()
    for name, part in list(parts.items()):
        if part.on and (part.carrier, part.on) in taken:
            parts[name] = Part(
                part.name, part.functions, part.vertex, part.carrier, part.at, 0, part.placing
            )
        taken.add((part.carrier, part.on))
    return Tree(parts)
