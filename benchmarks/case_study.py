"""Fill in docs/explanation/case-study.md: `python benchmarks/case_study.py FOLDER`.

Each `text` block of the page has a campaign and its output, without its worst runs and the rows
that `LEFT_OUT` matches, or the output of sign tests, and before them the campaigns of their runs.
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
    r"^(?:no_collision|coverage|(?:Forward|Turn|Avoid|Forward\+Turn) in control|least clearance"
    r"|warnings in)\b.*\n(?: .*\n)*",
    re.MULTILINE,
)
BLOCK = re.compile(r"```text\n(?P<commands>(?:\$ [^\n]*\n)+).*?```", re.DOTALL)


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
        commands = [line.removeprefix("$ ") for line in found["commands"].splitlines()]
        outputs = [printed(shlex.split(command), folder) for command in commands]
        print(*(text for pair in zip(commands, outputs, strict=True) for text in pair), sep="\n")
        kept = [
            text for command, text in zip(commands, outputs, strict=True) if "sign_test" in command
        ]
        return f"```text\n{found['commands']}{''.join(kept or outputs)}```"

    PAGE.write_text(BLOCK.sub(filled, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
