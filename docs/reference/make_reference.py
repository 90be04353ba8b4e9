"""Write the pages that are made: `python -m docs.reference.make_reference FOLDER`.

They describe the commands, findings, lints and rules, and list the decisions. `make site` writes
them beside a copy of the committed pages, to which they link; none of them is committed.
"""

import argparse
import inspect
import io
import re
import sys
import textwrap
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import chdir, redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path

import mars_asp
from mars_asp.asp.lint.catalogue import PAGES, page_text
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli import run_here
from mars_asp.cli.arguments import VERBS, help_texts, parser_of
from mars_asp.cli.rules_document import PURPOSES, documents, open_predicates, safe, with_names
from mars_asp.reasoning.rules import STAGES, load_rulebook

ROOT = Path(__file__).parents[2]
MADE = "<!-- Made by `make site`; edit the parsers, the rules or the decisions instead. -->\n"
#: Files and packages that a user writes, by the kind of finding that each shows.
EXAMPLES = {path.stem: path for path in sorted((ROOT / "docs/reference/findings").iterdir())}
#: The languages of their files.
LANGUAGES = {
    ".mars": "text",
    ".launch": "xml",
    ".py": "python",
    ".xml": "xml",
    ".yaml": "yaml",
}
#: The public names of Python to begin with.
FIRST = ("load", "loads", "Robot", "Finding")
#: Stages whose rules are sentences alone.
TEMPLATES = ("account", "absence")
#: A number, the title and the day of a decision, and its topic.
DECISION = re.compile(r"# (\d{4}): (.+)\n\nDecided on ([\d-]+), about \[.*?\]\((.+?)\)")
#: A smaller decision: its title, and the day at its end.
SMALLER = re.compile(r"(?m)^- \*\*(.+?)\*\*(?:.|\n(?!- ))*?\((20\d\d-\d\d-\d\d)\)$")
#: A consequence at the head of a rule: its kind and its severity.
HEAD = re.compile(r"^consequence\((\w+), *(\w+),")
#: The place of a rule, or the path of a file, in a line of its own.
PLACE = re.compile(r"(?m)^(([\w./-]+\.lp)(?::\d+)?)$")
#: The heading of a rule.
NAME = re.compile(r"(?m)^(###) (\S+)$")
PACKS = tuple(sorted(path.parent for path in ROOT.glob("examples/packs/*/pack.toml")))
FACT = re.compile(r"(?m)^(?![%#]).+\.$")


def pages() -> Mapping[str, Callable[[], str]]:
    """Return functions that make the text of each page, by its path."""
    stages = [stage for stage in PURPOSES if stage not in TEMPLATES]
    made: dict[str, Callable[[], Iterator[str]]] = {
        "reference/commands.md": _commands,
        "reference/findings.md": _findings,
        "reference/python.md": _python,
        "reference/lints.md": _lints,
        "reference/rules/README.md": _contents,
        "reference/rules/predicates.md": _predicates,
        **{f"reference/rules/{stage}.md": partial(_stage, stage) for stage in stages},
        **{f"reference/rules/pack-{pack.name}.md": partial(_pack, pack) for pack in PACKS},
        "decisions/README.md": _decisions,
    }
    return {f"docs/{name}": partial(_text, yields) for name, yields in made.items()}


def _text(yields: Callable[[], Iterator[str]]) -> str:
    return MADE + "\n".join(yields())


def _commands() -> Iterator[str]:
    yield "# Commands and their options\n"
    yield "`mars-asp COMMAND ...`; each command also prints this as `mars-asp COMMAND --help`.\n"
    for name in VERBS:
        _, parser = parser_of(name)
        parser.fill_help(name, "shared")
        yield f"## {name}\n"
        yield f"`mars-asp {name}`: {help_texts()[name]['summary']}.\n"
        yield f"Example: `mars-asp {help_texts()[name]['example']}`.\n"
        yield "| argument | meaning |"
        yield "|---|---|"
        for action in parser._actions:
            if action.help != argparse.SUPPRESS and action.dest not in ("help", "version"):
                yield f"| {_written(action)} | {_cell(_meaning(action))} |"
        yield ""


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


def _python() -> Iterator[str]:
    yield "# Python\n"
    yield "The public names of `mars_asp`, with their docstrings; begin with `load`.\n"
    yield "[Use mars-asp from Python](../../examples/api/README.md) shows them together.\n"
    for name in [*FIRST, *sorted(set(mars_asp.__all__) - {*FIRST}, key=str.lower)]:
        value = getattr(mars_asp, name)
        if not inspect.isclass(value) and not inspect.isfunction(value):
            continue
        yield from _documented(name, value, "##")
        for inner, member in vars(value).items() if inspect.isclass(value) else ():
            is_method = inspect.isfunction(member)
            held = member.fget if isinstance(member, property) else getattr(member, "func", None)
            function = member if is_method else held
            if not inner.startswith("_") and function is not None:
                yield from _documented(f"{name}.{inner}", function, "###", not is_method)


def _documented(
    name: str, value: Callable[..., object], heading: str, is_property: bool = False
) -> Iterator[str]:
    """Yield the heading, signature and docstring of a function, class, method or property."""
    yield f"{heading} {name}\n"
    if not is_property:
        shown = str(inspect.signature(value)).replace("self, ", "").replace("(self)", "()")
        parts = [f"{name}{shown}"] if len(shown) < 80 else [f"{name}(", *_parameters(value), ")"]
        yield "\n".join(["```python", *parts, "```\n"])
    yield f"```text\n{inspect.getdoc(value)}\n```\n"


