"""Colours of diagrams, after Okabe and Ito, which colour-blind readers can distinguish."""

from mars_asp.diagnostic import Severity
from mars_asp.draw.picture import Box, LineKind

LINES: dict[LineKind, str] = {
    "mount": "#6b6b6b",
    "data": "#0072b2",
    "control": "#c04f00",
    "reset": "#00735a",
    "lock": "#8f3a80",
    "limit": "#8f3a80",
}
#: The text of a legend for each kind of line, in the direction of the line.
MEANINGS: dict[LineKind, str] = {
    "mount": "is mounted on",
    "data": "data flows",
    "control": "control flows",
    "reset": "resets (R)",
    "lock": "locks",
    "limit": "limits",
}
INK, QUIET = "#1a1a1a", "#5a5a5a"
#: Of findings: text and outline, and a halo of lines, which is lighter than any line.
FINDINGS: dict[Severity, tuple[str, str]] = {
    "error": ("#a80000", "#f6c4c0"),
    "warning": ("#7a4300", "#fbe3ae"),
}
_MODULE, _ALONE = ("#ffffff", "#333333"), ("#f4f4f4", "#9a9a9a")
_DATA_NODE = ("#dcedf8", "#0072b2")
_CONTROL_NODE = ("#fce6d6", "#c04f00")


def box_colours(box: Box) -> tuple[str, str]:
    """Return the colours of a box: inside, outline."""
    if box.alone:
        return _ALONE
    if box.node is None:
        return _MODULE
    inside, outline = _DATA_NODE if box.carries == "data" else _CONTROL_NODE
    return box.colour or inside, outline
