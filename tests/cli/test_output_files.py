"""Outputs are none of the inputs, and each has a file of its own."""

import os
from collections.abc import Sequence
from pathlib import Path

import pytest

from mars_asp.cli import deliver, run_here
from tests.support.fixtures import Captured, Patch

ROBOT = "@configuration flat\n@include b.mars\n@modules A\n"
SCENARIO = '[robot]\nmodule = "A"\n'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("a.mars").write_text(ROBOT)
    Path("b.mars").write_text("@configuration flat\n@modules B\n")
    Path("s.toml").write_text(SCENARIO)
    Path("link").symlink_to("a.mars")
    Path("hard.mars").hardlink_to("b.mars")
    Path("mars.toml").write_text("ignore = []\n")
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        ["synthesise", "a.mars", "-o", "a.mars"],
        ["synthesise", "a.mars", "-o", "./link"],
        ["synthesise", "a.mars", "-o", "b.mars"],
        ["synthesise", "a.mars", "-o", "hard.mars"],
        ["check", "a.mars", "--write-baseline", "a.mars"],
        ["check", "a.mars", "--write-baseline", "mars.toml"],
        ["campaign", "a.mars", "--scenario", "s.toml", "--seeds", "1", "-o", "s.toml", "--fresh"],
        ["run", "a.mars", "--scenario", "s.toml", "--report", "x.html", "--replay", "./x.html"],
    ],
)
def test_an_output_that_is_an_input_or_another_output_is_refused(
    words: Sequence[str], folder: Path, capsys: Captured
) -> None:
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert run_here(words) == 2
    output = capsys.readouterr()
    assert "give " in output.out + output.err
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_an_output_replaces_a_file_that_was_not_read(folder: Path) -> None:
    Path("old.mars").write_text("old")
    assert run_here(["synthesise", "a.mars", "-o", "old.mars"]) == 0
    assert "@specification" in Path("old.mars").read_text()
    Path("mars.toml").write_text('baseline = "b.json"\n')
    baseline = ["check", "a.mars", "--write-baseline", "b.json"]
    assert [run_here(baseline), run_here(baseline)] == [0, 0]
    assert run_here(["fmt", "a.mars"]) == 0


@pytest.mark.parametrize("how", ["other", "longer", "shorter", "changed", "same"])
def test_the_last_write_of_a_campaign_looks_at_its_file(how: str, tmp_path: Path) -> None:
    path = tmp_path / "o.jsonl"
    deliver.begin_outputs()
    deliver.grow_file(str(path), 0, 0)
    deliver.add_line(b"a run\n")
    if how == "other":
        (tmp_path / "mine").write_bytes(b"a run\n")
        (tmp_path / "mine").replace(path)
    elif how == "longer":
        path.open("ab").write(b"more")
    elif how == "shorter":
        os.truncate(path, 0)
    elif how == "changed":
        path.write_bytes(b"A RUN\n")
    before = path.read_bytes()
    try:
        if how == "same":
            deliver.write_file(str(path), b"whole\n")
        else:
            with pytest.raises(OSError, match="it has changed since the last line"):
                deliver.write_file(str(path), b"whole\n")
    finally:
        deliver.end_growing()
    assert path.read_bytes() == (b"whole\n" if how == "same" else before)
