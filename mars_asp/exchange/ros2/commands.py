"""Command lines that launch files run beside their nodes: some start nodes, or launch a file."""

import re
from collections.abc import Sequence

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    Action,
    IncludeAction,
    NodeParameter,
    PackageShare,
    Part,
    Reads,
    Start,
    Tests,
    Text,
    plain,
    text_of,
    together,
)
from mars_asp.exchange.unread import Unread

_BLANKS = re.compile(r"\s+")
_SHOWN = 4
_INTERPRETERS = frozenset({"python", "python3", "bash", "sh"})


def of_command(texts: Sequence[Text], span: Span, tests: Tests) -> Action:
    """Return the action of a command line; a text in `texts` may hold several words."""
    words = [word for text in texts for word in _split_words(text)]
    known = [plain(word) for word in words]
    match known:
        case ["ros2", "run", _, _, *_]:
            package, executable, *arguments = words[2:]
        case ["rosrun", _, _, *_]:
            package, executable, *arguments = words[1:]
        case ["ros2", "control", "load_controller" | "load_start_controller", *_]:
            # It asks the manager for what a spawner asks it for.
            package, executable = text_of("controller_manager"), text_of("spawner")
            arguments = words[3:]
        case ["ros2", "launch", _, *_]:
            return _launched(words[2:], span, tests)
        case ["roslaunch", _, *_]:
            return _launched(words[1:], span, tests)
        case _:
            called = " ".join(filter(None, known[:_SHOWN])) or "?"
            script = words[1:2] if known[:1] and known[0] in _INTERPRETERS else words[:1]
            unread = Unread("programs that are not nodes", called, span)
            return together((unread, Reads(text_of(*script), span)), tests)
    return Start(span, package, executable, arguments=tuple(arguments), tests=tests)


def _launched(words: Sequence[Text], span: Span, tests: Tests) -> IncludeAction:
    """Return the include of the launch file that a `ros2 launch` or `roslaunch` command starts."""
    given: list[NodeParameter] = []
    named: list[Text] = []
    for word in words:
        first = word[0] if isinstance(word[0], str) else ""
        name, sign, value = first.partition(":=")
        if sign:
            whole = text_of(value, *word[1:])
            given.append(NodeParameter(((text_of(name), span),), whole, span))
        elif not first.startswith("-"):
            named.append(word)
    match named:
        case [package, file, *_]:
            path = text_of(PackageShare(package), "/launch/", file)
        case [path]:
            pass
        case _:
            path = ()
    return IncludeAction(path, span, tuple(given), tests)


def _split_words(text: Text) -> list[Text]:
    """Return the words of a text, split at blanks."""
    words: list[list[Part]] = [[]]
    for part in text:
        first, *others = _BLANKS.split(part) if isinstance(part, str) else (part,)
        words[-1].append(first)
        words += ([each] for each in others)
    return [text_of(*word) for word in words if any(word)]
