"""What an analysis tells of a robot, for the questions of an editor: plain values.

Modules are named as in the file of the robot; those of included files stand behind a prefix.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from mars_asp.diagnostic import Severity
from mars_asp.lsp.occurrences import DocumentOutline, Occurrence, is_configuration, outline
from mars_asp.lsp.places import Place, Position, TextEdit

#: A proxy of a mapping crosses no pipe.
_NONE: Mapping[str, tuple[str, ...]] = {}


class EditorFinding(NamedTuple):
    """Something that was found: what `check` and `rules lint` print of it, and where.

    `title` is what `explain` calls it, `kind(subject)`, of those that have an explanation; `fixes`
    are the edits that mend it, where these are safe.
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
    """A module as its annotations describe it: in lines for readers, and the places of its ports.

    `place` is where its name stands there.
    """

    lines: tuple[str, ...]
    place: Place
    outputs: Mapping[str, Place]
    inputs: Mapping[str, Place]


class OpenFile(NamedTuple):
    """A file of a robot, what its names stand behind, and the modules that it names."""

    path: str
    prefix: str
    mentions: tuple[Occurrence, ...]

    def name_of(self, mention: Occurrence) -> str:
        """Return the name that the robot gives to a module of the file."""
        return (
            prefixed_name(self.prefix, mention.name)
            if is_configuration(self.path)
            else mention.name
        )


class EditorRobot(NamedTuple):
    """The robot of a configuration: its files, the first its own, and its modules by name.

    `consequences` are the titles of those that are about each module, `nodes` what synthesis adds
    for it, once that is known.
    """

    path: str
    files: tuple[OpenFile, ...]
    modules: Mapping[str, Described]
    consequences: Mapping[str, tuple[str, ...]] = _NONE
    nodes: Mapping[str, tuple[str, ...]] | None = None

    @property
    def paths(self) -> frozenset[str]:
        """Return the files that it consists of."""
        return frozenset(file.path for file in self.files)


@dataclass(frozen=True)
class DocumentContext:
    """What a question is about: an open text, the robots that it is part of, and open texts."""

    here: DocumentOutline
    robots: tuple[EditorRobot, ...] = ()
    texts: Mapping[str, str] = field(default_factory=dict)
    findings: tuple[EditorFinding, ...] = ()

    def files(self, robot: EditorRobot) -> Iterator[OpenFile]:
        """Yield the files of a robot, open ones as they are now."""
        for file in robot.files:
            written = self.texts.get(file.path)
            if written is None:
                yield file
            else:
                yield file._replace(mentions=outline(file.path, written).mentions)

    def own_files(self) -> Iterator[tuple[EditorRobot, OpenFile]]:
        """Yield each robot with the open file, as often as the robot includes it."""
        path = self.here.text.path
        return ((r, file) for r in self.robots for file in r.files if file.path == path)

    def found_at(self, position: Position) -> Iterator[EditorFinding]:
        """Yield the findings at a position."""
        return (each for each in self.findings if each.place.range.holds(position))


def prefixed_name(prefix: str, name: str) -> str:
    """Return the name of an included file's module in the robot: the include's name before it."""
    if not prefix:
        return name
    return f"/{prefix}{name}" if name.startswith("/") else f"{prefix}/{name}"
