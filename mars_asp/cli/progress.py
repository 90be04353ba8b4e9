"""How far a command has come, on standard error, where a person is watching."""

import argparse
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mars_asp.output import visible

#: Nobody needs a bar for what is over before it could be read.
_PATIENCE = 1.0
#: Seconds between two bars: more often is not read, and a terminal takes time.
_SPACING = 0.1


@contextmanager
def stage(arguments: argparse.Namespace, what: str) -> Iterator[None]:
    """Show what is being done where that takes long and a person is watching.

    With `--verbose` the duration is printed instead.
    """
    if getattr(arguments, "verbose", False):
        started = time.monotonic()
        yield
        detail(arguments, f"{what}: {time.monotonic() - started:.2f} s")
        return
    if arguments.quiet or not sys.stderr.isatty():
        yield
        return
    # What grounds or parses does not come back before it is done, so another thread has to tell.
    shown = threading.Event()

    def tell() -> None:
        shown.set()
        _show(f"{what} ...")

    timer = threading.Timer(_PATIENCE, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        if shown.is_set():
            clear_line()


def detail(arguments: argparse.Namespace, text: str) -> None:
    """Print a line on standard error, with `--verbose` alone."""
    if getattr(arguments, "verbose", False):
        print(visible(f"mars-asp: {text}"), file=sys.stderr)


@contextmanager
def progress_bar(
    arguments: argparse.Namespace, what: str
) -> Iterator[Callable[[int, int], None] | None]:
    """Yield a function that is told how many of how many are done."""
    if arguments.quiet or not sys.stderr.isatty():
        yield None
        return
    started = time.monotonic()
    shown: float | None = None

    def progress(done: int, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - started < _PATIENCE or (shown is not None and now - shown < _SPACING):
            return
        shown = now
        width = 30 * done // max(1, total)
        bar = "#" * width + "." * (30 - width)
        _show(f"[{bar}] {done} of {total} {what}")

    try:
        yield progress
    finally:
        if shown is not None:
            clear_line()


def _show(text: str) -> None:
    print(f"\r{text:<78.78}", end="", file=sys.stderr, flush=True)


def clear_line() -> None:
    """Clear the line that tells how far the command is, where a person is watching."""
    if sys.stderr.isatty():
        print("\r" + " " * 78 + "\r", end="", file=sys.stderr, flush=True)
