"""The commands, their common options, and the parser of a command line."""

import argparse
import importlib
import os
import re
import sys
import textwrap
import time
from collections.abc import Mapping, Sequence, Set
from copy import copy
from functools import cache
from importlib.resources import files
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

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
#: Shorter words abbreviate no option.
_SHORTEST = len("--c")
#: Verbs are short: `clean` is not `can`.
_ALIKE_VERB = 0.78
#: The formats of a command's result; a command with others has its own `RESULT_FORMATS`.
FORMATS = ("text", "json")


#: The commands by purpose. `help.toml` has their texts.
GROUPS: Mapping[str, Sequence[str]] = {
    "Check a robot": ("check", "analyse", "extract", "can"),
    "Specify it": ("synthesise", "verify", "run", "campaign"),
    "Understand and change it": ("explain", "diff", "draw", "fmt"),
    "Exchange it": ("import", "export", "facts"),
    "Work on rules": ("rules", "test"),
    "Set up the command": ("completion", "lsp"),
}
VERBS = tuple(name for names in GROUPS.values() for name in names)
ALIASES = {"analyze": "analyse", "synthesize": "synthesise"}
#: The modules of commands whose names are keywords of Python.
_MODULES = {"import": "import_robot"}


@cache
def help_texts() -> Mapping[str, Mapping[str, str]]:
    """Return the texts of `help.toml`: of each command, and those that commands share."""
    # Most calls show no help.
    import tomllib

    return tomllib.loads((files(__package__) / "help.toml").read_text(encoding="utf-8"))


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
    for heading, names in GROUPS.items():
        parts.append(f"{heading}:")
        for name in names:
            texts = help_texts()[name]
            parts += _beside(f"  {name:<12}", texts["summary"], width)
            parts.append(f"{'':<14}$ mars-asp {texts['example']}")
        parts.append("")
    common = Parser(prog="mars-asp", add_help=False)
    common_options(common)
    common.fill_help("common")
    parts.append("Options of every command:")
    for action in common.options():
        head = f"  {', '.join(action.option_strings)} {_value_name(action)}"
        parts += _beside(head, action.help or "", width, 25)
    parts += ["", "`mars-asp COMMAND --help` describes a command and the options of its own.", ""]
    return "\n".join(parts)


def _value_name(action: argparse.Action) -> str:
    """Return the name of an option's value in the help; "" if it has none."""
    if action.nargs == 0:
        return ""
    return action.metavar if isinstance(action.metavar, str) else "|".join(action.choices or ())


def _beside(head: str, text: str, width: int, margin: int = 14) -> list[str]:
    """Return lines with `text` to the right of `head`, or below a head wider than `margin`."""
    lines = textwrap.wrap(text, max(20, width - margin), break_on_hyphens=False)
    if len(head.rstrip()) >= margin:
        return [head, *(f"{'':<{margin}}{line}" for line in lines)]
    return [f"{head if number == 0 else '':<{margin}}{line}" for number, line in enumerate(lines)]


