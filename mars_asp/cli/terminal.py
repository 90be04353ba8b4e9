"""How wide the lines of text on standard output can be."""

import os
import sys
from contextlib import suppress

from mars_asp.asp.trace.text import WIDTH

#: Narrower than that nothing can be read.
_LEAST = 40


def width() -> int:
    """Return the width of standard output: `COLUMNS`, else the terminal's, else 80."""
    stated = os.environ.get("COLUMNS", "")
    if stated.isascii() and stated.isdigit() and int(stated) > 0:
        return max(int(stated), _LEAST)
    if sys.stdout is not None and sys.stdout.isatty():
        # A worker writes through a pipe; the terminal is behind another descriptor.
        for descriptor in (1, 2, 0):
            with suppress(OSError):
                return max(os.get_terminal_size(descriptor).columns, _LEAST)
    return WIDTH
