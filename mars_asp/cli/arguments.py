"""The commands, their common options, and the parser of a command line."""

import argparse
import importlib
import os
import re
import sys
import textwrap
import time
from collections.abc import Mapping, Sequence
from copy import copy
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from mars_asp import __version__
from mars_asp.exchange.recognise import FORMATS as FOREIGN
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from _typeshed import SupportsWrite

USAGE = 2
_HELP = ("--help", "-h")
#: Options that write files are never proposed.
_WRITING = frozenset(
    {"--fix", "--write-baseline", "-o", "--output", "--update", "--snapshot", "--junit"}
)
#: The minimal similarity of proposed options; dashes make any two a little alike.
_ALIKE = 0.7
#: The formats of a command's result; a command with others has its own `RESULT_FORMATS`.
FORMATS = ("text", "json")


class Verb(NamedTuple):
    """The summary of a command, and an example call."""

    summary: str
    example: str


#: The commands by purpose.
GROUPS: Mapping[str, Mapping[str, Verb]] = {
    "Check a robot": {
        "check": Verb("report errors and warnings", "check my_ws/"),
        "analyse": Verb("list the consequences of a configuration", "analyse config.mars"),
        "extract": Verb("list the modules in annotated sources", "extract src/"),
        "can": Verb(
            "is the robot able to do something, or several things at one time",
            "can config.mars 'Rotn_Y of Camera while Rotn_Z of Arm'",
        ),
    },
    "Specify it": {
        "synthesise": Verb(
            "find the minimal specification", "synthesise config.mars -o specification.mars"
        ),
        "verify": Verb(
            "does a specification realise a configuration, and is it minimal",
            "verify specification.mars config.mars",
        ),
        "run": Verb(
            "execute a specification on the simulator and judge the run",
            "run specification.mars --scenario scenario.toml",
        ),
        "campaign": Verb(
            "run it in many worlds, and show what holds in how many",
            "campaign robot.mars --scenario s.toml --seeds 1-200",
        ),
    },
    "Understand and change it": {
        "explain": Verb(
            "why each consequence and node is there, down to lines",
            "explain config.mars DataSplitter1",
        ),
        "diff": Verb(
            "what changed between two configurations, and the lines that caused it",
            "diff old.mars new.mars",
        ),
        "draw": Verb("draw it: svg, png, dot or mmd", "draw config.mars -o config.svg"),
        "fmt": Verb("format `.mars` files, comments kept", "fmt config.mars"),
    },
    "Exchange it": {
        "import": Verb(
            "read a robot from URDF, ROS, twist_mux or dora files",
            "import urdf robot.urdf -o robot.mars",
        ),
        "export": Verb("write the mount tree as `urdf`", "export urdf config.mars -o robot.urdf"),
        "facts": Verb("print the facts as input of clingo", "facts config.mars"),
    },
    "Work on rules": {
        "rules": Verb(
            "list, show, check or begin rules, and what a pack of them changes",
            "rules show data/divergence",
        ),
        "test": Verb(
            "run cases of rules: facts or robots, and what is expected of them", "test tests/rules"
        ),
    },
    "Set up the command": {
        "completion": Verb(
            "print what completes words of this command in bash, zsh or fish", "completion bash"
        ),
        "lsp": Verb("answer editors: the language server, over stdio", "lsp"),
    },
}
VERBS: Mapping[str, Verb] = {name: verb for of in GROUPS.values() for name, verb in of.items()}
ALIASES = {"analyze": "analyse", "synthesize": "synthesise"}
#: Commands of other tools, with the equivalent commands of this one.
MEANT = {"format": "fmt", "lint": "check", "plot": "draw", "simulate": "run"}
#: The modules of commands whose names are keywords of Python.
_MODULES = {"import": "import_robot"}


def help_text() -> str:
    """Return the help of the whole program: each command with an example, and common options."""
    from mars_asp.cli.wrapping import columns

    width = columns(sys.stdout)
    parts = [
        "usage: mars-asp COMMAND [WORD...] [OPTION...]\n",
        "A static analyser for robot architectures: it finds wiring faults, computes the\n"
        "smallest fix, and shows the lines that cause each. It reads ROS workspaces,\n"
        "twist_mux files, dora dataflows, URDF and `.mars` files.\n",
    ]
    for heading, verbs in GROUPS.items():
        parts.append(f"{heading}:")
        for name, verb in verbs.items():
            parts += _beside(f"  {name:<12}", verb.summary, width)
            parts.append(f"{'':<14}$ mars-asp {verb.example}")
        parts.append("")
    common = Parser(prog="mars-asp", add_help=False)
    common_options(common)
    parts.append("Options of every command:")
    for action in common.options():
        names = ", ".join(action.option_strings)
        parts += _beside(f"  {names} {_value_name(action)}", action.help or "", width, 25)
    parts += ["", "`mars-asp COMMAND --help` describes a command and the options of its own.", ""]
    return "\n".join(parts)


