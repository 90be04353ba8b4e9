"""Fill in docs/explanation/case-study.md: `python benchmarks/case_study.py FOLDER`.

Each `sh` block of the page is a campaign, or a sign test of its runs; what it prints is written
into the `text` block that follows, of a campaign without its worst runs. The runs are kept in
FOLDER, and those that it has already are not carried out again.
"""

import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

PAGE = Path("docs/explanation/case-study.md")
BLOCK = re.compile(r"```sh\n(?P<command>[^\n]*)\n```\n\n```text\n.*?```", re.DOTALL)


def printed(words: Sequence[str], folder: Path) -> str:
    """Return what a command of the page prints, whose runs are in the folder.

    Raises:
        RuntimeError: the command did not come to its end.
    """
    _, *words = (str(folder / word) if word.endswith(".jsonl") else word for word in words)
    command = words if words[0].endswith(".py") else ["-m", "mars_asp", *words]
    done = subprocess.run([sys.executable, *command], check=False, capture_output=True, text=True)
    if done.returncode > 1 or done.stderr:
        raise RuntimeError(done.stderr)
    return re.split(r"^the worst", done.stdout, flags=re.MULTILINE)[0]


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)

    def filled(found: re.Match[str]) -> str:
        told = printed(shlex.split(found["command"]), folder)
        print(found["command"], told, sep="\n", flush=True)
        return f"```sh\n{found['command']}\n```\n\n```text\n{told}```"

    PAGE.write_text(BLOCK.sub(filled, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
