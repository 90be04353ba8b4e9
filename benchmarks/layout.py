"""Our layered layout against Graphviz's `dot`: the same boxes, labels and strokes, both ways.

    python benchmarks/layout.py draw FOLDER     pairs A and B in one PNG each, in a hidden order
    python benchmarks/layout.py score FOLDER    reads FOLDER/verdicts.txt, lines such as `07 A why`

Thirty graphs: the examples and their specifications, and random configurations of 6 to 60 modules.
Who is A and who is B stands in FOLDER/key.json, which whoever judges does not open before. `A`, `B`
or `=` is better. Crossings and the like are counted on the curves of both.
"""

import json
import random
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from math import dist
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pygraphviz
from numpy.typing import NDArray

from mars_asp.draw import depict
from mars_asp.draw.layered import Drawing, LayeredEdge, Point, Route, Size
from mars_asp.draw.packing import draw_graph
from mars_asp.draw.picture import Picture
from mars_asp.draw.png import png_bytes
from mars_asp.draw.shapes import FONT
from mars_asp.draw.svg import svg_text
from mars_asp.language import parse_text
from mars_asp.model.described import described_modules
from mars_asp.reasoning.project import load_project

ROOT = Path(__file__).parents[1]
EXAMPLES = [
    *("examples/level0/config.mars", "examples/level1/config.mars", "examples/scara/config.mars"),
    *("examples/mobile-camera/config.mars", "examples/gripper-arm/config.mars"),
    *(
        "tests/specifications/level0.mars",
        "tests/specifications/figure13-hierarchical-arbitration.mars",
    ),
    *("tests/specifications/figure07-representation.mars", "tests/mixed.mars"),
]
SIZES = (6, 6, 6, 9, 9, 9, 13, 13, 13, 18, 18, 18, 25, 25, 25, 35, 35, 35, 48, 48, 60)
#: Points of a curve between its ends.
STEPS = 12
#: Where lines that meet at a box part is no crossing.
NEAR_END = 14.0
#: Pixels for one of a pair.
WIDE, HIGH = 620, 620
Layout = Callable[[Sequence[Size], Sequence[LayeredEdge]], Drawing]


class Measured(NamedTuple):
    """What is counted on a drawing; less is better."""

    crossings: int
    lines_through_boxes: int
    labels_covered: int
    length: float
    area: float
    bends: float