def _value_name(action: argparse.Action) -> str:
    """Return the name of the value of an option; empty if it has none."""
    if action.nargs == 0:
        return ""
    return action.metavar if isinstance(action.metavar, str) else "|".join(action.choices or ())


def _beside(head: str, text: str, width: int, margin: int = 14) -> list[str]:
    """Return the lines of a text to the right of a head, or below it if the head is too long."""
    lines = textwrap.wrap(text, max(20, width - margin), break_on_hyphens=False)
    if len(head.rstrip()) >= margin:
        return [head, *(f"{'':<{margin}}{line}" for line in lines)]
    return [f"{head if number == 0 else '':<{margin}}{line}" for number, line in enumerate(lines)]


class Parser(argparse.ArgumentParser):
    """A parser that exits with status 2 on a wrong call and names the command for help.

    An option is never abbreviated: `--fi` must not be `--fix`.
    """

    def __init__(self, **settings: Any) -> None:
        """Take the settings of argparse."""
        super().__init__(**settings, allow_abbrev=False)

    def options(self) -> list[argparse.Action]:
        """Return the options."""
        return [action for action in self._actions if action.option_strings]

    def positionals(self) -> list[argparse.Action]:
        """Return the positional arguments."""
        return [action for action in self._actions if not action.option_strings]

    def defaults(self) -> dict[str, Any]:
        """Return the default of each argument; of arguments with one name, that of the first."""
        found: dict[str, Any] = {}
        for action in self._actions:
            if action.default is not argparse.SUPPRESS:
                found.setdefault(action.dest, copy(action.default))
        return {**found, **self._defaults}

    def error(self, message: str) -> NoReturn:
        """Print an error of the command line, with a similar word if there is one; exit with 2."""
        from mars_asp.cli.wrapping import columns, wrapped
        from mars_asp.output import visible

        unknown = re.match(r"unrecognized arguments: (-[^\s=]*)", message)
        names = {name for action in self.options() for name in action.option_strings}
        near = nearest(unknown[1], sorted(names - _WRITING), _ALIKE) if unknown else None
        if choice := re.search(r"invalid choice: '(.*)' \(choose from (.*)\)$", message):
            near = nearest(choice[1], re.findall(r"'([^']*)'", choice[2]))
            argument = re.match(r"argument ([A-Z]+):", message)
            takes_files = any(each.dest == "files" for each in self.positionals())
            if argument and takes_files and os.path.exists(choice[1]):  # noqa: PTH110 -- no error
                message += f"; {argument[1]} comes before the files"
        text = f"{message}: did you mean `{near}`?" if near else message
        mark = "" if text.endswith("?") else ";"
        whole = f"{self.prog}: {visible(text)}{mark} see `{self.prog} --help`"
        lines = wrapped(whole, columns(sys.stderr), "", "  ")
        self.exit(USAGE, "\n".join([*lines, ""]))

    def _print_message(self, message: str, file: "SupportsWrite[str] | None" = None) -> None:
        """Write a message, and raise OSError if that fails; argparse would ignore the error."""
        (file or sys.stderr).write(message)


