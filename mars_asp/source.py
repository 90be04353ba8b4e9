"""Stretches of files."""

from typing import NamedTuple


class Span(NamedTuple):
    """A stretch of one file; spans are in the order of their files.

    Lines and columns count from 1 in code points; a byte order mark counts for nothing; the
    end column is the first one behind the stretch. `path` is shown to users as it stands.
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int


def point(path: str, line: int, column: int) -> Span:
    """Return the empty span at one place."""
    return Span(path, line, column, line, column)
