"""Write the pages of `docs/reference` from parsers and rules: `python -m docs.reference.make_reference`."""

import argparse
import re
import textwrap
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import chdir, suppress
from functools import partial
from pathlib import Path
from unittest.mock import patch

from mars_asp.asp.lint.catalogue import PAGES
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli import run_here
from mars_asp.cli.arguments import VERBS
from mars_asp.cli.rules_document import PURPOSES, documents, open_predicates, safe
from mars_asp.reasoning.rules import STAGES, load_rulebook

ROOT = Path(__file__).parents[1]
MADE = "<!-- Made by `python -m docs.reference.make_reference`; edit the parsers and the rules instead. -->\n"
#: A consequence at the head of a rule: its kind and its severity.
HEAD = re.compile(r"^consequence\((\w+), *(\w+),")
#: The place of a rule, or the path of a file, in a line of its own.
PLACE = re.compile(r"(?m)^(([\w./-]+\.lp)(?::\d+)?)$")
#: The heading of a rule.
NAME = re.compile(r"(?m)^(###) (\S+)$")
PACKS = tuple(sorted(path.parent for path in ROOT.glob("examples/packs/*/pack.toml")))
FACT = re.compile(r"(?m)^(?![%#]).+\.$")


def pages() -> Mapping[str, Callable[[], str]]:
    """Return by the name of each page what makes its text."""
    made: dict[str, Callable[[], Iterator[str]]] = {
        "verbs.md": _verbs,
        "findings.md": _findings,
        "lints.md": _lints,
        "rules/README.md": _contents,
        "rules/predicates.md": _predicates,
        **{f"rules/{stage}.md": partial(_stage, stage) for stage in PURPOSES},
        **{f"rules/pack-{pack.name}.md": partial(_pack, pack) for pack in PACKS},
    }
    return {name: partial(_text, yields) for name, yields in made.items()}


def _text(yields: Callable[[], Iterator[str]]) -> str:
    return MADE + "\n".join(yields())


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


def _contents() -> Iterator[str]:
    yield "# Rules\n"
    yield "Every rule with a message, by the stage in which it is read: the message, why, and the"
    yield "text. `mars-asp rules doc` prints the same, `mars-asp rules show ID` one rule with its"
    yield "example and its trace. [The rules](../../../rules/README.md) explains the stages.\n"
    yield "## Our own rules\n"
    for stage, purpose in PURPOSES.items():
        yield f"- [{stage}]({stage}.md): {purpose}"
    yield "\n## Packs\n"
    yield "The packs of [examples/packs](../../../examples/packs/README.md):\n"
    for pack in PACKS:
        yield f"- [{pack.name}](pack-{pack.name}.md): {_summary(pack)}"
    yield ""


def _predicates() -> Iterator[str]:
    yield "# Predicates that packs may read or derive\n"
    yield "`mars-asp rules list --predicates` lists them with those of packs that are given, and"
    yield "`mars-asp rules show NAME` prints one. Rules of a folder"
    yield "read those of its own stage, and of `base`.\n"
    rulebook = load_rulebook(stages=STAGES)
    for stage, purpose in PURPOSES.items():
        listed = open_predicates(rulebook, stage)
        if not listed:
            continue
        yield f"## {stage}: {purpose}\n\n```text"
        for each in listed:
            yield f"{each.written}{'  (packs derive it)' if each.extensible else ''}"
            yield textwrap.fill(
                " ".join(each.words.split()), 112, initial_indent="    ", subsequent_indent="    "
            )
        yield "```\n"


def _stage(stage: str) -> Iterator[str]:
    yield f"# Rules: {stage}\n"
    yield f"`mars-asp rules doc --stage {stage}` prints this page: {PURPOSES[stage]}.\n"
    yield from _rules(load_rulebook(stages=STAGES), (stage,))


def _pack(pack: Path) -> Iterator[str]:
    shown = pack.relative_to(ROOT).as_posix()
    yield f"# Pack: {pack.name}\n"
    yield f"{_summary(pack)}. `mars-asp rules doc {shown}` prints this page."
    yield f"[How the pack is used](../../../{shown}/README.md) has examples.\n"
    with chdir(ROOT):
        rulebook = load_rulebook([Path(shown)], STAGES)
    yield from _rules(rulebook, PURPOSES, shown)


def _rules(rulebook: Rulebook, stages: Iterable[str], pack: str | None = None) -> Iterator[str]:
    """Yield what `rules doc` prints, with links to the files."""
    for page in documents(rulebook, stages, pack):
        yield NAME.sub(r"\1 `\2`", PLACE.sub(r"[\1](../../../\2)", safe(page)))


def _summary(pack: Path) -> str:
    return str(tomllib.loads((pack / "pack.toml").read_text(encoding="utf-8"))["summary"]).rstrip(
        "."
    )


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
    (folder / "rules").mkdir(parents=True, exist_ok=True)
    for name, text in pages().items():
        (folder / name).write_text(text(), encoding="utf-8")
