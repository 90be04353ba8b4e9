"""Specifications of a platform and a joystick that run in a scenario given as text."""

from pathlib import Path

from mars_asp.execution.judgement import judge
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.scenario.vary import UNCHANGED, Changes
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.language import parse_text

BASE = 'duration = 3\n[robot]\nmodule = "P"\n'
DRIVE = "@specification\n@modules P, C\nP is_controlled_by C\n"
HAND = '[devices.C]\nkind = "joystick"\nscript = [[0, "Trans_Z", 200]]\n'
WALL = "\n[world]\nwalls = [[[500, -900], [500, 900], [-900, 900]]]\n"


def trial(
    text: str, specification: str = DRIVE, folder: Path = Path(), changes: Changes = UNCHANGED
) -> Trial:
    scenario = read_scenario(text, folder / "s.toml", changes)
    made = stage_trial(parse_text(specification, "x.mars").configuration, {}, scenario)
    made.run_until(scenario.duration)
    return made


def verdicts(made: Trial) -> dict[str, bool | None]:
    return {verdict.name: verdict.holds for verdict in judge(made).requirements}
