"""Print what completes words of this command in a shell: commands, options, values and files."""

import argparse
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from mars_asp.cli.arguments import ALIASES, VERBS, Parser, help_texts, parser_of

#: The options that take kinds of findings, with commas between them.
_LISTS = frozenset({"--select", "--ignore"})


class _Option(NamedTuple):
    """An option: its names, its help, whether it takes a value, and the possible values."""

    names: tuple[str, ...]
    about: str
    takes: bool
    values: tuple[str, ...]


#: The option of every command that the parser of common options lacks.
_HELP = _Option(("--help", "-h"), "", False, ())


class _CommandWords(NamedTuple):
    """The names of a command, its help, its options, and the words that may follow it."""

    names: tuple[str, ...]
    about: str
    options: tuple[_Option, ...]
    words: tuple[str, ...]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    shells = tuple(_SCRIPTS)
    parser.add_argument("shell", nargs="?", choices=shells, metavar="SHELL", help=", ".join(shells))


def run(arguments: argparse.Namespace) -> int:
    """Print the script for a shell; without a shell, print the supported shells."""
    if arguments.shell is None:
        print("\n".join(_SCRIPTS))
        return 0
    print(_SCRIPTS[arguments.shell](tuple(_verbs())), end="")
    return 0


def _verbs() -> Iterator[_CommandWords]:
    for name in VERBS:
        _, parser = parser_of(name)
        parser.fill_help(name, "shared")
        summary = help_texts()[name]["summary"]
        aliases = tuple(alias for alias, of in ALIASES.items() if of == name)
        words = [str(choice) for action in parser.positionals() for choice in action.choices or ()]
        yield _CommandWords(
            (name, *aliases), summary, tuple(_options_of(parser.options())), tuple(words)
        )


def _options_of(actions: Iterable[argparse.Action]) -> Iterator[_Option]:
    common = {name: each.help for each in _common_options() for name in each.option_strings}
    for action in actions:
        about = common.get(action.option_strings[0]) or action.help or ""
        values = tuple(map(str, action.choices or ()))
        takes = action.nargs not in (0, "?")
        yield _Option(tuple(action.option_strings), about.replace("%%", "%"), takes, values)


@cache
def _kinds() -> str:
    """Return kinds of built-in findings and codes of warnings, separated by blanks."""
    from mars_asp.cli.input_codes import ignorable_codes
    from mars_asp.reasoning.findings import consequence_kinds
    from mars_asp.reasoning.rules import STAGES, load_rulebook

    return " ".join(
        sorted(consequence_kinds(load_rulebook(stages=STAGES)).union(ignorable_codes()))
    )


def _common_options() -> list[argparse.Action]:
    """Return the common options with their help, which the parser of a command omits."""
    from mars_asp.cli.arguments import common_options

    parser = Parser(add_help=False)
    common_options(parser)
    parser.fill_help("common")
    return parser.options()


# ---- Shells --------------------------------------------------------------------------------------


def _bash(verbs: tuple[_CommandWords, ...]) -> str:
    commands = tuple(name for verb in verbs for name in verb.names[:1])
    common = tuple(_options_of(_common_options()))
    before = _CommandWords(("",), "", (_HELP, *common), (*commands, "help"))
    values, words = [], []
    for verb in (before, _CommandWords(("help",), "", (), commands), *verbs):
        for option in (each for each in verb.options if each.takes):
            patterns = "|".join(f'"{name} {form}"' for name in verb.names for form in option.names)
            chosen = f'words="{" ".join(option.values)}"' if option.values else "return"
            if not _LISTS.isdisjoint(option.names):
                chosen = 'words=$kinds prefix=${word%"${word##*,}"}'
            values.append(f"        {patterns}) {chosen} ;;")
        names = " ".join(name for option in verb.options for name in option.names)
        pattern = "|".join(verb.names) or '""'
        words += [
            f"                {pattern})",
            f'                    words="{" ".join(verb.words)}"',
            f'                    [[ $word == -* ]] && words="{names}" ;;',
        ]
    # Options, some with a value, may precede the command.
    valued = "|".join(name for option in common if option.takes for name in option.names)
    return _fill_frame("bash", kinds=_kinds(), valued=valued, values=values, words=words)


def _zsh(verbs: tuple[_CommandWords, ...]) -> str:
    words = []
    for verb in verbs:
        words += [f"        {'|'.join(verb.names)})", "            _arguments -s \\"]
        for option in verb.options:
            about = option.about.replace("[", "(").replace("]", ")").replace(":", "\\:")
            value = f":value:({' '.join(option.values)})" if option.values else ":value:_files"
            if not _LISTS.isdisjoint(option.names):
                value = f":value:_values -s , kind {_kinds()}"
            value = value if option.takes else ""
            for name in option.names:
                words.append(f"                {_shell_word(f'*{name}[{about}]{value}')} \\")
        following = f"'*:word:(({' '.join(verb.words)}))'" if verb.words else ""
        words.append(f"                {following or _shell_word('*:file:_files')} ;;")
    listed = [f"        {_shell_word(f'{verb.names[0]}:{verb.about}')}" for verb in verbs]
    return _fill_frame("zsh", verbs=listed, words=words)


def _fish(verbs: tuple[_CommandWords, ...]) -> str:
    lines = ["# Completion of mars-asp for fish."]
    shown = "-n '__fish_use_subcommand; or __fish_seen_subcommand_from help'"
    for verb in verbs:
        about = _shell_word(verb.about)
        lines.append(f"complete -c mars-asp -f {shown} -a {verb.names[0]} -d {about}")
    for verb in verbs:
        of_verb = f"complete -c mars-asp -n '__fish_seen_subcommand_from {' '.join(verb.names)}'"
        lines += [f"{of_verb} -a '{' '.join(verb.words)}'"] if verb.words else []
        for option in verb.options:
            forms = " ".join(
                f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
                for name in option.names
            )
            is_list = not _LISTS.isdisjoint(option.names)
            values = _kinds() if is_list else " ".join(option.values)
            value = f" -xa '{values}'" if values else " -r"
            text = f"{forms}{value if option.takes else ''} -d {_shell_word(option.about)}"
            lines.append(f"{of_verb} {text}")
    return "\n".join([*lines, ""])


def _fill_frame(shell: str, **parts: str | Sequence[str]) -> str:
    """Return the completion script of a shell, in which `parts` replace `@name@`."""
    text = (files(__package__) / f"completion.{shell}").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part if isinstance(part, str) else "\n".join(part))
    return text


def _shell_word(text: str) -> str:
    """Return a text quoted as one word of a shell."""
    return "'" + text.replace("'", "'\\''") + "'"


_SCRIPTS = {"bash": _bash, "zsh": _zsh, "fish": _fish}
