"""The content of a diagram: a box for each module and node, a line for each relationship."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from mars_asp.diagnostic import Severity, Span
from mars_asp.language.print import print_number, print_relationship
from mars_asp.model.declarations import (
    FOREVER,
    Configuration,
    Control,
    Conversion,
    Data,
    Module,
    Mount,
    Relationship,
    Transformation,
    ends_of,
)
from mars_asp.model.described import module_classes
from mars_asp.model.ports import inputs, outputs
from mars_asp.model.rates import as_written
from mars_asp.output import visible

LineKind: TypeAlias = Literal["mount", "data", "control"]


@dataclass(frozen=True, slots=True)
class NumberedFinding:
    """A finding with its number in the diagram."""

    number: int
    severity: Severity
    text: str

    def __str__(self) -> str:
        """Return the finding's number, severity and message in one line."""
        return f"{self.number} {self.severity}: {self.text}"


def numbers(findings: Sequence[NumberedFinding]) -> str:
    """Return the gravest severity of findings and their numbers, as in `error 1, 3`."""
    if not findings:
        return ""
    return f"{gravest(findings)} {', '.join(str(each.number) for each in findings)}"


def gravest(findings: Iterable[NumberedFinding]) -> Severity:
    """Return `error` if any of the findings is an error, else `warning`."""
    return "error" if any(each.severity == "error" for each in findings) else "warning"


@dataclass(frozen=True, slots=True)
class Box:
    """A module or an introduced node; `note` describes it.

    `alone` is the reason why the box has no lines, empty if it has one.
    """

    name: str
    note: str
    node: str | None
    #: The colour that a rule pack gives nodes of this kind.
    colour: str | None = None
    carries: str | None = None
    alone: str = ""
    findings: tuple[NumberedFinding, ...] = ()


@dataclass(frozen=True, slots=True)
class Line:
    """A relationship in the direction of the flow, by the indices of its boxes.

    Mounts lead from the mounting module to its carrier. `label` may have several lines, `text` is
    the relationship as written. `outlet` and `inlet` are the ports of data, which may be None where
    there is only one. `rank` is the priority of a controller, `span` the location of the
    relationship.
    """

    kind: LineKind
    tail: int
    head: int
    label: str
    text: str
    outlet: str | None = None
    inlet: str | None = None
    rank: int | None = None
    span: Span | None = None
    findings: tuple[NumberedFinding, ...] = ()


@dataclass(frozen=True, slots=True)
class Picture:
    """The boxes and lines of a configuration or specification; all text is safe to show.

    `remark` is a sentence about boxes and lines that are left out.
    """

    title: str
    boxes: tuple[Box, ...]
    lines: tuple[Line, ...]
    remark: str = ""

    @property
    def marks(self) -> tuple[NumberedFinding, ...]:
        """The findings about its boxes and lines, by their numbers."""
        parts: tuple[Box | Line, ...] = (*self.boxes, *self.lines)
        found = {each for part in parts for each in part.findings}
        return tuple(sorted(found, key=lambda each: each.number))


def depict(
    configuration: Configuration, modules: Mapping[str, Module], *, classes: bool = False
) -> Picture:
    """Return the diagram of a configuration; it and `modules` have the descriptions of modules.

    Names that occur only in relationships have boxes; `classes` adds the paper's module classes.
    """
    described = configuration.with_declared(modules)
    conversions = {found.transformer: found for found in configuration.conversions}
    names = dict.fromkeys(name.text for name in configuration.modules)
    for relationship in configuration.relationships:
        names |= dict.fromkeys(_relationship_ends(relationship))
    introduces = configuration.kind == "specification"
    joined = {name for line in configuration.relationships for name in _relationship_ends(line)}
    unread = {name.text for name in configuration.opaque}
    boxes = [
        Box(
            _one_line(name),
            _module_note(described.get(name), conversions.get(name), classes),
            *(
                _node_look(name, configuration)
                if introduces and name not in described
                else (None, None, None)
            ),
            "" if name in joined else _reason(described.get(name), name in unread),
        )
        for name in names
    ]
    number = {name: index for index, name in enumerate(names)}
    lines = [
        _picture_line(relationship, number, described)
        for relationship in configuration.relationships
    ]
    declared = f"{configuration.architecture} " if configuration.declares_architecture else ""
    return Picture(f"{declared}{configuration.kind}", tuple(boxes), tuple(lines))


