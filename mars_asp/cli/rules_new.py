"""A new pack of rules: a template that passes its lint and its cases."""

import re
from pathlib import Path
from string import Template

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.deliver import write_file
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.reasoning.findings import consequence_kinds

_TOPIC = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*")
_FILES = {
    "pack.toml": """\
name = "$topic"
version = "0.1"
summary = "Controllers that command a module without seeing anything."
needs = ["mars-asp >= 0.1"]
""",
    "consequences/$topic.lp": """\
%# $title: what this pack wants to know about every robot
%
% Purpose: find controllers that see nothing of the world; put rules of your own here.

%*! sees(C: module)
Controller C uses data.
unless: `{C}` uses no data
*%
sees(C) :- uses_data_from(_, C, _).

%! id:      $topic/blind
%! because: `{C}` controls `{M}` without using any data
%! help:    let it use data of a sensor
%! why:     What sees nothing cannot react to what happens.
%! example: cases/$topic.lp
%! who:     M
%! at:      R
consequence($kind, warning, C, M) :- is_controlled_by(R, M, C), not sees(C).
""",
    "cases/$topic.lp": """\
% Facts as `mars-asp facts` prints them, and what is expected of the rules.
module("Base"). module("Drive").
is_controlled_by(1,"Base","Drive").

%case: a controller without data
%only: consequence($kind,warning,"Drive","Base")
%has: participant($kind,"Drive","Base",_,"Base") concerns($kind,"Drive","Base",1)
%> $topic/blind: `Drive` controls `Base` without using any data

%case: it uses data
module("Sonar").
uses_data_from(2,"Drive","Sonar").
%has: sees("Drive")
%not: consequence($kind,_,_,_)

%case: it uses data and controls nothing
module("Sonar").
uses_data_from(2,"Sonar","Drive").
%only: sees("Sonar") consequence($kind,_,"Drive","Base")
""",
    "cases/robot.mars": """\
# A robot as users write it, and what is expected to be found in it.
@configuration hierarchical
@modules Base, Drive

Base is_controlled_by Drive
# expect: warning $kind(Drive) at 5
# only: $kind
# expect cost: nodes 0
""",
    "README.md": """\
# $title

A pack of rules for mars-asp. It finds `$kind`: a controller that uses no data.

    mars-asp check --rules $topic robot.mars
    mars-asp rules lint $topic
    mars-asp test $topic --coverage --mutate

- `pack.toml` names the pack and what it needs.
- `consequences/` holds the rules that find something; `resolve/`, `verify/`, `run/` and `repair/`
  can be added.
- `cases/` holds what the rules are expected to make of facts (`.lp`) and of robots (`.mars`).
- `pyproject.toml` makes a wheel of it: `pip wheel --no-deps .`. Where that is installed,
  `--rules $topic` finds the pack.
""",
    "pyproject.toml": """\
[build-system]
requires = ["hatchling>=1.25"]
build-backend = "hatchling.build"

[project]
name = "mars-asp-$topic"
version = "0.1"
description = "$title, a pack of rules for mars-asp"
readme = "README.md"
requires-python = ">=3.11"
dependencies = ["mars-asp>=0.1"]

[project.entry-points."mars_asp.packs"]
$topic = "mars_asp_$kind"

[tool.hatch.build.targets.wheel]
include = ["/pack.toml", "/*/*.lp", "/cases"]
sources = { "" = "mars_asp_$kind" }
""",
}


def new_pack(topic: str, rulebook: Rulebook) -> tuple[str, ...]:
    """Write a pack into a new folder below the current one; return its files.

    Raises:
        MarsError: the topic is not a valid name, or a folder or a kind of finding has it.
    """
    kind = topic.replace("-", "_")
    folder = Path(topic)
    if not _TOPIC.fullmatch(topic):
        raise _topic_error(
            topic, f"`{topic}` cannot be a name", "write small letters, digits and `-`"
        )
    if folder.exists() or folder.is_symlink():
        raise _topic_error(
            topic, f"`{topic}` is there already", "choose another name, or remove it"
        )
    if kind in consequence_kinds(rulebook) or topic == "mars-asp":
        raise _topic_error(topic, f"`{kind}` is a name of ours", "choose another name")
    names = {"topic": topic, "kind": kind, "title": topic.replace("-", " ").capitalize()}
    written = []
    try:
        for path, text in _FILES.items():
            place = folder / Template(path).substitute(names)
            place.parent.mkdir(parents=True, exist_ok=True)
            write_file(str(place), Template(text).substitute(names))
            written.append(str(place))
    except OSError as error:
        message = f"`{topic}` cannot be written: {error.strerror or error}"
        raise _topic_error(topic, message, "choose a folder that you may write to") from None
    return tuple(written)


def _topic_error(topic: str, message: str, advice: str) -> MarsError:
    place = whole_file(topic)
    return MarsError((Diagnostic("usage", "error", message, place, help=advice),))
