"""The winners at an arbiter with the times and reasons, in rows for the text of a run."""

from collections.abc import Iterator, Sequence

#: An instant in seconds, the holder of control from then on, and the reason.
Row = tuple[float, str, str]

#: Two winners that take turns at least so often are listed once.
_TURNS = 20


def in_turn(rows: Sequence[Row]) -> Iterator[Row]:
    """Yield rows of winners; where two alternate for long, only their first turns and a count."""
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
