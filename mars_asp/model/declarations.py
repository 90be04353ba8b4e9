"""The declarations of annotated sources and configurations, as plain frozen values.

Names follow the reference of the language: modules carry annotations, a configuration relates
modules by mounts, control and data relationships. Nothing here decides anything.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal, TypeAlias, get_args

from mars_asp.diagnostic import Span
from mars_asp.model.attributes import Attribute, Attributed

ServiceKind: TypeAlias = Literal[
    "Sense", "DataOut", "ControlOut", "DataIn", "Converts", "Done", "Reset"
]
Architecture: TypeAlias = Literal["flat", "hierarchical"]
ConfigurationKind: TypeAlias = Literal["configuration", "specification"]

SERVICE_KINDS: tuple[ServiceKind, ...] = get_args(ServiceKind)
MOTION_FUNCTIONS = ("Rotn_X", "Rotn_Y", "Rotn_Z", "Trans_X", "Trans_Y", "Trans_Z")
GRASP = "Grasp"
DELIVERY_MODES = (
    "NotifyWhenReady",
    "NotifyAtFrequency",
    "NotifyOnMax",
    "NotifyOnMin",
    "NotifyOnValue",
    "NotifyOnChange",
    "RequestWhenReady",
)
#: The most arguments a mode takes (a bound, a value and its tolerance, a least difference).
MODE_ARGUMENTS = {"NotifyOnMax": 1, "NotifyOnMin": 1, "NotifyOnValue": 2, "NotifyOnChange": 1}


@dataclass(frozen=True, slots=True)
class Mode:
    """A delivery mode: its name, numeric arguments and the field the condition is about.

    `text` is the mode as it was written; two modes are equal when they mean the same.
    """

    name: str
    arguments: tuple[Decimal, ...] = ()
    of: str | None = None
    text: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Service:
    """One function annotation with the content of the declaration after it.

    `output` and every input are normalised representation names; `None` is unknown (in `output`
    also: without one). `hz` is in Hertz. `commands` are the functions a ControlOut commands.
    `port` is the name of the output where it is not the function's; `parameters` are the names of
    the inputs, in their order, or None if one has none, and may be fewer than the inputs.
    `window_ms` is how far apart the messages of its inputs may be sent. `span` starts at the
    annotation's `@`.
    """

    kind: ServiceKind
    span: Span
    function: str | None = None
    output: str | None = None
    inputs: tuple[str | None, ...] = ()
    modes: tuple[Mode, ...] = ()
    hz: Fraction | None = None
    commands: tuple[str, ...] = ()
    cost: int = 1
    port: str | None = None
    parameters: tuple[str | None, ...] = ()
    window_ms: int | None = None


@dataclass(frozen=True, slots=True)
class Function:
    """A native motion function or `Grasp`: bounds in degrees or mm, `rate` per second."""

    name: str
    span: Span
    min: Decimal | None = None
    max: Decimal | None = None
    rate: Decimal | None = None


@dataclass(frozen=True, slots=True)
class Transformation:
    """A mount tuple: (axis, degrees) rotations in order, then a translation in mm."""

    rotations: tuple[tuple[str, Decimal], ...] = ()
    translation: tuple[Decimal, Decimal, Decimal] = (Decimal(0), Decimal(0), Decimal(0))
    text: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Vertex:
    """The pose of vertex `number` in its module's reference frame."""

    number: int
    transformation: Transformation
    span: Span


@dataclass(frozen=True, slots=True)
class Module:
    """An annotated or declared module.

    `span` starts at its `@module_start`, `named` at its name, `guard` at its `@Guard`.
    """

    name: str
    span: Span
    services: tuple[Service, ...] = ()
    functions: tuple[Function, ...] = ()
    vertices: tuple[Vertex, ...] = ()
    named: Span | None = None
    guard: Span | None = None
    attributes: tuple[Attribute, ...] = ()


@dataclass(frozen=True, slots=True)
class Name:
    """A module's name where it is written in a `.mars` file.

    `described` is the module that describes it, where that is stated: `left: Camera`.
    """

    text: str
    span: Span
    described: str | None = None


@dataclass(frozen=True, slots=True)
class Include:
    """`@include path as name`: the modules and relationships of another configuration."""

    path: str
    name: str | None
    span: Span


