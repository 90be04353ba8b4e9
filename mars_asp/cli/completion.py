"""Print what completes words of this command in a shell: verbs, options, their values and files."""

import argparse
from collections.abc import Iterator
from typing import NamedTuple

from mars_asp.cli.arguments import ALIASES, VERBS, Parser, parser_of

#: The command that words are completed of.
_COMMAND = "mars-asp"


class _Option(NamedTuple):
    """An option: how it is written, what it does, whether a value follows, and which there are."""

    names: tuple[str, ...]
    about: str
    takes: bool
    values: tuple[str, ...]


class _Words(NamedTuple):
    """What may follow a verb, which has several names: options, and words that are no files."""

    names: tuple[str, ...]
    about: str
    options: tuple[_Option, ...]
    words: tuple[str, ...]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    shells = tuple(_SCRIPTS)
    parser.add_argument("shell", nargs="?", choices=shells, metavar="SHELL", help=", ".join(shells))
    parser.epilog = (
        "bash: source <(mars-asp completion bash), in ~/.bashrc. zsh: mars-asp completion zsh > "
        "_mars-asp, in a folder of $fpath. fish: mars-asp completion fish > "
        "~/.config/fish/completions/mars-asp.fish"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the script for a shell; without one the shells there are."""
    if arguments.shell is None:
        print("\n".join(_SCRIPTS))
        return 0
    for line in _SCRIPTS[arguments.shell](tuple(_verbs())):
        print(line)
    return 0


def _verbs() -> Iterator[_Words]:
    for name, verb in VERBS.items():
        _, parser = parser_of(name)
        aliases = tuple(alias for alias, of in ALIASES.items() if of == name)
        words = [str(choice) for action in parser.positionals() for choice in action.choices or ()]
        yield _Words((name, *aliases), verb.summary, tuple(_options(parser)), tuple(words))


def _options(parser: Parser) -> Iterator[_Option]:
    common = {name: each.help for each in _described() for name in each.option_strings}
    for action in parser.options():
        about = common.get(action.option_strings[0]) or action.help or ""
        values = tuple(map(str, action.choices or ()))
        takes = action.nargs not in (0, "?")
        yield _Option(tuple(action.option_strings), about.replace("%%", "%"), takes, values)


def _described() -> list[argparse.Action]:
    """Return the common options with their help, which a verb leaves to that of the command."""
    from mars_asp.cli.arguments import common_options

    parser = Parser(add_help=False)
    common_options(parser)
    return parser.options()


# ---- Shells --------------------------------------------------------------------------------------


def _bash(verbs: tuple[_Words, ...]) -> Iterator[str]:
    yield f"# Completion of {_COMMAND} for bash."
    yield "_mars_asp() {"
    yield "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}"
    yield "    local verb=${COMP_WORDS[1]} words="
    yield "    COMPREPLY=()"
    # Readline takes `--format=json` for three words.
    yield '    if [[ $word == "=" ]]; then'
    yield "        word="
    yield '    elif [[ $before == "=" ]]; then'
    yield "        before=${COMP_WORDS[COMP_CWORD-2]}"
    yield "    fi"
    yield "    if ((COMP_CWORD == 1)); then"
    yield f'        words="{" ".join((*VERBS, "--help", "--version"))}"'
    yield "    else"
    yield '        case "$verb $before" in'
    for verb in verbs:
        for option in (each for each in verb.options if each.takes):
            patterns = "|".join(f'"{name} {form}"' for name in verb.names for form in option.names)
            chosen = f'words="{" ".join(option.values)}"' if option.values else "return"
            yield f"            {patterns}) {chosen} ;;"
    yield "            *)"
    yield "                case $verb in"
    for verb in verbs:
        names = " ".join(name for option in verb.options for name in option.names)
        yield f"                    {'|'.join(verb.names)})"
        yield f'                        words="{" ".join(verb.words)}"'
        yield f'                        [[ $word == -* ]] && words="{names}" ;;'
    yield "                esac ;;"
    yield "        esac"
    yield "    fi"
    yield '    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")'
    yield "}"
    yield f"complete -o default -o bashdefault -F _mars_asp {_COMMAND}"


def _zsh(verbs: tuple[_Words, ...]) -> Iterator[str]:
    yield f"#compdef {_COMMAND}"
    yield f"# Completion of {_COMMAND} for zsh."
    yield "_mars_asp() {"
    yield "    local -a verbs"
    yield "    verbs=("
    for verb in verbs:
        yield f"        {_quoted(f'{verb.names[0]}:{verb.about}')}"
    yield "    )"
    yield "    if (( CURRENT == 2 )); then"
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
            value = value if option.takes else ""
            for name in option.names:
                yield f"                {_quoted(f'*{name}[{about}]{value}')} \\"
        words = f"'*:word:(({' '.join(verb.words)}))'" if verb.words else ""
        yield f"                {words or _quoted('*:file:_files')} ;;"
    yield "    esac"
    yield "}"
    yield f"compdef _mars_asp {_COMMAND}"


def _fish(verbs: tuple[_Words, ...]) -> Iterator[str]:
    yield f"# Completion of {_COMMAND} for fish."
    for verb in verbs:
        about = _quoted(verb.about)
        yield f"complete -c {_COMMAND} -f -n __fish_use_subcommand -a {verb.names[0]} -d {about}"
    for verb in verbs:
        seen = f"-n '__fish_seen_subcommand_from {' '.join(verb.names)}'"
        if verb.words:
            yield f"complete -c {_COMMAND} {seen} -a '{' '.join(verb.words)}'"
        for option in verb.options:
            forms = " ".join(
                f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
                for name in option.names
            )
            value = f" -xa '{' '.join(option.values)}'" if option.values else " -r"
            said = f"{forms}{value if option.takes else ''} -d {_quoted(option.about)}"
            yield f"complete -c {_COMMAND} {seen} {said}"


def _quoted(text: str) -> str:
    """Return a text as one word of a shell."""
    return "'" + text.replace("'", "'\\''") + "'"


_SCRIPTS = {"bash": _bash, "zsh": _zsh, "fish": _fish}