def _node_look(
    name: str, configuration: Configuration
) -> tuple[str | None, str | None, str | None]:
    """Return the kind of a node, its colour (of packs only), and the flow that it carries."""
    kind = configuration.node_kind(name)
    brought = next((each for each in configuration.kinds if each.kind == kind), None)
    if brought is not None:
        return kind, brought.colour, brought.carries
    return kind, None, kind and ("data" if kind.startswith("data") else "control")


def _relationship_ends(relationship: Relationship) -> tuple[str, str]:
    """Return the modules at the tail and the head of a relationship's line."""
    left, right = ends_of(relationship)
    return (left, right) if isinstance(relationship, Mount) else (right, left)


def _picture_line(
    relationship: Relationship, number: Mapping[str, int], described: Mapping[str, Module]
) -> Line:
    outlet = inlet = rank = None
    tail, head = (number[name] for name in _relationship_ends(relationship))
    kind: LineKind
    match relationship:
        case Mount():
            kind = "mount"
            at, on = relationship.mounting_vertex or 0, relationship.mounted_vertex or 0
            label = [f"vertex {at} on {on}"] if at or on else []
            if relationship.transformation is not None:
                label += _in_words(relationship.transformation)
        case Control():
            kind = "control"
            rank = relationship.priority
            words = [] if rank is None else [f"priority {rank}"]
            if relationship.hold_ms is not None:
                unit = "" if relationship.hold_ms == FOREVER else " ms"
                words.append(f"hold {relationship.hold_ms}{unit}")
            if relationship.allocation is not None:
                words.append(f"allocation {relationship.allocation}")
            label = [relationship.topic or "", " ".join(words)]
        case Data():
            kind = "data"
            ports = relationship.source_port, relationship.client_port
            outlet = ports[0] or _only_port(described.get(relationship.source), outputs)
            inlet = ports[1] or _only_port(described.get(relationship.client), inputs)
            label = [" → ".join(dict.fromkeys(port for port in ports if port is not None))]
            if relationship.hz is not None:
                label.append(_rate_label(relationship.hz))
            elif relationship.mode is not None:
                label.append(relationship.mode.text)
    text = _one_line(print_relationship(relationship))
    shown = "\n".join(filter(None, map(_one_line, label)))
    return Line(kind, tail, head, shown, text, outlet, inlet, rank, relationship.span)


def _in_words(transformation: Transformation) -> list[str]:
    """Return the rotations and shifts of a mount's transformation as texts."""
    turns = (
        f"{print_number(round(turn, 2))}° about {axis.lower()}"
        for axis, turn in transformation.rotations
    )
    lengths = (
        f"{print_number(length)} mm along {axis}"
        for axis, length in zip("xyz", transformation.translation, strict=True)
        if length
    )
    return [", ".join(turns), ", ".join(lengths)]


def _reason(module: Module | None, is_unread: bool) -> str:
    """Return why boxes have no lines; `is_unread`: topics of the module are unknown."""
    if not is_unread:
        return "nothing is connected to them"
    return "not in the catalogue" if module is None else "not all of their topics were read"


def _only_port(
    module: Module | None, ports: Callable[[Module], Mapping[str, object]]
) -> str | None:
    """Return the only output or input of a module, or None if it has none or several."""
    names = tuple(ports(module)) if module is not None else ()
    return names[0] if len(names) == 1 else None


def _module_note(module: Module | None, conversion: Conversion | None, classes: bool) -> str:
    if conversion is not None:
        return _one_line(f"{conversion.source} → {conversion.target}")
    if module is None:
        return ""
    words = [name.replace("_", " ") for name in module_classes(module)] if classes else []
    return ", ".join([*words, *(["guard"] if module.guard is not None else [])])


def _one_line(text: str) -> str:
    return visible(" ".join(text.split()))


def _rate_label(hz: Fraction) -> str:
    words = as_written(hz)
    return words if words.startswith("every") else f"{words} Hz"
