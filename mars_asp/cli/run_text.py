"""The result of a run as text: verdict, tables of links and controllers, and reasons."""

import argparse
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from mars_asp.cli.run_json import links_json, speakers
from mars_asp.cli.winners import in_turn
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.output import counted, visible

if TYPE_CHECKING:
    from rich.table import Table

    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.trial import Trial

#: The holder if no controller has control.
_NONE = "none"
#: The indent of further lines of a reason why a controller wins.
_BELOW_WINNER = " " * 6
#: The words for the states of a requirement.
_WORDS = {True: "holds", False: "VIOLATED", None: "NOT DECIDED"}


def run_text(trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace) -> str:
    """Return the verdict, the tables and each requirement as text; no tables with `--quiet`."""
    lines = list(_sentence("", _verdict(judgement)))
    if not arguments.quiet:
        lines += _table_lines((_links(trial), _controllers(trial)), arguments)
    for link in trial.executor.links:
        if link.faulty:
            fault = " ".join(f"{link.fault:.200}".splitlines())
            head = f"failed   {trial.executor.plan.link_title(link)}  "
            lines += _sentence(head, f"first by {fault}")
    for requirement in judgement.requirements:
        word = _WORDS[requirement.holds]
        lines += _sentence(f"{word:8} {requirement.name}  ", requirement.message)
    for warning in judgement.warnings:
        lines += _sentence("warning  ", f"{warning.message} [{warning.kind}]")
    bodies, clearance = trial.bodies, trial.clearance
    # Without obstacles there is no clearance.
    clear = f"least clearance {clearance:.0f} mm, " if clearance < float("inf") else ""
    lines += _sentence(
        f"{trial.scenario.duration:g} s, seed {trial.scenario.seed}: ",
        f"{counted(trial.collisions, 'collision')}, {clear}"
        f"{sum(body.driven for body in bodies):.0f} mm driven, "
        f"{sum(body.both for body in bodies):.2f} s turning while driving",
        "  ",
    )
    return "\n".join([*lines, ""])


def _table_lines(tables: "Iterable[Table]", arguments: argparse.Namespace) -> Sequence[str]:
    """Return the printed lines of those tables that have rows."""
    from rich.console import Console

    colour = {"always": True, "never": False}.get(arguments.color)
    console = Console(emoji=False, highlight=False, force_terminal=colour, no_color=colour is False)
    # On a closed pipe rich would exit with its own status; `print` does not.
    with console.capture() as captured:
        for table in tables:
            if table.row_count:
                console.print(table)
    return [line.rstrip() for line in captured.get().split("\n")[:-1]]


def run_line(trial: "Trial", wall: float) -> str:
    """Return the line of progress of a run after `wall` seconds of computing."""
    effectors = [trial.executor.effectors.get(each.module) for each in trial.scenario.robots]
    holders = (each.message.origin or "nobody" for each in effectors if each and each.message)
    dropped = sum(link.dropped.total() for link in trial.executor.links)
    seconds = trial.bodies[0].seconds
    return (
        f"{seconds:6.1f} of {trial.scenario.duration:g} s  {seconds / max(wall, 1e-9):5.0f}x  "
        f"least clearance {trial.clearance:6.0f} mm  dropped {dropped}  "
        f"in control: {', '.join(holders) or 'nobody'}"
    )


def _sentence(head: str, text: str, further: str = " " * 9) -> Iterator[str]:
    """Yield the lines of a wrapped sentence after `head`; further ones begin with `further`."""
    lines = wrapped(visible(text), columns(sys.stdout), visible(head), further)
    return (line.rstrip() for line in lines)


def _verdict(judgement: "Judgement") -> str:
    """Return the verdict, the requirements that decide it, and the number of warnings."""
    count, warnings = len(judgement.requirements), len(judgement.warnings)
    if judgement.verdict == "pass":
        warned = f", with {counted(warnings, 'warning')}" if warnings else ""
        return f"pass: all {count} requirements hold{warned}"
    state, result = (False, "violated") if judgement.verdict == "fail" else (None, "not decided")
    names = [each.name for each in judgement.requirements if each.holds is state]
    are = "is" if len(names) == 1 else "are"
    named = ", ".join(names)
    return f"{judgement.verdict}: {len(names)} of {count} requirements {are} {result}: {named}"


