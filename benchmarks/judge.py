"""How long judging a run takes beside simulating it: `python benchmarks/judge.py 240 900 3600`.

Two controllers take turns 20 times a second, and every requirement is asked for. Times are
processor time of this one process; the figure is their ratio, facts and rules together.
"""

import sys
import time
from pathlib import Path

from mars_asp.execution.judgement import judge
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.trial import stage_trial
from mars_asp.language import parse_text

SPECIFICATION = """\
@specification hierarchical
@modules P, Low, High
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by Low 0 hold 500
ArbitrationNode is_controlled_by High 1 hold 50
"""
SCENARIO = """\
duration = {duration}
[robot]
module = "P"
[world]
walls = [[[-9000, -9000], [9000, -9000], [9000, 9000], [-9000, 9000], [-9000, -9000]]]
[devices.Low]
kind = "joystick"
script = [[0, "Rotn_Y", 20]]
[devices.High]
kind = "joystick"
script = [[0, "Trans_Z", 100]]
[requirements]
no_collision = true
clearance = 10
exclusive = [["Trans_Z", "Rotn_Y"]]
reach = {{ at = [5000, 0] }}
coverage = 0.5
"""


def measured(duration: int) -> tuple[float, float, int]:
    """Return seconds of simulating and of judging, and how often control was switched."""
    configuration = parse_text(SPECIFICATION, "bench.mars").configuration
    scenario = read_scenario(SCENARIO.format(duration=duration), Path("bench.toml"))
    trial = stage_trial(configuration, {}, scenario)
    started = time.process_time()
    trial.run_until(scenario.duration)
    simulated = time.process_time()
    judge(trial)
    judged = time.process_time()
    switches = len(trial.executor.arbiters["ArbitrationNode"].holdings)
    return simulated - started, judged - simulated, switches


def main() -> None:
    for duration in map(int, sys.argv[1:] or ("240", "900", "3600")):
        simulated, judged, switches = measured(duration)
        print(
            f"{duration:,} s, {switches:,} switches: simulated in {simulated:.2f} s, judged in "
            f"{judged:.2f} s ({judged / simulated:.2f} times as long; goal: 3)"
        )


if __name__ == "__main__":
    main()
