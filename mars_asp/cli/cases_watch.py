"""Case files that run again whenever they or their rules change."""

import argparse
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stdout, suppress
from pathlib import Path

from mars_asp.cli.diagnostic_text import report_error
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.cases.places import pack_of_case
from mars_asp.reasoning.packs import MANIFEST

#: Seconds between two checks of the files.
_BEAT = 0.3
_PATTERNS = ("*.lp", "*.mars", MANIFEST)


def watched(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Run cases now and after each change, until the command is interrupted."""
    while True:
        # The standard output of a worker is shown when it ends, and this one does not end.
        before = _stamps(arguments)
        with redirect_stdout(sys.stderr):
            try:
                run(arguments)
            except MarsError as error:
                report_error(error, arguments)
            print("waiting for a change; Ctrl-C ends this", flush=True)
        while _stamps(arguments) == before:
            time.sleep(_BEAT)


def _stamps(arguments: argparse.Namespace) -> Mapping[Path, tuple[int, int]]:
    """Return the time of the last change of each file, and its size."""
    found: dict[Path, tuple[int, int]] = {}
    for path in _watched_files(arguments):
        with suppress(OSError):
            state = path.stat()
            found[path] = state.st_mtime_ns, state.st_size
    return found


def _watched_files(arguments: argparse.Namespace) -> Iterator[Path]:
    for path in map(Path, (*arguments.paths, *arguments.rules)):
        pack = pack_of_case(path) or pack_of_case(path / "any.lp")
        for folder in (path, *((pack,) if pack else ())):
            if folder.is_dir():
                for pattern in _PATTERNS:
                    yield from folder.rglob(pattern)
            else:
                yield folder
