"""Entry point: `mars-asp VERB ...` and `python -m mars_asp VERB ...`."""

import gc
import io
import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType


def main(words: Sequence[str] | None = None) -> int:
    """Run a command line, that of the process by default; return the exit status."""
    _end_plainly()
    # What is imported stays, so looking for cycles in it is lost time; a worker looks for its own.
    gc.disable()
    _open_what_is_closed()
    for stream in (sys.stdout, sys.stderr):
        # What we print is read again as UTF-8, and some systems would write something else.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace")
    from mars_asp.cli import run_command

    return run_command(sys.argv[1:] if words is None else words)


def _end_plainly() -> None:
    """Exit without a traceback at signals that come before the command handles them."""

    def end(number: int, frame: FrameType | None) -> None:
        os._exit(128 + number)

    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT"):
        number = getattr(signal, name, None)
        # Keep ignoring signals that were ignored at start (nohup, `&`).
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)


def _open_what_is_closed() -> None:
    """Open standard streams that are closed, so that no other file gets their descriptors.

    Writing to standard output still fails, and writing to standard error has no effect.
    """
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)
    if sys.stdin is None:
        sys.stdin = open(0, encoding="utf-8")  # noqa: SIM115 -- for the whole command
    if sys.stdout is None:
        sys.stdout = io.TextIOWrapper(io.FileIO(1, "w", closefd=False))
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8")  # noqa: SIM115


if __name__ == "__main__":
    sys.exit(main())
