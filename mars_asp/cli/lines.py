"""Lines of files, as traces show them."""

import linecache

from mars_asp.diagnostic import Span

#: Two lines of a terminal say what a place is about; who wants more has its line and column.
MOST = 150


def line_at(span: Span) -> str:
    """Return the line of a file where something stands, of a long one what stands around it."""
    return shortened(linecache.getline(span.path, span.line), span.column)


def shortened(line: str, column: int) -> str:
    """Return a line without the white space around it, cut to whole words around a column.

    Columns count from 1. The first word stays, as it says what kind of line it is.
    """
    bare = line.strip()
    if len(bare) <= MOST:
        return bare
    place = column - 1 - (len(line) - len(line.lstrip()))
    start = 0
    if place > MOST // 2:
        # A word without end is cut all the same.
        start = max(bare.rfind(" ", 0, place - MOST // 3) + 1, place - MOST // 2)
    end = start + MOST
    if end < len(bare):
        space = bare.rfind(" ", place, end)
        end = end if space < 0 else space
    first = bare[:start].partition(" ")[0]
    before = "" if not start else f"{first} ... " if len(first) < MOST // 6 else "... "
    return f"{before}{bare[start:end]}{' ...' if end < len(bare) else ''}"