@dataclass(frozen=True, slots=True)
class Mount:
    """`mounting vertex is_mounted_on mounted vertex transformation`."""

    mounting: str
    mounted: str
    span: Span
    mounting_vertex: int | None = None
    mounted_vertex: int | None = None
    transformation: Transformation | None = None


#: How long a message stays in force: milliseconds, or for good.
Hold: TypeAlias = int | Literal["forever"]
FOREVER: Literal["forever"] = "forever"
Allocation: TypeAlias = Literal["root", "split"]
#: Which of those that give a function alone take it, nearest first, by the allocation.
TAKING: Mapping[str | None, slice] = {None: slice(1), "root": slice(-1, None), "split": slice(None)}


@dataclass(frozen=True, slots=True)
class Control:
    """`controlled is_controlled_by controller priority hold allocation`, one for each controller.

    `allocation` selects the provider of an inherited function; `None` is the nearest. `listed` is
    whether the priority is the controller's place in a list, not a number; `topic` is the ROS topic
    of the commands in an imported robot.
    """

    controlled: str
    controller: str
    span: Span
    priority: int | None = None
    hold_ms: Hold | None = None
    allocation: Allocation | None = None
    listed: bool = False
    topic: str | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Data:
    """`client.port uses_data_from source.port mode hz`; optional components are `None`."""

    client: str
    source: str
    span: Span
    mode: Mode | None = None
    hz: Fraction | None = None
    client_port: str | None = None
    source_port: str | None = None


Sign: TypeAlias = Literal["suppress", "inhibit"]
#: The word of a line that gates an output or input, by its sign.
GATING: Mapping[Sign, str] = {"suppress": "is_suppressed_by", "inhibit": "is_inhibited_by"}


@dataclass(frozen=True, slots=True)
class Gating:
    """`gated.port is_suppressed_by trigger.output ms`, or `is_inhibited_by`.

    After each message of the trigger, the line of the gated output or input is closed for `ms`
    milliseconds. `port` is an output of `gated`, or an input in the input form.
    """

    gated: str
    trigger: str
    span: Span
    sign: Sign
    ms: int
    port: str | None = None
    trigger_port: str | None = None


@dataclass(frozen=True, slots=True)
class Reset:
    """`module is_reset_by source.output`."""

    module: str
    source: str
    span: Span
    source_port: str | None = None


@dataclass(frozen=True, slots=True)
class Lock:
    """`controlled is_locked_by source.output priority hold`."""

    controlled: str
    source: str
    span: Span
    priority: int | None = None
    hold_ms: int | None = None
    source_port: str | None = None


@dataclass(frozen=True, slots=True)
class Limit:
    """`controlled is_limited_by source.output hold`."""

    controlled: str
    source: str
    span: Span
    hold_ms: int | None = None
    source_port: str | None = None


StrategyName: TypeAlias = Literal["hierarchical", "latest", "flat", "weighted"]
STRATEGIES: tuple[StrategyName, ...] = get_args(StrategyName)


@dataclass(frozen=True, slots=True)
class Strategy:
    """`controlled is_arbitrated_by strategy period`: how its controllers are arbitrated."""

    controlled: str
    span: Span
    strategy: StrategyName
    period_ms: int | None = None


Relationship: TypeAlias = Mount | Control | Data | Gating | Reset | Lock | Limit | Strategy
#: The attributes with the two ends of relationships, the left one first.
_END_NAMES: Mapping[type[Relationship], tuple[str, ...]] = {
    Mount: ("mounting", "mounted"),
    Control: ("controlled", "controller"),
    Data: ("client", "source"),
    Gating: ("gated", "trigger"),
    Reset: ("module", "source"),
    Lock: ("controlled", "source"),
    Limit: ("controlled", "source"),
    Strategy: ("controlled",),
}
#: The words between the two ends of relationships.
_VERB_OF: Mapping[type[Relationship], str] = {
    Mount: "is_mounted_on",
    Control: "is_controlled_by",
    Data: "uses_data_from",
    Reset: "is_reset_by",
    Lock: "is_locked_by",
    Limit: "is_limited_by",
    Strategy: "is_arbitrated_by",
}
VERBS = (*_VERB_OF.values(), *GATING.values())
#: The relationships that a specification has as lines between outputs and receivers.
Connection: TypeAlias = Control | Data | Gating | Reset | Lock | Limit
#: The programs of muxes in imported robots.
Engine: TypeAlias = Literal["twist_mux", "cmd_vel_mux"]
ENGINES: tuple[Engine, ...] = get_args(Engine)
#: The foreign formats of robots.
FOREIGN = ("urdf", "twist_mux", "rosgraph", "dora", "ros2")


