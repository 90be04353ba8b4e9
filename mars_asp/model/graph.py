"""Nodes, muxes and relays that exchange topics, and the launch trees that start them."""

from dataclasses import dataclass
from fractions import Fraction

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import Engine, Hold, Inner


@dataclass(frozen=True, slots=True)
class Endpoint:
    """An end of a topic at a node.

    `topic` is its full name, all renaming done; `type` is the message's as it is written, if it is
    known; `span` is what an owner would change; `hz` is how often it is published, if that is
    known; `optional` is whether a node that hears it works as well without, `measured` whether it
    is no command, whatever its type.
    """

    topic: str
    type: str | None
    span: Span
    hz: Fraction | None = None
    optional: bool = False
    measured: bool = False


@dataclass(frozen=True, slots=True)
class Node:
    """A node by its full name; `guard` is the place that makes it a guard, if it is one.

    `relays` is whether it publishes what it hears, whatever the type of that; `unread` whether it
    may have topics besides. `conditions` decide if it starts, `is_named` is
    whether the name is its own whatever its program says; `renamed` are the names that a launch
    file gives its topics, `is_whole` whether all that these could mean is known. `package` is that
    of its program; `manages` are the nodes that it starts up and shuts down.
    """

    name: str
    span: Span
    published: tuple[Endpoint, ...] = ()
    subscribed: tuple[Endpoint, ...] = ()
    guard: Span | None = None
    relays: bool = False
    unread: bool = False
    conditions: tuple["Condition", ...] = ()
    is_named: bool = True
    renamed: tuple["Renamed", ...] = ()
    is_whole: bool = False
    package: str = ""
    manages: tuple[tuple[str, Span], ...] = ()


@dataclass(frozen=True, slots=True)
class MuxInput:
    """A topic that a mux listens to, with the name that the mux has for it."""

    name: str
    topic: str
    span: Span
    priority: int
    hold_ms: Hold | None


@dataclass(frozen=True, slots=True)
class Mux:
    """A node that hands on, of several topics, the one with the highest priority to `output`.

    `numbers` and `inner` are those of a cascade that became one mux, as `Muxed` has them.
    """

    name: str
    engine: Engine
    span: Span
    output: str
    inputs: tuple[MuxInput, ...]
    numbers: tuple[tuple[int, int], ...] = ()
    inner: tuple[Inner, ...] = ()
    conditions: tuple["Condition", ...] = ()


@dataclass(frozen=True, slots=True)
class Relay:
    """A node that hands on all of one topic to another, or with `hz` at most so many a second."""

    name: str
    span: Span
    source: str
    target: str
    hz: Fraction | None = None
    conditions: tuple["Condition", ...] = ()


@dataclass(frozen=True, slots=True)
class Graph:
    """Nodes, muxes, relays and how they are wired; neither muxes nor relays are among the nodes.

    `observed` is whether it is all of a robot that ran, so that what nobody hears is loose;
    elsewhere the base may hear it that is no node.
    """

    path: str
    nodes: tuple[Node, ...]
    muxes: tuple[Mux, ...] = ()
    observed: bool = False
    relays: tuple[Relay, ...] = ()


@dataclass(frozen=True, slots=True)
class Condition:
    """That a launch argument or variable has a value, or has not where it is not `wanted`.

    Where the condition was not read, `variable` is its text, and `reads` are the variables in it.
    """

    variable: str
    value: str
    wanted: bool
    span: Span
    reads: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Renamed:
    """A name of a launch file for a topic of a node: what it was, by its full name, and becomes."""

    source: str
    target: str
    span: Span


@dataclass(frozen=True, slots=True)
class Tree:
    """What a launch file starts with all that it includes, or what several files start together.

    Nodes of one name stand apart here. `unread` are the places of what may start or name more,
    `broken` those of files that no parser takes, with what is wrong.
    """

    path: str
    nodes: tuple[Node, ...] = ()
    muxes: tuple[Mux, ...] = ()
    relays: tuple[Relay, ...] = ()
    unread: tuple[Span, ...] = ()
    broken: tuple[tuple[str, Span], ...] = ()
