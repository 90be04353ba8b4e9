"""Rules that judge a run compare neighbouring intervals: twice as long, twice as much to judge."""

import clingo

from mars_asp.execution.judgement import run_facts, run_rulebook
from tests.support.trials import trial

SPECIFICATION = """\
@specification hierarchical
@modules P, Low, High
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by Low 0 hold 500
ArbitrationNode is_controlled_by High 1 hold 50
"""
SCENARIO = """\
duration = {duration}
robot.module = "P"
devices.Low = {{ kind = "joystick", script = [[0, "Rotn_Y", 20]] }}
devices.High = {{ kind = "joystick", script = [[0, "Trans_Z", 100]] }}
[requirements]
no_collision = true
exclusive = [["Trans_Z", "Rotn_Y"]]
reach = {{ at = [5000, 0] }}
"""


class Counted(clingo.Observer):
    """Counts ground rules."""

    rules = 0

    def rule(self, choice: bool, head: object, body: object) -> None:
        """Count a rule."""
        self.rules += 1


def ground_rules(duration: int) -> tuple[int, int]:
    """Return how often control is switched in a run, and how many rules judge it."""
    made = trial(SCENARIO.format(duration=duration), SPECIFICATION)
    counted, control = Counted(), clingo.Control(["--warn=none"])
    control.register_observer(counted)
    facts = "".join(f"{fact.atom}. " for fact in run_facts(made))
    control.add("base", [], "".join(text for _, text in run_rulebook().texts) + facts)
    control.ground([("base", [])])
    return len(made.executor.arbiters["ArbitrationNode"].holdings), counted.rules


def test_rules_that_judge_a_run_grow_linearly_with_it() -> None:
    (few, short), (some, middle), (many, long) = map(ground_rules, (10, 20, 40))
    assert (some - few, many - some) == (200, 400)
    assert long - middle == 2 * (middle - short) > 100
