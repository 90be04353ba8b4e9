"""The progress of a command, shown on standard error if that is a terminal.

One line is replaced again and again, and removed at the end. It is written by hand: rich hides the
cursor, and a worker that is killed could not show it again.
"""

import argparse
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from mars_asp.output import visible

#: Seconds until a stage or a bar is shown: shorter ones would only flicker.
_PATIENCE = 1.0
#: Seconds between two lines: users cannot read faster, and a terminal takes time.
_SPACING = 0.1
_BAR = 30
_T = TypeVar("_T")


@contextmanager
def stage(arguments: argparse.Namespace, name: str) -> Iterator[None]:
    """Show the name of a slow stage while the block runs; with `--verbose`, print its duration."""
    if getattr(arguments, "verbose", False):
        started = time.monotonic()
        yield
        detail(arguments, f"{name}: {time.monotonic() - started:.2f} s")
        return
    if not _is_watched(arguments):
        yield
        return
    # Grounding and parsing do not return before they are done, so another thread shows the name.
    shown = threading.Event()

    def show() -> None:
        shown.set()
        _write(f"{name} ...")

    timer = threading.Timer(_PATIENCE, show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        if shown.is_set():
            _write("")


def detail(arguments: argparse.Namespace, text: str) -> None:
    """Print a line on standard error if `--verbose` is set."""
    if getattr(arguments, "verbose", False):
        print(visible(f"mars-asp: {text}"), file=sys.stderr)


@contextmanager
def progress_bar(
    arguments: argparse.Namespace, noun: str
) -> Iterator[Callable[[int, int], None] | None]:
    """Yield a function (done, total) that shows the progress, or None without a terminal."""
    if not _is_watched(arguments):
        yield None
        return

    def line(at: tuple[int, int], _: float) -> str:
        done, total = at
        width = _BAR * done // max(1, total)
        return f"[{'#' * width}{'.' * (_BAR - width)}] {done} of {total} {noun}"

    with live_line(arguments, line, _PATIENCE) as show:
        yield lambda done, total: show((done, total))


@contextmanager
def live_line(
    arguments: argparse.Namespace, line_of: Callable[[_T, float], str], patience: float = 0.0
) -> Iterator[Callable[[_T], None]]:
    """Yield a function that shows a state as a line.

    Args:
        arguments: The command line; nothing is shown with `--quiet`.
        line_of: Returns the line of a state, after a number of seconds.
        patience: The number of seconds before the first line.
    """
    if not _is_watched(arguments):
        yield lambda state: None
        return
    started = time.monotonic()
    shown: float | None = None

    def show(state: _T) -> None:
        nonlocal shown
        wall = time.monotonic() - started
        if wall >= (patience if shown is None else shown + _SPACING):
            shown = wall
            _write(line_of(state, wall))

    try:
        yield show
    finally:
        if shown is not None:
            _write("")


def clear_line() -> None:
    """Remove the line of progress, which a killed worker may have left."""
    if sys.stderr.isatty():
        _write("")


def _is_watched(arguments: argparse.Namespace) -> bool:
    return not arguments.quiet and sys.stderr.isatty()


def _write(text: str) -> None:
    """Replace the line of progress."""
    try:
        columns = os.get_terminal_size(sys.stderr.fileno()).columns
    except (OSError, ValueError):
        columns = 0
    # A terminal without a known size has 0 columns. A line that fills the last column cannot be
    # replaced.
    columns = (columns or 80) - 1
    line = visible(text)[:columns]
    print(f"\r{line.ljust(columns)}\r{line}", end="", file=sys.stderr, flush=True)
