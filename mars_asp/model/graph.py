"""Nodes, muxes and relays that exchange topics, and the launch trees that start them."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import Engine, Hold, Inner


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A publisher or subscriber of a topic at a node.

    `topic` is its full name, all renaming done; `type` is the message type as written, if known;
    `span` is the place that an owner would change; `hz` is how often it is published, if known;
    `optional` is whether a subscribing node works as well without it, `measured` whether it reports
    a motion and commands none, regardless of its type, `last` whether it is published only as the
    program ends. `driver` is a package that usually publishes a topic of the name, if the robot
    starts none of its programs.
    """

    topic: str
    type: str | None
    span: Span
    hz: Fraction | None = None
    optional: bool = False
    measured: bool = False
    last: bool = False
    driver: str | None = None


@dataclass(frozen=True, slots=True)
class GraphNode:
    """A node by its full name; `guard` is the place that makes it a guard, if it is one.

    `relays` is whether it publishes the messages that it subscribes to, `unread` whether it may
    publish on further topics, `listens` whether it may subscribe to further ones. `conditions`
    decide if it starts, `is_named` is whether its program cannot change the name; `renamed` are the
    topics that a launch file renames, `is_whole` whether all its topics are known. `package` is
    that of its program; `manages` are the nodes that it starts up and shuts down; `names` are those
    of its topics, services, actions and parameters before any renaming; `given` are its parameter
    files.
    """

    name: str
    span: Span
    published: tuple[Endpoint, ...] = ()
    subscribed: tuple[Endpoint, ...] = ()
    guard: Span | None = None
    relays: bool = False
    unread: bool = False
    conditions: tuple["StartCondition", ...] = ()
    is_named: bool = True
    renamed: tuple["Renaming", ...] = ()
    is_whole: bool = False
    package: str = ""
    manages: tuple[tuple[str, Span], ...] = ()
    listens: bool = False
    names: frozenset[str] = frozenset()
    given: tuple["GivenFile", ...] = ()


@dataclass(frozen=True, slots=True)
class GivenFile:
    """A parameter file that a node is given; `span` is the place of the first name in it.

    `is_for_it` is whether a section of the file is for the node, `None` if the file has no section.
    """

    path: str
    span: Span
    is_for_it: bool | None


@dataclass(frozen=True, slots=True)
class MuxInput:
    """A topic that a mux listens to, an input or a lock, with the name that the mux has for it."""

    name: str
    topic: str
    span: Span
    priority: int
    hold_ms: Hold | None


@dataclass(frozen=True, slots=True)
class Mux:
    """A node that forwards, to `output`, the messages of the input with the highest priority.

    `locks` stop the inputs of lower priorities. `numbers` and `inner` describe a cascade that was
    merged into one mux, as in `Muxed`. `renamed` are its remappings, and `names` its topics before
    them, if all are known. `started` is the place where a launch file starts it.
    """

    name: str
    engine: Engine
    span: Span
    output: str
    inputs: tuple[MuxInput, ...]
    numbers: tuple[tuple[int, int], ...] = ()
    inner: tuple[Inner, ...] = ()
    conditions: tuple["StartCondition", ...] = ()
    given: tuple[GivenFile, ...] = ()
    locks: tuple[MuxInput, ...] = ()
    renamed: tuple["Renaming", ...] = ()
    names: frozenset[str] | None = None
    started: Span | None = None


@dataclass(frozen=True, slots=True)
class Relay:
    """A node that forwards the messages of one topic to another; `hz` is the maximal rate."""

    name: str
    span: Span
    source: str
    target: str
    hz: Fraction | None = None
    conditions: tuple["StartCondition", ...] = ()


@dataclass(frozen=True, slots=True)
class Graph:
    """The nodes, muxes and relays of a robot; the latter two are not among the nodes.

    `observed` is whether it was recorded in a run. Then a topic without a subscriber is
    unconnected; otherwise the base, which is not a node, may subscribe.
    """

    path: str
    nodes: tuple[GraphNode, ...]
    muxes: tuple[Mux, ...] = ()
    observed: bool = False
    relays: tuple[Relay, ...] = ()