class _Formatter(argparse.HelpFormatter):
    """A help formatter that keeps paragraphs."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        parts = text.split("\n\n")
        return "\n\n".join(
            textwrap.fill(" ".join(part.split()), width, break_on_hyphens=False) for part in parts
        )


def parser_of(word: str) -> tuple[ModuleType, Parser]:
    """Return the module of a command, whose word may be an alias, and its parser."""
    verb = ALIASES.get(word, word)
    module = importlib.import_module(f"mars_asp.cli.{_MODULES.get(verb, verb)}")
    description = (module.__doc__ or "").partition("\n")[0]
    parser = Parser(prog=f"mars-asp {word}", description=description, formatter_class=_Formatter)
    module.configure(parser)
    own = len(parser.options())
    common_options(parser, getattr(module, "RESULT_FORMATS", FORMATS))
    common = parser.options()[own:]
    names = [f"{option.option_strings[0]} {_value_name(option)}".rstrip() for option in common]
    for option in common:
        option.help = argparse.SUPPRESS
    parser.epilog = "\n\n".join(
        filter(
            None,
            (
                parser.epilog,
                f"Example: mars-asp {VERBS[verb].example}",
                f"Options of every command, described by `mars-asp --help`: {', '.join(names)}. "
                "Without --memory-limit a command may take half of the memory that the container "
                "or the machine has.",
            ),
        )
    )
    return module, parser


def arguments_of(command: str, **values: object) -> argparse.Namespace:
    """Return the arguments of a quiet call of a command.

    `values` are the values of arguments; all others have their defaults.
    """
    given = {"quiet": True, "color": "never", "started": time.monotonic(), **values}
    return argparse.Namespace(**{**parser_of(command)[1].defaults(), **given})


def ordered(words: Sequence[str]) -> list[str]:
    """Return the words of a command line with the command first.

    Options that precede the command are moved after it. `help` becomes `--help`, and `help COMMAND`
    becomes `COMMAND --help`. An unknown command or option exits with status 2.
    """
    parser = Parser(prog="mars-asp", add_help=False)
    common_options(parser)
    takes = {
        name: option.nargs is None for option in parser.options() for name in option.option_strings
    }
    flags = "".join(
        name[1] for name, has_value in takes.items() if len(name) == 2 and not has_value
    )
    at = 0
    while at < len(words) and words[at].startswith("-") and words[at] not in _HELP:
        name, equals, _ = words[at].partition("=")
        if re.fullmatch(rf"-[{flags}]{{2,}}", name):
            at += 1
            continue
        if name not in takes:
            near = nearest(name, (*takes, "--help"), _ALIKE)
            parser.error(
                f"unknown option `{words[at]}`{f': did you mean `{near}`?' if near else ''}"
            )
        at += 2 if takes[name] and not equals else 1
    before, rest = list(words[:at]), list(words[at:])
    if not rest or rest[0] in (*_HELP, "help"):
        if not {"-V", "--version"}.isdisjoint(before):
            return ["--version"]
        rest = [each for each in rest[1:2] if each not in (*_HELP, "help")]
        if not rest:
            return ["--help"]
        before = ["--help"]
    if ALIASES.get(rest[0], rest[0]) not in VERBS:
        is_option = f"--{rest[0]}" in (*takes, "--version")
        near = MEANT.get(rest[0]) or (
            f"--{rest[0]}" if is_option else nearest(rest[0], (*VERBS, *ALIASES))
        )
        hint = f"did you mean `{near}`?" if near else f"one of {', '.join(VERBS)}"
        parser.error(f"there is no command `{rest[0]}`: {hint}")
    return [rest[0], *before, *rest[1:]]


def common_options(parser: argparse.ArgumentParser, formats: Sequence[str] = FORMATS) -> None:
    """Add the options of every command; `formats` are the formats of the command's result."""
    add = parser.add_argument
    add(
        "--rules",
        metavar="DIR|NAME",
        action="append",
        default=[],
        type=rule_pack,
        help="a rule pack, a path or one that is installed; repeatable",
    )
    add("--trust", action="store_true", help="a rule pack may rank its costs above built-in ones")
    add(
        "--sources",
        metavar="PATH",
        action="append",
        default=[],
        help="more annotated sources; repeatable",
    )
    add(
        "--from",
        dest="from_format",
        choices=FOREIGN,
        help="the format of FILE, where its content does not show it",
    )
    add("--format", choices=formats, default="text", help="of the output (default text)")
    add(
        "--time-limit",
        metavar="SECONDS",
        type=positive,
        help="stop after this long, with status 3 (default: no limit)",
    )
    add(
        "--memory-limit",
        metavar="MB",
        type=positive,
        help="stop beyond this much, with status 3 "
        "(default: half of what the container or the machine has)",
    )
    add(
        "--color",
        choices=("auto", "always", "never"),
        default="auto",
        help="of text; auto obeys NO_COLOR, FORCE_COLOR and TERM=dumb, and else colours what goes "
        "to a terminal",
    )
    add("--config", metavar="SETTINGS", help="the settings, instead of the nearest mars.toml")
    add("--isolated", action="store_true", help="take no settings")
    add(
        "-q",
        "--quiet",
        action="store_true",
        help="no progress, no notes, no summary; JSON still names what was not read",
    )
    add(
        "-v",
        "--verbose",
        action="store_true",
        help="list on standard error the settings, robots and launch files that count, and how "
        "long each step takes",
    )
    add(
        "-V",
        "--version",
        action="version",
        version=f"mars-asp {__version__}",
        help="print the version and exit",
    )


def add_flags(parser: argparse.ArgumentParser, texts: Mapping[str, str]) -> None:
    """Add options without a value; `texts` has the help of each."""
    for option, text in texts.items():
        parser.add_argument(option, action="store_true", help=text)


def add_output(
    parser: argparse.ArgumentParser, text: str = "where to write it", metavar: str = "OUT"
) -> None:
    """Add the option that names the file of the result; the default is standard output."""
    parser.add_argument("-o", "--output", metavar=metavar, default="-", help=text)


def misuse(command: str, problem: str) -> int:
    """Print why words of a command do not go together; return the exit status."""
    print(f"mars-asp {command}: {problem}", file=sys.stderr)
    return USAGE


def rule_pack(given: str) -> str:
    """Return a path as it is, or the folder of the installed pack if there is no such path."""
    if os.path.exists(given):  # noqa: PTH110 -- never raises
        return given
    from mars_asp.reasoning.packs import installed_pack

    return str(installed_pack(given) or given)


def positive(text: str) -> float:
    """Read a number above 0 of a command line."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e9:
        raise argparse.ArgumentTypeError(f"`{text}` must be a positive number")
    return value
