"""The layout of Graphviz, where its program `dot` is installed."""

import json
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence

from mars_asp.draw.layered import NEAR, Drawing, LayeredEdge, Point, Route, Size
from mars_asp.draw.picture import LinkEnd

#: Attributes of edges by the part of a box at which they end.
PORTS: Mapping[LinkEnd, str] = {"top": "", "side": ", headport=e", "foot": ", headport=s"}
#: Graphviz measures boxes in inches of so many px.
_INCH = 72


class NoGraphvizError(Exception):
    """The program `dot` is missing or failed; the argument is the reason."""


def draw_by_dot(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Drawing:
    """Return the positions of boxes and links in the layout by `dot` of Graphviz.

    Raises:
        NoGraphvizError: `dot` is not installed, or fails.
    """
    program = shutil.which("dot")
    if program is None:
        raise NoGraphvizError("the program `dot` is not installed")
    text = "\n".join(_graph(sizes, links))
    run = subprocess.run(
        [program, "-Tjson0"], input=text, capture_output=True, text=True, check=False
    )
    if run.returncode:
        raise NoGraphvizError(f"`dot` failed: {run.stderr.strip() or run.returncode}")
    graph = json.loads(run.stdout)
    left, low, right, high = map(float, graph["bb"].split(","))

    def point(text: str) -> Point:
        x, y = map(float, text.split(","))
        return x - left, high - y

    centres = {int(each["name"]): point(each["pos"]) for each in graph.get("objects", ())}
    routes = {
        int(each["id"]): Route(
            tuple(map(point, each["pos"].split())), point(each["lp"]) if "lp" in each else None
        )
        for each in graph.get("edges", ())
    }
    return Drawing(
        (right - left, high - low),
        tuple(centres[index] for index in range(len(sizes))),
        tuple(routes[index] for index in range(len(links))),
    )


def _graph(sizes: Sequence[Size], links: Sequence[LayeredEdge]) -> Iterator[str]:
    """Yield the lines of a graph for `dot`, in which boxes are numbers without names."""
    yield f'digraph {{ nodesep={NEAR / _INCH:.3f}; node [shape=box, label="", fixedsize=true];'
    for index, (width, height) in enumerate(sizes):
        yield f"{index} [width={width / _INCH:.3f}, height={height / _INCH:.3f}];"
    for index, link in enumerate(links):
        label = ""
        if link.label is not None:
            # An empty label of this size, with a distance from the line at its side.
            width, height = link.label
            size = f'fixedsize="true" width="{width + 8:.0f}" height="{height:.0f}"'
            table = f'<table border="0" cellborder="0" {size}><tr><td></td></tr></table>'
            label = f", label=<{table}>"
        yield f"{link.tail} -> {link.head} [id={index}, arrowhead=none{PORTS[link.end]}{label}];"
    yield "}"
