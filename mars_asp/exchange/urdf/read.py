"""URDF to a configuration: joints as mounts and motion functions."""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np

from mars_asp.diagnostic import Diagnostic, MarsError, Span, whole_file
from mars_asp.exchange.unread import notes
from mars_asp.exchange.urdf.angles import (
    QUARTER,
    Turns,
    degrees_of,
    degrees_of_written,
    main_axis,
    rotation_of,
    turns_of,
    turns_to,
    writable,
)
from mars_asp.exchange.urdf.document import UrdfJoint, read_document
from mars_asp.language import Parsed
from mars_asp.model.declarations import (
    Configuration,
    Function,
    Module,
    Mount,
    Name,
    Transformation,
    Vertex,
)
from mars_asp.model.ranges import BOUND

_METRE = 1000
_MOST_PLACES = 3
_NONE = Decimal(0)


@dataclass(frozen=True, slots=True)
class _Placed:
    """A module mounted on `carrier`: turns about the carrier's axes, then a shift in metres."""

    module: Module
    carrier: str
    turns: Turns
    shift: tuple[Decimal, Decimal, Decimal]


def import_urdf(text: str, path: str) -> Parsed:
    """Return the configuration of a URDF document, with warnings, and notes of skipped contents.

    A link becomes a module, mounted on its parent. A joint that moves along or about x, y or z is
    a motion function of its child, a planar one has three of them and a floating one six; another
    one becomes a module of its own between the two, whose z is the joint's axis.

    Raises:
        MarsError: the document is not XML, has a document type, or has errors in links and joints.
    """
    document = read_document(text, path)
    links = _language_names(document.links)
    movers = _language_names((joint.name for joint in document.joints), links.values())
    placed = [p for joint in document.joints for p in _placements(joint, links, movers)]
    mounts, described = [], []
    for one in placed:
        mount, module = _mount(one)
        mounts.append(mount)
        if module.functions or module.vertices:
            described.append(module)
    inserted = set(movers.values())
    between = [Name(p.module.name, p.module.span) for p in placed if p.module.name in inserted]
    configuration = Configuration(
        path,
        whole_file(path),
        modules=(*(Name(links[name], at) for name, at in document.links.items()), *between),
        relationships=tuple(mounts),
        declared=tuple(described),
    )
    return Parsed(configuration, (*_remarks(document.joints), *notes(document.unread)))


