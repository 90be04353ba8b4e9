"""What the server asks of its workers, and what they answer: values that cross a pipe."""

from collections.abc import Mapping
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.lsp.robot import EditorFinding, EditorRobot
from mars_asp.lsp.rules import Rules

#: `check`, `source` and `lint`: what is found in a robot, in a source of no robot, in rules;
#: `survey`: consequences and nodes of each module; `repairs` of all findings; `trace`: why there is
#: what `about` names; `owners`: the configurations that a source belongs to; `format`: the text of
#: a configuration in canonical layout.
Sort: TypeAlias = Literal[
    "check", "source", "lint", "survey", "repairs", "trace", "owners", "format"
]


class Question(NamedTuple):
    """A question about a file, where `texts` are those of files that are not saved."""

    sort: Sort
    path: str
    texts: Mapping[str, str]
    about: str = ""


class CheckedFile(NamedTuple):
    """What is found in a robot or a source; the robot, if it could be read."""

    findings: tuple[EditorFinding, ...]
    robot: EditorRobot | None


class LintedFile(NamedTuple):
    """What is found in a file of rules, and the rules around it."""

    findings: tuple[EditorFinding, ...]
    rules: Rules


class Survey(NamedTuple):
    """The consequences that are about each module, and the nodes that synthesis adds for it.

    The nodes are `None` where no specification realises the robot.
    """

    consequences: Mapping[str, tuple[str, ...]]
    nodes: Mapping[str, tuple[str, ...]] | None


class Failed(NamedTuple):
    """Why there is no answer."""

    reason: str
