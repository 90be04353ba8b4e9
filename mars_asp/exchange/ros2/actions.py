"""Actions of launch files in any language, and texts with parts that are known at launch time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from mars_asp.diagnostic import Span
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.yaml_document import Items, Scalar


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """The value of a launch argument; `default` is that of the reference itself, if it has one."""

    name: str
    default: "Text | None" = None


@dataclass(frozen=True, slots=True)
class PackageShare:
    """The folder with a package's installed shared files, as `$(find-pkg-share PACKAGE)`."""

    package: "Text"


@dataclass(frozen=True, slots=True)
class OwnParameter:
    """The value of a parameter that a node reads itself, as a part of a text in its source."""

    name: str


@dataclass(frozen=True, slots=True)
class Unknown:
    """A part that is known only when the file runs."""


@dataclass(frozen=True, slots=True)
class LaunchDirectory:
    """The folder of the launch file."""


Part: TypeAlias = str | LaunchArgument | OwnParameter | PackageShare | Unknown | LaunchDirectory
#: A text in parts, as substitutions are; an empty one is the empty text.
Text: TypeAlias = tuple[Part, ...]
UNKNOWN: Text = (Unknown(),)
#: A longer text names nothing.
_MOST = 4096


@dataclass(frozen=True, slots=True)
class Test:
    """A condition of an action: `text` equals `value` or, if not `wanted`, does not.

    If `value` is None, the text is a boolean. With `branch`, it represents a branch of code whose
    condition is not known; with `implied`, the other tests of the action imply it.
    """

    text: Text
    value: Text | None
    wanted: bool
    span: Span
    branch: bool = False
    implied: bool = False


Tests: TypeAlias = tuple[Test, ...]


@dataclass(frozen=True, slots=True)
class Remap:
    """A renaming of `source` to `target`, of one node or of all later ones of the group."""

    source: Text
    target: Text
    span: Span


@dataclass(frozen=True, slots=True)
class NodeParameter:
    """A parameter that a launch file sets without a parameter file; `span` is that of its value.

    `keys` are the steps of its name, each with its location; `items` are the texts of a list;
    `written` is the value where it is written as YAML; the parameter is set if all `tests` hold.
    """

    keys: tuple[tuple[Text, Span], ...]
    value: Text
    span: Span
    items: tuple[Text, ...] | None = None
    written: Scalar | Items | None = None
    tests: Tests = ()

    @property
    def name(self) -> Text:
        """The name, its steps joined by dots."""
        (first, _), *others = self.keys
        return text_of(first, *(part for step, _ in others for part in (".", step)))


@dataclass(frozen=True, slots=True)
class Start:
    """A node to start; `plugin` is whether `executable` is a component's class.

    `files` are those of its parameters; `is_rewritten` is whether a launch file reads some of them
    as YAML and writes them anew. `unread` are parts of it that only a run knows.
    """

    span: Span
    package: Text
    executable: Text
    plugin: bool = False
    name: Text | None = None
    namespace: Text | None = None
    remaps: tuple[Remap, ...] = ()
    files: tuple[Text, ...] = ()
    parameters: tuple[NodeParameter, ...] = ()
    arguments: tuple[Text, ...] = ()
    tests: Tests = ()
    unread: tuple[tuple[str, Span], ...] = ()
    is_rewritten: bool = False


@dataclass(frozen=True, slots=True)
class LaunchGroup:
    """A group of actions; if `scoped`, its settings (namespace, remappings) end with it."""

    actions: "tuple[Action, ...]"
    scoped: bool = True
    tests: Tests = ()


@dataclass(frozen=True, slots=True)
class PushNamespace:
    """A namespace for all later actions of the group, within the current one."""

    namespace: Text
    span: Span


@dataclass(frozen=True, slots=True)
class Declare:
    """A launch argument: its default, or with `forced` its value, if the tests hold."""

    name: str
    value: Text | None
    span: Span
    forced: bool = False
    tests: Tests = ()


@dataclass(frozen=True, slots=True)
class SetParameters:
    """Parameters, and files of these, for all later nodes of the group."""

    files: tuple[Text, ...]
    parameters: tuple[NodeParameter, ...]


@dataclass(frozen=True, slots=True)
class IncludeAction:
    """Another launch file, with values of its arguments.

    `inherits` is whether it also has the arguments of the including file, as in ROS 2.
    """

    path: Text
    span: Span
    arguments: tuple[NodeParameter, ...] = ()
    tests: Tests = ()
    inherits: bool = True


@dataclass(frozen=True, slots=True)
class Reads:
    """Files that launching reads itself, such as a description of the robot, as words of a text."""

    words: Text
    span: Span


@dataclass(frozen=True, slots=True)
class Readings:
    """The alternative lists of actions of a launch file, each with the tests of its branches."""

    readings: "tuple[tuple[tuple[Action, ...], Tests], ...]"


@dataclass(frozen=True, slots=True)
class Undeclared:
    """An argument that a launch file of ROS 1 reads without declaring it."""

    name: str
    span: Span


Action: TypeAlias = (
    Start
    | LaunchGroup
    | PushNamespace
    | Remap
    | Declare
    | SetParameters
    | IncludeAction
    | Reads
    | Readings
    | Unread
    | Undeclared
)


def text_of(*parts: Part | Text) -> Text:
    """Return the concatenation of parts, adjacent strings joined; `UNKNOWN` if it is too long."""
    found: list[Part] = []
    size = 0
    for part in parts:
        for each in part if isinstance(part, tuple) else (part,):
            size += len(each) if isinstance(each, str) else 1
            if size > _MOST:
                return UNKNOWN
            if isinstance(each, str) and found and isinstance(found[-1], str):
                found[-1] += each
            elif each != "":
                found.append(each)
    return tuple(found)


def plain(text: Text) -> str | None:
    """Return a text as a string, or None if parts of it are open."""
    if not text:
        return ""
    return text[0] if len(text) == 1 and isinstance(text[0], str) else None


def together(actions: Sequence[Action], tests: Tests) -> LaunchGroup:
    """Return actions under common tests, as a group without a scope of its own."""
    return LaunchGroup(tuple(actions), scoped=False, tests=tests)
