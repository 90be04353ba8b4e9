"""A mount tree to URDF: motion functions as joints."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from xml.etree import ElementTree

from mars_asp.diagnostic import NOT_EXPORTED, Diagnostic, MarsError
from mars_asp.exchange.unread import Unread, notes
from mars_asp.exchange.urdf.angles import OPEN, roll_pitch_yaw
from mars_asp.kinematics.frames import KinematicTree, build_robot
from mars_asp.model.declarations import (
    GRASP,
    MOTION_FUNCTIONS,
    Configuration,
    Function,
    Module,
    Mount,
    ends_of,
    verb_of,
)

#: A sort of lines and annotations that URDF cannot hold.
_ATTRIBUTES = "tags and properties"
_AXES = {"X": "1 0 0", "Y": "0 1 0", "Z": "0 0 1"}


def export_urdf(configuration: Configuration, modules: Mapping[str, Module]) -> str:
    """Return the mount tree of a configuration as a URDF document.

    A module's motion functions become joints in their order, the last of which carries its link;
    further links, named after the module, are between them, and below those of the root.
    `left_out` has what URDF cannot hold.

    Raises:
        MarsError: nothing is mounted, or the mounts are not one tree, which URDF requires.
    """
    mounts = [r for r in configuration.relationships if isinstance(r, Mount)]
    known = configuration.with_declared(modules)
    body = build_robot(mounts, known)
    roots = [name for name in body.order if name not in body.carrier]
    problems = tuple(_obstacles(configuration, mounts, body, roots))
    if problems:
        raise MarsError(problems)
    robot = ElementTree.Element("robot", name=roots[0])
    taken = set(body.order)
    for name in body.order:
        every = known[name].functions if name in known else ()
        functions = tuple(each for each in every if each.name in MOTION_FUNCTIONS)
        carried = name in body.carrier
        below = [_fresh(name, taken) for _ in functions[carried:]]
        stages = [body.carrier[name], *below, name] if carried else [*below, name]
        for stage in (*below, name):
            ElementTree.SubElement(robot, "link", name=stage)
        steps = functions or ((None,) if carried else ())
        for (parent, child), function in zip(pairwise(stages), steps, strict=True):
            called = f"{name}_{function.name if function else 'mount'}"
            kind = _joint_type(function)
            joint = ElementTree.SubElement(robot, "joint", name=called, type=kind)
            ElementTree.SubElement(joint, "parent", link=parent)
            ElementTree.SubElement(joint, "child", link=child)
            if carried and parent == body.carrier[name]:
                pose = body.placement[name]
                xyz = " ".join(_number_text(float(length) / 1000) for length in pose[:3, 3])
                rpy = " ".join(_number_text(angle) for angle in roll_pitch_yaw(pose[:3, :3]))
                ElementTree.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
            if function:
                _add_motion(joint, function)
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n"


def _number_text(value: float) -> str:
    """Return a number without the rounding of products: 2, not 1.9999999999999993."""
    return f"{value + 0.0:.15g}"


def left_out(configuration: Configuration, modules: Mapping[str, Module]) -> Iterator[Diagnostic]:
    """Yield a note for each sort of lines and annotations that URDF cannot hold.

    Modules without a mount are one sort, and their annotations are not listed.
    """
    return notes(_left_out(configuration, modules), NOT_EXPORTED)


def _left_out(configuration: Configuration, modules: Mapping[str, Module]) -> Iterator[Unread]:
    links, vertices = set[str](), set[tuple[str, int | None]]()
    for line in configuration.relationships:
        match line:
            case Mount(mounting, mounted):
                links |= {mounting, mounted}
                ends = (mounting, line.mounting_vertex), (mounted, line.mounted_vertex)
                vertices |= {*ends}
                for called, number in ends:
                    if number is not None:
                        yield Unread("numbers of vertices", f"{called} {number}", line.span)
            case _:
                yield Unread(f"lines with `{verb_of(line)}`", ends_of(line)[0], line.span)
    for name in configuration.modules:
        if name.text not in links:
            yield Unread("modules without a mount", name.text, name.span)
    for own in configuration.attributed:
        if own.module in links:
            yield Unread(_ATTRIBUTES, own.module, own.attribute.span)
    for module in configuration.with_declared(modules).values():
        if module.name in links:
            yield from _annotations_left_out(module)
            for vertex in module.vertices:
                if (module.name, vertex.number) not in vertices:
                    called = f"{module.name} {vertex.number}"
                    yield Unread("vertices without a mount", called, vertex.span)


def _annotations_left_out(module: Module) -> Iterator[Unread]:
    for function in module.functions:
        if function.name == GRASP:
            yield Unread("annotations `@Grasp`", module.name, function.span)
    for service in module.services:
        yield Unread("annotations of data and commands", module.name, service.span)
    for attribute in module.attributes:
        yield Unread(_ATTRIBUTES, module.name, attribute.span)
    if module.guard is not None:
        yield Unread("annotations `@Guard`", module.name, module.guard)


def _obstacles(
    configuration: Configuration, mounts: Sequence[Mount], body: KinematicTree, roots: Sequence[str]
) -> Iterator[Diagnostic]:
    """Yield the reasons why mounts are not one tree."""
    seen: set[str] = set()
    for mount in mounts:
        if mount.mounting not in body.carrier:
            message = f"the mounts of `{mount.mounting}` do not lead to a root"
            yield Diagnostic("urdf", "error", message, mount.span, help="open the cycle")
        elif mount.mounting in seen:
            message = f"`{mount.mounting}` is mounted twice"
            yield Diagnostic("urdf", "error", message, mount.span, help="keep one of its mounts")
        seen.add(mount.mounting)
    if not mounts:
        message = "nothing is mounted, and URDF describes mounts"
        yield Diagnostic("urdf", "error", message, configuration.span, help="add `is_mounted_on`")
    elif len(roots) > 1:
        named = ", ".join(f"`{name}`" for name in roots)
        message = f"there are {len(roots)} roots, {named}, but URDF has one"
        help_text = "mount them on one module, or write one robot to a file"
        yield Diagnostic("urdf", "error", message, configuration.span, help=help_text)


def _fresh(name: str, taken: set[str]) -> str:
    """Return `name` with a number that is not in `taken`, and add it there."""
    number = 0
    while (word := f"{name}__{number}") in taken:
        number += 1
    taken.add(word)
    return word


def _joint_type(function: Function | None) -> str:
    if function is None:
        return "fixed"
    if function.name.startswith("Trans"):
        return "prismatic"
    return "continuous" if function.min is None and function.max is None else "revolute"


def _add_motion(joint: ElementTree.Element, function: Function) -> None:
    """Add axis and limits; an open limit is `OPEN`, because a missing one means 0 in URDF."""
    ElementTree.SubElement(joint, "axis", xyz=_AXES[function.name[-1]])
    turns = function.name.startswith("Rotn")
    declared = {"lower": function.min, "upper": function.max, "velocity": function.rate}
    open_ = {"lower": -OPEN, "upper": OPEN, "velocity": OPEN}
    limits = {"effort": str(OPEN)}
    for key, value in declared.items():
        if value is None:
            limits[key] = str(open_[key])
        else:
            # Adding zero takes the sign of a zero away.
            limits[key] = _number_text(math.radians(value) if turns else float(value) / 1000)
    if joint.get("type") == "continuous":
        del limits["lower"], limits["upper"]
    ElementTree.SubElement(joint, "limit", limits)
