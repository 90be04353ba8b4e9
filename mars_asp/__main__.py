"""Entry point: `mars-asp VERB ...` and `python -m mars_asp VERB ...`."""

import gc
import io
import sys

#: A command lives shortly and its values hold no cycles; looking for some at Python's own pace
#: would take a tenth of its time.
COLLECT_AFTER = 100_000


def main() -> int:
    """Run the command line; return the exit status."""
    gc.set_threshold(COLLECT_AFTER)
    for stream in (sys.stdout, sys.stderr):
        # What we print is read again as UTF-8, and some systems would write something else.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="backslashreplace")
    from mars_asp.cli import run_command

    return run_command(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
