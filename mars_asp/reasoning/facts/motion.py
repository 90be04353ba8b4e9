"""The effects of mounts on motions, as facts.

`rules/physical.lp` decides from these facts which functions are inherited, emergent or in conflict.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import numpy as np

from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.kinematics.frames import (
    TOLERANCE,
    Joint,
    KinematicTree,
    Matrix,
    Posture,
    build_robot,
    generic_posture,
    inverse,
    jacobian,
    scaled,
    take_posture,
)
from mars_asp.kinematics.supports import circuits, columns_with_share, fewest_groups, spanned
from mars_asp.model.declarations import MOTION_FUNCTIONS, Configuration, Control, Module, Mount
from mars_asp.model.described import described_modules, module_classes
from mars_asp.model.ranges import MOST
from mars_asp.reasoning.facts.identifiers import numbered

_SEEDS = (1, 2, 3)
_ZERO, _GENERIC = Atom("zero"), Atom("generic")
_MILLION = 1_000_000


def frame_facts(
    configuration: Configuration,
    modules: Mapping[str, Module],
    queried: Iterable[tuple[str, str]] = (),
) -> tuple[Fact, ...]:
    """Return the motions that modules get from the native functions of their carriers, as facts.

    The facts are about sensors, end-effectors, controlled modules, and the pairs of function and
    module in `queried`; `rules/vocabulary.lp` has the predicates. The location of each fact is the
    mount of its module.
    """
    mounts, known, heirs = scene(configuration, modules)
    functions: dict[str, list[str]] = {}
    for function, name in dict.fromkeys(queried):
        functions.setdefault(name, []).append(function)
    robot = build_robot(mounts, known)
    heirs = {name for name in (*heirs, *functions) if name in robot.carrier}
    if not heirs or not any(robot.joints.values()):
        return ()
    rest, generic = postures(robot)
    spans = {mount.mounting: mount.span for mount in reversed(mounts)}
    return tuple(
        Fact(atom, spans[name])
        for name in robot.order
        if name in heirs
        for atom in observations(robot, name, rest, generic, functions.get(name, ()))
    )


def frames(
    configuration: Configuration, modules: Mapping[str, Module]
) -> dict[str, tuple[str, Matrix]]:
    """Return each mounted or carrying module's root and its pose there at rest, 3x4 in mm.

    Modules on a cycle of mounts are left out.
    """
    mounts, known, _ = scene(configuration, modules)
    robot = build_robot(mounts, known)
    poses = take_posture(robot).poses
    root: dict[str, str] = {}
    for name in robot.order:
        root[name] = root[robot.carrier[name]] if name in robot.carrier else name
    return {name: (root[name], poses[name][:3]) for name in sorted(robot.order)}


def postures(robot: KinematicTree) -> tuple[Posture, tuple[Posture, ...]]:
    """Return a robot's posture at rest, and several random ones without axes aligned by chance."""
    return take_posture(robot), tuple(generic_posture(robot, seed) for seed in _SEEDS)


def scene(
    configuration: Configuration, modules: Mapping[str, Module]
) -> tuple[list[Mount], Mapping[str, Module], set[str]]:
    """Return the mounts, the described modules, and the names of modules that may inherit motions.

    Sensors, end-effectors and controlled modules may inherit motions of their carriers.
    """
    known = described_modules(configuration, modules)
    numbers = [relationship for _, relationship in numbered(configuration.relationships)]
    mounts = [relationship for relationship in numbers if isinstance(relationship, Mount)]
    heirs = {r.controlled for r in numbers if isinstance(r, Control)}
    for name, module in known.items():
        if not {"sensor", "end_effector"}.isdisjoint(module_classes(module)):
            heirs.add(name)
    return mounts, known, heirs


def observations(
    robot: KinematicTree,
    name: str,
    rest: Posture,
    generic: tuple[Posture, ...],
    queried: Sequence[str],
) -> Iterator[Atom]:
    """Yield the facts about the motions that a mounted module gets from its carriers.

    All are in the frame of the module `name`. `rest` and `generic` are the postures of `postures`;
    `queried` are functions whose minimal combinations are added.
    """
    ancestors = robot.ancestors(name)
    yield Atom("rooted", (name, ancestors[-1], len(ancestors)))
    providers = [ancestor for ancestor in ancestors if robot.joints[ancestor]]
    if not providers:
        return
    here = inverse(rest.poses[name])
    twists = jacobian(rest, name, providers)
    free = max((jacobian(posture, name, providers) for posture in generic), key=_matrix_rank)
    alone: set[str] = set()
    start = 0
    for provider in providers:
        joints = robot.joints[provider]
        own = slice(start, start + len(joints))
        start = own.stop
        for joint, twist in zip(joints, twists[:, own].T, strict=True):
            shown = tuple(_appearance(name, provider, joint.function, twist))
            alone.update(str(atom.arguments[3]) for atom in shown if atom.name == "appears")
            yield from shown
        place = (here @ rest.poses[provider])[:3, 3]
        yield from _lever_arms(name, provider, place, twists[:, own])
        if len(joints) > 1:
            for posture, columns in ((_ZERO, twists[:, own]), (_GENERIC, free[:, own])):
                for function, names in _combinations(joints, columns):
                    alone.add(function)
                    for shared in names:
                        yield Atom("combines", (name, provider, posture, function, shared))
    if len(providers) > 1:
        yield from _supports(robot, name, free, alone)
        for function in queried:
            yield from _circuits(robot, name, free, function)