class Parser(argparse.ArgumentParser):
    """A parser that exits with status 2 on a wrong call and names the command for help.

    An option is never abbreviated: `--fi` must not be `--fix`.
    """

    def __init__(self, **settings: Any) -> None:
        """Create the parser with the settings of argparse."""
        super().__init__(**settings, allow_abbrev=False)
        #: The command of which help is shown, and the names of its common options.
        self.command: str | None = None
        self.common = ""
        self._words: Sequence[str] = ()

    def parse_known_intermixed_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse words as argparse does, and keep them for the message of an error."""
        self._words = args or ()
        return super().parse_known_intermixed_args(args, namespace)

    def fill_help(self, *tables: str) -> None:
        """Set the help of each argument from tables of `help.toml`, unless it has one."""
        for action in self._actions:
            name = action.option_strings[-1] if action.option_strings else str(action.metavar)
            texts = (help_texts()[table].get(name) for table in tables)
            action.help = action.help or next(filter(None, texts), None)

    def format_help(self) -> str:
        """Return the help of a command, with an example and the names of common options."""
        if self.command is not None:
            texts = help_texts()[self.command]
            self.fill_help(self.command, "shared")
            parts = (
                texts.get("epilog"),
                f"Example: mars-asp {texts['example']}",
                f"Options of every command, described by `mars-asp --help`: {self.common}. "
                "Without --memory-limit a command may take half of the memory that the container "
                "or the machine has.",
            )
            self.epilog = "\n\n".join(filter(None, parts))
        return super().format_help()

    def options(self) -> list[argparse.Action]:
        """Return the arguments that begin with a dash, `--help` among them."""
        return [action for action in self._actions if action.option_strings]

    def positionals(self) -> list[argparse.Action]:
        """Return the arguments without a dash, in the order of the command line."""
        return [action for action in self._actions if not action.option_strings]

    def defaults(self) -> dict[str, Any]:
        """Return the default of each argument; of arguments with one name, that of the first."""
        found: dict[str, Any] = {}
        for action in self._actions:
            if action.default is not argparse.SUPPRESS:
                found.setdefault(action.dest, copy(action.default))
        return {**found, **self._defaults}

    def meant(self, word: str) -> str | None:
        """Return the words for a word of other tools, or None if the command has no such words."""
        table = help_texts()["meant"]
        words = table.get(f"{self.command} {word}") or table.get(word)
        if words is None or not words.startswith("-"):
            return words
        name, _, value = words.partition(" ")
        option = self._option_string_actions.get(name)
        return words if option and value in ("", *(option.choices or ())) else None

    def error(self, message: str) -> NoReturn:
        """Print an error of the command line, with a similar word if there is one; exit with 2."""
        from mars_asp.cli.wrapping import columns, wrapped
        from mars_asp.output import visible

        names = {name for action in self.options() for name in action.option_strings}
        if message.startswith("the following arguments are required"):
            message = self._misspelt(names) or message
        unknown = re.match(r"unrecognized arguments: (-[^\s=]*)", message)
        word = unknown[1] if unknown else ""
        # A short option may have its value attached, as in `-Tpng`.
        near = word and (self.meant(word) or self.meant(word[:2]))
        near = near or _near_option(word, names - _WRITING)
        choice = re.search(r"invalid choice: '(.*)' \(choose from (.*)\)$", message)
        word, advised = choice[1] if choice else word, help_texts()["advice"]
        advice = advised.get(f"{self.command} {word}") or advised.get(word)
        if choice:
            known = re.findall(r"'([^']*)'", choice[2])
            near = self.meant(choice[1]) or nearest(choice[1], known)
            near = f"mars-asp {near}" if near == choice[1] else near
            argument = re.match(r"argument ([A-Z]+):", message)
            takes_files = any(each.dest == "files" for each in self.positionals())
            if argument and takes_files and os.path.exists(choice[1]):  # noqa: PTH110 -- no error
                message += f"; {argument[1]} comes before the files"
        if unknown and os.path.lexists(word):
            near, advice = None, f"write `./{word}` for the file"
        text = f"{message}: did you mean `{near}`?" if near else message
        text = f"{message}: {advice}" if advice else text
        mark = "" if text.endswith("?") else ";"
        whole = f"{self.prog}: {visible(text)}{mark} see `{self.prog} --help`"
        lines = wrapped(whole, columns(sys.stderr), "", "  ")
        self.exit(USAGE, "\n".join([*lines, ""]))

    def _misspelt(self, names: Set[str]) -> str | None:
        """Return the error of the first word that looks like an unknown option, or None."""
        given = (word.partition("=")[0] for word in self._words if re.match("--?[a-z]", word))
        wrong = (word for word in given if word not in names and word[:2] not in names)
        return next((f"unrecognized arguments: {word}" for word in wrong), None)

    def _print_message(self, message: str, file: "SupportsWrite[str] | None" = None) -> None:
        """Write a message, and raise OSError if that fails; argparse would ignore the error."""
        (file or sys.stderr).write(message)


def _near_option(word: str, names: Set[str]) -> str | None:
    """Return the option that a word abbreviates, or that is similar to it apart from dashes."""
    begun = sorted(name for name in names if len(word) > _SHORTEST and name.startswith(word))
    known = {name.lstrip("-"): name for name in sorted(names)}
    near = nearest(word.lstrip("-"), known, _ALIKE)
    return begun[0] if len(begun) == 1 else None if near is None else known[near]


class _Formatter(argparse.HelpFormatter):
    """A help formatter that keeps paragraphs."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        parts = text.split("\n\n")
        return "\n\n".join(
            textwrap.fill(" ".join(part.split()), width, break_on_hyphens=False) for part in parts
        )


