"""Who won at an arbiter from when on and why, in rows that people read."""

from collections.abc import Iterator, Sequence

#: An instant in seconds, who held control from then on, and why.
Row = tuple[float, str, str]

#: Two winners that take turns so often or more are told once.
_TURNS = 20


def in_turn(rows: Sequence[Row]) -> Iterator[Row]:
    """Yield rows; of two winners that take turns for the same reasons only the first turn of each.

    A third row tells how often they go on, and until when.
    """
    at = 0
    while at < len(rows):
        end = at + 2
        while end < len(rows) and rows[end][1:] == rows[end - 2][1:]:
            end += 1
        if end - at < _TURNS:
            yield rows[at]
            at += 1
            continue
        yield from rows[at : at + 2]
        more, until = end - at - 2, rows[end - 1][0]
        yield rows[at + 2][0], "...", f"and so on in turn, {more} more times until {until:.3f} s"
        at = end
