"""Requirements of runs, and the reasons of failures."""

from pathlib import Path

import pytest

from mars_asp.asp.trace import Derived, Given
from mars_asp.execution.judgement import (
    ALWAYS,
    GATED,
    ON_REQUEST,
    REASONS,
    UNDECIDED,
    WARNINGS,
    in_words,
    judge,
    run_rulebook,
)
from mars_asp.reasoning.rules import load_rulebook
from tests.support.trials import BASE, DRIVE, HAND, WALL, trial, verdicts


@pytest.mark.parametrize(
    ("requirement", "name", "holds"),
    [
        ("no_collision = true", "no_collision", False),
        ("clearance = 10", "clearance", False),
        ("reach = { at = [300, 0], radius = 10 }", "reach", True),
        ("reach = { at = [300, 0], radius = 10, within = 0.5 }", "reach", False),
        ('exclusive = [["Trans_Z", "Rotn_Y"]]', "exclusive", True),
        ("coverage = 0.9", "coverage", False),
    ],
)
def test_requirements_on_request(requirement: str, name: str, holds: bool) -> None:
    made = trial(f"{BASE}{HAND}{WALL}[requirements]\n{requirement}\n")
    assert verdicts(made)[name] is holds


def test_commands_beyond_a_limit_are_always_reported() -> None:
    made = trial(f"{BASE}limits = {{ Trans_Z = 100 }}\n{HAND}")
    assert verdicts(made)["commands within limits"] is False
    assert made.bodies[0].driven == pytest.approx(300)


def test_two_controllers_without_an_arbiter_are_always_reported() -> None:
    both = DRIVE.replace("P, C", "P, C, D") + "P is_controlled_by D\n"
    made = trial(BASE + HAND + HAND.replace(".C]", ".D]"), both)
    assert verdicts(made)["one controller at a time"] is False


def test_a_violation_is_explained_down_to_the_lines_that_require_it(tmp_path: Path) -> None:
    text = f"{BASE}limits = {{ Trans_Z = 100 }}\n{HAND}{WALL}[requirements]\nno_collision = true\n"
    judgement = judge(trial(text, folder=tmp_path))
    traces = {c.kind: trace for c, trace in judgement.traces()}
    limit, collision = traces["limit_breach"], traces["collision"]
    assert isinstance(limit, Derived)
    assert isinstance(collision, Derived)
    assert limit.message == "`P` was commanded Trans_Z at 200 mm/s, and its limit is 100 mm/s"
    declared = [p for p in limit.premises if isinstance(p, Given) and p.origin == "stated"]
    assert [p.span.line for p in declared if p.span] == [4]
    peak = next(p for p in limit.premises if isinstance(p, Given) and p.origin == "observed")
    assert peak.seconds == 0
    given, obeyed = collision.premises[0], collision.premises[2]
    assert isinstance(given, Given)
    assert given.span is not None
    assert text.splitlines()[given.span.line - 1] == "no_collision = true"
    assert isinstance(obeyed, Given)
    assert obeyed.message == "the robot obeyed `C` in `Trans_Z` from 0 s to 3 s"


def test_the_run_rules_have_checked_messages_and_a_requirement_each() -> None:
    book = load_rulebook(stages=("run",), strict=True)
    kinds = {
        str(rule.node.head.atom.symbol.arguments[0])
        for rule in book.rules
        if rule.stage == "run" and rule.text.startswith("consequence(")
    }
    required = {*ALWAYS.values(), *GATED.values(), *ON_REQUEST.values()}
    assert kinds == {*required, *UNDECIDED.values(), *WARNINGS, *REASONS}


FROM_FILE = '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
DECLARED = "@module_start\n@module_name P\n@Trans_Z\n@module_end\n"