def random_text(modules: int, seed: int) -> str:
    """Return a configuration with the shapes of robots: few sources, few effectors, a tree."""
    rng = random.Random(seed)
    names = [f"Module{index}" for index in range(modules)]
    lines = [
        f"{b} is_mounted_on {rng.choice(names[:i])}"
        for i, b in enumerate(names)
        if 0 < i < modules // 4
    ]
    for index, name in enumerate(names[1:], 1):
        for source in rng.sample(
            names[max(0, index - 9) : index], min(index, rng.choice([0, 1, 1, 2]))
        ):
            mode = rng.choice(["", "", "", " NotifyAtFrequency 10", " RequestWhenReady"])
            lines.append(f"{name} uses_data_from {source}{mode}")
    for effector in names[: max(1, modules // 6)]:
        for rank, other in enumerate(
            rng.sample(names[modules // 3 :], min(modules // 3, rng.choice([1, 2, 3])))
        ):
            lines.append(f"{effector} is_controlled_by {other} {rank + 1}")
    return "\n".join(["@configuration", f"@modules {', '.join(names)}", *lines, ""])


def pictures() -> Iterator[tuple[str, Picture]]:
    """Yield the graphs with their names."""
    for path in EXAMPLES:
        project = load_project(str(ROOT / path))
        yield (
            path,
            depict(
                project.configuration, described_modules(project.configuration, project.modules)
            ),
        )
    for seed, modules in enumerate(SIZES):
        parsed = parse_text(random_text(modules, seed), "random.mars").configuration
        yield f"random, {modules} modules, seed {seed}", depict(parsed, {})


def by_dot(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Drawing:
    """Return Graphviz's layout of boxes and links, with its own defaults but for distances."""
    graph = pygraphviz.AGraph(directed=True, strict=False, nodesep=26 / 72)
    for index, (width, height) in enumerate(sizes):
        graph.add_node(
            index, shape="box", label="", fixedsize="true", width=width / 72, height=height / 72
        )
    for index, link in enumerate(links):
        graph.add_edge(link.tail, link.head, key=index, arrowhead="none", label=_sized(link.label))
    graph.layout("dot")
    left, low, right, high = map(float, graph.graph_attr["bb"].split(","))

    def placed(text: str) -> Point:
        x, y = map(float, text.split(","))
        return x - left, high - y

    edges = {
        int(edge.name): edge for edge in graph.edges(keys=True) for edge in [graph.get_edge(*edge)]
    }
    routes = []
    for index in range(len(links)):
        attributes = edges[index].attr
        points = tuple(placed(each) for each in attributes["pos"].split())
        routes.append(Route(points, placed(attributes["lp"]) if attributes["lp"] else None))
    centres = tuple(placed(graph.get_node(index).attr["pos"]) for index in range(len(sizes)))
    return Drawing((right - left, high - low), centres, tuple(routes))


def _sized(label: Size | None) -> str:
    if label is None:
        return ""
    # Its line passes at the side, where ours is covered by the label.
    inside = f'fixedsize="true" width="{label[0] + 8:.0f}" height="{label[1]:.0f}"'
    return f'<<table border="0" cellborder="0" {inside}><tr><td></td></tr></table>>'


# ---- Counting ------------------------------------------------------------------------------------


def measured(drawing: Drawing, sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Measured:
    """Return what can be counted on a drawing."""
    lines = [_line(route) for route in drawing.routes]
    boxes = [_rectangle(at, size, -2) for at, size in zip(drawing.centres, sizes, strict=True)]
    labels = {
        number: _rectangle(route.label, link.label, -2)
        for number, (route, link) in enumerate(zip(drawing.routes, links, strict=True))
        if route.label and link.label
    }
    through = sum(
        _meets(line, box)
        for line, link in zip(lines, links, strict=True)
        for number, box in enumerate(boxes)
        if number not in (link.tail, link.head)
    )
    covered = sum(
        _meets(line, label)
        for number, line in enumerate(lines)
        for own, label in labels.items()
        if number != own
    )
    covered += sum(_overlap(label, box) for label in labels.values() for box in boxes)
    covered += sum(_overlap(a, b) for a, b in combinations(labels.values(), 2))
    return Measured(
        sum(_crossings(a, b) for a, b in combinations(lines, 2)),
        through,
        covered,
        sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines),
        drawing.size[0] * drawing.size[1],
        sum(map(_bend, lines)),
    )


def _line(route: Route) -> NDArray[np.float64]:
    """Return points on the curves of a route."""
    points = np.array(route.points)
    steps = np.linspace(0, 1, STEPS + 1)[:, None]
    parts = [points[:1]]
    for a, b, c, d in zip(points[:-1:3], points[1::3], points[2::3], points[3::3], strict=True):
        curve = (
            (1 - steps) ** 3 * a
            + 3 * (1 - steps) ** 2 * steps * b
            + 3 * (1 - steps) * steps**2 * c
            + steps**3 * d
        )
        parts.append(curve[1:])
    return np.concatenate(parts)


def _crossings(one: NDArray[np.float64], other: NDArray[np.float64]) -> int:
    """Return how often two lines cross, but for where they part at a box."""
    p, r = one[:-1, None], np.diff(one, axis=0)[:, None]
    q, s = other[None, :-1], np.diff(other, axis=0)[None]
    cross = r[..., 0] * s[..., 1] - r[..., 1] * s[..., 0]
    apart = q - p
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (apart[..., 0] * s[..., 1] - apart[..., 1] * s[..., 0]) / cross
        u = (apart[..., 0] * r[..., 1] - apart[..., 1] * r[..., 0]) / cross
    hit = (t >= 0) & (t < 1) & (u >= 0) & (u < 1) & (cross != 0)
    found = 0
    for i, j in zip(*np.nonzero(hit), strict=True):
        at = one[i] + t[i, j] * (one[i + 1] - one[i])
        ends = (one[0], one[-1], other[0], other[-1])
        found += all(dist(at, end) > NEAR_END for end in ends)
    return found


Rectangle = tuple[float, float, float, float]


def _rectangle(at: Point, size: Size, grown: float) -> Rectangle:
    wide, high = size[0] / 2 + grown, size[1] / 2 + grown
    return at[0] - wide, at[1] - high, at[0] + wide, at[1] + high


def _meets(line: NDArray[np.float64], box: Rectangle) -> bool:
    fine = np.concatenate([line, (line[1:] + line[:-1]) / 2])
    inside = (
        (fine[:, 0] > box[0])
        & (fine[:, 0] < box[2])
        & (fine[:, 1] > box[1])
        & (fine[:, 1] < box[3])
    )
    return bool(inside.any())


def _overlap(a: Rectangle, b: Rectangle) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _bend(line: NDArray[np.float64]) -> float:
    """Return by how many degrees a line turns in all."""
    steps = np.diff(line, axis=0)
    steps = steps[np.hypot(*steps.T) > 1e-6]
    angles = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    return float(np.degrees(np.abs(angles)).sum())


# ---- Judging -------------------------------------------------------------------------------------


def draw(folder: Path) -> None:
    """Write the pairs, the key, and what was counted."""
    folder.mkdir(parents=True, exist_ok=True)
    order, key = random.SystemRandom(), {}
    for number, (name, picture) in enumerate(pictures(), 1):
        found = {"ours": _drawn(picture, draw_graph), "dot": _drawn(picture, by_dot)}
        names = list(found)
        order.shuffle(names)
        parts = [_scaled(found[who][0], side * (WIDE + 20)) for side, who in enumerate(names)]
        high = max(high for _, high in parts) + 30
        words = "".join(
            f'<text x="{side * (WIDE + 20) + 5}" y="20">{number:02} {letter}</text>'
            for side, letter in enumerate("AB")
        )
        both = (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDE + 20}" height="{high:.0f}" '
            f'font-family="{FONT}"><rect width="100%" height="100%" fill="#bbbbbb"/>{words}'
            f"{''.join(text for text, _ in parts)}</svg>"
        )
        (folder / f"{number:02}.png").write_bytes(png_bytes(both, "pair"))
        measures = {who: counted._asdict() for who, (_, counted) in found.items()}
        key[f"{number:02}"] = {"name": name, "A": names[0], "B": names[1], **measures}
    (folder / "key.json").write_text(json.dumps(key, indent=1), encoding="utf-8")


def _scaled(text: str, x: int) -> tuple[str, float]:
    """Return a picture to stand in another, as large as there is room for, and how high it is."""
    match = re.match(r'(<svg [^>]*?)width="([0-9.]+)" height="([0-9.]+)"', text)
    assert match is not None
    wide, high = float(match[2]), float(match[3])
    scale = min(WIDE / wide, HIGH / high, 1.5)
    size = f'x="{x}" y="30" width="{wide * scale:.1f}" height="{high * scale:.1f}"'
    return f"{match[1]}{size}{text[match.end() :]}", high * scale


def _drawn(picture: Picture, layout: Layout) -> tuple[str, Measured]:
    """Return a picture as it is drawn where `layout` places what it shows."""
    seen: list[Measured] = []

    def watched(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Drawing:
        drawing = layout(sizes, links)
        seen.append(measured(drawing, sizes, links))
        return drawing

    return svg_text(picture, layout=watched), seen[0]


def score(folder: Path) -> None:
    """Print who was better in each pair, and what was counted."""
    key = json.loads((folder / "key.json").read_text(encoding="utf-8"))
    wins = {"ours": 0, "dot": 0, "=": 0}
    print("| graph | better | crossings | through boxes | labels covered | length | area | bends |")
    print("|---|---|---|---|---|---|---|---|")
    for line in (folder / "verdicts.txt").read_text(encoding="utf-8").splitlines():
        number, letter, *_ = line.split(maxsplit=2)
        pair = key[number]
        who = pair.get(letter, "=")
        wins[who] += 1
        both = [(pair["ours"][field], pair["dot"][field]) for field in Measured._fields]
        counts = [f"{a}:{b}" for a, b in both[:3]] + [f"{a / b:.2f}" for a, b in both[3:]]
        print(f"| {number} {pair['name']} | {who} | {' | '.join(counts)} |")
    print(f"\nours {wins['ours']}, dot {wins['dot']}, neither {wins['=']}")
    for field in Measured._fields:
        pairs = [(pair["ours"][field], pair["dot"][field]) for pair in key.values()]
        fewer, more = sum(a < b for a, b in pairs), sum(a > b for a, b in pairs)
        ours, dot = map(sum, zip(*pairs, strict=True))
        print(f"{field}: ours {ours:.0f}, dot {dot:.0f}; ours less {fewer}, more {more}")


if __name__ == "__main__":
    {"draw": draw, "score": score}[sys.argv[1]](Path(sys.argv[2]))
