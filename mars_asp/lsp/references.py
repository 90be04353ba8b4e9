"""The definitions and references of a module in all files of its robots."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

from mars_asp.lsp.occurrences import Occurrence, is_configuration
from mars_asp.lsp.places import START, Place, Position
from mars_asp.lsp.robot import DocumentContext, EditorRobot, OpenFile, prefixed_name

#: The key of a module's occurrences: a robot and a name in it, or the module of a source.
_Key: TypeAlias = tuple[str, str]
_SOURCES = ""
_PATHS = re.compile(r"[ \t]*@(sources|include)[ \t]+(.*)")


def definition(scene: DocumentContext, position: Position) -> tuple[Place, ...]:
    """Return the definitions of the module (annotations or list), port or path at a position."""
    mention = scene.here.at(position)
    if mention is None:
        return tuple(_file_at(scene, position))
    port = mention.port
    if port is not None and port.range.holds(position):
        return tuple(dict.fromkeys(_port_places(scene, mention)))
    same = references(scene, position)
    for role in ("annotated", "listed"):
        found = tuple(place for place, each in same if each.role == role)
        if found:
            return found
    return tuple(place for place, _ in same[:1])


def references(scene: DocumentContext, position: Position) -> tuple[tuple[Place, Occurrence], ...]:
    """Return the occurrences of the module at a position, each with its location."""
    mention = scene.here.at(position)
    return () if mention is None else same_module(scene, mention)


def same_module(
    scene: DocumentContext, mention: Occurrence
) -> tuple[tuple[Place, Occurrence], ...]:
    """Return the occurrences of the module of `mention`, those in the open file first."""
    path = scene.here.text.path
    of_key: dict[_Key, list[tuple[Place, Occurrence]]] = {}
    keys_of: dict[tuple[Place, Occurrence], set[_Key]] = {}
    # A file without an analysis is its own robot.
    here = OpenFile(path, "", scene.here.mentions)
    for robot in scene.robots or (EditorRobot(path, (here,), {}),):
        files = tuple(scene.files(robot))
        annotated = {
            each.name
            for file in files
            if not is_configuration(file.path)
            for each in file.mentions
            if each.role == "annotated"
        }
        for file in files:
            instances = {each.name for each in file.mentions if each.described is not None}
            blocks = {each.name for each in file.mentions if each.role == "annotated"}
            for each in file.mentions:
                at = Place(file.path, each.range), each
                for key in _keys(robot, file, each, annotated - instances, blocks):
                    of_key.setdefault(key, []).append(at)
                    keys_of.setdefault(at, set()).add(key)
    start = Place(path, mention.range), mention
    found, waiting = {start}, [start]
    while waiting:
        for key in keys_of.get(waiting.pop(), ()):
            # Each key is needed once: it adds all its occurrences.
            new = set(of_key.pop(key, ())) - found
            found |= new
            waiting += new
    return tuple(sorted(found, key=lambda each: (each[0].path != path, each[0])))


def _keys(
    robot: EditorRobot, file: OpenFile, mention: Occurrence, annotated: set[str], blocks: set[str]
) -> Iterator[_Key]:
    """Yield the identities of an occurrence; occurrences that share one are of the same module."""
    name = mention.name
    if not is_configuration(file.path) or (mention.role == "describing" and name not in blocks):
        yield _SOURCES, name
    else:
        yield robot.path, prefixed_name(file.prefix, name)
        if mention.described is None and name in annotated and name not in blocks:
            yield _SOURCES, name


def _port_places(scene: DocumentContext, mention: Occurrence) -> Iterator[Place]:
    assert mention.port is not None
    for robot, file in scene.own_files():
        described = robot.modules.get(prefixed_name(file.prefix, mention.name))
        if described is not None:
            ports = described.outputs if mention.port.is_output else described.inputs
            if mention.port.is_output is None:
                ports = {**described.inputs, **described.outputs}
            yield from filter(None, (ports.get(mention.port.name),))


def _file_at(scene: DocumentContext, position: Position) -> Iterator[Place]:
    """Yield the existing file that the path at a position of `@sources` or `@include` names."""
    text = scene.here.text
    line, column = text.column(position)
    match = _PATHS.match(text.lines[line - 1])
    if match is None or not is_configuration(text.path):
        return
    at = match.start(2)
    for piece in match[2].split(","):
        if at <= column - 1 <= at + len(piece):
            written = re.sub(r"\s(?://|#).*", "", piece).strip()
            if match[1] == "include":
                written = re.sub(r"\s+as\s+\S+$", "", written)
            if written and "\0" not in written:
                path = Path(text.path).parent / written
                if path.is_file():
                    yield Place(str(path), START)
        at += len(piece) + 1