def _matrix_rank(columns: Matrix) -> int:
    return int(np.linalg.matrix_rank(scaled(columns), tol=TOLERANCE))


def _appearance(name: str, provider: str, function: str, twist: Matrix) -> Iterator[Atom]:
    """Yield the motion that a carrier's function gives a module: one axis, or several shares.

    `name` is the module, `provider` the carrier, `twist` the velocity of the module, in its frame.
    """
    turns = function.startswith("Rotn")
    direction = twist[:3] if turns else twist[3:]
    names = MOTION_FUNCTIONS[:3] if turns else MOTION_FUNCTIONS[3:]
    result: tuple[Term, ...] = (name, provider, function)
    largest = int(np.abs(direction).argmax())
    if abs(direction[np.arange(3) != largest]).max() < TOLERANCE:
        sign = 1 if direction[largest] > 0 else -1
        yield Atom("appears", (*result, names[largest], sign))
    else:
        for axis, share in zip(names, direction, strict=True):
            yield Atom("appears_in_part", (*result, axis, round(share * _MILLION)))


def _lever_arms(name: str, provider: str, place: Matrix, twists: Matrix) -> Iterator[Atom]:
    """Yield the distance of a module's origin from each axis by which a provider turns it.

    The axes of a provider meet in its origin, which is at `place` in the module's frame.
    """
    turned = np.abs(twists[:3]).max(axis=1) > TOLERANCE
    for axis in np.flatnonzero(turned):
        micrometres = round(float(np.linalg.norm(np.delete(place, axis))) * 1000)
        if micrometres:
            result = (name, provider, MOTION_FUNCTIONS[axis], min(micrometres, MOST))
            yield Atom("lever_arm", result)


def _combinations(joints: Sequence[Joint], twists: Matrix) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the motions that one provider's joints, with these `twists`, give together.

    Each comes with the contributing joints. Translations include those along an arc.
    """
    for rows, functions in ((twists[:3], MOTION_FUNCTIONS[:3]), (twists, MOTION_FUNCTIONS)):
        for index in np.flatnonzero(spanned(rows)):
            if rows is twists and index < 3:
                continue
            shared = columns_with_share(rows, int(index))
            yield functions[index], tuple(joints[column].function for column in shared)


def _supports(robot: KinematicTree, name: str, free: Matrix, alone: Set[str]) -> Iterator[Atom]:
    """Yield the smallest, nearest sets of carriers that provide a function only together.

    `free` has the twists of all joints in a generic posture; functions in `alone` are left out.
    """
    distance = {ancestor: n for n, ancestor in enumerate(robot.ancestors(name), 1)}
    providers = [ancestor for ancestor in distance if robot.joints[ancestor]]
    joints = [joint for provider in providers for joint in robot.joints[provider]]
    ends = np.cumsum([len(robot.joints[provider]) for provider in providers])
    groups = np.split(free, ends[:-1], axis=1)
    inside = spanned(free)
    wanted = [i for i, f in enumerate(MOTION_FUNCTIONS) if inside[i] and f not in alone]
    for unit, sets in fewest_groups(groups, wanted).items():
        function = MOTION_FUNCTIONS[unit]
        costs = [
            (sum(distance[providers[i]] for i in found), sorted(providers[i] for i in found), found)
            for found in sets
        ]
        costs.sort()
        nearest = [each for each in costs if each[0] == costs[0][0]]
        for number, (cost, _, found) in enumerate(nearest):
            columns = [c for i in found for c in range(ends[i] - groups[i].shape[1], ends[i])]
            yield Atom("support", (name, function, number, cost))
            for column in columns_with_share(free[:, columns], unit):
                joint = joints[columns[column]]
                yield Atom("shares", (name, function, number, joint.module, joint.function))


def _circuits(robot: KinematicTree, name: str, free: Matrix, function: str) -> Iterator[Atom]:
    """Yield minimal sets of joints, of several carriers, that together give a function."""
    joints = [joint for ancestor in robot.ancestors(name) for joint in robot.joints[ancestor]]
    if function not in MOTION_FUNCTIONS:
        return
    number = 0
    for circuit in circuits(free, MOTION_FUNCTIONS.index(function)):
        if len({joints[column].module for column in circuit}) > 1:
            for column in circuit:
                joint = joints[column]
                yield Atom("circuit", (name, function, number, joint.module, joint.function))
            number += 1