#: The variable of a condition of code that was not read begins so; its place follows.
OPEN_CONDITION = "the condition at "
#: What the variable of a condition begins with that is a branch of code; its value is a number.
OPEN_BRANCH = "the branch taken at "


@dataclass(frozen=True, slots=True)
class StartCondition:
    """A test of a launch argument or variable: it equals `value` or, if not `wanted`, does not.

    If the condition could not be read, `variable` is its text, and `reads` are the variables in it.
    """

    variable: str
    value: str
    wanted: bool
    span: Span
    reads: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Renaming:
    """A topic that a launch file, or a parameter, renames: its full names before and after."""

    source: str
    target: str
    span: Span
    is_by_parameter: bool = False


@dataclass(frozen=True, slots=True)
class AbsentFile:
    """A file, program, function or argument that is used but missing in its package.

    It is a file or program that a launch file names, a file that the package has and does not
    install, the function of a console script, or all programs of a package whose `setup.cfg` does
    not set where they are installed; the name is then that of the package. Of an argument that is
    passed to a launch file, `package` is that file, and of a parameter it is the program. ROS 1
    refuses an argument that is not declared, and ROS 2 passes over it. An undeclared argument is
    one that a launch file of ROS 1, the `package`, reads.
    """

    name: str
    package: str
    span: Span
    sort: Literal[
        "file",
        "program",
        "not installed",
        "function",
        "programs",
        "argument",
        "refused argument",
        "undeclared argument",
        "parameter",
    ] = "file"


@dataclass(frozen=True, slots=True)
class RepeatedKey:
    """A key that a parameter file has for the second time.

    `is_merged` is whether both have maps, which ROS 2 merges, and `within` whether it is of such a
    map.
    """

    name: str
    span: Span
    is_merged: bool = False
    within: bool = False


@dataclass(frozen=True, slots=True)
class LaunchTree:
    """The nodes of a launch file with all that it includes, or of several files together.

    Nodes of one name are kept apart. `unread` are places that may start or name more, `unstarted`
    those of them that may start nodes, `broken` those of files that cannot be parsed, with the
    error, `repeated` the keys that its parameter files have twice, and `rewritten` those of the
    files that launch files read as YAML. `defaults` are the values of the launch arguments that
    users may set. `by_hand` are nodes of programs that no launch file of the folder starts, which
    are with its first tree; `shared` are the parameter files that may be for nodes whose names are
    not known. `is_of_programs` is whether it has all programs of a folder, in place of a launch
    file.
    """

    path: str
    nodes: tuple[GraphNode, ...] = ()
    muxes: tuple[Mux, ...] = ()
    relays: tuple[Relay, ...] = ()
    unread: tuple[Span, ...] = ()
    unstarted: tuple[Span, ...] = ()
    broken: tuple[tuple[str, Span], ...] = ()
    missing: tuple[AbsentFile, ...] = ()
    defaults: tuple[tuple[str, str], ...] = ()
    repeated: tuple[RepeatedKey, ...] = ()
    rewritten: tuple[str, ...] = ()
    by_hand: tuple[GraphNode, ...] = ()
    shared: tuple[str, ...] = ()
    is_of_programs: bool = False

    @property
    def files(self) -> frozenset[str]:
        """The files in which a finding about the tree can be."""
        spans = [span for _, span in self.broken]
        spans += (each.span for each in self.repeated)
        spans += (each.span for each in self.missing)
        spans += (each.span for each in self.nodes)
        spans += (each.span for each in self.muxes)
        spans += (each.span for each in self.relays)
        for node in self.nodes:
            spans += (end.span for end in (*node.published, *node.subscribed))
            spans += (each.span for each in node.renamed)
            spans += (each.span for each in node.given)
        for mux in self.muxes:
            spans += (each.span for each in (*mux.inputs, *mux.locks))
            spans += (each.span for each in mux.renamed)
            spans += (each.span for each in mux.given)
        return frozenset(span.path for span in spans)