@pytest.mark.parametrize(
    ("device", "declared", "function", "holds"),
    [
        ("", DECLARED, "Trans_Z", True),
        ("", DECLARED, "Rotn_Y", False),
        ("", "", "Rotn_Y", True),
        ("", "", "Rotn_X", False),
        ("", DECLARED.replace("_Z", "_Y"), "Trans_Y", False),
    ],
)
def test_a_command_for_a_function_that_is_not_there_is_a_violation(
    device: str, declared: str, function: str, holds: bool, tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text(f"def go():\n    return '{function}', 5\n")
    made = trial(BASE + FROM_FILE + device, DRIVE + declared, tmp_path)
    assert verdicts(made) == {name: name != "commanded functions exist" or holds for name in ALWAYS}


@pytest.mark.parametrize(
    ("declared", "function", "moves"),
    [(DECLARED, "Trans_Z", True), (DECLARED, "Rotn_Y", False), ("", "Rotn_Y", True)],
)
def test_a_robot_moves_by_the_functions_that_it_has(
    declared: str, function: str, moves: bool, tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text(f"def go():\n    return '{function}', 5\n")
    made = trial(BASE + FROM_FILE, DRIVE + declared, tmp_path)
    still = trial(BASE + HAND.replace("200", "0"), DRIVE, tmp_path)
    assert (made.bodies[0].pose != still.bodies[0].pose) is moves


GUARDED = """\
@specification hierarchical
@modules P, G, C, S
G.{input} uses_data_from S
G is_controlled_by C
P is_controlled_by G
@module_start
@module_name S
@Sense NotifyAtFrequency 10
Bump pressed();
@module_end
@module_start
@module_name G
@Guard
@ControlOut
Command filter({parameters});
@module_end
"""


@pytest.mark.parametrize(
    ("parameters", "takes"),
    [("Command command, Bump bump", "command, bump"), ("Bump bump, Command in", "bump, command")],
)
def test_commands_go_to_the_input_that_no_data_line_means(
    parameters: str, takes: str, tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text(
        "def go():\n    return 'Trans_Z', 5\n\n\ndef pressed():\n    return 0\n\n\n"
        f"def stop({takes}):\n    return None if bump else command\n"
    )
    bindings = FROM_FILE + '[bindings.S]\npython = "b.py:pressed"\nperiod = 100\n'
    bindings += '[bindings.G]\npython = "b.py:stop"\n'
    specification = GUARDED.format(input="bump", parameters=parameters)
    made = trial(BASE + bindings, specification, tmp_path)
    assert verdicts(made)["no module failed"]
    assert made.bodies[0].pose != trial(BASE, "@specification\n@modules P\n").bodies[0].pose


def test_a_joint_obeys_its_own_function_alone(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go():\n    return 'Rotn_Z', 5\n")
    specification = "@specification\n@modules P, J, C\nJ is_controlled_by C\n"
    for function, holds in (("Rotn_Z", True), ("Rotn_Y", False)):
        joint = f'[devices.J]\nkind = "joint"\nfunction = "{function}"\n'
        made = trial(BASE + FROM_FILE + joint, specification, tmp_path)
        assert verdicts(made)["commanded functions exist"] is holds


ODD_ERROR = "class Odd(Exception):\n    def __str__(self):\n        return 1 / 0\n"


@pytest.mark.parametrize(
    ("raised", "first"),
    [("ValueError('no\\nmap')", "ValueError: no map"), ("Odd()", "Odd")],
)
def test_a_module_that_fails_fails_the_run(raised: str, first: str, tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(f"{ODD_ERROR}def go():\n    raise {raised}\n")
    (requirement,) = (
        r for r in judge(trial(BASE + FROM_FILE, folder=tmp_path)).requirements if not r.holds
    )
    assert requirement.name == "no module failed"
    assert requirement.message == f"`C` failed 31 times, first by {first} (b.py:5, at 0 s)"


SONAR_ERRORS = """\
class Blank:
    def __repr__(self):
        return 1 / 0

def check(reading):
    if reading > 3:
        raise ValueError("too far")

def sonar():
    return Blank() if {odd} else 4.5

def go(reading):
    {body}
"""


@pytest.mark.parametrize(
    ("odd", "body", "message"),
    [
        (False, "check(reading)", "ValueError: too far (b.py:7, at 0.1 s, given 4.5)"),
        (
            True,
            "1 / 0",
            "ZeroDivisionError: division by zero (b.py:13, at 0.1 s, given <Blank instance>)",
        ),
        (False, "exit(3)", "RuntimeError: it called `exit(3)` (b.py:13, at 0.1 s, given 4.5)"),
    ],
)
def test_a_failure_has_its_line_its_instant_and_its_inputs(
    odd: bool, body: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text(SONAR_ERRORS.format(odd=odd, body=body))
    bound = FROM_FILE + ('[bindings.S]\npython = "b.py:sonar"\nperiod = 100\ndelay = 100\n')
    specification = "@specification\n@modules P, C, S\nC uses_data_from S\nP is_controlled_by C\n"
    made = trial(BASE + bound, specification, tmp_path)
    (requirement,) = (r for r in judge(made).requirements if not r.holds)
    times = made.executor.failures["C"].count
    assert requirement.message == f"`C` failed {times} times, first by {message}"


def test_a_goal_that_was_not_reached_is_reported_with_the_nearest_point(tmp_path: Path) -> None:
    requirements = "[requirements]\nreach = { at = [2500, 800], within = 1.5 }\n"
    judgement = judge(trial(BASE + HAND + requirements, folder=tmp_path))
    (requirement,) = (r for r in judgement.requirements if not r.holds)
    assert requirement.message == (
        "the robot did not reach (2500, 800) within 1.5 s; nearest 2.341 m, at 1.5 s"
    )


@pytest.mark.parametrize(
    ("unit", "number", "written"),
    [
        ("times", 1, "once"),
        ("times", 2, "twice"),
        ("times", 31, "31 times"),
        ("Trans_X", 250_500, "250.5 mm/s"),
        ("Rotn_Y", 90_000, "90 degrees/s"),
        ("Grasp", 40_000, "40 mm"),
    ],
)
def test_rates_are_written_in_units_of_a_scenario(unit: str, number: int, written: str) -> None:
    assert in_words(unit, number) == written


def test_requested_failures_do_not_fail_a_run() -> None:
    made = trial(f'{BASE}{HAND}[faults]\nC = {{ kind = "throwing", from = 1, until = 2 }}\n')
    assert made.executor.links[0].dropped["failed"] == 10
    assert all(verdicts(made).values())


def test_a_screen_that_fails_fails_the_run_though_nothing_follows_it(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go(reading):\n    raise ValueError(reading)\n")
    screen = "@specification\n@modules P, S, A\nA uses_data_from S\n"
    text = BASE + '[bindings.A]\npython = "b.py:go"\n[devices.S]\nkind = "odometry"\n'
    made = trial(text, screen, tmp_path)
    assert verdicts(made)["no module failed"] is False
    assert made.executor.failures["A"].count == 31


def test_rules_of_packs_on_a_run_read_tags_and_properties(tmp_path: Path) -> None:
    (tmp_path / "consequences").mkdir()
    (tmp_path / "run").mkdir()
    (tmp_path / "pack.toml").write_text('name = "mine"\nversion = "1"\n')
    # Ours derives a predicate called `level` for itself.
    (tmp_path / "consequences" / "vocabulary.lp").write_text(
        "%*! critical(M: module)\nM is critical.\nfrom: tag\n*%\n#defined critical/1.\n"
        "%*! level(M: module, N: count)\nM is at level N.\nfrom: property\n*%\n#defined level/2.\n"
    )
    (tmp_path / "run" / "mine.lp").write_text(
        "consequence(loose, error, E, C) :- critical(E), commanded_by(E, C), not guard(C).\n"
        "consequence(of_class, error, E, K) :- level(E, 3), class(E, K).\n"
    )
    rulebook = run_rulebook([tmp_path])
    blocks = "@module_start\n@module_name P\n{}@Trans_Z\nvoid go(T t);\n@module_end\n"
    guard = "@module_start\n@module_name C\n@Guard\n@ControlOut\nT say();\n@module_end\n"

    def violated(tags: str, others: str = "") -> set[str]:
        made = trial(BASE + HAND, DRIVE + blocks.format(tags) + others)
        found = judge(made, rulebook).requirements
        return {each.name for each in found if not each.holds}

    assert violated("") == set()
    assert violated("@Tag critical\n") == {"loose"}
    assert violated("@Tag critical\n@Property level 3\n") == {"loose", "of_class"}
    assert violated("@Tag critical\n", guard) == set()
