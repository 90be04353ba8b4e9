"""Judge whether a specification realises a configuration, and whether it is minimal."""

import argparse
import json
import sys

from mars_asp.cli.reason import analyse_project, read_project, rulebook_for
from mars_asp.model import Control, Data
from mars_asp.resolve import NODES, RELATIONSHIPS, synthesise
from mars_asp.verify import verify
from mars_asp.visible import visible


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("specification", metavar="SPEC", help="a `.mars` specification")
    parser.add_argument("file", metavar="CONFIG", help="the configuration it is to realise")


def run(arguments: argparse.Namespace) -> int:
    """Print what fails; 1 where the specification does not realise the configuration."""
    specification = read_project(arguments, arguments.specification).configuration
    project = read_project(arguments)
    rulebook = rulebook_for(arguments, ("resolve", "verify"))
    violations = verify(specification, project, rulebook)
    minimal: bool | None = None
    if not violations:
        analysis = analyse_project(project, rulebook)
        best = synthesise(
            project.configuration, project.modules, analysis, rulebook, arguments.time_limit
        )
        if best is not None and best.resolution.proven:
            declared = {name.text for name in project.configuration.modules}
            nodes = [n.text for n in specification.modules if n.text not in declared]
            lines = [r for r in specification.relationships if isinstance(r, Data | Control)]
            # Conversion cost needs to know the converters; nodes and lines are counted here.
            minimal = (len(nodes), len(lines)) <= (best.cost(NODES), best.cost(RELATIONSHIPS))
    if arguments.format == "json":
        listed = [
            {
                "clause": v.clause,
                "message": v.message,
                "help": v.help,
                "rule": {"id": v.rule.id, "path": v.rule.span.path, "line": v.rule.span.line},
            }
            for v in violations
        ]
        json.dump(
            {"realises": not violations, "minimal": minimal, "violations": listed}, sys.stdout
        )
        print()
        return int(bool(violations))
    for violation in violations:
        print(visible(f"clause {violation.clause}: {violation.message} [{violation.rule.id}]"))
        print(visible(f"    help: {violation.help}"))
    if not violations:
        word = {True: "and is minimal", False: "but is not minimal", None: ""}[minimal]
        print(f"the specification realises the configuration {word}".rstrip())
    return int(bool(violations))
