"""Commands that an answer suggests can be pasted into a shell, whatever files are called."""

import json
import shlex
import sys
from importlib import metadata
from pathlib import Path
from unittest.mock import Mock

import pytest

from mars_asp.cli import run_here, suggested_commands
from tests.support.fixtures import Captured, Patch

ROBOT = """\
@configuration
@modules "left eye", Screen, Log, Spare
Screen uses_data_from "left eye"
Log uses_data_from "left eye"
Spare uses_data_from Nowhere
"""


@pytest.mark.parametrize(
    ("words", "before"),
    [
        (["explain", "--why-not", "DataSplitter1"], "Why: "),
        (["explain", "--why-not", 'data_divergence("left eye")'], "Why: "),
        (["explain", "--alternatives"], "See it break: "),
        (["analyse"], "For edits that remove the errors: "),
    ],
)
def test_a_suggested_command_works(
    words: list[str], before: str, tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "it's a robot.mars"
    file.write_text(ROBOT)
    verb, *rest = words
    run_here([verb, str(file), *rest, "--sources", str(tmp_path)])
    output = capsys.readouterr().out
    suggested = next(line for line in output.split("\n") if line.strip().startswith(before))
    program, *again = shlex.split(suggested.strip().removeprefix(before))
    assert program == "mars-asp"
    assert str(file) in again
    assert again[-2:] == ["--sources", str(tmp_path)]
    assert run_here(again) in (0, 1)
    assert capsys.readouterr().out.strip()


def test_suggested_commands_quote_names_and_keep_settings(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = "C is_controlled_by A 1\nC is_controlled_by B 1\n"
    text = f"@configuration hierarchical\n@modules A, B, C\n{lines}"
    Path("a b.mars").write_text(text)
    run_here(["check", "a b.mars", "--fix", "--isolated"])
    shown = " ".join(capsys.readouterr().err.split())
    assert "`mars-asp explain 'a b.mars' --repair --isolated`" in shown
    run_here(["check", "a b.mars", "--select", "control_convergence", "--format", "full"])
    assert "`mars-asp analyse 'a b.mars'`" in "".join(capsys.readouterr())


def test_programs_read_each_line_of_standard_error(tmp_path: Path, capsys: Captured) -> None:
    file = tmp_path / "fast.mars"
    file.write_text(
        "@configuration\n@modules A, B\nA uses_data_from B 400\n@module_start\n@module_name B\n"
        "@Sense NotifyAtFrequency 200\nImg f();\n@module_end\n"
    )
    name = str(file)
    for words in (
        ["synthesise", name],
        ["verify", "--without", "X", name],
        ["explain", name, "--alternatives"],
    ):
        assert run_here([*words, "--format", "json"]) == 1
        *_, last = map(json.loads, capsys.readouterr().err.splitlines())
        assert last["code"] == "unrealisable"
        assert last["path"] == name


def test_lines_are_shown_without_escapes_and_within_the_width(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    file = tmp_path / "t.mars"
    file.write_text(
        "@configuration\n@modules A,\tB, Unused\nA\tuses_data_from\tB\nA uses_data_from B\n"
    )
    run_here(["explain", str(file), "duplicate_relationship"])
    assert "t.mars:3  A uses_data_from B\n" in capsys.readouterr().out
    run_here(["check", str(file), "--format", "full"])
    (*_, counted, advice, _) = capsys.readouterr().err.split("\n")
    assert (counted, advice) == (
        "2 of them have exactly one repair, shown above; --fix",
        "  applies those that go together",
    )
    run_here(["check", str(file), "--fix"])
    fixed = [line for line in capsys.readouterr().err.split("\n") if not line.startswith("    ")]
    assert any(line.startswith("fixed") for line in fixed)
    assert all(len(line) <= 60 or len(line.split()) <= 2 for line in fixed), fixed
    run_here(["draw", str(file), "-o", "picture.unknown"])
    assert max(map(len, capsys.readouterr().err.split("\n"))) <= 60


UV = "uv tool install '/a/my clone[png]'"
PIPX = "pipx install --force '/c[png]'"
PIP = "python -m pip install -e '/c[png]'"


@pytest.mark.parametrize(
    ("origin", "mark", "expected"),
    [
        ('{"url": "file:///a/my%20clone", "dir_info": {}}', "uv-receipt.toml", UV),
        ('{"url": "file:///c", "dir_info": {"editable": true}}', "pipx_metadata.json", PIPX),
        ('{"url": "file:///c", "dir_info": {"editable": true}}', "pyvenv.cfg", PIP),
        (None, "uv-receipt.toml", "uv tool install 'mars-asp[png]'"),
    ],
)
def test_an_extra_is_added_in_the_way_of_the_installation(
    origin: str | None, mark: str, expected: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    (tmp_path / mark).touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr(sys, "executable", "python")
    found = Mock(read_text=lambda name: origin)
    monkeypatch.setattr(metadata, "distribution", lambda name: found)
    assert suggested_commands.way_to_install("png") == expected
