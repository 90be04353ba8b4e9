"""A picture in the language of Mermaid, which code hosts show in Markdown."""

from mars_asp.draw.colours import LINES, box_colours
from mars_asp.draw.picture import Box, Line, LineKind, Picture, numbers

_ARROWS: dict[LineKind, str] = {
    "mount": "===",
    "data": "-->",
    "control": "-.->",
    "reset": "-.->",
    "lock": "-.->",
    "limit": "-.->",
}
_PLAIN = frozenset(" ()[]{}.,:+-=/_→…")


def mermaid_text(picture: Picture) -> str:
    """Return a diagram as Mermaid; special characters in names are written as codes."""
    parts = ["flowchart TD"]
    if picture.remark:
        parts.append(f"  %% {picture.remark}")
    for each in picture.marks:
        parts.append(f"  %% {''.join(map(_code, str(each).replace('`', '')))}")
    parts += (f"  n{index}{_box(box)}" for index, box in enumerate(picture.boxes))
    parts += (_mermaid_edge(line) for line in picture.lines)
    for index, box in enumerate(picture.boxes):
        fill, stroke = box_colours(box)
        width = ",stroke-width:3px" if box.findings else ""
        parts.append(f"  style n{index} fill:{fill},stroke:{stroke},color:#1a1a1a{width}")
    for index, line in enumerate(picture.lines):
        colour, width = LINES[line.kind], "3px" if line.kind == "mount" else "1.6px"
        parts.append(f"  linkStyle {index} stroke:{colour},stroke-width:{width},color:{colour}")
    return "\n".join(parts) + "\n"


def quoted(*lines: str) -> str:
    """Return lines as one quoted text of Mermaid."""
    return '"' + "<br/>".join("".join(map(_code, line)) for line in lines if line) + '"'


def _code(character: str) -> str:
    return character if character.isalnum() or character in _PLAIN else f"#{ord(character)};"


def _box(box: Box) -> str:
    text = quoted(box.name, box.note, numbers(box.findings))
    if box.node == "gate_node":
        return f"(({text}))"
    return f"[{text}]" if box.node is None else f"([{text}])"


def _mermaid_edge(line: Line) -> str:
    letter = "R" if line.end == "foot" else ""
    text = quoted(*line.label.split("\n"), letter, numbers(line.findings))
    label = f"|{text}|" if text != quoted() else ""
    arrow = _ARROWS["control" if line.sign else line.kind]
    return f"  n{line.tail} {arrow}{label} n{line.head}"