@dataclass(frozen=True, slots=True)
class Inner:
    """A mux inside a cascade: its output is an input of another mux, which ranks it at `priority`.

    `numbers` are pairs of an input's priority in the configuration and as written; `name` is its
    own name, `topic` the input.
    """

    span: Span
    priority: int
    numbers: tuple[tuple[int, int], ...]
    inner: "tuple[Inner, ...]" = ()
    name: str | None = None
    topic: str | None = None


@dataclass(frozen=True, slots=True)
class Muxed:
    """A mux of an imported robot that ranks the commands for `module`, with its inner muxes.

    `numbers` are as in `Inner`, empty if the configuration has the original priorities.
    `name` is its own name, `topic` its output.
    """

    module: str
    engine: Engine
    span: Span
    numbers: tuple[tuple[int, int], ...] = ()
    inner: tuple[Inner, ...] = ()
    name: str | None = None
    topic: str | None = field(default=None, compare=False)


def verb_of(relationship: Relationship) -> str:
    """Return the word between the two ends of a relationship."""
    if isinstance(relationship, Gating):
        return GATING[relationship.sign]
    return _VERB_OF[type(relationship)]


def ports_of(relationship: Relationship) -> tuple[str | None, str | None]:
    """Return the ports that a relationship names at its two ends, the left one first."""
    match relationship:
        case Data():
            return relationship.client_port, relationship.source_port
        case Gating():
            return relationship.port, relationship.trigger_port
        case Reset() | Lock() | Limit():
            return None, relationship.source_port
    return None, None


def ends_of(relationship: Relationship) -> tuple[str, str]:
    """Return the two modules of a relationship, the left one first; that of a strategy twice."""
    left, *right = (getattr(relationship, name) for name in _END_NAMES[type(relationship)])
    return left, right[0] if right else left


def with_ends(relationship: Relationship, left: str, right: str) -> Relationship:
    """Return a relationship between two other modules; a strategy has the left one alone."""
    names: dict[str, Any] = dict(zip(_END_NAMES[type(relationship)], (left, right), strict=False))
    return replace(relationship, **names)


def with_source(relationship: Relationship, source: str, port: str | None) -> Relationship:
    """Return a relationship with another right end, and with its port if the kind has one."""
    name = "trigger_port" if isinstance(relationship, Gating) else "source_port"
    ports: dict[str, Any] = {name: port} if hasattr(relationship, name) else {}
    return replace(with_ends(relationship, ends_of(relationship)[0], source), **ports)


@dataclass(frozen=True, slots=True)
class Conversion:
    """The conversion of a transformer in a specification, as in its comment.

    `converter` is a module's name, or `None` for the abstract one.
    """

    transformer: str
    converter: str | None
    source: str
    target: str
    span: Span


@dataclass(frozen=True, slots=True)
class StandIn:
    """The module that an InheritanceNode of a specification represents.

    `evident` is whether it follows from mounts and control, so that no comment is printed.
    """

    node: str
    module: str
    span: Span
    evident: bool = False


@dataclass(frozen=True, slots=True)
class PackKind:
    """A kind of node that a rule pack provides, with the name and colour of its nodes.

    Its nodes take and give commands or data, `carries`. They have `one` or `several` `inputs`, as
    `outputs` `one`, `several` or `none`: these only listen. `behaves` is whether a run needs
    their behaviour. `pack` is the name of the pack.
    """

    kind: str
    name: str
    carries: str
    inputs: str
    outputs: str
    colour: str | None
    behaves: bool
    span: Span
    pack: str


@dataclass(frozen=True, slots=True)
class PackNode:
    """A node of a specification, and the rule pack in its comment."""

    node: str
    pack: str
    span: Span


