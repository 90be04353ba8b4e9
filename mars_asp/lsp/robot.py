"""The results of the analysis of a robot that requests of an editor need: plain values.

Modules have their names in the robot's configuration: those of included files have a prefix.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from mars_asp.diagnostic import Severity
from mars_asp.lsp.occurrences import DocumentOutline, Occurrence, is_configuration, outline
from mars_asp.lsp.places import Place, Position, TextEdit

#: Not a MappingProxyType: that cannot be pickled.
_NONE: Mapping[str, tuple[str, ...]] = {}


class EditorFinding(NamedTuple):
    """A finding of `check` or `rules lint`: its location and printed texts.

    `title` is its name `kind(subject)` for `explain`, or None if it has no explanation; `fixes` are
    the safe edits that remove it.
    """

    place: Place
    severity: Severity
    code: str
    message: str
    help: str | None = None
    effect: str | None = None
    related: tuple[tuple[Place, str], ...] = ()
    title: str | None = None
    fixes: tuple[TextEdit, ...] = ()


class Described(NamedTuple):
    """The annotations of a module as lines of text, and the locations of its ports.

    `place` is the location of the module name in the annotations.
    """

    lines: tuple[str, ...]
    place: Place
    outputs: Mapping[str, Place]
    inputs: Mapping[str, Place]


class OpenFile(NamedTuple):
    """A file of a robot, the prefix of its module names in the robot, and their occurrences."""

    path: str
    prefix: str
    mentions: tuple[Occurrence, ...]

    def name_of(self, mention: Occurrence) -> str:
        """Return the full name of a module in the robot, with the prefix of the file if any."""
        return (
            prefixed_name(self.prefix, mention.name)
            if is_configuration(self.path)
            else mention.name
        )


class EditorRobot(NamedTuple):
    """The robot of a configuration: its files, its own first, and its annotated modules by name.

    `consequences` has the titles of the consequences about each module, `nodes` the nodes that
    synthesis adds for it, or None before synthesis has run.
    """

    path: str
    files: tuple[OpenFile, ...]
    modules: Mapping[str, Described]
    consequences: Mapping[str, tuple[str, ...]] = _NONE
    nodes: Mapping[str, tuple[str, ...]] | None = None

    @property
    def paths(self) -> frozenset[str]:
        """Return the paths of all files of the robot."""
        return frozenset(file.path for file in self.files)


@dataclass(frozen=True)
class DocumentContext:
    """The context of a request: a text, the robots with it, all open texts and its findings."""

    here: DocumentOutline
    robots: tuple[EditorRobot, ...] = ()
    texts: Mapping[str, str] = field(default_factory=dict)
    findings: tuple[EditorFinding, ...] = ()

    def files(self, robot: EditorRobot) -> Iterator[OpenFile]:
        """Yield the files of a robot; open ones with the occurrences of their unsaved text."""
        for file in robot.files:
            written = self.texts.get(file.path)
            if written is None:
                yield file
            else:
                yield file._replace(mentions=outline(file.path, written).mentions)

    def own_files(self) -> Iterator[tuple[EditorRobot, OpenFile]]:
        """Yield each robot that contains the open file, once for each include of it."""
        path = self.here.text.path
        return ((r, file) for r in self.robots for file in r.files if file.path == path)

    def found_at(self, position: Position) -> Iterator[EditorFinding]:
        """Yield the findings at a position."""
        return (each for each in self.findings if each.place.range.holds(position))


def prefixed_name(prefix: str, name: str) -> str:
    """Return the name in the robot of an included file's module: with the include's prefix."""
    if not prefix:
        return name
    return f"/{prefix}{name}" if name.startswith("/") else f"{prefix}/{name}"
