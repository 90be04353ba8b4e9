"""The picture of a run: the way coloured by controller, obstacles, and who held control when."""

from collections.abc import Iterator
from html import escape

from mars_asp.trial import Trial

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#666666")
_SIZE, _LANE, _LEFT = 640.0, 22.0, 120.0


def plot_run(trial: Trial) -> str:
    """Return an SVG; the same run gives the same bytes."""
    spans = [(since, until, origin) for since, until, origin, _ in trial.commands if origin]
    names = sorted({name for _, _, name in spans})
    colours = {name: _COLOURS[k % len(_COLOURS)] for k, name in enumerate(names)}
    height = _SIZE + 30 + _LANE * len(names) + 20
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_SIZE + 40:g}" height="{height:g}" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
        *_world(trial, spans, colours),
        *_lanes(trial, spans, names, colours),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _world(
    trial: Trial, spans: list[tuple[float, float, str]], colours: dict[str, str]
) -> Iterator[str]:
    body, world = trial.body, trial.body.world
    xs = [0.0, *world.segments[:, ::2].ravel(), *(p.forward for _, p in body.track)]
    ys = [0.0, *world.segments[:, 1::2].ravel(), *(p.side for _, p in body.track)]
    low, high = (min(xs) - 300, min(ys) - 300), (max(xs) + 300, max(ys) + 300)
    scale = _SIZE / max(high[0] - low[0], high[1] - low[1])

    def at(x: float, y: float) -> tuple[float, float]:
        # Forward is up and side is right, as seen from above.
        return 20 + (y - low[1]) * scale, 20 + (high[0] - x) * scale

    for a, b, c, d in world.segments:
        (x, y), (u, v) = at(a, b), at(c, d)
        yield f'<path d="M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" stroke="#333" stroke-width="2"/>'
    now = trial.body.seconds
    round_ = [(*c, "#999") for c in world.circles]
    round_ += [(*c.at(now), c.radius, "#d98") for c in world.moving]
    for cx, cy, radius, fill in round_:
        x, y = at(cx, cy)
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius * scale:.1f}" fill="{fill}"/>'
    left = iter(spans)
    span = next(left, None)
    for (since, p), (_, q) in zip(body.track, body.track[1:], strict=False):
        while span is not None and span[1] < since:
            span = next(left, None)
        held = span is not None and span[0] <= since
        colour = colours[span[2]] if held and span is not None else "#bbb"
        (x, y), (u, v) = at(p.forward, p.side), at(q.forward, q.side)
        if (p.forward, p.side) != (q.forward, q.side):
            yield f'<path d="M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" stroke="{colour}" stroke-width="3"/>'
    x, y = at(body.pose.forward, body.pose.side)
    yield (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{body.radius * scale:.1f}" fill="none" '
        'stroke="black"/>'
    )


def _lanes(
    trial: Trial,
    spans: list[tuple[float, float, str]],
    names: list[str],
    colours: dict[str, str],
) -> Iterator[str]:
    duration, top = trial.scenario.duration, _SIZE + 50
    wide = (_SIZE + 20 - _LEFT) / duration
    for row, name in enumerate(names):
        y = top + row * _LANE
        yield f'<text x="10" y="{y + 13:g}">{escape(name)}</text>'
        for since, until, holder in spans:
            if holder == name:
                x, width = _LEFT + since * wide, max((until - since) * wide, 0.3)
                yield (
                    f'<rect x="{x:.2f}" y="{y:g}" width="{width:.2f}" height="{_LANE - 6:g}" '
                    f'fill="{colours[name]}"/>'
                )
    y = top + len(names) * _LANE + 8
    yield f'<text x="{_LEFT:g}" y="{y:g}">0 s</text>'
    yield f'<text x="{_SIZE + 20:g}" y="{y:g}" text-anchor="end">{duration:g} s</text>'
