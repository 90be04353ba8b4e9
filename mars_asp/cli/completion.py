"""Print what completes words of this command in a shell: commands, options, values and files."""

import argparse
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mars_asp.cli.arguments import ALIASES, VERBS, Parser, parser_of

#: The options that take kinds of findings, with commas between them.
_LISTS = frozenset({"--select", "--ignore"})
#: The command whose words are completed.
_COMMAND = "mars-asp"


class _Option(NamedTuple):
    """An option: its names, its help, whether a value follows, and the possible values."""

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
    parser.epilog = (
        "bash: source <(mars-asp completion bash), in ~/.bashrc. zsh: mars-asp completion zsh > "
        "_mars-asp, in a folder of $fpath. fish: mars-asp completion fish > "
        "~/.config/fish/completions/mars-asp.fish"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the script for a shell; without a shell, print the supported shells."""
    if arguments.shell is None:
        print("\n".join(_SCRIPTS))
        return 0
    for line in _SCRIPTS[arguments.shell](tuple(_verbs())):
        print(line)
    return 0


def _verbs() -> Iterator[_CommandWords]:
    for name, verb in VERBS.items():
        _, parser = parser_of(name)
        aliases = tuple(alias for alias, of in ALIASES.items() if of == name)
        words = [str(choice) for action in parser.positionals() for choice in action.choices or ()]
        yield _CommandWords(
            (name, *aliases), verb.summary, tuple(_options_of(parser.options())), tuple(words)
        )


def _options_of(actions: Iterable[argparse.Action]) -> Iterator[_Option]:
    common = {name: each.help for each in _common_options() for name in each.option_strings}
    for action in actions:
        about = common.get(action.option_strings[0]) or action.help or ""
        values = tuple(map(str, action.choices or ()))
        takes = action.nargs not in (0, "?")
        yield _Option(tuple(action.option_strings), about.replace("%%", "%"), takes, values)


def _kinds() -> list[str]:
    """Return the kinds of findings of the built-in rules, and the codes of warnings on reading."""
    from mars_asp.diagnostic import INPUT_WARNINGS
    from mars_asp.reasoning.findings import consequence_kinds
    from mars_asp.reasoning.rules import STAGES, load_rulebook

    return sorted(consequence_kinds(load_rulebook(stages=STAGES)).union(INPUT_WARNINGS))


def _common_options() -> list[argparse.Action]:
    """Return the common options with their help, which the parser of a command omits."""
    from mars_asp.cli.arguments import common_options

    parser = Parser(add_help=False)
    common_options(parser)
    return parser.options()


# ---- Shells --------------------------------------------------------------------------------------


def _bash(verbs: tuple[_CommandWords, ...]) -> Iterator[str]:
    commands = tuple(name for verb in verbs for name in verb.names[:1])
    common = tuple(_options_of(_common_options()))
    before = _CommandWords(("",), "", (_HELP, *common), (*commands, "help"))
    verbs = (before, _CommandWords(("help",), "", (), commands), *verbs)
    yield f"# Completion of {_COMMAND} for bash."
    yield "_mars_asp() {"
    yield "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}"
    yield "    local verb= words= prefix= at"
    yield f'    local kinds="{" ".join(_kinds())}"'
    yield "    COMPREPLY=()"
    # Options, some with a value, may precede the command.
    yield "    for ((at = 1; at < COMP_CWORD; at++)); do"
    yield "        case ${COMP_WORDS[at]} in"
    valued = "|".join(name for option in common if option.takes for name in option.names)
    yield f"            {valued})"
    yield '                [[ ${COMP_WORDS[at+1]} == "=" ]] && ((at++))'
    yield "                ((at++)) ;;"
    yield "            -*) ;;"
    yield "            *)"
    yield "                verb=${COMP_WORDS[at]}"
    yield "                break ;;"
    yield "        esac"
    yield "    done"
    # Readline splits `--format=json` into three words.
    yield '    if [[ $word == "=" ]]; then'
    yield "        word="
    yield '    elif [[ $before == "=" ]]; then'
    yield "        before=${COMP_WORDS[COMP_CWORD-2]}"
    yield "    fi"
    yield '    case "$verb $before" in'
    for verb in verbs:
        for option in (each for each in verb.options if each.takes):
            patterns = "|".join(f'"{name} {form}"' for name in verb.names for form in option.names)
            chosen = f'words="{" ".join(option.values)}"' if option.values else "return"
            if not _LISTS.isdisjoint(option.names):
                chosen = 'words=$kinds prefix=${word%"${word##*,}"}'
            yield f"        {patterns}) {chosen} ;;"
    yield "        *)"
    yield "            case $verb in"
    for verb in verbs:
        names = " ".join(name for option in verb.options for name in option.names)
        pattern = "|".join(verb.names) or '""'
        yield f"                {pattern})"
        yield f'                    words="{" ".join(verb.words)}"'
        yield f'                    [[ $word == -* ]] && words="{names}" ;;'
    yield "            esac ;;"
    yield "    esac"
    yield '    mapfile -t COMPREPLY < <(compgen -P "$prefix" -W "$words" -- "${word#"$prefix"}")'
    yield "}"
    yield f"complete -o default -o bashdefault -F _mars_asp {_COMMAND}"


def _zsh(verbs: tuple[_CommandWords, ...]) -> Iterator[str]:
    kinds = " ".join(_kinds())
    yield f"#compdef {_COMMAND}"
    yield f"# Completion of {_COMMAND} for zsh."
    yield "_mars_asp() {"
    yield "    local -a verbs"
    yield "    verbs=("
    for verb in verbs:
        yield f"        {_shell_word(f'{verb.names[0]}:{verb.about}')}"
    yield "    )"
    yield "    if (( CURRENT == 2 )) || [[ $words[2] == help ]]; then"
    yield "        _describe command verbs"
    yield "        return"
    yield "    fi"
    yield "    local verb=$words[2]"
    yield "    shift words"
    yield "    (( CURRENT-- ))"
    yield "    case $verb in"
    for verb in verbs:
        yield f"        {'|'.join(verb.names)})"
        yield "            _arguments -s \\"
        for option in verb.options:
            about = option.about.replace("[", "(").replace("]", ")").replace(":", "\\:")
            value = f":value:({' '.join(option.values)})" if option.values else ":value:_files"
            if not _LISTS.isdisjoint(option.names):
                value = f":value:_values -s , kind {kinds}"
            value = value if option.takes else ""
            for name in option.names:
                yield f"                {_shell_word(f'*{name}[{about}]{value}')} \\"
        words = f"'*:word:(({' '.join(verb.words)}))'" if verb.words else ""
        yield f"                {words or _shell_word('*:file:_files')} ;;"
    yield "    esac"
    yield "}"
    yield f"compdef _mars_asp {_COMMAND}"


def _fish(verbs: tuple[_CommandWords, ...]) -> Iterator[str]:
    kinds = " ".join(_kinds())
    yield f"# Completion of {_COMMAND} for fish."
    shown = "-n '__fish_use_subcommand; or __fish_seen_subcommand_from help'"
    for verb in verbs:
        about = _shell_word(verb.about)
        yield f"complete -c {_COMMAND} -f {shown} -a {verb.names[0]} -d {about}"
    for verb in verbs:
        seen = f"-n '__fish_seen_subcommand_from {' '.join(verb.names)}'"
        if verb.words:
            yield f"complete -c {_COMMAND} {seen} -a '{' '.join(verb.words)}'"
        for option in verb.options:
            forms = " ".join(
                f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
                for name in option.names
            )
            values = kinds if not _LISTS.isdisjoint(option.names) else " ".join(option.values)
            value = f" -xa '{values}'" if values else " -r"
            text = f"{forms}{value if option.takes else ''} -d {_shell_word(option.about)}"
            yield f"complete -c {_COMMAND} {seen} {text}"


def _shell_word(text: str) -> str:
    """Return a text quoted as one word of a shell."""
    return "'" + text.replace("'", "'\\''") + "'"


_SCRIPTS = {"bash": _bash, "zsh": _zsh, "fish": _fish}
