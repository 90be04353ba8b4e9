"""A progress bar on standard error, where a person is watching."""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Nobody needs a bar for what is over before it could be read.
_PATIENCE = 1.0


@contextmanager
def progress_bar(
    arguments: argparse.Namespace, what: str
) -> Iterator[Callable[[int, int], None] | None]:
    """Yield a function that is told how many of how many are done."""
    if arguments.quiet or not sys.stderr.isatty():
        yield None
        return
    started = time.monotonic()
    shown = False

    def progress(done: int, total: int) -> None:
        nonlocal shown
        if time.monotonic() - started < _PATIENCE or done % 50:
            return
        shown = True
        width = 30 * done // max(1, total)
        bar = "#" * width + "." * (30 - width)
        print(f"\r[{bar}] {done} of {total} {what}", end="", file=sys.stderr, flush=True)

    try:
        yield progress
    finally:
        if shown:
            print("\r" + " " * 78 + "\r", end="", file=sys.stderr, flush=True)
