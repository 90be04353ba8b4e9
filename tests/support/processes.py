"""The command as a process of its own."""

import os
import subprocess
import sys

from tests.support.documents import ROOT

#: Messages in one line, however long they are, and nothing coloured.
PLAIN = {"COLUMNS": "1000", "NO_COLOR": "1"}


def mars(*words: str, text: str | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "mars_asp", *words],
        cwd=ROOT,
        env={**os.environ, **PLAIN},
        input=text,
        capture_output=True,
        text=True,
        check=False,
    )
