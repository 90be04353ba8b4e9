"""Rules, predicates and files of rules as pages of `rules show` and `rules doc`."""

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from urllib.parse import quote

from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.metadata import file_name
from mars_asp.asp.rules.outline import Outline
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, plain
from mars_asp.cli.deliver import write_file
from mars_asp.cli.rules_example import RuleExample
from mars_asp.output import counted, fenced, markdown, visible
from mars_asp.reasoning.findings import EXPANSIONS
from mars_asp.reasoning.packs import FOLDERS
from mars_asp.reasoning.rules import BASE, STAGES, seal

#: The purpose of the rules of each stage.
PURPOSES: Mapping[str, str] = {"base": BASE, **STAGES}

#: A hole that fills a whole piece of code.
_CODED = re.compile(r"`\{([^{}:@]*)[^{}]*\}`")
#: A hole of a message, with its sort.
_HOLE = re.compile(r"\{([^{}:@]*)[^{}]*\}")


def speaking(rulebook: Rulebook, stage: str) -> Iterator[Rule]:
    """Yield the rules of a stage that have a message."""
    return (rule for rule in rulebook.rules if rule.stage == stage and rule.because is not None)


def documents(rulebook: Rulebook, stages: Iterable[str], pack: str | None = None) -> Iterator[str]:
    """Yield the page of each file of some stages; only those in the folder `pack` if not None."""
    for stage in stages:
        for path, (at, outline) in rulebook.outlines.items():
            if at == stage and _is_of(path, pack):
                yield _page(rulebook, path, stage, outline)


def _page(rulebook: Rulebook, path: str, stage: str, outline: Outline) -> str:
    of_file = (rule for rule in speaking(rulebook, stage) if rule.span.path == path)
    rules = (f"{rule_document(rule, '###')}\n" for rule in of_file)
    return "\n".join([f"{file_document(path, stage, outline)}\n", *rules])


def _is_of(path: str, pack: str | None) -> bool:
    """Whether a file of rules is documented: in the folder `pack`, or any file without one."""
    return pack is None or (path.endswith(".lp") and Path(path).is_relative_to(pack))


def write_pages(rulebook: Rulebook, stages: Iterable[str], pack: str | None, folder: str) -> str:
    """Write a page for each file of rules into a folder, and an index; return a report."""
    listed, written = ["# Rules", ""], 1
    Path(folder).mkdir(parents=True, exist_ok=True)
    for stage in stages:
        named = ((path, of) for path, (at, of) in rulebook.outlines.items() if at == stage)
        files = [(path, of) for path, of in named if _is_of(path, pack)]
        listed += [f"## {stage}", "", f"{PURPOSES[stage]}.", ""] if files else []
        for path, outline in files:
            name = f"{file_name(path, stage).replace('/', '-')}.md"
            title = markdown(visible(outline.title))
            listed.append(f"- [{markdown(file_name(path, stage))}]({quote(name)}): {title}")
            page = _page(rulebook, path, stage, outline)
            write_file(str(Path(folder) / name), safe(page.replace("## ", "# ", 1)))
            written += 1
        listed += [""] if files else []
    write_file(str(Path(folder) / "index.md"), "\n".join(listed))
    index = visible(str(Path(folder) / "index.md"))
    return f"wrote {counted(written, 'page')}, {index} and those that it lists"


def file_document(path: str, stage: str, outline: Outline) -> str:
    """Return Markdown on a file of rules: name, purpose, and the predicates it reads and gives."""
    parts = [f"## {markdown(file_name(path, stage))}", markdown(outline.title), markdown(path)]
    lines = [f"Purpose: {markdown(outline.purpose)}"] if outline.purpose else []
    for name, predicates in predicates_of(outline):
        if predicates:
            lines.append(f"{name.capitalize()}: {', '.join(f'`{p}`' for p in predicates)}")
    return "\n\n".join(filter(None, [*parts, *lines]))


def predicates_of(outline: Outline) -> Iterator[tuple[str, tuple[Signature, ...]]]:
    """Yield each way in which a file uses predicates, with these predicates."""
    yield "given", outline.given
    yield "derives", outline.derives
    yield "decides", outline.decides
    yield "shows", outline.shows


def safe(text: str) -> str:
    """Return a text of packs with control characters escaped, except tabs and line feeds."""
    lines = (map(visible, line.split("\t")) for line in text.split("\n"))
    return "\n".join(map("\t".join, lines))


def rule_document(rule: Rule, heading: str) -> str:
    """Return the document of a rule, below a heading such as `##`."""
    parts = [f"{heading} {markdown(rule.id)}", markdown(rule.because or "no message")]
    if rule.effect:
        parts.append(f"Effect: {markdown(rule.effect)}")
    if rule.help:
        parts.append(f"Help: {markdown(rule.help)}")
    if rule.why:
        parts.append(f"Why: {markdown(rule.why)}")
    parts += [f"{key.capitalize()}: {markdown(f'`{listed}`')}" for key, listed in rule.lists]
    if rule.example:
        parts.append(f"Example: {markdown(rule.example)}")
    parts.append(markdown(f"{rule.span.path}:{rule.span.line}"))
    return "\n\n".join([*parts, fenced(plain(rule.text), "clingo")])


