"""The diagram of a campaign: the share of passed runs over a parameter, with intervals."""

import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape

from mars_asp.draw.shapes import FONT
from mars_asp.execution.campaign.summary import Cell, fixed_values
from mars_asp.execution.scenario.vary import Axis, written_change
from mars_asp.output import visible

#: The palette of Okabe and Ito, distinguishable with colour blindness.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#1a1a1a")
_LEFT, _TOP, _WIDTH, _HEIGHT, _LINE = 70.0, 46.0, 560.0, 300.0, 18.0
#: Pixels between points of two series at one value, so that their intervals can be seen.
_APART = 7.0


def plotted_axis(axes: Sequence[Axis]) -> Axis:
    """Return the axis to plot: the first varied one with numbers, else the first varied one."""
    several = [axis for axis in axes if len(axis.values) > 1]
    return next((axis for axis in several if _numeric(axis)), several[0])


def campaign_picture(cells: Sequence[Cell], axes: Sequence[Axis], title: str) -> str:
    """Return an SVG: a point with its 95 % interval for each cell, a series for each further value.

    Args:
        cells: the cells of the grid.
        axes: the axes of the grid; at least one has several values.
        title: the title above the diagram.
    """
    axis = plotted_axis(axes)
    # A cell of an earlier grid may lack the parameter.
    shown = [cell for cell in cells if axis.key in cell.vary]
    fixed = fixed_values(shown)
    text = ", ".join(written_change(*each) for each in fixed.items() if each[0] != axis.key)
    series: dict[str, list[Cell]] = {}
    for cell in shown:
        rest = {k: value for k, value in cell.vary.items() if k != axis.key and k not in fixed}
        series.setdefault(", ".join(written_change(*each) for each in rest.items()), []).append(
            cell
        )
    height = _TOP + _HEIGHT + 60 + _LINE * (len(series) if len(series) > 1 else 0)
    positions = _positions(axis)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_LEFT + _WIDTH + 30:g}" '
        f'height="{height:g}" font-family="{FONT}" font-size="12">',
        f"<title>{_svg_text(title)}</title>",
        '<rect width="100%" height="100%" fill="white"/>',
        f'<text x="{_LEFT:g}" y="20" font-weight="bold">{_svg_text(title)}</text>',
        f'<text x="{_LEFT:g}" y="37">runs that passed{_svg_text(text and f" with {text}")}; '
        "intervals of 95 % (Wilson)</text>",
        *_frame(axis, positions),
    ]
    for number, (name, each) in enumerate(series.items()):
        shift = (number - (len(series) - 1) / 2) * _APART
        colour = _COLOURS[number % len(_COLOURS)]
        parts += _series(each, axis, positions, shift, colour)
        if len(series) > 1:
            y = _TOP + _HEIGHT + 62 + number * _LINE
            parts.append(f'<circle cx="{_LEFT + 5:g}" cy="{y - 4:g}" r="4" fill="{colour}"/>')
            parts.append(f'<text x="{_LEFT + 16:g}" y="{y:g}">{_svg_text(name)}</text>')
    return "\n".join([*parts, "</svg>", ""])


def _numeric(axis: Axis) -> bool:
    return all(
        isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        for value in axis.values
    )


def _positions(axis: Axis) -> dict[str, float]:
    """Return the x coordinate of each value: numbers to scale, others at equal distances."""
    if _numeric(axis):
        low, high = min(axis.values), max(axis.values)
        shares = [(value - low) / (high - low) for value in axis.values]
    else:
        shares = [number / (len(axis.values) - 1) for number in range(len(axis.values))]
    # Margins of 40 pixels at both sides.
    return {
        str(value): _LEFT + 40 + (_WIDTH - 80) * share
        for value, share in zip(axis.values, shares, strict=True)
    }


def _frame(axis: Axis, positions: Mapping[str, float]) -> Iterator[str]:
    for percent in range(0, 101, 20):
        y = _y(percent / 100)
        yield f'<path d="M{_LEFT:g} {y:.1f}H{_LEFT + _WIDTH:g}" stroke="#ddd"/>'
        yield f'<text x="{_LEFT - 8:g}" y="{y + 4:.1f}" text-anchor="end">{percent} %</text>'
    bottom = _TOP + _HEIGHT
    for value, x in positions.items():
        yield f'<path d="M{x:.1f} {bottom:g}v5" stroke="#1a1a1a"/>'
        label = _svg_text(value if len(value) <= 20 else f"{value[:19]}…")
        yield f'<text x="{x:.1f}" y="{bottom + 19:g}" text-anchor="middle">{label}</text>'
    yield f'<path d="M{_LEFT:g} {bottom:g}H{_LEFT + _WIDTH:g}" stroke="#1a1a1a"/>'
    middle = _LEFT + _WIDTH / 2
    key = _svg_text(axis.key)
    yield f'<text x="{middle:g}" y="{bottom + 38:g}" text-anchor="middle">{key}</text>'


def _series(
    cells: Sequence[Cell], axis: Axis, positions: Mapping[str, float], shift: float, colour: str
) -> Iterator[str]:
    points = []
    for cell in cells:
        value = str(cell.vary[axis.key])
        if value in positions:
            points.append((positions[value] + shift, cell.passed))
    points.sort()
    if _numeric(axis):
        way = " ".join(f"{x:.1f},{_y(share.held / share.of):.1f}" for x, share in points)
        yield f'<polyline points="{way}" fill="none" stroke="{colour}" stroke-opacity=".4"/>'
    for x, share in points:
        low, high = share.interval
        yield (
            f'<path d="M{x:.1f} {_y(low):.1f}V{_y(high):.1f}" stroke="{colour}" stroke-width="2"/>'
        )
        yield (
            f'<circle cx="{x:.1f}" cy="{_y(share.held / share.of):.1f}" r="4" fill="{colour}">'
            f"<title>{_svg_text(share.text)}</title></circle>"
        )


def _y(share: float) -> float:
    return _TOP + _HEIGHT * (1 - share)


def _svg_text(text: str) -> str:
    return escape(visible(text))
