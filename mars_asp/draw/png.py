"""A picture as PNG: the SVG, rasterised by resvg."""

from math import sqrt
from xml.etree.ElementTree import fromstring

from mars_asp.diagnostic import refusal
from mars_asp.draw.shapes import FONT

_ZOOM = 2.0
#: Each takes four bytes while it is drawn.
_MOST_PIXELS = 40_000_000
_LETTER = '<svg xmlns="http://www.w3.org/2000/svg" width="20" height="20">{}</svg>'
_TEXT = f'<text x="2" y="16" font-family="{FONT}">M</text>'


def png_bytes(svg: str, path: str, way: str = "install the extra `png`") -> bytes:
    """Return the SVG of a diagram as PNG at twice its size, or smaller if that is too large.

    Messages name `path`, and `way`, how to install resvg.

    Raises:
        MarsError: resvg is not installed, or finds no font.
    """
    try:
        from resvg_py import svg_to_bytes  # noqa: PLC0415 -- of the extra `png`
    except ImportError:
        message = "a PNG needs the package `resvg_py`, which is not installed"
        advice = f"{way}, or write an `.svg`"
        raise refusal("png", message, path, advice) from None
    # Without a font that it knows, resvg leaves out text without a word.
    with_letter = svg_to_bytes(svg_string=_LETTER.format(_TEXT))
    if with_letter == svg_to_bytes(svg_string=_LETTER.format("")):
        message = "a PNG needs a sans-serif font, and no known one is installed"
        raise refusal("png", message, path, "install one, such as DejaVu Sans, or write an `.svg`")
    root = fromstring(svg)
    area = float(root.attrib["width"]) * float(root.attrib["height"])
    return bytes(svg_to_bytes(svg_string=svg, zoom=min(_ZOOM, sqrt(_MOST_PIXELS / area))))
