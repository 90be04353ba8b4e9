"""Lanes in the diagram of a run: requested control, granted control, and times of events."""

from collections.abc import Iterator
from math import floor, log10

from mars_asp.draw.shapes import escaped, text_width
from mars_asp.execution.recording.frame import LANE, MARGIN, SIZE, TEXT, Frame
from mars_asp.output import visible

#: Maximal number of ticks; their distance is 1, 2 or 5 seconds, times a power of ten.
_TICKS = 10


def draw_lanes(frame: Frame, instants: Iterator[tuple[float, str]]) -> Iterator[str]:
    """Yield a lane for each module: pale while its message is in force, full while it is obeyed.

    `instants` are times in seconds with colours; each gets a line across all lanes.
    """
    rows = {name: frame.top + row * LANE for row, name in enumerate(frame.colours)}
    end = SIZE + MARGIN
    for name, y in rows.items():
        whole = escaped(visible(name))
        shown = escaped(cut(name, frame.left - 18))
        title = "" if shown == whole else f"<title>{whole}</title>"
        yield f'<text x="{MARGIN / 2:g}" y="{y + 12:g}">{title}{shown}</text>'
        yield (
            f'<rect class="lane" data-name="{whole}" x="{frame.left:g}" y="{y:g}" '
            f'width="{end - frame.left:g}" height="{LANE - 6:g}" fill="#f4f4f4"/>'
        )
        if name in frame.silent:
            yield (
                f'<text x="{frame.left + 6:g}" y="{y + 12:g}" font-style="italic" fill="#666" '
                'pointer-events="none">silent</text>'
            )
    for spans, opacity in ((frame.wanted, 0.3), (frame.held, 1)):
        yield f'<g opacity="{opacity:g}" pointer-events="none">'
        for since, until, name in spans:
            x, width = frame.left + since * frame.wide, (until - since) * frame.wide
            yield (
                f'<rect x="{x:.2f}" y="{rows[name]:g}" width="{max(width, 0.3):.2f}" '
                f'height="{LANE - 6:g}" fill="{frame.colours[name]}"/>'
            )
        yield "</g>"
    for at, colour in instants:
        x = frame.left + at * frame.wide
        yield (
            f'<path class="instant" d="M{x:.2f} {frame.top - 6:g}V{frame.bottom:g}" '
            f'stroke="{colour}" stroke-width="1.5" pointer-events="none"/>'
        )
    yield from _axis(frame)


def _axis(frame: Frame) -> Iterator[str]:
    duration, y, end = frame.trial.scenario.duration, frame.bottom, SIZE + MARGIN
    yield f'<path d="M{frame.left:g} {y:g}H{end:g}" stroke="#333"/>'
    step = round_step(duration / _TICKS)
    count = floor(duration / step + 1e-9)
    last = f"{duration:g} s"
    for k in range(count + 1):
        x = frame.left + k * step * frame.wide
        yield f'<path d="M{x:.2f} {y:g}v5" stroke="#333"/>'
        label = f"{float(f'{k * step:.12g}'):g}"
        if x + text_width(label, TEXT) / 2 + 8 < end - text_width(last, TEXT):
            yield f'<text x="{x:.2f}" y="{y + 17:g}" text-anchor="middle">{label}</text>'
    yield f'<path d="M{end:g} {y:g}v5" stroke="#333"/>'
    yield f'<text x="{end:g}" y="{y + 17:g}" text-anchor="end">{last}</text>'


def round_step(least: float) -> float:
    """Return the smallest 1, 2 or 5 times a power of ten that is at least `least` (above 0)."""
    power: float = 10.0 ** floor(log10(least))
    return next(k * power for k in (1, 2, 5, 10) if k * power >= least * (1 - 1e-9))


def cut(name: str, wide: float) -> str:
    """Return a name that is shortened to a width in pixels."""
    shown = visible(name)
    if text_width(shown, TEXT) > wide:
        while shown and text_width(f"{shown}…", TEXT) > wide:
            shown = shown[:-1]
        shown += "…"
    return shown
