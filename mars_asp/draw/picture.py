"""What a picture shows: a box for each module and node, a line for each relationship."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import (
    FOREVER,
    Configuration,
    Control,
    Conversion,
    Data,
    Module,
    Mount,
    Relationship,
)
from mars_asp.model.described import module_classes
from mars_asp.model.ports import inputs, outputs
from mars_asp.model.rates import as_written
from mars_asp.output import visible

LineKind: TypeAlias = Literal["mount", "data", "control"]


@dataclass(frozen=True, slots=True)
class Box:
    """A module, or a node that was introduced; `note` says what it is or does."""

    name: str
    note: str
    node: str | None
    #: The colour that a rule pack gives nodes of this kind.
    colour: str | None = None
    carries: str | None = None


@dataclass(frozen=True, slots=True)
class Line:
    """A relationship in the direction in which things flow, by the index of its boxes.

    Mounts lead from the mounting module to what carries it. `text` is the relationship as written.
    `outlet` and `inlet` are the ports of data, which a line need not name where there is only one.
    """

    kind: LineKind
    tail: int
    head: int
    label: str
    text: str
    outlet: str | None = None
    inlet: str | None = None


@dataclass(frozen=True, slots=True)
class Picture:
    """The boxes and lines of a configuration or specification; all text is safe to show.

    `remark` is a sentence on what is not there.
    """

    title: str
    boxes: tuple[Box, ...]
    lines: tuple[Line, ...]
    remark: str = ""


def depict(configuration: Configuration, modules: Mapping[str, Module]) -> Picture:
    """Return the picture of a configuration, whose modules `modules` and itself describe.

    Names that only relationships mention have boxes, too.
    """
    described = {**modules, **{module.name: module for module in configuration.declared}}
    conversions = {found.transformer: found for found in configuration.conversions}
    names = dict.fromkeys(name.text for name in configuration.modules)
    for relationship in configuration.relationships:
        names |= dict.fromkeys(_ends(relationship))
    introduces = configuration.kind == "specification"
    boxes = [
        Box(
            _shown(name),
            _note(described.get(name), conversions.get(name)),
            *_node(name, configuration),
        )
        if introduces and name not in described
        else Box(_shown(name), _note(described.get(name), conversions.get(name)), None)
        for name in names
    ]
    number = {name: index for index, name in enumerate(names)}
    lines = [_line(relationship, number, described) for relationship in configuration.relationships]
    stated = f"{configuration.architecture} " if configuration.stated else ""
    return Picture(f"{stated}{configuration.kind}", tuple(boxes), tuple(lines))


def _node(name: str, configuration: Configuration) -> tuple[str | None, str | None, str | None]:
    """Return the kind of a node, the colour that a pack gives it, and what it carries."""
    kind = configuration.node_kind(name)
    brought = next((each for each in configuration.kinds if each.kind == kind), None)
    if brought is not None:
        return kind, brought.colour, brought.carries
    return kind, None, kind and ("data" if kind.startswith("data") else "control")


def _ends(relationship: Relationship) -> tuple[str, str]:
    match relationship:
        case Mount(mounting, mounted):
            return mounting, mounted
        case Control(controlled, controller):
            return controller, controlled
        case Data(client, source):
            return source, client


def _line(
    relationship: Relationship, number: Mapping[str, int], described: Mapping[str, Module]
) -> Line:
    outlet = inlet = None
    tail, head = (number[name] for name in _ends(relationship))
    kind: LineKind
    match relationship:
        case Mount():
            kind = "mount"
            at, on = relationship.mounting_vertex or 0, relationship.mounted_vertex or 0
            words = [f"vertex {at} on {on}"] if at or on else []
            if relationship.transformation is not None:
                words.append("".join(relationship.transformation.text.split()))
        case Control():
            kind = "control"
            words = [] if relationship.priority is None else [f"priority {relationship.priority}"]
            if relationship.hold_ms is not None:
                unit = "" if relationship.hold_ms == FOREVER else " ms"
                words.append(f"hold {relationship.hold_ms}{unit}")
            if relationship.allocation is not None:
                words.append(f"allocation {relationship.allocation}")
        case Data():
            kind = "data"
            ports = relationship.source_port, relationship.client_port
            words = [" → ".join(port for port in ports if port is not None)] if any(ports) else []
            outlet = ports[0] or _only_port(described.get(relationship.source), outputs)
            inlet = ports[1] or _only_port(described.get(relationship.client), inputs)
            if relationship.mode is not None:
                words.append(relationship.mode.text)
            if relationship.hz is not None:
                words.append(_rate(relationship.hz))
    label, text = _shown(" ".join(words)), _shown(print_relationship(relationship))
    return Line(kind, tail, head, label, text, outlet, inlet)


def _only_port(
    module: Module | None, ports: Callable[[Module], Mapping[str, object]]
) -> str | None:
    """Return the one output, or input, of a module that has no other."""
    names = tuple(ports(module)) if module is not None else ()
    return names[0] if len(names) == 1 else None


def _note(module: Module | None, conversion: Conversion | None) -> str:
    if conversion is not None:
        return _shown(f"{conversion.source} → {conversion.target}")
    if module is None:
        return ""
    words = [name.replace("_", " ") for name in module_classes(module)]
    return ", ".join([*words, *(["guard"] if module.guard is not None else [])])


def _shown(text: str) -> str:
    return visible(" ".join(text.split()))


def _rate(hz: Fraction) -> str:
    words = as_written(hz)
    return words if words.startswith("every") else f"{words} Hz"
