"""The end of a campaign: shares with intervals, quantiles, warnings, and the worst runs."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from typing import Any, TextIO

from mars_asp.cli.wrapping import cells as width_of
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.execution.campaign.summary import (
    MOST_WORST,
    QUANTILES,
    Cell,
    Spread,
    cell_of,
    cells,
    fixed_values,
    share_passed,
    worst,
)
from mars_asp.execution.scenario.vary import written_change
from mars_asp.output import counted, visible

_Result = Mapping[str, Any]
#: The titles of quantities in the table, and their units.
_TITLES = {
    "min_clearance_mm": ("least clearance", "mm"),
    "reached_s": ("time to reach", "s"),
    "nearest_to_place_mm": ("distance to place", "mm"),
}
#: The quantiles in the table.
_SHOWN = (5, 50, 95)


def print_table(
    results: Sequence[_Result], commands: Sequence[Mapping[str, Any]], stream: TextIO
) -> None:
    """Print the shares and the worst runs; `commands` has the commands that repeat these."""
    for line in _shares_table(results, columns(stream)):
        print(line, file=stream)
    shown = worst(results)
    if not shown:
        return
    failed = len(results) - share_passed(results).held
    among = f" of {failed}" if failed > MOST_WORST else ""
    print(f"the worst{among} that did not pass, each with its command:", file=stream)
    for result, command in zip(shown, commands, strict=True):
        outcome = wrapped(visible(_result_text(result)), columns(stream), "  ", "    ")
        print("\n".join(outcome), file=stream)
        print(f"    {command['command']}", file=stream)


def _shares_table(results: Sequence[_Result], width: int) -> Iterator[str]:
    """Yield the shares of each cell: passed runs, requirements and controllers; then quantiles.

    Requirements that always held share one line; so do controllers that were always or never in
    control, and warnings that occur in equally many runs.
    """
    whole, groups = cell_of({}, results), cells(results)
    passed, controls = whole.passed, whole.in_control
    labels = [_label(cell, fixed_values(groups)) for cell in groups]
    labelled = [("", whole), *zip(labels, groups, strict=True)]
    rows = [(label, "passed", cell.passed.text) for label, cell in labelled]
    always = [
        name for name, share in whole.requirements.items() if share.held == share.of == passed.of
    ]
    rows += [
        (label, name, cell.requirements[name].text)
        for name in whole.requirements
        for label, cell in labelled
        if name not in always and name in cell.requirements
    ]
    rows += [
        (label, f"{name} in control", cell.in_control[name].text)
        for name, share in controls.items()
        for label, cell in labelled
        if 0 < share.held < share.of and name in cell.in_control
    ]
    for name in whole.spreads:
        title, unit = _spread_title(name)
        rows += [
            (label, title, _spread_text(cell.spreads[name], unit))
            for label, cell in labelled
            if name in cell.spreads
        ]
    fixed = ", ".join(written_change(*each) for each in fixed_values(groups).items())
    head = f"{counted(passed.of, 'run')}{' with ' * bool(fixed)}{fixed}"
    yield from map(visible, wrapped(f"{head}, intervals of 95 % (Wilson)", width, "", "  "))
    # A single cell has the same results as the whole.
    yield from _aligned(rows if len(groups) > 1 else [row for row in rows if not row[0]])
    by_head: dict[str, list[str]] = {f"passed in every run ({passed.of} of {passed.of}): ": always}
    for name, count in whole.warnings.items():
        by_head.setdefault(f"warnings in {count} of {passed.of}: ", []).append(name)
    by_head["in control in each run: "] = [n for n, s in controls.items() if 0 < s.held == s.of]
    by_head["in control in no run: "] = [n for n, s in controls.items() if s.held == 0]
    for head, names in by_head.items():
        if names:
            yield from map(visible, wrapped(", ".join(names), width, head, "  "))


def _spread_title(name: str) -> tuple[str, str]:
    """Return the title and the unit of a quantity; `ROBOT.QUANTITY` has the robot in its title."""
    robot, _, quantity = name.rpartition(".")
    title, unit = _TITLES[quantity]
    return f"{title} of {robot}" if robot else title, unit


def _spread_text(spread: Spread, unit: str) -> str:
    """Return the quantiles that a table shows, as in `5 % 12 mm, 50 % 130 mm, 95 % 480 mm`."""
    digits = int(unit == "s")
    shown = (
        f"{percent} % {f'{value:.{digits}f} {unit}' if value < inf else 'never'}"
        for percent, value in zip(QUANTILES, spread.values, strict=True)
        if percent in _SHOWN
    )
    return ", ".join(shown)


def _aligned(rows: Sequence[tuple[str, str, str]]) -> Iterator[str]:
    """Yield the lines of a table with aligned columns; a repeated name is omitted."""
    names = max((width_of(visible(name)) for _, name, _ in rows), default=0)
    labels = max((width_of(visible(label)) for label, _, _ in rows), default=0)
    before = None
    for label, name, text in rows:
        shown = visible(name if name != before else "")
        before = name
        place = f"  {_filled(visible(label), labels)}" if labels else ""
        yield f"{_filled(shown, names)}{place}  {text}"


def _filled(text: str, width: int) -> str:
    return text + " " * (width - width_of(text))


def _label(cell: Cell, fixed: Mapping[str, Any]) -> str:
    """Return the values that distinguish a cell (those not in `fixed`), or a dash without any."""
    declared = (written_change(*each) for each in cell.vary.items() if each[0] not in fixed)
    return ", ".join(declared) or "-"


def _result_text(result: _Result) -> str:
    """Return the seed, the changed values and the outcome of a run."""
    named = [f"seed {result['seed']}", *(written_change(*each) for each in result["vary"].items())]
    violated = [r["name"] for r in result["requirements"] if r["holds"] is False]
    undecided = [r["name"] for r in result["requirements"] if r["holds"] is None]
    if result.get("error"):
        outcome = result["error"]
    elif violated:
        outcome = f"violated: {', '.join(violated)}"
    else:
        outcome = f"not decided: {', '.join(undecided)}"
    if result.get("collisions"):
        outcome += f"; {counted(result['collisions'], 'collision')}"
    return f"{', '.join(named)}: {outcome}"