def _parameters(value: Callable[..., object]) -> Iterator[str]:
    for parameter in inspect.signature(value).parameters.values():
        if parameter.name != "self":
            yield f"    {parameter},"


def _findings() -> Iterator[str]:
    yield "# Findings\n"
    yield "What `analyse`, `check`, `verify` and `run` report, by kind, with the rules that find"
    yield "it."
    yield "`mars-asp rules show KIND` prints the same in a terminal."
    yield "The example of a kind is a file that a user writes, with what the command reports."
    yield "Below each rule are the facts of a case that fires it, and of the most similar case in"
    yield "which no rule finds this kind; the suite runs both.\n"
    rulebook = load_rulebook(stages=STAGES).built_in
    kinds: dict[str, list[tuple[str, Rule]]] = {}
    for rule in rulebook.rules:
        if rule.because is not None and (head := HEAD.match(rule.text)):
            kinds.setdefault(head[1], []).append((head[2], rule))
    for kind in sorted(kinds):
        yield f"## {kind}\n"
        if kind in EXAMPLES:
            yield from _files(EXAMPLES[kind])
            yield from _report(kind, EXAMPLES[kind])
        else:
            yield "Reported of a run: [Judge a run](../how-to/judge-a-run.md) has an example.\n"
        for severity, rule in kinds[kind]:
            yield f"### {rule.id} ({'as it is weighed' if severity == 'W' else severity})\n"
            yield f"{with_names(rule.because)}\n"
            if rule.help:
                yield f"Help: {with_names(rule.help)}\n"
            if rule.why:
                yield f"{rule.why}\n"
            yield f"Defined in [{rule.span.path}](../../{rule.span.path}).\n"
            if rule.example:
                fires = ROOT / rule.example
                yield from _case("Facts that fire it", fires)
                if (silent := _silent(kind, fires)) is not None:
                    yield from _case("Facts that do not", silent)


def _files(example: Path) -> Iterator[str]:
    """Yield the files of an example, but for the manifest of its package."""
    for path in sorted(example.rglob("*")) if example.is_dir() else [example]:
        if path.is_file() and path.name != "package.xml" and path.suffix in LANGUAGES:
            shown = path.relative_to(ROOT / "docs/reference").as_posix()
            text = path.read_text(encoding="utf-8")
            yield f"[{shown.removeprefix('findings/')}]({shown}):\n"
            yield f"```{LANGUAGES[path.suffix]}\n{text}```\n"


def _report(kind: str, example: Path) -> Iterator[str]:
    """Yield what `analyse` reports of a kind in an example."""
    words = ["analyse", example.relative_to(ROOT).as_posix(), "--select", kind, "--quiet"]
    output = io.StringIO()
    with chdir(ROOT), redirect_stdout(output), redirect_stderr(output):
        run_here(words)
    yield f"```console\n$ mars-asp {' '.join(words)}\n{output.getvalue()}```\n"


def _lints() -> Iterator[str]:
    yield "# Lints\n"
    yield "What `mars-asp rules lint` reports of rules that an analysis would take. A line"
    yield "`%! allow: CODE REASON` above a rule switches a lint off for that rule. Each example"
    yield "is a whole file, which the tests lint; sorts such as `city` are its own.\n"
    for page in PAGES:
        yield f"{page_text(page)}\n"


def _contents() -> Iterator[str]:
    yield "# Rules\n"
    yield "Every rule with a message, by the stage in which it is read: the message, why, and the"
    yield "text. `mars-asp rules doc` prints the same, `mars-asp rules show ID` one rule with its"
    yield "example and its trace. [The rules](../../../rules/README.md) explains the stages.\n"
    yield "## Our own rules\n"
    for stage, purpose in PURPOSES.items():
        yield f"- {stage if stage in TEMPLATES else f'[{stage}]({stage}.md)'}: {purpose}"
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


def _decisions() -> Iterator[str]:
    yield "# Decisions\n"
    yield "Where the paper leaves something open, or where there was a choice, a page records the"
    yield "decision, its reasons, its alternatives and its consequences."
    yield "Smaller ones are on the page of their topic."
    yield "The day is that on which a decision was last weighed.\n"
    folder = ROOT / "docs/decisions"
    found: dict[str, list[str]] = {}
    for path in sorted(folder.glob("[0-9]*.md")):
        match = DECISION.match(path.read_text(encoding="utf-8"))
        assert match, path
        listed = found.setdefault(match[4], [])
        listed.append(f"- [{match[2]}]({path.name}), {match[3]}")
    topics = {path.name for path in folder.glob("[a-z]*.md")}
    for name in sorted(topics | found.keys()):
        text = (folder / name).read_text(encoding="utf-8")
        yield f"## {text.partition(chr(10))[0].removeprefix('# ')}\n"
        yield from found.get(name, [])
        for title, day in SMALLER.findall(text) if name in topics else []:
            yield f"- [{' '.join(title.rstrip('.,:').split())}]({name}), {day}"
        yield ""


def _case(heading: str, case: Path) -> Iterator[str]:
    """Yield the facts of a case, folded."""
    title, _, _ = case.read_text(encoding="utf-8").partition("\n")
    shown = case.relative_to(ROOT).as_posix()
    yield '<details markdown="1">'
    yield f"<summary>{heading}: {title.removeprefix('% ')} ({shown})</summary>\n"
    yield "```prolog"
    yield from sorted(_facts(case))
    yield "```\n\n</details>\n"


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


def write(folder: Path) -> None:
    """Write all pages below a folder."""
    for name, text in pages().items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
