"""Fill in docs/explanation/case-study.md: `python benchmarks/case_study.py FOLDER`.

Each `text` block of the page is a campaign, or a sign test of its runs, and its output, that of a
campaign without its worst runs and the rows that `LEFT_OUT` matches.
The runs are kept in FOLDER, and those that it has already are not carried out again.
"""

import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

PAGE = Path("docs/explanation/case-study.md")
#: Rows of a table of a campaign, with the rows of its settings below each.
LEFT_OUT = re.compile(
    r"^(?:no_collision|(?:Forward|Turn|Avoid|Forward\+Turn) in control|least clearance|warnings in)"
    r"\b.*\n(?: .*\n)*",
    re.MULTILINE,
)
BLOCK = re.compile(r"```text\n\$ (?P<command>[^\n]*)\n.*?```", re.DOTALL)


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
    return LEFT_OUT.sub("", re.split(r"^the worst", done.stdout, flags=re.MULTILINE)[0])


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)

    def filled(found: re.Match[str]) -> str:
        told = printed(shlex.split(found["command"]), folder)
        print(found["command"], told, sep="\n", flush=True)
        return f"```text\n$ {found['command']}\n{told}```"

    PAGE.write_text(BLOCK.sub(filled, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
