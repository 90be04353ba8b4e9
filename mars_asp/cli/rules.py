"""List, show or check the rules of every stage."""

import argparse
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from mars_asp.asp.rules.consistency import INCONSISTENT
from mars_asp.asp.rules.declarations import Declaration, declarations, wrong_references
from mars_asp.asp.rules.metadata import file_name
from mars_asp.asp.rules.names import shared_names
from mars_asp.asp.rules.outline import Outline
from mars_asp.asp.rules.risks import risks
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.sorts import wrong_sorts
from mars_asp.asp.signature import Signature, plain
from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import rulebook_for
from mars_asp.cli.report import report
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.output import visible
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.vocabulary import unbounded
from mars_asp.reasoning.findings import EXPANSIONS
from mars_asp.reasoning.project import project_facts
from mars_asp.reasoning.rules import BASE, STAGES, load_rulebook
from mars_asp.reasoning.sample import samples
from mars_asp.spelling import nearest

_PURPOSES = {"base": BASE, **STAGES}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("action", choices=("list", "show", "lint", "doc"))
    parser.add_argument(
        "what",
        nargs="?",
        metavar="ID|PREDICATE|PATH",
        help="of `show`: a rule's id, a predicate or a file of rules; of `lint`: files to check",
    )
    parser.add_argument(
        "--stage",
        metavar="STAGE",
        choices=tuple(_PURPOSES),
        help=f"list or document the rules of one stage alone: {', '.join(_PURPOSES)}",
    )


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked."""
    action, what = arguments.action, arguments.what
    wrong = _misused(action, what, arguments.stage)
    if wrong:
        print(f"mars-asp rules: {wrong}", file=sys.stderr)
        return 2
    if action == "lint":
        packs = [*arguments.rules, *([what] if what else [])]
        found = lint([Path(path) for path in packs])
        report(found, arguments)
        if not found:
            print("nothing wrong")
        return 0
    rulebook = rulebook_for(arguments, STAGES)
    as_json = arguments.format == "json"
    stages = (arguments.stage,) if arguments.stage else tuple(_PURPOSES)
    if action == "show":
        print(encoded(shown_json(rulebook, what)) if as_json else _safe(shown(rulebook, what)))
    elif action == "doc":
        print("# Rules\n")
        print(_safe("\n".join(_documents(rulebook, stages))))
    elif as_json:
        found_rules = (rule for stage in stages for rule in _speaking(rulebook, stage))
        print(encoded([_rule_json(rule) for rule in found_rules]))
    else:
        print("\n\n".join(_listed(rulebook, stage) for stage in stages))
    return 0


def lint(packs: Sequence[Path]) -> tuple[Diagnostic, ...]:
    """Return what is noteworthy about rule packs that an analysis would take.

    They are grounded over sample robots, so that what fails while grounding is told, too.

    Raises:
        MarsError: what an analysis would refuse, with its places.
    """
    rulebook = load_rulebook(packs, STAGES, strict=not packs)
    tried: dict[tuple[str, Span], Diagnostic] = {}
    for project in samples() if rulebook.packs else ():
        try:
            analyse(project_facts(project), rulebook, project.configuration.span)
        except MarsError as error:
            for each in map(_of_sample, error.diagnostics):
                tried.setdefault((each.code, each.span), each)
    wrong = [each for each in tried.values() if each.severity == "error"]
    if wrong:
        raise MarsError(wrong)
    misread: list[Diagnostic] = []
    for file in rulebook.documented:
        tuple(declarations(file.docstrings, file.path, misread))
    misread += wrong_references(rulebook.declarations.values())
    large = unbounded(rulebook.declarations.values())
    return (
        *(replace(each, severity="warning") for each in misread),
        *wrong_sorts(rulebook.rules, rulebook.declarations, rulebook.replaced),
        *risks(rulebook.rules, large),
        *shared_names(rulebook),
        *tried.values(),
    )


def shown(rulebook: Rulebook, name: str) -> str:
    """Return what there is to say of the rule of an id, a predicate, or a file of rules.

    Raises:
        MarsError: there is none of these.
    """
    found = _named(rulebook, name)
    if isinstance(found, Rule):
        return _document(found, "##")
    if isinstance(found, tuple):
        return "\n\n".join(map(_predicate_document, found))
    stage, outline = rulebook.outlines[found]
    rules = [rule for rule in _speaking(rulebook, stage) if rule.span.path == found]
    listed = "\n".join(f"- `{rule.id}`: {rule.because}" for rule in rules)
    return "\n\n".join(filter(None, (_file_document(found, stage, outline), listed)))


def shown_json(rulebook: Rulebook, name: str) -> dict[str, object]:
    """Return what `shown` tells, for programs.

    Raises:
        MarsError: there is no such rule, predicate or file.
    """
    found = _named(rulebook, name)
    if isinstance(found, Rule):
        return _rule_json(found)
    if isinstance(found, tuple):
        return {"predicates": list(map(_predicate_json, found))}
    stage, outline = rulebook.outlines[found]
    return {
        "path": found,
        "stage": stage,
        "title": outline.title,
        "purpose": outline.purpose,
        **{name: list(map(str, predicates)) for name, predicates in _predicates(outline)},
        "rules": [rule.id for rule in rulebook.rules if rule.span.path == found],
    }


def _misused(action: str, what: str | None, stage: str | None) -> str | None:
    """Return what is wrong with a call, if anything is."""
    if action == "show" and not what:
        return "`show` needs the ID of a rule, a predicate or a file; `list` names rules"
    if stage and action in ("show", "lint"):
        return f"--stage has no effect on `{action}`"
    return None


def _of_sample(found: Diagnostic) -> Diagnostic:
    """Return what is said of a sample robot: what has no answer there may have one elsewhere."""
    if found.code != INCONSISTENT:
        return found
    message = found.message.replace("this configuration", "a sample robot")
    return replace(found, severity="warning", message=message)


def _named(rulebook: Rulebook, name: str) -> Rule | tuple[Declaration, ...] | str:
    """Return the rule of an id, predicates, or the path of a file.

    A file is named by its path or by what its ids begin with, predicates by their name, with or
    without the number of arguments.
    """
    rule = rulebook.by_id.get(name)
    if rule is not None:
        return rule
    files = {file_name(path, stage): path for path, (stage, _) in rulebook.outlines.items()}
    if name in rulebook.outlines:
        return name
    if name in files:
        return files[name]
    declared = rulebook.declarations
    predicates = tuple(each for at, each in declared.items() if name in (at.name, str(at)))
    if predicates:
        return predicates
    near = _near(name, (*rulebook.by_id, *files, *(each.name for each in declared)))
    hint = f"did you mean `{near}`?" if near else "`mars-asp rules list` names them all"
    where = point("rules", 1, 1)
    message = f"there is no rule or predicate `{name}`"
    raise MarsError((Diagnostic("rule", "error", message, where, help=hint),))


def _near(name: str, known: Collection[str]) -> str | None:
    """Return the id that is meant by one that leaves out the stage, or is misspelt."""
    behind = (each for each in known if each.endswith(f"/{name}"))
    return next(behind, None) or nearest(name, known)


def _speaking(rulebook: Rulebook, stage: str) -> Iterator[Rule]:
    return (rule for rule in rulebook.rules if rule.stage == stage and rule.because is not None)


def _listed(rulebook: Rulebook, stage: str) -> str:
    rules = tuple(_speaking(rulebook, stage))
    width = max((len(rule.id) for rule in rules), default=0)
    lines = [
        visible(f"{rule.id:<{width}}  {rule.span.path}:{rule.span.line}  {rule.because}")
        for rule in rules
    ]
    return "\n".join([f"{stage}: {_PURPOSES[stage]}", *lines])


def _documents(rulebook: Rulebook, stages: Iterable[str]) -> Iterator[str]:
    for stage in stages:
        for path, (at, outline) in rulebook.outlines.items():
            if at == stage:
                yield f"{_file_document(path, stage, outline)}\n"
                of_file = (r for r in _speaking(rulebook, stage) if r.span.path == path)
                yield from (f"{_document(rule, '###')}\n" for rule in of_file)


def _file_document(path: str, stage: str, outline: Outline) -> str:
    parts = [f"## {file_name(path, stage)}", outline.title, path]
    lines = [f"Purpose: {outline.purpose}"] if outline.purpose else []
    for name, predicates in _predicates(outline):
        if predicates:
            lines.append(f"{name.capitalize()}: {', '.join(f'`{p}`' for p in predicates)}")
    return "\n\n".join(filter(None, [*parts, *lines]))


def _predicates(outline: Outline) -> Iterator[tuple[str, tuple[Signature, ...]]]:
    yield "given", outline.given
    yield "derives", outline.derives
    yield "decides", outline.decides
    yield "shows", outline.shows


def _safe(text: str) -> str:
    """Return what packs wrote with control characters escaped, but for tabs and line feeds."""
    lines = (map(visible, line.split("\t")) for line in text.split("\n"))
    return "\n".join(map("\t".join, lines))


def _document(rule: Rule, heading: str) -> str:
    parts = [f"{heading} {rule.id}", rule.because or "no message"]
    if rule.effect:
        parts.append(f"Effect: {rule.effect}")
    if rule.help:
        parts.append(f"Help: {rule.help}")
    if rule.why:
        parts.append(f"Why: {rule.why}")
    parts += [f"{key.capitalize()}: `{listed}`" for key, listed in rule.lists]
    if rule.example:
        parts.append(f"Example: {rule.example}")
    parts.append(f"{rule.span.path}:{rule.span.line}")
    return "\n\n".join([*parts, f"```clingo\n{plain(rule.text)}\n```"])


def _predicate_document(declaration: Declaration) -> str:
    sentences = {"says": declaration.says, "unless": declaration.unless}
    said = [f"{key}: {sentence}" for key, each in sentences.items() for sentence in each]
    said += [f"from: {declaration.origin}"] if declaration.origin else []
    said += ["packs: extend"] if declaration.extensible else []
    said += ["packs: read"] if declaration.public else []
    said += [] if declaration.joins else ["joins: nothing"]
    said += [] if declaration.cited else ["cited: never"]
    said += [] if declaration.ordering is None else [f"orders: {declaration.ordering}"]
    place = f"{declaration.span.path}:{declaration.span.line}"
    parts = (f"## {declaration.written}", declaration.words, "\n".join(said), place)
    return "\n\n".join(filter(None, parts))


def _predicate_json(declaration: Declaration) -> dict[str, object]:
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
        "from": declaration.origin,
        "packs": "extend" if declaration.extensible else "read",
        "path": declaration.span.path,
        "line": declaration.span.line,
    }


def _rule_json(rule: Rule) -> dict[str, object]:
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