@dataclass(frozen=True, slots=True)
class MissingFile:
    """A missing file that a key of a node names; `builds` is whether the node may build it."""

    module: str
    key: str
    path: str
    span: Span
    builds: bool


@dataclass(frozen=True, slots=True)
class Configuration:
    """A configuration or a specification, which has the same body.

    `declares_architecture` is whether the file states it; `period_ms` is of flat arbitration;
    `sources` are the paths of `@sources`; `declared` the module blocks in the file itself and,
    once extraction has run, those found in sources; `muxes` are those of a file that is not ours,
    `relays` the places of its relays, contracted already, `opaque` its nodes of which topics could
    not be read; `includes` are other configurations that are still to be taken in. `format` is
    the foreign format of the file, `None` for `.mars`: with one, the architecture is assumed;
    `origin` is that of the imported files, also after the import was saved as a `.mars` file.
    `kinds` are those of nodes that rule packs bring, `attributed` its own lines about attributes of
    modules, `missing` the files of its nodes that are not there.
    """

    path: str
    span: Span
    kind: ConfigurationKind = "configuration"
    architecture: Architecture = "flat"
    declares_architecture: bool = False
    period_ms: int | None = None
    sources: tuple[Name, ...] = ()
    modules: tuple[Name, ...] = ()
    relationships: tuple[Relationship, ...] = ()
    declared: tuple[Module, ...] = ()
    conversions: tuple[Conversion, ...] = ()
    stand_ins: tuple[StandIn, ...] = ()
    pack_nodes: tuple[PackNode, ...] = ()
    muxes: tuple[Muxed, ...] = ()
    relays: tuple[Span, ...] = ()
    opaque: tuple[Name, ...] = ()
    includes: tuple[Include, ...] = ()
    format: str | None = None
    origin: str | None = None
    kinds: tuple[PackKind, ...] = ()
    attributed: tuple[Attributed, ...] = ()
    missing: tuple[MissingFile, ...] = ()

    def with_declared(self, modules: Mapping[str, Module]) -> dict[str, Module]:
        """Return `modules` and the declared modules by name; the latter have precedence."""
        return {**modules, **{module.name: module for module in self.declared}}

    def node_kind(self, name: str) -> str | None:
        """Return the kind of the node with a name, also of packs, or None."""
        brought = self.pack_kind(name)
        return node_kind(name) or (None if brought is None else brought.kind)

    def pack_kind(self, name: str) -> PackKind | None:
        """Return the pack's kind of the node with a name, or None if it is not of a pack."""
        stem = name.rstrip("0123456789")
        number = name.removeprefix(stem)
        if not number or number.startswith("0"):
            return None
        return next((each for each in self.kinds if each.name == stem), None)


NodeKind: TypeAlias = Literal[
    "data_splitter",
    "data_transformer",
    "arbitration_node",
    "control_splitter",
    "inheritance_node",
    "gate_node",
]
#: How the paper's figures name each kind of node; the first ArbitrationNode has no number.
NODE_NAMES: dict[NodeKind, str] = {
    "data_splitter": "DataSplitter",
    "data_transformer": "DataTransformer",
    "arbitration_node": "ArbitrationNode",
    "control_splitter": "ControlSplitter",
    "inheritance_node": "InheritanceNode",
    "gate_node": "Gate",
}
_NODE_NAME = re.compile(
    r"(?P<stem>DataSplitter|DataTransformer|ControlSplitter|InheritanceNode|Gate)[1-9][0-9]*"
    r"|(?P<arbiter>ArbitrationNode)([2-9]|[1-9][0-9]+)?"
)


def node_kind(name: str) -> NodeKind | None:
    """Return the built-in kind of the node with a name, or None."""
    match = _NODE_NAME.fullmatch(name)
    if match is None:
        return None
    stem = match["stem"] or match["arbiter"]
    return next(kind for kind, word in NODE_NAMES.items() if word == stem)


def node_names(kinds: Iterable[PackKind]) -> Mapping[str, str]:
    """Return the names (such as `DataSplitter`) of nodes by their kinds, also of packs."""
    names: dict[str, str] = dict(NODE_NAMES.items())
    return names | {each.kind: each.name for each in kinds}
