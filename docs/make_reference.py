"""Write the pages of `docs/reference` from parsers and rules: `python -m docs.make_reference`."""

import argparse
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

from mars_asp.asp.lint.catalogue import PAGES
from mars_asp.asp.rules.rule import Rule
from mars_asp.cli import run_here
from mars_asp.cli.arguments import VERBS
from mars_asp.reasoning.rules import STAGES, load_rulebook

ROOT = Path(__file__).parents[1]
MADE = "<!-- Made by `python -m docs.make_reference`; edit the parsers and the rules instead. -->\n"
#: A consequence at the head of a rule: its kind and its severity.
HEAD = re.compile(r"^consequence\((\w+), *(\w+),")
FACT = re.compile(r"(?m)^(?![%#]).+\.$")


def pages() -> Iterator[tuple[str, str]]:
    """Yield the name of each page and its text."""
    yield "verbs.md", MADE + "\n".join(_verbs())
    yield "findings.md", MADE + "\n".join(_findings())
    yield "lints.md", MADE + "\n".join(_lints())


def _verbs() -> Iterator[str]:
    yield "# Verbs and their options\n"
    yield "`mars-asp VERB ...`; each verb also prints this as `mars-asp VERB --help`.\n"
    for name, verb in VERBS.items():
        yield f"## {name}\n"
        yield f"`mars-asp {name}`: {verb.summary}.\n"
        yield f"Example: `mars-asp {verb.example}`.\n"
        yield "| argument | meaning |"
        yield "|---|---|"
        for action in _parser(name)._actions:
            if action.help != argparse.SUPPRESS and action.dest not in ("help", "version"):
                yield f"| {_written(action)} | {_cell(_meaning(action))} |"
        yield ""


def _parser(verb: str) -> argparse.ArgumentParser:
    """Return the parser of a verb, as it is when it prints its help."""
    found: list[argparse.ArgumentParser] = []
    with (
        patch.object(
            argparse.ArgumentParser, "print_help", lambda parser, *_: found.append(parser)
        ),
        suppress(SystemExit),
    ):
        run_here([verb, "--help"])
    return found[0]


def _written(action: argparse.Action) -> str:
    choices = "|".join(map(str, action.choices or ()))
    value = action.metavar or choices or action.dest.upper()
    value = value if isinstance(value, str) else " ".join(value)
    if not action.option_strings:
        return f"`{value}`".replace("|", "\\|")
    named = ", ".join(action.option_strings)
    return f"`{named}{'' if action.nargs == 0 else f' {value}'}`".replace("|", "\\|")


def _meaning(action: argparse.Action) -> str:
    told = (action.help or "") % {**vars(action), "prog": "mars-asp"}
    default = None if action.default == argparse.SUPPRESS else action.default
    if action.option_strings and isinstance(default, str | int) and not isinstance(default, bool):
        told += f"{' ' * bool(told)}(default: `{default}`)"
    return told


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _findings() -> Iterator[str]:
    yield "# Findings\n"
    yield "What `analyse`, `check`, `verify` and `run` report, by kind, with the rule that finds"
    yield "it. The example fires the rule; the counterexample is the most similar case in which no"
    yield "rule finds this kind. Both are facts of `tests/rules`, which the suite runs. Words in"
    yield "braces are filled in.\n"
    rulebook = load_rulebook(stages=STAGES).built_in
    kinds: dict[str, list[tuple[str, Rule]]] = {}
    for rule in rulebook.rules:
        if rule.because is not None and (head := HEAD.match(rule.text)):
            kinds.setdefault(head[1], []).append((head[2], rule))
    for kind in sorted(kinds):
        yield f"## {kind}\n"
        for severity, rule in kinds[kind]:
            yield f"### {rule.id} ({severity})\n"
            yield f"{rule.because}\n"
            if rule.help:
                yield f"Help: {rule.help}\n"
            if rule.why:
                yield f"{rule.why}\n"
            yield f"Defined in [{rule.span.path}](../../{rule.span.path}).\n"
            if rule.example:
                fires = ROOT / rule.example
                yield from _example("Example", fires)
                if (silent := _silent(kind, fires)) is not None:
                    yield from _example("Counterexample", silent)


def _lints() -> Iterator[str]:
    yield "# Lints\n"
    yield "What `mars-asp rules lint` reports of rules that an analysis would take. A line"
    yield "`%! allow: CODE REASON` above a rule switches a lint off for that rule. Each example"
    yield "is a whole file, which the tests lint; sorts such as `city` are its own.\n"
    for page in PAGES:
        yield f"## {page.code}\n"
        yield f"**{page.title}.** {page.what}\n"
        yield f"Why: {page.why}\n"
        if page.fixed:
            yield f"`--fix` writes {page.fixed}.\n"
        yield f"Reported:\n\n```clingo\n{page.bad}```\n"
        yield f"Not reported:\n\n```clingo\n{page.good}```\n"


def _example(heading: str, case: Path) -> Iterator[str]:
    title, _, _ = case.read_text(encoding="utf-8").partition("\n")
    yield f"{heading} ({case.relative_to(ROOT).as_posix()}): {title.removeprefix('% ')}\n"
    yield "```prolog"
    yield from sorted(_facts(case))
    yield "```\n"


def _facts(case: Path) -> set[str]:
    return set(FACT.findall(case.read_text(encoding="utf-8")))


def _silent(kind: str, fires: Path) -> Path | None:
    """Return the case beside one that differs from it in fewest facts and lacks the finding."""
    own = _facts(fires)
    others = [
        case
        for case in sorted(fires.parent.glob("*.lp"))
        if f"consequence({kind}," not in case.read_text(encoding="utf-8")
    ]
    return min(others, key=lambda case: (len(own ^ _facts(case)), case.name), default=None)


if __name__ == "__main__":
    folder = ROOT / "docs" / "reference"
    folder.mkdir(exist_ok=True)
    for name, text in pages():
        (folder / name).write_text(text, encoding="utf-8")
