"""Requests of the server to its workers, and their answers: values that are pickled."""

from collections.abc import Mapping
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.lsp.robot import EditorFinding, EditorRobot
from mars_asp.lsp.rules import Rules

#: `check`, `source`, `lint`: findings in a robot, in a source without robot, in rules; `survey`:
#: consequences and nodes of each module; `repairs` of all findings; `trace` of the finding `about`;
#: `owners`: the configurations of a source, in folders up to `about`; `format`: the text of a
#: configuration in canonical layout.
Sort: TypeAlias = Literal[
    "check", "source", "lint", "survey", "repairs", "trace", "owners", "format"
]


class Question(NamedTuple):
    """A request about a file; `texts` are the unsaved texts by path."""

    sort: Sort
    path: str
    texts: Mapping[str, str]
    about: str = ""


class CheckedFile(NamedTuple):
    """The findings in a robot or a source; the robot, or None if it cannot be read."""

    findings: tuple[EditorFinding, ...]
    robot: EditorRobot | None


class LintedFile(NamedTuple):
    """The findings in a file of rules, and the rules that it is used with."""

    findings: tuple[EditorFinding, ...]
    rules: Rules


class Survey(NamedTuple):
    """The consequences about each module, and the nodes that synthesis adds for it.

    `nodes` is None if no specification realises the robot.
    """

    consequences: Mapping[str, tuple[str, ...]]
    nodes: Mapping[str, tuple[str, ...]] | None


class Failed(NamedTuple):
    """The reason why there is no answer."""

    reason: str
