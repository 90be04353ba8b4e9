"""A URDF document: its links and joints, or all its errors at once."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.exchange.elements import XmlElement, read_elements
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.urdf.angles import FARTHEST, OPEN
from mars_asp.model.cycles import knots
from mars_asp.spelling import nearest

KINDS = ("fixed", "revolute", "continuous", "prismatic", "planar", "floating")
#: Children of a robot that are read, and its colours, which have no meaning for modules.
_READ = frozenset({"link", "joint", "material"})
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?")
_MOST = 200
_MOST_GUESSES = 20
_NONE, _ONE = Decimal(0), Decimal(1)
_Three: TypeAlias = tuple[Decimal, Decimal, Decimal]


@dataclass(frozen=True, slots=True)
class UrdfJoint:
    """A joint: metres and radians, as they are written.

    `axis` is a direction in the child's frame; `lower`, `upper` and `rate` are `None` where they
    are open or not stated; `mimics` is the joint that this one follows.
    """

    name: str
    kind: str
    parent: str
    child: str
    shift: _Three
    turns: _Three
    axis: _Three
    lower: Decimal | None
    upper: Decimal | None
    rate: Decimal | None
    mimics: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class UrdfDocument:
    """Links and joints in the order of the document; the joints make trees of the links.

    `links` maps the name of each link to its location, and `unread` are the other elements of the
    robot, such as `ros2_control`.
    """

    links: Mapping[str, Span]
    joints: tuple[UrdfJoint, ...]
    unread: tuple[Unread, ...] = ()


def read_document(text: str, path: str) -> UrdfDocument:
    """Return the links and joints of a URDF document.

    Raises:
        MarsError: all errors of the document, or the first of the XML.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return _UrdfReader(text.split("\n")).document(read_elements(text, path))


def _unexpanded(root: XmlElement) -> tuple[XmlElement, str] | None:
    """Return the first macro or expression of xacro with its text, or None."""
    left = [root]
    for element in left:
        if element.name.startswith("xacro:"):
            return element, f"the macro `<{element.name}>`"
        for key, value in element.attributes.items():
            if "${" in value or "$(" in value:
                return element, f'`{key}="{value[:_MOST]}"`'
        left += element.children
    return None