def import_urdfs(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of the single file in `files`, a pair of text and path.

    Raises:
        MarsError: the document has errors, or there are several.
    """
    (text, path), *others = files
    if others:
        message = f"`{others[0][1]}` is a second document, and a robot has one in URDF"
        place = whole_file(others[0][1])
        raise MarsError((Diagnostic("usage", "error", message, place, help="give one at a time"),))
    found = import_urdf(text, path)
    configuration = replace(found.configuration, architecture="hierarchical")
    return found._replace(configuration=configuration)


def _placements(
    joint: UrdfJoint, links: dict[str, str], movers: dict[str, str]
) -> Iterator[_Placed]:
    turns = _written_turns(joint)
    child = Module(links[joint.child], joint.span)
    parent = links[joint.parent]
    axis = np.array([float(part) for part in joint.axis])
    letter = main_axis(axis)
    if joint.kind == "fixed":
        yield _Placed(child, parent, turns, joint.shift)
    elif letter or joint.kind == "floating":
        child = replace(child, functions=_functions(joint, letter or "Z"))
        yield _Placed(child, parent, turns, joint.shift)
    else:
        there = turns_to(axis)
        mover = Module(movers[joint.name], joint.span, functions=_functions(joint, "Z"))
        yield _Placed(mover, parent, (*there, *turns), joint.shift)
        back = tuple((name, -degrees) for name, degrees in reversed(there))
        yield _Placed(child, mover.name, back, (_NONE, _NONE, _NONE))


def _written_turns(joint: UrdfJoint) -> Turns:
    # Angles beyond a full turn are reduced to the equivalent ones below it.
    angles = (
        degrees_of_written(angle)
        if abs(angle) <= math.tau
        else degrees_of(math.remainder(float(angle), math.tau))
        for angle in joint.turns
    )
    return tuple(zip("xyz", angles, strict=True))


def _mount(placed: _Placed) -> tuple[Mount, Module]:
    """Return the mount of a module, and the module, which may have got a vertex for it.

    A tuple holds two turns, so the first of three is undone at vertex 1 of the mounting module.
    """
    turns = tuple((axis, degrees) for axis, degrees in placed.turns if degrees)
    if len(turns) > 2:
        turns = turns_of(rotation_of(turns))
    x, y, z = (writable(metres * _METRE) for metres in placed.shift)
    at = Transformation(turns[-2:], (x, y, z))
    module = placed.module
    mount = Mount(module.name, placed.carrier, module.span, transformation=at)
    if len(turns) < 3:
        return (mount if turns or x or y or z else replace(mount, transformation=None)), module
    (axis, degrees), *_ = turns
    vertex = Vertex(1, Transformation(((axis, -degrees),)), module.span)
    return replace(mount, mounting_vertex=1), replace(module, vertices=(vertex,))


def _functions(joint: UrdfJoint, letter: str) -> tuple[Function, ...]:
    """Return the motion functions of a joint along or about the axis `letter`."""
    match joint.kind:
        case "planar":
            names = [f"Trans_{each}" for each in "XYZ" if each != letter]
            return tuple(Function(name, joint.span) for name in (*names, f"Rotn_{letter}"))
        case "floating":
            names = [f"{kind}_{each}" for kind in ("Trans", "Rotn") for each in "XYZ"]
            return tuple(Function(name, joint.span) for name in names)
        case _:
            return (_joint_function(joint, letter),)


def _joint_function(joint: UrdfJoint, letter: str) -> Function:
    slides = joint.kind == "prismatic"

    def converted(value: Decimal | None) -> Decimal | None:
        if value is None:
            return None
        found = writable(value * _METRE) if slides else degrees_of_written(value)
        # A bound beyond the range of the language counts as open.
        return found if abs(found) <= BOUND.most else None

    name = f"{'Trans' if slides else 'Rotn'}_{letter}"
    bounds = converted(joint.lower), converted(joint.upper)
    return Function(name, joint.span, *bounds, converted(joint.rate) or None)


def _remarks(joints: Sequence[UrdfJoint]) -> Iterator[Diagnostic]:
    """Yield one warning for all joints that follow others, and one for all inexact right angles."""
    following = [joint for joint in joints if joint.mimics is not None and joint.kind != "fixed"]
    if following:
        lines = [f"`{joint.name}` follows `{joint.mimics}`" for joint in following]
        what = f"joint {lines[0]}, but is imported as independent"
        if len(following) > 1:
            what = f"{len(following)} joints follow others, but are imported as independent"
        help_text = "mounts cannot couple joints; inheritance assumes that both move independently"
        spans = [joint.span for joint in following]
        yield _remark("urdf-mimic", what, help_text, list(zip(spans, lines, strict=True)))
    near = [
        (joint.span, f"`{angle}`", f"`{nearest!r}`")
        for joint in joints
        for angle in joint.turns
        if 1e-9 < abs(float(angle) - (nearest := round(float(angle) / QUARTER) * QUARTER)) < 2e-3
    ]
    if near:
        what = f"{near[0][1]} is nearly a quarter turn, and is used as written"
        if len(near) > 1:
            what = f"{len(near)} angles are nearly quarter turns, and are used as written"
        help_text = f"for a right angle write {near[0][2]}; inheritance depends on it"
        yield _remark("urdf-angle", what, help_text, [(span, lines) for span, lines, _ in near])


def _remark(
    code: str, message: str, help_text: str, places: Sequence[tuple[Span, str]]
) -> Diagnostic:
    """Return a warning at several locations; the last label counts the remaining ones."""
    (first, _), *others = places
    labels = others[:_MOST_PLACES]
    if len(others) > len(labels):
        span, result = labels[-1]
        labels[-1] = span, f"{result}, and {len(others) - len(labels)} more"
    return Diagnostic(code, "warning", message, first, tuple(labels), help_text)


def _language_names(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Return for each name a distinct one that `.mars` allows, none of them in `taken`."""
    found: dict[str, str] = {}
    used, stems = set(taken), dict[str, int]()
    for name in names:
        stem = re.sub(r"^(?=[0-9])|\W", "_", name, flags=re.ASCII)
        word = stem
        while word in used:
            stems[stem] = stems.get(stem, 1) + 1
            word = f"{stem}_{stems[stem]}"
        found[name] = word
        used.add(word)
    return found
