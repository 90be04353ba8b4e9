"""A picture in the language of Graphviz."""

from mars_asp.draw.colours import LINES, box_colours
from mars_asp.draw.graphviz import PORTS
from mars_asp.draw.picture import Box, Line, LineKind, Picture, numbers

_STYLES: dict[LineKind, str] = {
    "mount": "penwidth=3, arrowhead=dot",
    "data": "arrowhead=normal",
    "control": "style=dashed, arrowhead=normal",
    "reset": "style=dotted, arrowhead=normal",
    "lock": "style=dotted, arrowhead=normal",
    "limit": "style=dotted, arrowhead=normal",
}
_ESCAPES = str.maketrans({"\\": "\\\\", '"': '\\"', "&": "&amp;"})


def dot_text(picture: Picture) -> str:
    """Return a diagram in the language DOT; names are quoted."""
    parts = [
        "digraph {",
        f"  label={quoted(picture.title, picture.remark, *map(str, picture.marks))};",
        '  node [fontname="Helvetica", style=filled];',
        '  edge [fontname="Helvetica", fontsize=10];',
    ]
    parts += (f"  n{index} [{_box(box)}];" for index, box in enumerate(picture.boxes))
    parts += (f"  n{line.tail} -> n{line.head} [{_dot_style(line)}];" for line in picture.lines)
    return "\n".join([*parts, "}"]) + "\n"


def quoted(*lines: str) -> str:
    r"""Return lines as one quoted string of DOT, joined by `\n`."""
    return '"' + "\\n".join(line.translate(_ESCAPES) for line in lines if line) + '"'


def _box(box: Box) -> str:
    fill, stroke = box_colours(box)
    shape = "box" if box.node is None else 'box, style="filled,rounded"'
    shape = "circle" if box.node == "gate_node" else shape
    label = quoted(box.name, box.note, numbers(box.findings))
    width = ", penwidth=3" if box.findings else ""
    return f'label={label}, shape={shape}, fillcolor="{fill}", color="{stroke}"{width}'


def _dot_style(line: Line) -> str:
    colour = LINES[line.kind]
    text = quoted(*line.label.split("\n"), numbers(line.findings))
    label = f'label={text}, fontcolor="{colour}", ' if text != quoted() else ""
    style = _STYLES[line.kind] if line.sign is None else "style=dotted, arrowhead=normal"
    foot = ', headlabel="R"' if line.end == "foot" else ""
    return f'{label}color="{colour}", {style}{PORTS[line.end]}{foot}'
