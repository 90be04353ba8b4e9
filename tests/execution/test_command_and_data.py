"""A module with a command part and a data part runs as annotated methods of one object."""

import re
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured, Patch

#: Only the data part is lowered here; the distance feeds both.
SOURCE = """\
# @module_start
# @module_name Nav
class Nav:
    def __init__(self):
        self.calls = []
    {first}
    {second}
# @module_end
# @module_start
# @module_name Odo
# @Sense NotifyAtFrequency 10
def odo() -> "Distance":
    return 1.0
# @module_end
# @module_start
# @module_name Screen
# @DataIn
def show(progress: "Progress") -> None:
    print("shown:", progress)
# @module_end
"""
DRIVE = """# @ControlOut
    def drive(self, distance: "Distance") -> tuple:
        self.calls.append("drive")
        return "Trans_Z", 10.0 * len(self.calls)"""
PROGRESS = """# @DataOut NotifyWhenReady
    def progress(self, distance: "Distance") -> "Progress":
        self.calls.append("progress")
        return " ".join(self.calls[-2:])"""
ROBOT = """\
@configuration
@sources nav.py
@modules Odo, Nav, Screen, Base
Nav uses_data_from Odo
Screen uses_data_from Nav
Base is_controlled_by Nav
"""


@pytest.mark.parametrize("methods", [(DRIVE, PROGRESS), (PROGRESS, DRIVE)])
def test_both_parts_run_and_share_their_object(
    methods: tuple[str, str], tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("nav.py").write_text(SOURCE.format(first=methods[0], second=methods[1]))
    Path("r.mars").write_text(ROBOT)
    Path("s.toml").write_text('duration = 0.15\n[robot]\nmodule = "Base"\n')
    assert run_here(["run", "r.mars", "--scenario", "s.toml"]) == 0
    output = capsys.readouterr().out
    # Data come before control: the second progress follows the first command.
    assert re.findall("shown: (.*)", output) == ["progress", "drive progress"]
    assert "pass: all 6 requirements hold\n" in output
    run_here(["run", "r.mars", "--scenario", "s.toml", "--vary", "modules.Nav=off"])
    assert "shown" not in capsys.readouterr().out
