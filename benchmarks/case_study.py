"""Carry out the campaigns of docs/case-study.md: `python benchmarks/case_study.py FOLDER`.

Each `sh` block of the page is a campaign; what its table shows is written into the `text` block
that follows. The runs are kept in FOLDER, and those that it has already are not carried out again.
"""

import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

PAGE = Path("docs/case-study.md")
_CAMPAIGN = re.compile(
    r"```sh\n(?P<command>mars-asp campaign [^\n]*)\n```\n\n```text\n.*?```", re.DOTALL
)


def campaigns(page: str) -> list[list[str]]:
    """Return the words of each command of the page, after `mars-asp`."""
    return [shlex.split(found["command"])[1:] for found in _CAMPAIGN.finditer(page)]


def table(words: Sequence[str], folder: Path) -> str:
    """Return what a campaign shows, without its worst runs; `-o` names a file of the folder.

    Raises:
        RuntimeError: the command did not come to its end.
    """
    here = [str(folder / word) if word.endswith(".jsonl") else word for word in words]
    command = [sys.executable, "-m", "mars_asp", *here]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode > 1:
        raise RuntimeError(done.stderr)
    return re.split(r"^the worst", done.stdout, flags=re.MULTILINE)[0]


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)

    def filled(found: re.Match[str]) -> str:
        told = table(shlex.split(found["command"])[1:], folder)
        print(found["command"], told, sep="\n", flush=True)
        return f"```sh\n{found['command']}\n```\n\n```text\n{told}```"

    PAGE.write_text(_CAMPAIGN.sub(filled, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