class _UrdfReader:
    """A reader of links and joints that collects all errors of a document."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        self.links: set[str] = set()
        self.problems: list[Diagnostic] = []

    def document(self, root: XmlElement) -> UrdfDocument:
        if root.name != "robot":
            self.note(
                root, f"`<{root.name}>` is not a `<robot>`", "a URDF document is one `<robot>`"
            )
        elif (found := _unexpanded(root)) is not None:
            element, written = found
            message = f"{written} is not expanded: this is a file of xacro"
            self.note(element, message, "expand it first: `xacro FILE > robot.urdf`")
            raise MarsError(self.problems)
        links, joints = list(root.named("link")), list(root.named("joint"))
        if not links and not self.problems:
            self.note(root, "the robot has no links", 'write one at least: `<link name="..."/>`')
        self.links = self.names(links)
        self.names(joints)
        read = tuple(map(self.joint, joints))
        if not self.problems:
            self.trees(read)
        if self.problems:
            raise MarsError(self.problems)
        others = (each for each in root.children if each.name not in _READ)
        return UrdfDocument(
            {each.attributes["name"]: each.span for each in links},
            read,
            tuple(Unread("elements besides links and joints", e.name, e.span) for e in others),
        )

    def note(self, at: XmlElement | UrdfJoint, message: str, help_text: str) -> None:
        excerpt = self.lines[at.span.line - 1]
        found = Diagnostic("urdf", "error", message, at.span, help=help_text, excerpt=excerpt)
        self.problems.append(found)

    def names(self, elements: Iterable[XmlElement]) -> set[str]:
        seen: set[str] = set()
        for element in elements:
            name = element.attributes.get("name", "")
            if not name.strip():
                self.note(element, f"a {element.name} without a name", 'write `name="..."`')
            elif name in seen:
                self.note(element, f"a second {element.name} named `{name}`", "rename one of them")
            seen.add(name)
        return seen

    def joint(self, element: XmlElement) -> UrdfJoint:
        """Return a joint, with defaults in place of wrong values; note the errors."""
        name, kind = (element.attributes.get(key, "") for key in ("name", "type"))
        if kind not in KINDS:
            found = f"joint `{name}` is `{kind}`" if kind else f"joint `{name}` has no type"
            self.note(element, found, self.hint(kind, KINDS))
        origin, axis, mimic = (_child(element, word) for word in ("origin", "axis", "mimic"))
        along = self.three(axis, "xyz", (_ONE, _NONE, _NONE))
        if axis is not None and not any(map(float, along)):
            self.note(axis, "an axis of length zero", "state its direction, such as `0 0 1`")
        lower, upper, rate = None, None, None
        if kind != "fixed" and (limit := _child(element, "limit")) is not None:
            rate = self.rate(limit)
            lower, upper = (None, None) if kind == "continuous" else self.bounds(limit)
        return UrdfJoint(
            name,
            kind,
            self.end(element, name, "parent"),
            self.end(element, name, "child"),
            self.three(origin, "xyz", (_NONE, _NONE, _NONE)),
            self.three(origin, "rpy", (_NONE, _NONE, _NONE)),
            along,
            lower,
            upper,
            rate,
            None if mimic is None else mimic.attributes.get("joint", ""),
            element.span,
        )

    def end(self, joint: XmlElement, name: str, role: str) -> str:
        element = _child(joint, role)
        link = "" if element is None else element.attributes.get("link", "")
        if element is None:
            self.note(joint, f"joint `{name}` has no {role}", f'write `<{role} link="..."/>` in it')
        elif link not in self.links:
            self.note(element, f"there is no link `{link}`", self.hint(link, self.links))
        return link

    def hint(self, word: str, known: Iterable[str]) -> str:
        """Return the help for an unknown word: the nearest known one, unless errors are many."""
        near = nearest(word, known) if len(self.problems) < _MOST_GUESSES else None
        if near:
            return f"did you mean `{near}`?"
        return f"write one of {', '.join(KINDS)}" if known is KINDS else "declare the link"

    def three(self, element: XmlElement | None, key: str, default: _Three) -> _Three:
        written = None if element is None else element.attributes.get(key)
        if element is None or written is None:
            return default
        words = written[:_MOST].split()
        match tuple(map(_decimal, words)):
            case (Decimal() as x, Decimal() as y, Decimal() as z) if len(written) < _MOST:
                if max(abs(x), abs(y), abs(z)) < FARTHEST:
                    return x, y, z
        found = f'`{key}="{written[:_MOST]}"` are not three numbers below {FARTHEST}'
        self.note(element, found, f'write `{key}="{" ".join(map(str, default))}"` or similar')
        return default

    def bounds(self, limit: XmlElement) -> tuple[Decimal | None, Decimal | None]:
        """Return lower and upper bound; None for open ones, 0 for one that is not stated."""
        declared = [key for key in ("lower", "upper") if key in limit.attributes]
        lower, upper = (self.limit_value(limit, key) for key in ("lower", "upper"))
        if lower > upper:
            self.note(limit, f"the lower bound {lower} is above the upper one", "swap them")
        return (
            lower if declared and lower > -OPEN else None,
            upper if declared and upper < OPEN else None,
        )

    def rate(self, limit: XmlElement) -> Decimal | None:
        """Return the maximal velocity, or None if it is open, or 0 (the joint could never move)."""
        found = self.limit_value(limit, "velocity")
        if found < 0:
            self.note(limit, f"the velocity {found} is below 0", "write its magnitude")
        return found if 0 < found < OPEN else None

    def limit_value(self, limit: XmlElement, key: str) -> Decimal:
        written = limit.attributes.get(key, "0")
        found = _decimal(written) if len(written) < _MOST else None
        if found is None:
            shown = f'`{key}="{written[:_MOST]}"`'
            self.note(limit, f"{shown} is not a number", "write one in metres or radians")
        return found or _NONE

    def trees(self, joints: Sequence[UrdfJoint]) -> None:
        """Note where joints do not make trees of the links."""
        above: dict[str, UrdfJoint] = {}
        for joint in joints:
            first = above.setdefault(joint.child, joint)
            if first is not joint:
                found = f"`{joint.child}` is the child of `{first.name}` and of `{joint.name}`"
                self.note(joint, found, "a link has one parent joint: delete the other")
        edges = [(joint.child, joint.parent, number) for number, joint in enumerate(joints)]
        for knot in knots(edges):
            names = ", ".join(f"`{joints[number].name}`" for _, _, number in knot.walk)
            found = f"the joints lead back to `{knot.walk[0][0]}`: {names}"
            self.note(
                joints[knot.walk[0][2]], found, "the links of a robot form a tree: delete one"
            )


def _child(element: XmlElement, name: str) -> XmlElement | None:
    return next(element.named(name), None)


def _decimal(word: str) -> Decimal | None:
    return Decimal(word) if _NUMBER.fullmatch(word) else None
