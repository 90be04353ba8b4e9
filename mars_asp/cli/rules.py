"""List, show or check the rule base."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mars_asp.asp.rules.consistency import INCONSISTENT
from mars_asp.asp.rules.risks import risks
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import rulebook_for
from mars_asp.cli.report import report
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import project_facts
from mars_asp.reasoning.rules import STAGES, load_rulebook
from mars_asp.reasoning.sample import samples
from mars_asp.spelling import nearest


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("action", choices=("list", "show", "lint", "doc"))
    parser.add_argument("what", nargs="?", metavar="ID|PATH", help="a rule's id, or files to lint")


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked."""
    if arguments.action == "lint":
        packs = [*arguments.rules, *([arguments.what] if arguments.what else [])]
        found = lint([Path(path) for path in packs])
        report(found, arguments)
        if not found:
            print("nothing wrong")
        return 0
    if arguments.action == "show" and not arguments.what:
        print("mars-asp rules: `show` needs the ID of a rule; `list` names them", file=sys.stderr)
        return 2
    rulebook = rulebook_for(arguments)
    messages = [rule for rule in rulebook.rules if rule.because is not None]
    if arguments.action == "show":
        rule = _named(rulebook, arguments.what)
        print(encoded(_json(rule)) if arguments.format == "json" else _document(rule).rstrip("\n"))
    elif arguments.action == "doc":
        print("# Rules\n")
        for rule in messages:
            print(_document(rule))
    elif arguments.format == "json":
        print(encoded([_json(rule) for rule in messages]))
    else:
        for rule in messages:
            print(f"{rule.id:<32} {rule.span.path}:{rule.span.line}  {rule.because}")
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
    return (*risks(rulebook.rules), *tried.values())


def _of_sample(found: Diagnostic) -> Diagnostic:
    """Return what is said of a sample robot: what has no answer there may have one elsewhere."""
    if found.code != INCONSISTENT:
        return found
    message = found.message.replace("this configuration", "a sample robot")
    return replace(found, severity="warning", message=message)


def _named(rulebook: Rulebook, name: str) -> Rule:
    rule = rulebook.by_id.get(name)
    if rule is None:
        near = nearest(name, rulebook.by_id)
        hint = f"did you mean `{near}`?" if near else "`mars-asp rules list` names them all"
        where = point("rules", 1, 1)
        raise MarsError(
            (Diagnostic("rule", "error", f"there is no rule `{name}`", where, help=hint),)
        )
    return rule


def _document(rule: Rule) -> str:
    parts = [f"## {rule.id}\n", f"{rule.because or 'no message'}\n"]
    if rule.help:
        parts.append(f"Help: {rule.help}\n")
    parts.append(f"{rule.span.path}:{rule.span.line}\n")
    return "\n".join([*parts, f"```clingo\n{rule.text}\n```\n"])


def _json(rule: Rule) -> dict[str, object]:
    return {
        "id": rule.id,
        "because": rule.because,
        "help": rule.help,
        "path": rule.span.path,
        "line": rule.span.line,
        "text": rule.text,
    }
