"""A new pack of rules: a template that passes its lint and its cases."""

import re
from importlib.resources import files
from pathlib import Path
from string import Template

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.deliver import write_file
from mars_asp.diagnostic import refusal
from mars_asp.reasoning.findings import consequence_kinds

_TOPIC = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")
#: The files of a pack, in the order in which they are written. Each has a template.
_FILES = (
    "pack.toml",
    "consequences/$topic.lp",
    "cases/$topic.lp",
    "cases/robot.mars",
    "README.md",
    "pyproject.toml",
)


def new_pack(topic: str, rulebook: Rulebook) -> tuple[str, ...]:
    """Write a pack into a new folder below the current one; return its files.

    Raises:
        MarsError: the topic is not a valid name, or a folder or a kind of finding has it.
    """
    kind = topic.replace("-", "_")
    folder = Path(topic)
    if not _TOPIC.fullmatch(topic):
        message = f"`{topic}` cannot be a name"
        form = "begin with a small letter; then write small letters and digits, and `-` between"
        raise refusal("usage", message, topic, form)
    if folder.exists() or folder.is_symlink():
        message = f"`{topic}` is there already"
        raise refusal("usage", message, topic, "choose another name, or remove it")
    if kind in consequence_kinds(rulebook) or topic == "mars-asp":
        raise refusal("usage", f"`{kind}` is a name of ours", topic, "choose another name")
    names = {"topic": topic, "kind": kind, "title": topic.replace("-", " ").capitalize()}
    written = []
    try:
        for path in _FILES:
            name = path.replace("/", ".").replace("$", "")
            template = files(__package__) / f"rules_new.{name}.txt"
            place = folder / Template(path).substitute(names)
            place.parent.mkdir(parents=True, exist_ok=True)
            text = template.read_text(encoding="utf-8")
            write_file(str(place), Template(text).substitute(names))
            written.append(str(place))
    except OSError as error:
        message = f"`{topic}` cannot be written: {error.strerror or error}"
        advice = "choose a folder that you may write to"
        raise refusal("usage", message, topic, advice) from None
    return tuple(written)
