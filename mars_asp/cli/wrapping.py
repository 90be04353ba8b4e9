"""The width of text for people, and its breaks into lines."""

import os
import re
import unicodedata
from collections.abc import Mapping
from contextlib import suppress

from mars_asp.asp.units import UNIT
from mars_asp.output import counted, listing

#: The width of a line by default.
_COLUMNS = 80
#: Text in fewer columns is unreadable.
_FEWEST = 20
#: A word, a command or a short text between backticks, and a number with its unit. A backtick after
#: a letter or a full stop closes the quoted text, even if that contains backticks.
_WORD = rf"(?:(?<![\w.`])`(?:mars-asp [^`]*|[^`]{{0,40}})`|\d (?={UNIT})|\S)+"
#: The rule or code at the end of a text.
_REFERENCE = "(?:\x1b\\[[0-9;]*m)*\\[[^\\s\\[]*\\](?:\x1b\\[[0-9;]*m)*"
_STYLE = re.compile("\x1b\\[[0-9;]*m")


def columns(stream: object) -> int:
    """Return the width of a stream in columns: `COLUMNS`, else the terminal's, else 80."""
    with suppress(ValueError):
        wanted = int(os.environ.get("COLUMNS", ""))
        if wanted > 0:
            return max(wanted, _FEWEST)
    isatty = getattr(stream, "isatty", None)
    # In a worker standard output is a pipe to the command, so each stream is tried.
    for number in (1, 2, 0) if isatty and isatty() else ():
        with suppress(OSError, ValueError):
            # A terminal of unknown size has 0 columns.
            if found := os.get_terminal_size(number).columns:
                return max(found, _FEWEST)
    return _COLUMNS


def cells(text: str) -> int:
    """Return the number of terminal columns of a text; styles have none."""
    if text.isascii():
        return len(_STYLE.sub("", text) if "\x1b" in text else text)
    return sum(map(_cells_of, _STYLE.sub("", text)))


def _cells_of(character: str) -> int:
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def wrapped(text: str, width: int, first: str = "", further: str = "") -> list[str]:
    """Return the lines of a text broken at blanks; only a longer word exceeds the width.

    A text between backticks is one word unless it is long. The first line begins with `first`, each
    further line with `further`. A reference alone on the last line takes the word before it along.
    """
    # Most sentences need one line.
    if len(first) + len(text) <= width and text.isascii() and " ".join(text.split()) == text:
        return [first + text]
    lines: list[list[str]] = [[]]
    taken = cells(first)
    for word in re.findall(_WORD, text):
        size = cells(word)
        if lines[-1] and taken + 1 + size > width:
            lines.append([])
            taken = cells(further)
        taken += size + bool(lines[-1])
        lines[-1].append(word)
    if len(lines) > 1 and len(lines[-2]) > 1 and re.fullmatch(_REFERENCE, " ".join(lines[-1])):
        if taken + 1 + cells(lines[-2][-1]) <= width:
            lines[-1].insert(0, lines[-2].pop())
    heads = [first, *(further for _ in lines[1:])]
    return [head + " ".join(words) for head, words in zip(heads, lines, strict=True)]


#: The units of costs that are numbers of things, by the names of the costs.
_UNITS = {"nodes": "node", "relationships": "relationship"}
_CONVERSION = "conversion"


def compared(extra: Mapping[str, int]) -> str:
    """Return differences of costs in words, or "costs the same" without any.

    `{"nodes": 1, "conversion": 2}` is `costs 1 node more, conversion cost +2`.
    """
    costs = [(unit, extra.get(name, 0)) for name, unit in _UNITS.items()]
    more = [counted(number, unit) for unit, number in costs if number > 0]
    less = [counted(-number, unit) for unit, number in costs if number < 0]
    words = [" and ".join(each) + than for each, than in ((more, " more"), (less, " less")) if each]
    differences = [f"costs {', but '.join(words)}"] if words else []
    conversion = extra.get(_CONVERSION, 0)
    if conversion:
        differences.append(f"conversion cost {conversion:+d}")
    return ", ".join(differences) or "costs the same"


def spent(costs: Mapping[str, int]) -> str:
    """Return costs in words, as in `2 nodes and 6 relationships`; "" if all are 0."""
    counts = [
        f"conversion cost {number}" if name == _CONVERSION else counted(number, _UNITS[name])
        for name, number in costs.items()
        if number
    ]
    return listing(counts)
