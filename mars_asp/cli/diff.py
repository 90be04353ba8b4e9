"""Compare two configurations: consequences, nodes and costs, with the lines that changed them."""

import argparse
import shlex
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from mars_asp.cli.analyse import consequence_json
from mars_asp.cli.diagnostic_text import colours, paint
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import beside, check_inputs, read_project, report_project, rulebook_for
from mars_asp.cli.lines import line_at, lines_of, located_line_json
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.diagnostic import Span
from mars_asp.output import visible
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.diff import Change, Difference, diff
from mars_asp.reasoning.rules import COSTS
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode
from mars_asp.reasoning.synthesis.synthesise import Synthesis

#: The most lines shown of a difference without consequences and nodes.
_MOST_LINES = 20


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW")


def run(arguments: argparse.Namespace) -> int:
    """Print the changes; return 1 if an error appeared."""
    paths = arguments.old, arguments.new
    check_inputs(*paths)
    old = read_project(beside(arguments, *paths), arguments.old)
    new = read_project(beside(arguments, *paths[::-1]), arguments.new, quietly=True)
    # Both may read the same sources.
    others = tuple(each for each in new.diagnostics if each not in old.diagnostics)
    report_project(replace(new, diagnostics=others), arguments, [arguments.new])
    old, new = comparable(old, new)
    rulebook, budget = rulebook_for(arguments), Budget(arguments.time_limit)
    found = diff(Reasoner(old, rulebook, budget), Reasoner(new, rulebook, budget), lines_of)
    coloured, width = colours(arguments, sys.stdout), columns(sys.stdout)
    lines = [*difference_lines(found, coloured, arguments.quiet, width)]
    if old.configuration.kind != new.configuration.kind and not arguments.quiet:
        lines += _after_kinds(old, new, width)
    print_result(arguments, lambda: difference_json(found), lines)
    return int(found.has_new_errors)


def _after_kinds(old: Project, new: Project, width: int) -> Iterator[str]:
    """Yield the lines on a specification beside a configuration, with the command that fits."""
    is_old = old.configuration.kind == "specification"
    name, (specification, other) = ("OLD", (old, new)) if is_old else ("NEW", (new, old))
    text = f"{name} is a specification and has its nodes already; to judge it by the other:"
    yield from wrapped(text, width)
    paths = specification.configuration.path, other.configuration.path
    yield f"    {visible(shlex.join(['mars-asp', 'verify', *paths]))}"


def comparable(old: Project, new: Project) -> tuple[Project, Project]:
    """Return both projects; foreign files beside a specification are what `import` prints of them.

    Configurations have a mux as priorities, and specifications as a node.
    """
    return _like(old, new), _like(new, old)


def _like(project: Project, other: Project) -> Project:
    if project.format is None or other.configuration.kind != "specification":
        return project
    from mars_asp.exchange.lift import lifted

    return replace(project, configuration=lifted(project.configuration))


def difference_json(found: Difference) -> dict[str, object]:
    """Return a difference with the keys that `docs/how-to/what-if.md` names."""
    return {
        "consequences": [_change_json(c, consequence_json(c.item)) for c in found.consequences],
        "nodes": [
            _change_json(
                c,
                {"name": c.item.name, "kind": c.item.kind, "resolves": [*_resolves(c, found)]},
            )
            for c in found.nodes
        ],
        "cost": {"old": _cost_json(found.old), "new": _cost_json(found.new)},
        "added": [located_line_json(span) for span in found.added],
        "removed": [located_line_json(span) for span in found.removed],
    }


def _change_json(change: Change[Any], item: dict[str, object]) -> dict[str, object]:
    return {
        "change": change.how,
        **item,
        "added": [located_line_json(span) for span in change.added],
        "removed": [located_line_json(span) for span in change.removed],
        "unchanged": [located_line_json(span) for span in change.unchanged],
    }


def _cost_json(synthesis: Synthesis | None) -> dict[str, int] | None:
    if synthesis is None:
        return None
    return {name: synthesis.cost(level) for name, level in COSTS.items()}


def _resolves(change: Change[IntroducedNode], found: Difference) -> tuple[str, ...]:
    synthesis = found.old if change.new is None else found.new
    return () if synthesis is None else synthesis.specification.resolves.get(change.item.name, ())


def difference_lines(found: Difference, coloured: bool, quiet: bool, width: int) -> Iterator[str]:
    """Yield the lines of a difference: consequences, nodes, and costs unless `quiet`."""
    for change in found.consequences:
        consequence = change.item
        word = paint(f"{change.how} {consequence.kind}", consequence.severity, coloured)
        yield from wrapped(visible(consequence.message), width, f"{word}: ", "  ")
        yield from _causes(change)
    for node in found.nodes:
        reasons = ", ".join(_resolves(node, found))
        word = paint(f"{node.how} {visible(node.item.name)}", "strong", coloured)
        text = f"{word}, which resolves {visible(reasons)}" if reasons else word
        yield from wrapped(text, width, "", "  ")
        yield from _causes(node)
    if quiet:
        return
    if found.is_empty:
        lines = tuple(_changed_lines(found.added, found.removed))
        yield "no consequence and no node changed, but lines:" if lines else "nothing changed"
        yield from lines[:_MOST_LINES]
        if (left := len(lines) - _MOST_LINES) > 0:
            yield f"    and {left} more, which `--format json` lists"
    yield from _cost_line(found)


def _causes(change: Change[Any]) -> Iterator[str]:
    if not change.cited and not change.unchanged:
        yield "    no line that it rests on changed"
    yield from _changed_lines(change.added, change.removed)
    for path, line, text in dict.fromkeys((s.path, s.line, line_at(s)) for s in change.unchanged):
        yield visible(f"    = {path}:{line}: {text}  (unchanged, with another effect)")


def _changed_lines(added: Iterable[Span], removed: Iterable[Span]) -> Iterator[str]:
    for sign, spans in (("-", removed), ("+", added)):
        # A list of controllers is several relationships in one line.
        for path, line, text in dict.fromkeys((s.path, s.line, line_at(s)) for s in spans):
            yield visible(f"    {sign} {path}:{line}: {text}")


def _cost_line(found: Difference) -> Iterator[str]:
    if found.old is None or found.new is None:
        yield visible(f"{'; '.join(found.unrealised)}, so no nodes are compared")
        return
    parts = []
    for name, level in COSTS.items():
        old, new = found.old.cost(level), found.new.cost(level)
        parts.append(f"{name} {old}" if old == new else f"{name} {old} -> {new}")
    yield f"cost: {', '.join(parts)}"
