"""The changes by a pack in configurations: findings, nodes and costs."""

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from mars_asp.cli.diagnostic_text import report_error
from mars_asp.cli.diff import difference_json
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import load, only_robot
from mars_asp.cli.lines import lines_of
from mars_asp.diagnostic import MarsError, refusal
from mars_asp.output import counted, visible
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.packs import with_companions
from mars_asp.reasoning.questions.diff import Difference, diff
from mars_asp.reasoning.rules import COSTS, load_rulebook, rules_directory
from mars_asp.reasoning.session import Reasoner


class _Compared(NamedTuple):
    """A configuration, and the changes in it."""

    path: str
    found: Difference


def print_changes(pack: str, files: Sequence[str], arguments: argparse.Namespace) -> int:
    """Print the changes by a pack; return 1 if an error appeared, 2 if a file cannot be read.

    Without files, the examples of the installation are compared.

    Raises:
        MarsError: the pack has errors, or there are no examples.
    """
    given = [Path(path) for path in arguments.rules]
    before = load_rulebook(given, trusted=arguments.trust)
    packs = [*given, *with_companions(Path(pack))]
    after = load_rulebook(packs, trusted=arguments.trust)
    reading = argparse.Namespace(**{**vars(arguments), "rules": [str(each) for each in packs]})
    # A configuration may state attributes that only the pack declares; without the pack's rules no
    # rule reads these facts.
    before = replace(before, brought=after.brought)
    compared: list[_Compared] = []
    status = 0
    for path in files or _examples():
        try:
            project = load(reading, only_robot(reading, path))
            budget = Budget(arguments.time_limit)
            found = diff(
                Reasoner(project, before, budget), Reasoner(project, after, budget), lines_of
            )
        except MarsError as error:
            report_error(error, arguments)
            status = 2
            continue
        compared.append(_Compared(path, found))
    listed = ({"path": each.path, **difference_json(each.found)} for each in compared)
    lines = map(visible, _difference_text(compared))
    print_result(arguments, lambda: {"pack": pack, "configurations": list(listed)}, lines)
    return max(status, int(any(each.found.has_new_errors for each in compared)))


def _examples() -> tuple[str, ...]:
    folder = rules_directory().parent / "examples"
    here = Path.cwd()
    found = [p for p in sorted(folder.glob("*/*.mars")) if p.name == "config.mars"]
    if not found:
        message = "this installation has no examples"
        raise refusal("usage", message, "examples", "name the files of configurations")
    return tuple(str(p.relative_to(here) if p.is_relative_to(here) else p) for p in found)


def _difference_text(compared: Iterable[_Compared]) -> Iterator[str]:
    same = 0
    for each in compared:
        lines = [*_changes(each.found), *_cost_lines(each.found)]
        same += not lines
        if lines:
            yield f"{each.path}:"
            yield from (f"  {line}" for line in lines)
    if same:
        yield f"unchanged: {counted(same, 'configuration')}"


def _changes(found: Difference) -> Iterator[str]:
    for change in found.consequences:
        item = change.item
        yield f"{change.how} {item.severity} {item.kind}({item.subject}): {item.message}"
    for node in found.nodes:
        yield f"{node.how} {node.item.name}"


def _cost_lines(found: Difference) -> Iterator[str]:
    if found.old is None or found.new is None:
        if found.old is not found.new:
            yield f"a specification {'appeared' if found.old is None else 'vanished'}"
        return
    parts = []
    for name, level in COSTS.items():
        old, new = found.old.cost(level), found.new.cost(level)
        parts += [f"{name} {old} -> {new}"] if old != new else []
    if parts:
        yield f"cost: {', '.join(parts)}"
