"""What mounts do to motions: numbers turned into facts, and no decision.

What is inherited, emergent or in conflict is for `rules/physical.lp` to say.
"""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from mars_asp.atom import Atom, Fact, Term
from mars_asp.facts import described_modules, module_classes, numbered
from mars_asp.frames import (
    TOLERANCE,
    Matrix,
    Posture,
    Robot,
    build_robot,
    generic_posture,
    inverse,
    jacobian,
    ranks_with_units,
    take_posture,
)
from mars_asp.model import MOTION_FUNCTIONS, Configuration, Control, Module, Mount
from mars_asp.ranges import MOST

_SEEDS = (1, 2, 3)
_ZERO, _GENERIC = Atom("zero"), Atom("generic")
_MILLION = 1_000_000


def frame_facts(
    configuration: Configuration, modules: Mapping[str, Module], moved: Iterable[str] = ()
) -> tuple[Fact, ...]:
    """Return how native functions of carriers show in the frames of those they carry.

    Told of sensors, end-effectors, whatever is controlled, and the modules `moved`; see
    `rules/vocabulary.lp` for the predicates. The place of each fact is the mount of the module
    that it is about.
    """
    mounts, known, heirs = _scene(configuration, modules)
    robot = build_robot(mounts, known)
    heirs = {name for name in (*heirs, *moved) if name in robot.carrier}
    if not heirs or not any(robot.joints.values()):
        return ()
    rest = take_posture(robot)
    generic = tuple(generic_posture(robot, seed) for seed in _SEEDS)
    spans = {mount.mounting: mount.span for mount in reversed(mounts)}
    return tuple(
        Fact(atom, spans[name])
        for name in robot.order
        if name in heirs
        for atom in _observations(robot, name, rest, generic)
    )


def frames(
    configuration: Configuration, modules: Mapping[str, Module]
) -> dict[str, tuple[str, Matrix]]:
    """Return each mounted or carrying module's root and its pose there at rest, 3x4 in mm.

    Modules on a cycle of mounts have none.
    """
    mounts, known, _ = _scene(configuration, modules)
    robot = build_robot(mounts, known)
    poses = take_posture(robot).poses
    root: dict[str, str] = {}
    for name in robot.order:
        root[name] = root[robot.carrier[name]] if name in robot.carrier else name
    return {name: (root[name], poses[name][:3]) for name in sorted(robot.order)}


def _scene(
    configuration: Configuration, modules: Mapping[str, Module]
) -> tuple[list[Mount], dict[str, Module], set[str]]:
    """Return the mounts in the order of their identifiers, the described, and who may inherit."""
    known = described_modules(configuration, modules)
    numbers = [relationship for _, relationship in numbered(configuration.relationships)]
    mounts = [relationship for relationship in numbers if isinstance(relationship, Mount)]
    heirs = {r.controlled for r in numbers if isinstance(r, Control)}
    for name, module in known.items():
        if not {"sensor", "end_effector"}.isdisjoint(module_classes(module)):
            heirs.add(name)
    return mounts, known, heirs


def _observations(
    robot: Robot, name: str, rest: Posture, generic: tuple[Posture, ...]
) -> Iterator[Atom]:
    ancestors = robot.ancestors(name)
    yield Atom("rooted", (name, ancestors[-1], len(ancestors)))
    providers = [ancestor for ancestor in ancestors if robot.joints[ancestor]]
    if not providers:
        return
    here = inverse(rest.poses[name])
    twists = jacobian(rest, name, providers)
    free = max(
        (jacobian(posture, name, providers) for posture in generic),
        key=lambda columns: ranks_with_units(columns)[0],
    )
    start = 0
    for provider in providers:
        joints = robot.joints[provider]
        own = slice(start, start + len(joints))
        start = own.stop
        for joint, twist in zip(joints, twists[:, own].T, strict=True):
            yield from _appearance(name, provider, joint.function, twist)
        place = (here @ rest.poses[provider])[:3, 3]
        yield from _lever_arms(name, provider, place, twists[:, own])
        if len(joints) > 1:
            yield from _own_ranks(name, provider, _ZERO, twists[:, own])
            yield from _own_ranks(name, provider, _GENERIC, free[:, own])
    if len(providers) > 1:
        rank, together = ranks_with_units(free)
        for function, other in zip(MOTION_FUNCTIONS, together, strict=True):
            yield Atom("chain_rank", (name, _GENERIC, function, rank, other))


def _appearance(name: str, provider: str, function: str, twist: Matrix) -> Iterator[Atom]:
    """Tell as what one function appears: one signed function, or shares of several."""
    turns = function.startswith("Rotn")
    direction = twist[:3] if turns else twist[3:]
    names = MOTION_FUNCTIONS[:3] if turns else MOTION_FUNCTIONS[3:]
    told: tuple[Term, ...] = (name, provider, function)
    largest = int(np.abs(direction).argmax())
    if abs(direction[np.arange(3) != largest]).max() < TOLERANCE:
        sign = 1 if direction[largest] > 0 else -1
        yield Atom("appears", (*told, names[largest], sign))
    else:
        for axis, share in zip(names, direction, strict=True):
            yield Atom("appears_in_part", (*told, axis, round(share * _MILLION)))


def _lever_arms(name: str, provider: str, place: Matrix, twists: Matrix) -> Iterator[Atom]:
    """Tell how far the axes of a provider, which meet in its place, pass what they turn."""
    turned = np.abs(twists[:3]).max(axis=1) > TOLERANCE
    for axis in np.flatnonzero(turned):
        micrometres = round(float(np.linalg.norm(np.delete(place, axis))) * 1000)
        if micrometres:
            told = (name, provider, MOTION_FUNCTIONS[axis], min(micrometres, MOST))
            yield Atom("lever_arm", told)


def _own_ranks(name: str, provider: str, posture: Atom, twists: Matrix) -> Iterator[Atom]:
    """Tell the ranks of one provider's functions, of turns without their shift: arcs count."""
    turning, turned = ranks_with_units(twists[:3])
    rank, moved = ranks_with_units(twists)
    told: tuple[Term, ...] = (name, provider, posture)
    for function, other in zip(MOTION_FUNCTIONS[:3], turned, strict=True):
        yield Atom("own_rank", (*told, function, turning, other))
    for function, other in zip(MOTION_FUNCTIONS[3:], moved[3:], strict=True):
        yield Atom("own_rank", (*told, function, rank, other))
