"""Colours of the terminal."""

_CODES = {"error": "31", "warning": "33", "note": "36", "dim": "2", "strong": "1"}


def paint(text: str, style: str, coloured: bool) -> str:
    """Return a text in a style, where colours are wanted."""
    return f"\x1b[{_CODES[style]}m{text}\x1b[0m" if coloured else text
