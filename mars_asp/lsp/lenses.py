"""Lenses above modules: the number of consequences and the introduced nodes of a module."""

from collections.abc import Iterator
from typing import NamedTuple

from mars_asp.lsp.places import Range
from mars_asp.lsp.robot import DocumentContext, EditorRobot
from mars_asp.output import counted

#: Up to this number nodes are named, more are counted.
_MOST_NAMED = 3


class Lens(NamedTuple):
    """The text above a line, and its module, or None for the whole robot."""

    title: str
    range: Range
    robot: str
    module: str | None


def lenses(scene: DocumentContext) -> Iterator[Lens]:
    """Yield the lenses of the modules that a text lists or annotates, and of its robot."""
    path = scene.here.text.path
    for robot in scene.robots:
        if robot.path == path and scene.here.header is not None:
            yield Lens(_summary(scene, robot), scene.here.header, robot.path, None)
        for file in scene.files(robot):
            if file.path != path:
                continue
            for each in file.mentions:
                if each.role not in ("listed", "annotated"):
                    continue
                name = file.name_of(each)
                title = _lens_title(robot, name)
                if title:
                    yield Lens(f"{each.name}: {title}", each.range, robot.path, name)
            # A file that is included twice shows each lens once.
            break


def _lens_title(robot: EditorRobot, name: str) -> str:
    parts = []
    about = len(robot.consequences.get(name, ()))
    if about:
        parts.append(counted(about, "consequence"))
    nodes = (robot.nodes or {}).get(name, ())
    if nodes:
        named = ", ".join(nodes) if len(nodes) <= _MOST_NAMED else f"{len(nodes)} nodes"
        parts.append(named)
    return "; ".join(parts)


def _summary(scene: DocumentContext, robot: EditorRobot) -> str:
    """Return a text with the numbers of consequences, errors, warnings and nodes of a robot."""
    found = {title for titles in robot.consequences.values() for title in titles}
    parts = [counted(len(found), "consequence")]
    for severity in ("error", "warning"):
        number = sum(each.severity == severity for each in scene.findings)
        if number:
            parts.append(counted(number, severity))
    if robot.nodes is not None:
        nodes = {node for names in robot.nodes.values() for node in names}
        parts.append(counted(len(nodes), "node"))
    return ", ".join(parts)
