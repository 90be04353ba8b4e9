"""The command as a process of its own."""

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from mars_asp.cli.arguments import VERBS
from tests.support.documents import ROOT

#: Messages in one line, however long they are, and nothing coloured.
PLAIN = {"COLUMNS": "1000", "NO_COLOR": "1"}
#: Forks a process for each command, so that the package is imported once.
_SERVER = multiprocessing.get_context("forkserver")
_SERVER.set_forkserver_preload(
    ["mars_asp.__main__", "mars_asp.cli.worker", *(f"mars_asp.cli.{verb}" for verb in VERBS)]
)


def mars(
    *words: str, text: str | None = None, folder: Path = ROOT
) -> subprocess.CompletedProcess[str]:
    """Run a command in a process that has imported the package already."""
    with TemporaryDirectory() as beside:
        streams = [Path(beside, name) for name in ("in", "out", "err")]
        streams[0].write_text(text or "", encoding="utf-8")
        process = _SERVER.Process(target=_run, args=(words, folder, streams))
        process.start()
        process.join()
        output, errors = (
            path.read_bytes().decode("utf-8", "surrogateescape") for path in streams[1:]
        )
        assert process.exitcode is not None
        return subprocess.CompletedProcess(words, process.exitcode, output, errors)


def _run(words: tuple[str, ...], folder: Path, streams: list[Path]) -> None:
    """Replace the standard streams and run the command line."""
    os.chdir(folder)
    os.environ.update(PLAIN)
    for number, path in enumerate(streams):
        flags = os.O_WRONLY | os.O_CREAT if number else os.O_RDONLY
        os.dup2(os.open(path, flags), number)
    # As the interpreter opens them, and for the whole command.
    sys.stdin = open(0, encoding="utf-8")  # noqa: SIM115
    sys.stdout = open(1, "w", encoding="utf-8")  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", buffering=1)  # noqa: SIM115
    from mars_asp.__main__ import main

    sys.argv = ["mars-asp", *words]
    sys.exit(main())
