"""What rules say: the texts above them with holes, filled with values as people read them."""

import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import TypeVar

import clingo

_Value = TypeVar("_Value")
_HOLE = re.compile(r"\{([^{}]*)\}")


def fill(
    text: str | None, values: Mapping[str, _Value], show: Callable[[_Value], str]
) -> str | None:
    """Fill the `{Variable}` holes of a message with values as `show` writes them."""
    if text is None:
        return None
    form, holes = _form(text)
    if not holes:
        return text
    return form % tuple([show(values[h]) if h in values else f"{{{h}}}" for h in holes])


@cache
def _form(text: str) -> tuple[str, tuple[str, ...]]:
    """Return a message for `%`, and the names of its holes."""
    return _HOLE.sub("%s", text.replace("%", "%%")), tuple(_HOLE.findall(text))


def shown(symbol: clingo.Symbol) -> str:
    """Return a term as a message shows it: a string without its quotes, a list in words."""
    if symbol.type == clingo.SymbolType.String:
        return symbol.string
    names, more = _listed(symbol)
    if not names:
        return str(symbol)
    *others, last = [*names, *([f"{more} more"] if more else [])]
    return f"{', '.join(others)} and {last}" if others else last


def _listed(symbol: clingo.Symbol) -> tuple[list[str], int]:
    """Return the names in a list `and("A",and("B",N))`, and how many more N says there are."""
    names: list[str] = []
    while symbol.match("and", 2):
        first, symbol = symbol.arguments
        names.append(f"`{shown(first)}`")
    return names, symbol.number if symbol.type == clingo.SymbolType.Number else 0
