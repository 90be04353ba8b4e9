"""Commands in Markdown: lines after `$ ` in a `console` block, with their output."""

import io
import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[2]
#: The file of a campaign, which a command of a document writes elsewhere.
RUNS = "runs.jsonl"
_BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def commands(document: Path) -> Iterator[tuple[str, str]]:
    """Yield each command with the output that the document shows."""
    for block in _BLOCK.finditer(document.read_text(encoding="utf-8")):
        for part in re.split(r"^\$ ", block[1], flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            yield command, output


def questions(path: Path) -> list[tuple[str, str]]:
    """Return the commands in a file, each after `$ `, with the output that follows."""
    parts = f"\n{path.read_text(encoding='utf-8')}".split("\n$ ")[1:]
    return [(command.strip(), output) for command, _, output in (p.partition("\n") for p in parts)]


def answered(path: Path, command: str, expected: str, update_golden: bool) -> str:
    """Return the output of a command; write it to the file, or check it against `expected`."""
    found = run(command)
    if update_golden:
        text = path.read_text(encoding="utf-8")
        text = text.replace(f"{command}\n{expected}", f"{command}\n{found.strip()}\n")
        path.write_text(text, encoding="utf-8")
    else:
        assert found.strip() == expected.strip()
    return found


def run(command: str, folder: Path = ROOT) -> str:
    """Run a `mars-asp`, `python` or `cat` command in a folder; return its output."""
    from mars_asp.cli import run_here

    words = shlex.split(command)
    if words[0] == "cat":
        return "".join((folder / name).read_text(encoding="utf-8") for name in words[1:])
    if words[0] == "python":
        return _run_script(words[1:], folder)
    assert words[0] == "mars-asp", command
    here = Path.cwd()
    output = io.StringIO()
    try:
        os.chdir(folder)
        with (
            TemporaryDirectory() as away,
            redirect_stdout(output),
            redirect_stderr(output),
        ):
            run_here([f"{away}/{word}" if word == RUNS else word for word in words[1:]])
    finally:
        os.chdir(here)
    return output.getvalue()


def _run_script(words: list[str], folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, *words],
        check=False,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    return done.stdout + done.stderr


#: A command whose output is JSON, and the block below it.
JSON = re.compile(r"^`(mars-asp [^`]+)`:\n\n```(jsonl?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def json_block(command: str, language: str) -> str:
    """Return the JSON that a command prints, laid out for a page; JSON lines as they are."""
    from mars_asp.cli import run_here

    words = shlex.split(command)[1:]
    output, errors = io.StringIO(), io.StringIO()
    both = words[-1] == "2>&1"
    here = Path.cwd()
    try:
        os.chdir(ROOT)
        with redirect_stdout(output), redirect_stderr(output if both else errors):
            run_here(words[:-1] if both else words)
    finally:
        os.chdir(here)
    text = output.getvalue()
    return text if language == "jsonl" else f"{_laid_out(json.loads(text), 0)}\n"


def _laid_out(value: object, indent: int, width: int = 150) -> str:
    """Return JSON with as many elements in a line as fit, containers that do not on their own."""
    flat = json.dumps(value, ensure_ascii=False)
    if len(flat) + indent <= width or not isinstance(value, dict | list) or not value:
        return flat
    keys = [f"{json.dumps(key, ensure_ascii=False)}: " for key in value if isinstance(value, dict)]
    elements = value.values() if isinstance(value, dict) else value
    text, room = "{" if isinstance(value, dict) else "[", width - indent - 1
    for key, element in zip_longest(keys, elements, fillvalue=""):
        part = f"{key}{_laid_out(element, indent + 1)}"
        first = part.partition("\n")[0]
        if len(text) == 1 or ("\n" not in part and len(part) + 2 <= room):
            text += part if len(text) == 1 else f", {part}"
        else:
            text, room = f"{text},\n{' ' * (indent + 1)}{part}", width - indent - 1
        room = -1 if "\n" in part else room - len(first) - 2
    return text + ("}" if isinstance(value, dict) else "]")


def refresh_json(document: Path) -> None:
    """Write the real output of every command that prints JSON into a document."""

    def block(match: re.Match[str]) -> str:
        return f"`{match[1]}`:\n\n```{match[2]}\n{json_block(match[1], match[2])}```"

    text = document.read_text(encoding="utf-8")
    document.write_text(JSON.sub(block, text), encoding="utf-8")


def refresh(document: Path) -> None:
    """Write the real output of every command into a document."""

    def block(match: re.Match[str]) -> str:
        parts = []
        for part in re.split(r"^\$ ", match[1], flags=re.MULTILINE)[1:]:
            command = part.partition("\n")[0]
            parts.append(f"$ {command}\n{run(command)}")
        return "```console\n" + "".join(parts) + "```"

    text = document.read_text(encoding="utf-8")
    document.write_text(_BLOCK.sub(block, text), encoding="utf-8")
