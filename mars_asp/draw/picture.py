"""The content of a diagram: a box for each module and node, a line for each relationship."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Literal, TypeAlias

from mars_asp.diagnostic import Severity, Span
from mars_asp.language.print import print_number, print_relationship
from mars_asp.model.declarations import (
    FOREVER,
    Configuration,
    Control,
    Conversion,
    Data,
    Gating,
    Limit,
    Lock,
    Module,
    Mount,
    Relationship,
    Reset,
    Sign,
    Strategy,
    Transformation,
    ends_of,
    ports_of,
)
from mars_asp.model.described import module_classes
from mars_asp.model.ports import inputs, outputs
from mars_asp.model.rates import as_written
from mars_asp.output import visible

#: The part of a box at which a link ends.
LinkEnd: TypeAlias = Literal["top", "side", "foot"]
LineKind: TypeAlias = Literal["mount", "data", "control", "reset", "lock", "limit"]
#: Letters of Gates in a line, after Brooks.
SIGNS: Mapping[Sign, str] = {"suppress": "S", "inhibit": "I"}
EFFECTS: Mapping[Sign, str] = {"suppress": "suppresses", "inhibit": "inhibits"}


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
    there is only one, and the topic of commands. `rank` is the priority of a controller, `span` the
    location of the relationship, `sign` the effect of a trigger.
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
    sign: Sign | None = None

    @property
    def end(self) -> LinkEnd:
        """The part of the box at its head where it ends."""
        if self.kind == "reset":
            return "foot"
        return "side" if self.sign or self.kind in ("lock", "limit") else "top"


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
    joined = {end: None for line in configuration.relationships for end in _relationship_ends(line)}
    names = dict.fromkeys(name.text for name in configuration.modules) | joined
    introduces = configuration.kind == "specification"
    notes = dict(_gate_notes(configuration))
    strategies = dict(_strategies(configuration))
    unread = {name.text for name in configuration.opaque}
    commanding = frozenset(_commanding(configuration, described))
    boxes = []
    for name in names:
        note = _module_note(described.get(name), conversions.get(name), classes)
        words = (notes.get(name, strategies.get(name)), note)
        alone = "" if name in joined else _reason(described.get(name), name in unread)
        look: tuple[str | None, str | None, str | None] = (None, None, None)
        if introduces and name not in described:
            look = _node_look(name, configuration, commanding)
        boxes.append(Box(_one_line(name), ", ".join(filter(None, words)), *look, alone))
    number = {name: index for index, name in enumerate(names)}
    lines = [
        _picture_line(relationship, number, described, notes, commanding)
        for relationship in configuration.relationships
        if not isinstance(relationship, Strategy)
    ]
    declared = f"{configuration.architecture} " if configuration.declares_architecture else ""
    return Picture(f"{declared}{configuration.kind}", tuple(boxes), tuple(lines))


def _node_look(
    name: str, configuration: Configuration, commanding: Set[str]
) -> tuple[str | None, str | None, str | None]:
    """Return the kind of a node, its colour (of packs only), and the flow that it carries.

    `commanding` has the gates of commands.
    """
    kind = configuration.node_kind(name)
    brought = next((each for each in configuration.kinds if each.kind == kind), None)
    if brought is not None:
        return kind, brought.colour, brought.carries
    if kind == "gate_node":
        return kind, None, "control" if name in commanding else "data"
    return kind, None, kind and ("data" if kind.startswith("data") else "control")


def _strategies(configuration: Configuration) -> Iterator[tuple[str, str]]:
    """Yield for modules and nodes how their controllers are arbitrated."""
    for line in configuration.relationships:
        if isinstance(line, Strategy):
            period = f", period {line.period_ms} ms" if line.period_ms is not None else ""
            yield line.controlled, f"{line.strategy} arbitration{period}"


def _gate_notes(configuration: Configuration) -> Iterator[tuple[str, str]]:
    """Yield each gate with the signs of its triggers."""
    signs: dict[str, set[Sign]] = {}
    if configuration.kind != "specification":
        return
    for line in configuration.relationships:
        if isinstance(line, Gating) and configuration.node_kind(line.gated) == "gate_node":
            signs.setdefault(line.gated, set()).add(line.sign)
    for gate, found in signs.items():
        yield gate, "/".join(letter for sign, letter in SIGNS.items() if sign in found)


def _commanding(configuration: Configuration, described: Mapping[str, Module]) -> Iterator[str]:
    """Yield the modules and gates whose name alone means their commands."""
    for line in configuration.relationships:
        if isinstance(line, Control):
            if configuration.node_kind(line.controlled) == "gate_node":
                yield line.controlled
            if line.controller not in described:
                yield line.controller
    for name, module in described.items():
        if "control_out_algorithm" in module_classes(module):
            yield name


def _relationship_ends(relationship: Relationship) -> tuple[str, str]:
    """Return the modules at the tail and the head of a relationship's line."""
    left, right = ends_of(relationship)
    return (left, right) if isinstance(relationship, Mount) else (right, left)


def _picture_line(
    relationship: Mount | Control | Data | Gating | Reset | Lock | Limit,
    number: Mapping[str, int],
    described: Mapping[str, Module],
    notes: Mapping[str, str],
    commanding: Set[str],
) -> Line:
    """Return the line of a relationship; `notes` are those of gates, `commanding` send commands."""
    inlet, outlet = ports_of(relationship)
    rank, sign = None, None
    ports = " → ".join(dict.fromkeys(port for port in (outlet, inlet) if port is not None))
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
            outlet = inlet = relationship.topic
        case Data():
            kind = "data"
            outlet = outlet or _only_port(described.get(relationship.source), outputs)
            inlet = inlet or _only_port(described.get(relationship.client), inputs)
            label = [ports]
            if relationship.hz is not None:
                rate = as_written(relationship.hz)
                label.append(rate if rate.startswith("every") else f"{rate} Hz")
            elif relationship.mode is not None:
                label.append(relationship.mode.text)
        case Gating(gated):
            kind = "control" if relationship.port is None and gated in commanding else "data"
            sign = relationship.sign
            # The note of a gate has the sign of all its triggers, unless there are two.
            word = EFFECTS[sign] if gated not in notes else SIGNS[sign] * ("/" in notes[gated])
            label = [ports, f"{word} {relationship.ms} ms"]
        case Reset():
            kind, label = "reset", [ports]
        case Lock():
            below = "" if relationship.priority is None else f" below {relationship.priority}"
            kind, label = "lock", [ports, f"locks{below}"]
        case Limit():
            kind, label = "limit", [ports, "limits"]
    if isinstance(relationship, Lock | Limit) and relationship.hold_ms is not None:
        label.append(f"hold {relationship.hold_ms} ms")
    text = _one_line(print_relationship(relationship))
    shown = "\n".join(filter(None, map(_one_line, label)))
    return Line(kind, tail, head, shown, text, outlet, inlet, rank, relationship.span, sign=sign)


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