def print_winners(trial: "Trial") -> None:
    """Print the controllers in control at each arbiter, with the times and reasons."""
    from mars_asp.execution.executor.arbitration import FlatArbitration

    for name, arbiter in trial.executor.arbiters.items():
        print(f"\n{visible(name)}")
        if isinstance(arbiter, FlatArbitration):
            kind = "weighted: sends the weighted" if arbiter.weighted else "flat: sends the"
            print(f"  {kind} mean of each {arbiter.period / 1e6:g} ms; no controller wins")
            continue
        rows = [(held.since / 1e9, held.holder or _NONE, held.why) for held in arbiter.holdings]
        longest = max((len(holder) for _, holder, _ in rows), default=0)
        for since, holder, why in in_turn(rows):
            head = visible(f"  {since:9.3f} s  {holder:{longest}}  ")
            print("\n".join(wrapped(visible(why), columns(sys.stdout), head, _BELOW_WINNER)))
        if not arbiter.holdings:
            print("  no command arrived")


def print_reasons(trial: "Trial", *, losses: bool) -> None:
    """Print the deliveries of Gates and stops of locks, or the losses, with rule and line."""
    from mars_asp.execution.judgement import reasons_of

    found = reasons_of(trial, losses=losses)
    if losses:
        print("\nkept back" if found else "\nno Gate kept anything back")
    elif found:
        print("\nGates, locks and limits")
    for reason, span in found:
        text = f"{reason.message}  [{reason.rule.id}] {span.path}:{span.line}"
        print("\n".join(wrapped(visible(text), columns(sys.stdout), "  ", _BELOW_WINNER)))


def print_traces(judgement: "Judgement") -> None:
    """Print why each requirement was violated."""
    from mars_asp.asp.trace.text import traces_text
    from mars_asp.cli.lines import line_at

    topics = [(c.kind, trace) for c, trace in judgement.traces()]
    for line in traces_text(topics, line_at, width=columns(sys.stdout)):
        print(visible(line) if line.startswith(" ") else f"\n{visible(line)}")


def _links(trial: "Trial") -> "Table":
    rows = (
        (
            f"{link['source']} -> {link['client']}",
            "" if link["asked_hz"] is None else f"{link['asked_hz']:g}",
            f"{link['got_hz']:.2f}",
            f"{link['oldest_ms']:g}",
            ", ".join(f"{count} {why}" for why, count in sorted(link["dropped"].items())),
        )
        for link in links_json(trial)
    )
    return _text_table(("link", "asked Hz", "got Hz", "oldest ms", "dropped"), rows)


def _controllers(trial: "Trial") -> "Table":
    from mars_asp.execution.executor.arbitration import HierarchicalArbitration

    # A controller without messages has a row as well.
    suppressed = Counter(dict.fromkeys(speakers(trial), 0))
    for arbiter in trial.executor.arbiters.values():
        if isinstance(arbiter, HierarchicalArbitration):
            suppressed.update(arbiter.suppressed)
    times, duration = trial.control_time, trial.scenario.duration
    rows = (
        (name, f"{100 * times.get(name, 0.0) / duration:.1f} %", str(suppressed[name]))
        for name in sorted({*times, *suppressed})
    )
    return _text_table(("controller", "in control", "suppressed"), rows)


def _text_table(heads: tuple[str, ...], rows: "Iterable[Sequence[str]]") -> "Table":
    """Return the table of the columns in which a row has a value."""
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False)
    listed = [*rows]
    kept = [number for number in range(len(heads)) if any(r[number] for r in listed)]
    for number in kept:
        table.add_column(heads[number], justify="right" if 0 < number < 4 else "left")
    for row in listed:
        table.add_row(*(Text(visible(row[number])) for number in kept))
    return table