def rule_source(rule: Rule, rulebook: Rulebook) -> str:
    """Return the lines of a rule in its file, with the comment above it, as a block of code."""
    texts = dict(zip(rulebook.paths, (text for _, text in rulebook.texts), strict=False))
    lines = plain(texts.get(rule.span.path, "")).split("\n")[: rule.span.line - 1]
    above = itertools.takewhile(lambda line: line.startswith("%"), reversed(lines))
    return fenced("\n".join([*reversed(list(above)), plain(rule.text)]), "clingo")


def with_names(text: str | None) -> str | None:
    """Return a text of a rule with variable names in its holes; None for None."""
    if text is None:
        return None
    # A hole at the end of a word, as of a plural, is removed.
    return _HOLE.sub("…", re.sub(rf"(?<=\w){_HOLE.pattern}", "", _CODED.sub(r"`\1`", text)))


def rule_summary(rule: Rule, heading: str, example: RuleExample | None) -> str:
    """Return the message, effect, help and reason of a rule, below a heading such as `##`.

    Their texts have the values of the example; without one, the names of variables.
    """
    texts = example or map(with_names, (rule.because, rule.effect, rule.help))
    because, effect, help_text, *_ = texts
    named = {"Effect": effect, "Help": help_text, "Why": rule.why}
    parts = [f"{label}: {markdown(text)}" for label, text in named.items() if text]
    place = markdown(f"{rule.span.path}:{rule.span.line}")
    because = markdown(because or "no message")
    return "\n\n".join([f"{heading} {markdown(rule.id)}", because, *parts, place])


def predicate_document(declaration: Declaration) -> str:
    """Return Markdown on a predicate: its declaration, sentences, keys and location."""
    sentences = {"says": declaration.says, "unless": declaration.unless}
    lines = [f"{key}: {markdown(each)}" for key, found in sentences.items() for each in found]
    origin = declaration.attribution or declaration.origin
    lines += [f"from: {origin}"] if origin else []
    lines += (f"key: {', '.join(key) or 'nothing'}" for key in declaration.named_keys)
    lines += [f"packs: {use}"] if (use := _use_by_packs(declaration)) else []
    lines += [] if declaration.joins else ["joins: nothing"]
    lines += [] if declaration.cited else ["cited: never"]
    lines += [] if declaration.ordering is None else [f"orders: {declaration.ordering}"]
    place = f"{declaration.span.path}:{declaration.span.line}"
    parts = (
        f"## {markdown(declaration.written)}",
        markdown(declaration.words),
        "\n".join(lines),
        markdown(place),
    )
    return "\n\n".join(filter(None, parts))


def _use_by_packs(declaration: Declaration) -> str | None:
    """Return the permission of packs for a predicate: `extend`, `read` or None."""
    if declaration.extensible:
        return "extend"
    is_open = declaration.public or declaration.signature.unsigned in _reserved()
    return "read" if is_open else None


@cache
def _reserved() -> frozenset[Signature]:
    return seal().reserved


def open_predicates(rulebook: Rulebook, stage: str) -> tuple[Declaration, ...]:
    """Return the predicates of a stage that rules of packs may read or derive."""
    return tuple(
        each
        for each in rulebook.declarations.values()
        if stage in FOLDERS.values()
        and _use_by_packs(each)
        and rulebook.outlines.get(each.span.path, ("",))[0] == stage
    )


def predicate_lines(rulebook: Rulebook, stage: str) -> Iterator[str]:
    """Yield one line for each predicate of a stage that packs may read or derive."""
    listed = open_predicates(rulebook, stage)
    width = max((len(str(each.signature)) for each in listed), default=0)
    for each in listed:
        words = " ".join(each.words.split()).partition(". ")[0].rstrip(".")
        yield f"{each.signature!s:<{width}}  {_use_by_packs(each):<6}  {words}"


def predicate_json(declaration: Declaration) -> dict[str, object]:
    """Return the declaration of a predicate with the keys of `rules show --format json`."""
    return {
        "predicate": str(declaration.signature),
        "arguments": [
            {"name": name, "sorts": sorted(sorts), "constants": list(constants)}
            for name, sorts, constants in declaration.arguments
        ],
        "words": declaration.words,
        "says": list(declaration.says),
        "unless": list(declaration.unless),
        "cited": declaration.cited,
        "orders": declaration.ordering,
        "keys": list(map(list, declaration.named_keys)),
        "from": declaration.origin,
        "attribute": declaration.attribution,
        "packs": _use_by_packs(declaration),
        "path": declaration.span.path,
        "line": declaration.span.line,
    }


def rule_json(rule: Rule) -> dict[str, object]:
    """Return the metadata, location and text of a rule with the keys of the contract."""
    return {
        "id": rule.id,
        "stage": rule.stage,
        "because": rule.because,
        "help": rule.help,
        "effect": rule.effect,
        "why": rule.why,
        "example": rule.example,
        **{key: dict(rule.lists).get(key) for key in EXPANSIONS},
        "path": rule.span.path,
        "line": rule.span.line,
        "text": plain(rule.text),
    }
