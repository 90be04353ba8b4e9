"""List, show or check the rule base."""

import argparse
import sys
from pathlib import Path

from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import rulebook_for
from mars_asp.cli.report import report
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.risks import risks
from mars_asp.rule_cases import STAGES
from mars_asp.rulebook import Rule, Rulebook, load_rulebook
from mars_asp.source import point
from mars_asp.spelling import nearest


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("action", choices=("list", "show", "lint", "doc"))
    parser.add_argument("what", nargs="?", metavar="ID|PATH", help="a rule's id, or files to lint")


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked."""
    if arguments.action == "lint":
        packs = [*arguments.rules, *([arguments.what] if arguments.what else [])]
        rulebook = load_rulebook([Path(path) for path in packs], STAGES, strict=True)
        found = tuple(risks(rulebook.rules))
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