def parser_of(word: str) -> tuple[ModuleType, Parser]:
    """Return the module and parser of a command; `word` is its name or an alias."""
    verb = ALIASES.get(word, word)
    module = importlib.import_module(f"mars_asp.cli.{_MODULES.get(verb, verb)}")
    description = (module.__doc__ or "").partition("\n")[0]
    parser = Parser(prog=f"mars-asp {word}", description=description, formatter_class=_Formatter)
    parser.command = verb
    module.configure(parser)
    own = len(parser.options())
    common_options(parser, getattr(module, "RESULT_FORMATS", FORMATS))
    common = parser.options()[own:]
    names = (f"{option.option_strings[0]} {_value_name(option)}".rstrip() for option in common)
    parser.common = ", ".join(names)
    for option in common:
        option.help = argparse.SUPPRESS
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
            near = parser.meant(name) or _near_option(name, {*takes, "--help"})
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
        near = parser.meant(rest[0]) or (f"--{rest[0]}" if is_option else _near_verb(rest[0]))
        hint = f"did you mean `{near}`?" if near else f"one of {', '.join(VERBS)}"
        hint = help_texts()["advice"].get(rest[0], hint)
        parser.error(f"there is no command `{rest[0]}`: {hint}")
    return [rest[0], *before, *rest[1:]]


def _near_verb(word: str) -> str | None:
    """Return the only command that begins with a word, else one that is spelt like it, or None."""
    longer = [verb for verb in VERBS if verb.startswith(word) and len(word) > 1]
    return longer[0] if len(longer) == 1 else nearest(word, (*VERBS, *ALIASES), _ALIKE_VERB)


def common_options(parser: argparse.ArgumentParser, formats: Sequence[str] = FORMATS) -> None:
    """Add the options of every command; `formats` are the formats of the command's result."""
    add = parser.add_argument
    add("--rules", metavar="DIR|NAME", action="append", default=[], type=rule_pack)
    add("--trust", action="store_true")
    add("--sources", metavar="PATH", action="append", default=[])
    add("--from", dest="from_format", choices=FOREIGN)
    add("--format", choices=formats, default="text")
    add("--time-limit", metavar="SECONDS", type=positive)
    add("--memory-limit", metavar="MB", type=positive)
    add("--color", choices=("auto", "always", "never"), default="auto")
    add("--config", metavar="SETTINGS")
    add("--isolated", action="store_true")
    add("-q", "--quiet", action="store_true")
    add("-v", "--verbose", action="store_true")
    add(
        "-V",
        "--version",
        action="version",
        version=f"mars-asp {__version__}",
        help="print the version and exit",
    )


def add_flags(parser: argparse.ArgumentParser, *options: str) -> None:
    """Add options without a value."""
    for option in options:
        parser.add_argument(option, action="store_true")


def add_output(parser: argparse.ArgumentParser, metavar: str = "OUT") -> None:
    """Add the option that names the file of the result; the default is standard output."""
    parser.add_argument("-o", "--output", metavar=metavar, default="-")


def misuse(command: str, problem: str) -> int:
    """Print why words of a command contradict each other; return the exit status."""
    print(f"mars-asp {command}: {problem}", file=sys.stderr)
    return USAGE


def rule_pack(given: str) -> str:
    """Return an existing path unchanged, else the folder of the installed pack of this name."""
    if os.path.exists(given):  # noqa: PTH110 -- never raises
        return given
    from mars_asp.reasoning.packs import installed_pack

    return str(installed_pack(given) or given)


def positive(text: str) -> float:
    """Return the number in a text; an error unless it is above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1e9:
        raise argparse.ArgumentTypeError(f"`{text}` must be a positive number")
    return value
