"""Commands that an answer suggests can be pasted into a shell, whatever files are called."""

import shlex
from pathlib import Path

import pytest

from mars_asp.cli import run_here

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
    words: list[str], before: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "it's a robot.mars"
    file.write_text(ROBOT)
    verb, *rest = words
    run_here([verb, str(file), *rest, "--sources", str(tmp_path)])
    told = capsys.readouterr().out
    suggested = next(line for line in told.split("\n") if line.strip().startswith(before))
    program, *again = shlex.split(suggested.strip().removeprefix(before))
    assert program == "mars-asp"
    assert str(file) in again
    assert again[-2:] == ["--sources", str(tmp_path)]
    assert run_here(again) in (0, 1)
    assert capsys.readouterr().out.strip()
