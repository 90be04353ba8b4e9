"""How several motions make up a function where one motion or mount is not there.

Numbers are turned into facts, as in `motion`; `rules/account` decides which lines are causes.
"""

from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import replace
from typing import TypeAlias

from mars_asp.asp.solve.atoms import Atom
from mars_asp.kinematics.frames import Joint, KinematicTree, build_robot
from mars_asp.model.declarations import Configuration, Module
from mars_asp.reasoning.facts.motion import observations, postures, scene

#: More motions and mounts than these are not tried one by one.
_MOST = 24
#: By function, the motions that make it up together.
_Parts: TypeAlias = Mapping[str, frozenset[Joint]]


def otherwise(
    configuration: Configuration, modules: Mapping[str, Module], wanted: Set[str]
) -> Iterator[Atom]:
    """Yield facts on how functions of the modules in `wanted` combine without each motion or mount.

    See `rules/account/vocabulary.lp` for the predicates.
    """
    mounts, known, _ = scene(configuration, modules)
    robot = build_robot(mounts, known)
    chains = {name: robot.ancestors(name) for name in robot.carrier if name in wanted}
    chains = {
        name: chain
        for name, chain in chains.items()
        if sum(1 + len(robot.joints[carrier]) for carrier in chain) <= _MOST
    }
    now = _joint_sets(robot, chains)
    for carrier in dict.fromkeys(each for chain in chains.values() for each in chain):
        carried = [name for name, chain in chains.items() if carrier in chain]
        for without, changed, gone in _changed(robot, carrier):
            then = _joint_sets(changed, carried)
            for name in carried:
                kept = {f: parts for f, parts in now[name].items() if gone.isdisjoint(parts)}
                yield from _differences(name, without, kept, then[name])


def _changed(
    robot: KinematicTree, carrier: str
) -> Iterator[tuple[Atom, KinematicTree, Set[Joint]]]:
    """Yield each variant of a robot in which a module lacks one of its motions, or its mount.

    Each comes with the atom of the change and with the joints that no longer act.
    """
    joints = robot.joints[carrier]
    for joint in joints:
        others = tuple(each for each in joints if each != joint)
        changed = replace(robot, joints={**robot.joints, carrier: others})
        yield Atom("lost", (carrier, joint.function)), changed, {joint}
    if carrier in robot.carrier:
        carriers = {name: each for name, each in robot.carrier.items() if name != carrier}
        beyond = {joint for each in robot.ancestors(carrier) for joint in robot.joints[each]}
        yield Atom("cut", (carrier,)), replace(robot, carrier=carriers), beyond


def _joint_sets(robot: KinematicTree, names: Iterable[str]) -> Mapping[str, _Parts]:
    """Return, by module and function, the joints that give the function together.

    Of several sets of joints it is the first one, which the rules choose as well.
    """
    rest, generic = postures(robot)
    result = {}
    for name in names:
        parts: dict[str, set[Joint]] = {}
        for atom in observations(robot, name, rest, generic, ()):
            match atom:
                case Atom("shares", (_, function, 0, module, motion)):
                    parts.setdefault(str(function), set()).add(Joint(str(module), str(motion)))
        result[name] = {function: frozenset(some) for function, some in parts.items()}
    return result


def _differences(name: str, without: Atom, kept: _Parts, then: _Parts) -> Iterator[Atom]:
    for function in sorted({*kept, *then}):
        parts = then.get(function, frozenset())
        if parts != kept.get(function, frozenset()):
            yield Atom("made_otherwise", (name, function, without))
            for part in sorted(parts, key=lambda joint: (joint.module, joint.function)):
                yield Atom("other_part", (name, function, without, part.module, part.function))
