"""URDF: links and joints as mounted modules with motion functions, and back.

A link becomes a module; a moving joint becomes the motion function of a module of its own between
parent and child (named after the joint), for URDF joints move about any axis: that module is turned
so that its z axis is the joint's. Metres and radians become millimetres and degrees.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.frames import Matrix, build_robot, inverse, rotation
from mars_asp.model import Configuration, Function, Module, Mount, Name, Transformation, Vertex
from mars_asp.source import Span, point

_MOVING = {"revolute": "Rotn_Z", "continuous": "Rotn_Z", "prismatic": "Trans_Z"}


@dataclass(frozen=True, slots=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    origin: Matrix
    axis: Matrix
    limits: Mapping[str, str]


def import_urdf(text: str, path: str) -> Configuration:
    """Return the configuration of a URDF document.

    Raises:
        MarsError: the document is not XML, declares entities, or has joints that no mount can say.
    """
    root = _read(text, path)
    try:
        return _configuration(root, path)
    except KeyError as error:
        raise _refused(path, f"a joint lacks {error}, or no link is so named") from None
    except ValueError as error:
        raise _refused(path, f"a number is wrong: {error}") from None


def _configuration(root: ElementTree.Element, path: str) -> Configuration:
    """Raise KeyError for what is missing, ValueError for what is no number."""
    here = point(path, 1, 1)
    joints = [_joint(element) for element in root.findall("joint")]
    strange = [joint for joint in joints if joint.kind not in (*_MOVING, "fixed")]
    if strange:
        raise _refused(path, f"joint `{strange[0].name}` is `{strange[0].kind}`")
    names = [element.get("name", "") for element in root.findall("link")]
    names += [joint.name for joint in joints if joint.kind in _MOVING]
    word = _words(names)
    placed = [placed for joint in joints for placed in _mounts(joint, word, here)]
    mounts = [mount for mount, _ in placed]
    vertices = {mount.mounting: vertices for mount, vertices in placed if vertices}
    declared = {
        word[joint.name]: _module(joint, word, here) for joint in joints if joint.kind in _MOVING
    }
    for name, own in vertices.items():
        declared[name] = replace(declared.get(name, Module(name, here)), vertices=own)
    return Configuration(
        path,
        here,
        modules=tuple(Name(word[name], here) for name in names),
        relationships=tuple(mounts),
        declared=tuple(declared.values()),
    )


def export_urdf(configuration: Configuration, modules: Mapping[str, Module]) -> str:
    """Return the mount tree of a configuration as a URDF document.

    A module with motion functions gets one joint for each, in their order, before its own link.

    Raises:
        MarsError: nothing is mounted, or there is more than one root: URDF has one.
    """
    mounts = [r for r in configuration.relationships if isinstance(r, Mount)]
    known = {**modules, **{module.name: module for module in configuration.declared}}
    body = build_robot(mounts, known)
    roots = [name for name in body.order if name not in body.carrier]
    if len(roots) != 1:
        raise _refused(configuration.path, f"{len(roots)} roots, and URDF has exactly one")
    robot = ElementTree.Element("robot", name=roots[0])
    for name in body.order:
        functions = [joint.function for joint in body.joints[name]]
        stages = [f"{name}__{number}" for number in range(len(functions))] + [name]
        for stage in stages:
            ElementTree.SubElement(robot, "link", name=stage)
        if name in body.carrier:
            fixed = _add_joint(robot, f"{name}__mount", "fixed", body.carrier[name], stages[0])
            _add_origin(fixed, body.placement[name])
        for number, function in enumerate(functions):
            declared = next(f for f in known[name].functions if f.name == function)
            _add_motion(robot, declared, stages[number], stages[number + 1])
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n"


def turns_of(matrix: Matrix) -> tuple[tuple[str, Decimal], ...]:
    """Return rotations (x, y, z) about fixed axes in degrees that make up a 3x3 rotation."""
    roll, pitch, yaw = _roll_pitch_yaw(matrix)
    turns = zip("xyz", (roll, pitch, yaw), strict=True)
    return tuple((axis, _degrees(angle)) for axis, angle in turns if abs(angle) > 1e-14)


def _read(text: str, path: str) -> ElementTree.Element:
    """Parse XML and refuse every document type: entities live there."""

    def refuse(*_: object) -> None:
        raise _refused(path, "a document type or entity, which is refused")

    gate = expat.ParserCreate()
    gate.StartDoctypeDeclHandler = refuse
    try:
        gate.Parse(text, True)
        return ElementTree.fromstring(text)
    except (expat.ExpatError, ElementTree.ParseError, ValueError) as error:
        raise _refused(path, f"no XML: {error}") from None


def _joint(element: ElementTree.Element) -> _Joint:
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        raise KeyError("parent or child")
    origin, axis, limits = (element.find(name) for name in ("origin", "axis", "limit"))
    pose = np.eye(4)
    if origin is not None:
        pose[:3, 3] = _three(origin.get("xyz", "0 0 0")) * 1000
        for letter, angle in zip("xyz", _three(origin.get("rpy", "0 0 0")), strict=True):
            pose[:3, :3] = rotation(letter, float(_degrees(angle))) @ pose[:3, :3]
    along = _three("1 0 0" if axis is None else axis.get("xyz", "1 0 0"))
    if not along.any():
        raise ValueError("an axis of no length")
    return _Joint(
        element.attrib["name"],
        element.attrib["type"],
        parent.attrib["link"],
        child.attrib["link"],
        pose,
        along,
        {} if limits is None else limits.attrib,
    )


def _mounts(
    joint: _Joint, word: Mapping[str, str], here: Span
) -> Iterator[tuple[Mount, tuple[Vertex, ...]]]:
    if joint.kind == "fixed":
        yield _mount(word[joint.child], word[joint.parent], joint.origin, here)
        return
    turned = np.eye(4)
    turned[:3, :3] = _z_along(joint.axis)
    mover = word[joint.name]
    yield _mount(mover, word[joint.parent], joint.origin @ turned, here)
    yield _mount(word[joint.child], mover, inverse(turned), here)


def _mount(
    mounting: str, mounted: str, pose: Matrix, here: Span
) -> tuple[Mount, tuple[Vertex, ...]]:
    """Return a mount and the vertex it needs.

    A tuple holds two turns, so the first of three is undone at vertex 1 of the mounting module.
    """
    turns = turns_of(pose[:3, :3])
    x, y, z = (_number(float(length)) for length in pose[:3, 3])
    at = Transformation(turns[-2:], (x, y, z))
    if len(turns) < 3:
        return Mount(mounting, mounted, here, transformation=at), ()
    (axis, degrees), *_ = turns
    vertex = Vertex(1, Transformation(((axis, -degrees),)), here)
    return Mount(mounting, mounted, here, 1, transformation=at), (vertex,)


def _module(joint: _Joint, word: Mapping[str, str], here: Span) -> Module:
    def bound(key: str) -> Decimal | None:
        if key not in joint.limits or (joint.kind == "continuous" and key != "velocity"):
            return None
        value = float(joint.limits[key])
        if not math.isfinite(value):
            raise ValueError(joint.limits[key])
        return _number(value * 1000) if joint.kind == "prismatic" else _degrees(value)

    limits = (bound("lower"), bound("upper"), bound("velocity") or None)  # 0 says nothing
    return Module(word[joint.name], here, functions=(Function(_MOVING[joint.kind], here, *limits),))


def _add_joint(
    robot: ElementTree.Element, name: str, kind: str, parent: str, child: str
) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    return joint


def _add_origin(joint: ElementTree.Element, pose: Matrix) -> None:
    xyz = " ".join(repr(float(length) / 1000) for length in pose[:3, 3])
    rpy = " ".join(repr(angle) for angle in _roll_pitch_yaw(pose[:3, :3]))
    ElementTree.SubElement(joint, "origin", xyz=xyz, rpy=rpy)


def _add_motion(robot: ElementTree.Element, function: Function, parent: str, child: str) -> None:
    turns = function.name.startswith("Rotn")
    bounded = function.min is not None and function.max is not None
    kind = ("revolute" if bounded else "continuous") if turns else "prismatic"
    joint = _add_joint(robot, f"{parent}_{function.name}", kind, parent, child)
    axis = {"X": "1 0 0", "Y": "0 1 0", "Z": "0 0 1"}[function.name[-1]]
    ElementTree.SubElement(joint, "axis", xyz=axis)
    stated = {"lower": function.min, "upper": function.max, "velocity": function.rate}
    limits = {
        key: repr(math.radians(value) if turns else float(value) / 1000)
        for key, value in stated.items()
        if value is not None
    }
    if kind != "continuous" or limits:
        ElementTree.SubElement(joint, "limit", {"effort": "0", "velocity": "0", **limits})


def _z_along(axis: Matrix) -> Matrix:
    """Return a rotation by two turns that takes z to an axis; exact for the six main ones."""
    x, y, z = axis / np.linalg.norm(axis)
    tilt = float(_degrees(math.atan2(math.hypot(x, y), z)))
    return rotation("z", float(_degrees(math.atan2(y, x)))) @ rotation("y", tilt)


def _roll_pitch_yaw(matrix: Matrix) -> tuple[float, float, float]:
    pitch = math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    if math.hypot(matrix[0, 0], matrix[1, 0]) < 1e-12:  # x stands along z: one turn is free
        return math.atan2(-matrix[1, 2], matrix[1, 1]), pitch, 0.0
    roll = math.atan2(matrix[2, 1], matrix[2, 2])
    return roll, pitch, math.atan2(matrix[1, 0], matrix[0, 0])


def _degrees(radians: float) -> Decimal:
    """Return degrees; what is a quarter turn within rounding is one exactly."""
    degrees = math.degrees(radians)
    nearest = round(degrees / 90) * 90
    return _number(float(nearest) if abs(degrees - nearest) < 1e-9 else degrees)


def _number(value: float) -> Decimal:
    return Decimal(repr(value + 0.0))


def _three(text: str) -> Matrix:
    numbers = np.array([float(word) for word in text.split()])
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        raise ValueError(text)
    return numbers


def _words(names: list[str]) -> dict[str, str]:
    """Return names that the language can say, each its own."""
    taken: dict[str, str] = {}
    for name in names:
        stem = re.sub(r"\W", "_", name, flags=re.ASCII)
        word = stem if re.match(r"[A-Za-z_]", stem) else f"_{stem}"
        while word in taken.values():
            word += "_"
        taken[name] = word
    return taken


def _refused(path: str, message: str) -> MarsError:
    return MarsError((Diagnostic("urdf", "error", message, point(path, 1, 1)),))
