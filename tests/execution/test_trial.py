"""Scenarios, requirements and the verb `run`."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mars_asp.asp.trace import Derived, Given
from mars_asp.cli import run_command, run_here
from mars_asp.diagnostic import MarsError
from mars_asp.execution.judgement import ALWAYS, ON_REQUEST, judge
from mars_asp.execution.recording.picture import plot_run
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.language import parse_text
from mars_asp.reasoning.rules import load_rulebook
from tests.support.documents import ROOT

LEVEL0 = ROOT / "examples" / "level0"
BASE = 'duration = 3\n[robot]\nmodule = "P"\n'
DRIVE = "@specification\n@modules P, C\nP is_controlled_by C\n"
HAND = '[devices.C]\nkind = "joystick"\nscript = [[0, "Trans_Z", 200]]\n'


def trial(text: str, specification: str = DRIVE, folder: Path = Path()) -> Trial:
    scenario = read_scenario(text, folder / "s.toml")
    made = stage_trial(parse_text(specification, "x.mars").configuration, {}, scenario)
    made.run_until(scenario.duration)
    return made


def verdicts(made: Trial) -> dict[str, bool]:
    return {verdict.name: verdict.holds for verdict in judge(made).requirements}


def test_a_joystick_drives_a_platform() -> None:
    made = trial(BASE + "[bindings.C]\nperiod = 100\n" + HAND)
    assert made.body.driven == pytest.approx(600)
    assert made.control_time == {"C": pytest.approx(3)}


WALL = "\n[world]\nwalls = [[[500, -900], [500, 900], [-900, 900]]]\n"


@pytest.mark.parametrize(
    ("asked", "name", "holds"),
    [
        ("no_collision = true", "no_collision", False),
        ("clearance = 10", "clearance", False),
        ("reach = { at = [300, 0], radius = 10 }", "reach", True),
        ("reach = { at = [300, 0], radius = 10, within = 0.5 }", "reach", False),
        ('exclusive = [["Trans_Z", "Rotn_Y"]]', "exclusive", True),
        ("coverage = 0.9", "coverage", False),
    ],
)
def test_requirements_on_request(asked: str, name: str, holds: bool) -> None:
    made = trial(f"{BASE}{HAND}{WALL}[requirements]\n{asked}\n")
    assert verdicts(made)[name] is holds


def test_commands_beyond_a_limit_are_reported_without_being_asked() -> None:
    made = trial(f"{BASE}limits = {{ Trans_Z = 100 }}\n{HAND}")
    assert verdicts(made)["commands within limits"] is False
    assert made.body.driven == pytest.approx(300)


def test_two_controllers_without_an_arbiter_are_reported_without_being_asked() -> None:
    both = DRIVE.replace("P, C", "P, C, D") + "P is_controlled_by D\n"
    made = trial(BASE + HAND + HAND.replace(".C]", ".D]"), both)
    assert verdicts(made)["one controller at a time"] is False


def test_a_violation_is_explained_down_to_the_lines_that_asked(tmp_path: Path) -> None:
    text = f"{BASE}limits = {{ Trans_Z = 100 }}\n{HAND}{WALL}[requirements]\nno_collision = true\n"
    judgement = judge(trial(text, folder=tmp_path))
    traces = {c.kind: trace for c, trace in judgement.traces()}
    limit, collision = traces["limit_breach"], traces["collision"]
    assert isinstance(limit, Derived)
    assert isinstance(collision, Derived)
    assert (
        limit.message
        == "`P` was commanded Trans_Z at 200000 thousandths a second, and 100000 is its limit"
    )
    assert [p.span.line for p in limit.premises if isinstance(p, Given) and p.span] == [4]
    asked, contact = collision.premises[0], collision.premises[1]
    assert isinstance(asked, Given)
    assert asked.span is not None
    assert text.splitlines()[asked.span.line - 1] == "no_collision = true"
    assert isinstance(contact, Derived)
    assert contact.message is not None
    assert contact.message.startswith("the robot obeyed `C` in Trans_Z from 0 to ")


def test_the_run_rules_have_checked_messages_and_a_requirement_each() -> None:
    book = load_rulebook(stages=("run",), strict=True)
    kinds = {
        str(rule.ast.head.atom.symbol.arguments[0])
        for rule in book.rules
        if rule.stage == "run" and rule.text.startswith("consequence(")
    }
    assert kinds == {*ALWAYS.values(), *ON_REQUEST.values()}


def test_all_errors_of_a_scenario_come_at_once_with_their_lines() -> None:
    with pytest.raises(MarsError) as raised:
        read_scenario('sed = 1\nduration = "x"\n[robot]\nmodul = "P"\n', Path("s.toml"))
    found = [(d.span.line, d.message, d.help) for d in raised.value.diagnostics]
    assert (1, "`sed` is no key here", "did you mean `seed`?") in found
    assert (2, "`duration` is no int or float", None) in found
    assert (4, "`modul` is no key here", "did you mean `module`?") in found


def test_blocks_of_a_configuration_say_what_its_modules_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    blocks = {
        "Eye": "@Sense NotifyAtFrequency 20, RequestWhenReady\nScan look();",
        "Log": "@DataIn\nvoid log(Scan scan);",
        "Hand": "@ControlOut\nCommand lead();",
        "Base": "@Trans_Z _ _ 800\n@Rotn_Y",
        "Arm": "@Grasp 0 80",
    }
    written = "".join(
        f"@module_start\n@module_name {name}\n{block}\n@module_end\n"
        for name, block in blocks.items()
    )
    (tmp_path / "robot.mars").write_text(
        "@configuration flat\n@modules Eye, Log, Screen, Hand, Base, Arm\n"
        "Arm is_mounted_on Base (y, 90, _, _, 0, 0, 0)\nLog uses_data_from Eye\n"
        "Screen uses_data_from Eye NotifyAtFrequency 5\n"
        "Arm is_controlled_by Hand\n" + written.replace("@ControlOut", "@ControlOut Rotn_Y, Grasp"),
    )
    (tmp_path / "lead.py").write_text(
        "count = 0\nprint('read')\ndef lead():\n    global count\n    count += 1\n"
        "    print('led')\n"
        "    return ('Rotn_Y', 9) if count % 2 else ('Grasp', 40)\n"
    )
    (tmp_path / "s.toml").write_text(
        "duration = 2\n[robot]\nmodule = 'Base'\n[devices]\nEye.kind = 'sonar'\n"
        "Arm.kind = 'gripper'\n[bindings]\nHand = { python = 'lead.py:lead', period = 100 }\n"
    )
    words = ["run", str(tmp_path / "robot.mars"), "--scenario", str(tmp_path / "s.toml")]
    assert run_here([*words, "--format", "json"]) == 0
    printed, told = capsys.readouterr()
    assert told.startswith("read\nled\n")
    found = json.loads(printed)
    asked = {(link["source"], link["client"]): link["asked_hz"] for link in found["links"]}
    assert asked["Eye", "DataSplitter1"] == 20
    assert asked["DataSplitter1", "Screen"] == 5
    assert found["verdict"] == "pass"


#: A marker `^` stands before each place that is told, in the order in which they are told.
WRONG_FORMS = """\
duration = 1
[robot]
module = "P"
^start = [0, 0]
[world]
walls = [
  [[0, 0], [1, 1]],  # ], [
  ^[], ^[0, 1],
  ^"a], [",
]
polygons = [[[0, 0]], ^[[0, "b"]], ^3]
circles = [[0, 0, 10], ^[0, 0], ^[0, 0, -5], ^{ x = 1 }]
marks = [{ at = [1, 2], colour = "red" }, { ^at = [1], ^colour = 4 }, ^{ at = [3, 4] }]
scatter = { count = 3, ^radius = 4 }
[[world.moving]]
from = [0, 0]
to = [1, 1]
radius = 10
speed = 5
^[[world.moving]]
^from = [0]
radius = 10
speed = 5
[devices.D]
kind = "joystick"
script = [[0, "Trans_Z", 100], ^[1, "Trans_Q", 100], ^[2, "Trans_Z"], ^[[]]]
[requirements]
^reach = { radius = 3 }
exclusive = [["Trans_Z", "Rotn_Y"], ^["Trans_Z"], ^["Trans_Z", "Turn"]]
^coverage = 2
"""


def test_values_of_a_wrong_form_are_reported_where_they_stand() -> None:
    lines = WRONG_FORMS.splitlines()
    marked = [
        (number, match.start() - index + 1)
        for number, line in enumerate(lines, 1)
        for index, match in enumerate(re.finditer(r"\^", line))
    ]
    with pytest.raises(MarsError) as raised:
        read_scenario(WRONG_FORMS.replace("^", ""), Path("s.toml"))
    found = raised.value.diagnostics
    assert sorted({(d.span.line, d.span.column) for d in found}) == marked
    told = {d.span.line: d.message for d in found}
    assert told[4] == "`start` is not `[forward, side, heading]`"
    assert told[8] == "an entry of `walls` is not a list of points `[forward, side]`"
    assert told[20] == "`moving` without `to`"
    assert told[28] == "`reach` without `at`"


@pytest.mark.parametrize("key", ["a", '"a b"', "'a.b'"])
def test_a_key_of_very_many_parts_is_refused_before_it_is_read(key: str) -> None:
    with pytest.raises(MarsError) as raised:
        read_scenario(f"duration = 1\n{'. '.join([key] * 100_000)} = 1\n", Path("s.toml"))
    (found,) = raised.value.diagnostics
    assert (found.span.line, found.message) == (2, "a key of more than 100 parts")


def test_a_world_without_room_for_its_circles_is_reported() -> None:
    with pytest.raises(MarsError, match="finds no place for 3 circles"):
        trial(f"{BASE}{HAND}[world]\nscatter = {{ count = 3, within = 10, free = 900 }}\n")


def test_broken_toml_is_placed() -> None:
    with pytest.raises(MarsError) as raised:
        read_scenario("seed = 1\nduration = = 2\n", Path("s.toml"))
    assert raised.value.diagnostics[0].span.line == 2


def test_unbound_modules_are_reported_together_before_the_run() -> None:
    with pytest.raises(MarsError) as raised:
        trial(BASE, DRIVE.replace("P, C", "P, C, D") + "P is_controlled_by D\n")
    assert sorted(d.message.split("`")[1] for d in raised.value.diagnostics) == ["C", "D"]


FAULTS = [
    ('kind = "silent", from = 1, until = 2', 21, 0),
    ('kind = "throwing", from = 1, until = 2', 21, 10),
    ('kind = "stuck", from = 1, until = 2', 31, 0),
    ('kind = "babbling", by = 10', 301, 0),
    ('kind = "late", by = 50', 30, 0),
]


@pytest.mark.parametrize(("fault", "delivered", "failed"), FAULTS)
def test_injected_faults(fault: str, delivered: int, failed: int) -> None:
    made = trial(f"{BASE}{HAND}[faults]\nC = {{ {fault} }}\n")
    link = made.executor.links[0]
    assert (link.delivered, link.dropped["failed"]) == (delivered, failed)


def test_a_scenario_declares_a_processing_delay(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go():\n    return 'Trans_Z', 100\n")
    binding = '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    driven = [
        trial(BASE + binding + delay, folder=tmp_path).body.driven
        for delay in ("", "delay = 500\n")
    ]
    assert driven == pytest.approx([300, 250])


def test_dropped_messages_are_shown(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "c.mars").write_text(
        "@specification\n@modules P, C, D\nP is_controlled_by C\nP is_controlled_by D\n"
    )
    hands = "".join(HAND.replace(".C]", f".{name}]") for name in "CD")
    (tmp_path / "s.toml").write_text(BASE + hands)
    words = ["run", str(tmp_path / "c.mars"), "--scenario", str(tmp_path / "s.toml")]
    assert run_command(words) == 1
    assert re.search(r"C -> P +10\.33 +0 +31 overtaken", capfd.readouterr().out)
    assert run_command([*words, "--format", "json"]) == 1
    links = json.loads(capfd.readouterr().out)["links"]
    assert [link["dropped"] for link in links] == [{"overtaken": 31}, {}]


def test_analysis_runs_no_behaviour(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """A source is text to analysis; only a run imports it."""
    ran = tmp_path / "ran"
    (tmp_path / "b.py").write_text(
        f"open({str(ran)!r}, 'w')\n# @module_start\n# @module_name C\n# @ControlOut Trans_Z\n"
        "def go() -> tuple[str, float]:\n    return 'Trans_Z', 100\n# @module_end\n"
    )
    config = tmp_path / "c.mars"
    config.write_text("@configuration\n@sources b.py\n@modules P, C\nP is_controlled_by C\n")
    (tmp_path / "s.toml").write_text(BASE + "[bindings.C]\nperiod = 100\n")
    for verb in ("check", "analyse", "synthesise", "explain"):
        assert run_command([verb, str(config)]) == 0
        assert not ran.exists()
    assert run_command(["run", str(config), "--scenario", str(tmp_path / "s.toml")]) == 0
    assert ran.exists()
    assert "100.0 %" in capfd.readouterr().out


def test_module_state_does_not_leak_from_one_run_into_the_next(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(
        "count = [0]\ndef go():\n    count[0] += 1\n    return 'Trans_Z', count[0]\n"
    )
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    driven = {trial(text, folder=tmp_path).body.driven for _ in range(2)}
    assert len(driven) == 1


@pytest.mark.parametrize(
    ("body", "failed"), [("def go():\n    exit(3)\n", 30), ("exit(3)\ndef go(): ...\n", None)]
)
def test_a_behaviour_cannot_end_the_program(body: str, failed: int | None, tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(body)
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    if failed is None:
        with pytest.raises(MarsError, match="SystemExit: 3"):
            trial(text, folder=tmp_path)
    else:
        (link,) = trial(text, folder=tmp_path).executor.links
        assert abs(link.dropped["failed"] - failed) <= 1
        assert link.fault == "RuntimeError: it called `exit(3)`"


def test_what_failed_first_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "b.py").write_text("def go():\n    raise ValueError('no\\x1b[31m map')\n")
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    (tmp_path / "s.toml").write_text(text)
    (tmp_path / "d.mars").write_text(DRIVE)
    run_here(["run", str(tmp_path / "d.mars"), "--scenario", str(tmp_path / "s.toml")])
    told = capsys.readouterr().out
    assert "failed   C -> P  first by ValueError: no\\x1b[31m map\n" in told


def _run(*words: str) -> int:
    return run_command(
        ["run", str(LEVEL0 / "config.mars"), "--scenario", str(LEVEL0 / "scenario.toml"), *words]
    )


def test_level_0_runs_and_same_seed_is_same_trace_to_the_byte(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    traces = []
    for name in ("a", "b"):
        out, svg = tmp_path / f"{name}.jsonl", tmp_path / f"{name}.svg"
        words = ["--duration", "5", "--format", "json", "--record", str(out), "--plot", str(svg)]
        status = _run(*words)
        result = json.loads(capfd.readouterr().out)
        assert (status, result["verdict"], result["collisions"]) == (0, "pass", 0)
        assert set(result["control_time"]) <= {"Turn", "Forward", "Collide"}
        traces.append(out.read_bytes() + svg.read_bytes())
    assert traces[0] == traces[1]
    assert len(traces[0]) > 10_000


def test_a_violated_requirement_is_status_1(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = (LEVEL0 / "scenario.toml").read_text() + "clearance = 3000\n"
    text = text.replace('"sources/', f'"{LEVEL0.as_posix()}/sources/')
    (tmp_path / "s.toml").write_text(text)
    words = ["run", str(LEVEL0 / "config.mars"), "--scenario", str(tmp_path / "s.toml")]
    words += ["--duration", "1", "--explain"]
    assert run_command(words) == 1
    out = " ".join(capfd.readouterr().out.split())
    assert "VIOLATED clearance" in out
    assert "micrometres, and 3000000 were asked for [run/clearance]" in out
    assert f"s.toml:{len(text.splitlines())}: clearance = 3000" in out
    assert run_command([*words, "--format", "json"]) == 1
    (trace,) = json.loads(capfd.readouterr().out)["traces"]
    assert trace["rule"]["id"] == "run/clearance"
    assert [premise["atom"] for premise in trace["premises"]][:1] == ["asked(clearance)"]


def test_a_plot_names_who_held_control() -> None:
    assert ">C</text>" in plot_run(trial(BASE + HAND + WALL))


def test_annotated_functions_run_without_another_line_of_glue(
    capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = (LEVEL0 / "scenario.toml").read_text()
    bare = text[: text.index("[bindings]")] + text[text.index("[requirements]") :]
    (tmp_path / "s.toml").write_text(bare)
    words = ["run", str(LEVEL0 / "config.mars"), "--duration", "3", "--format", "json"]
    told = []
    for scenario, sources in (
        (LEVEL0 / "scenario.toml", []),
        (tmp_path / "s.toml", ["--sources", str(LEVEL0 / "sources")]),
    ):
        assert run_command([*words, "--scenario", str(scenario), *sources]) == 0
        result = json.loads(capfd.readouterr().out)
        told.append((result["events"], result["driven_mm"], result["control_time"]))
    assert told[0] == told[1]
    assert told[0][0] > 100


def test_a_reader_who_leaves_ends_a_run_quietly() -> None:
    scenario = str(LEVEL0 / "scenario.toml")
    words = ("run", str(LEVEL0 / "config.mars"), "--scenario", scenario, "--duration", "1")
    command = [sys.executable, "-m", "mars_asp", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None and running.stderr is not None
        running.stdout.close()
        assert running.stderr.read() == b""
    assert running.returncode == 141


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
    [("ValueError('no\\nmap')", r"ValueError: no\nmap"), ("Odd()", "Odd")],
)
def test_a_module_that_fails_fails_the_run(raised: str, first: str, tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(f"{ODD_ERROR}def go():\n    raise {raised}\n")
    (requirement,) = (
        r for r in judge(trial(BASE + FROM_FILE, folder=tmp_path)).requirements if not r.holds
    )
    assert requirement.name == "no module failed"
    assert requirement.message == f"`C` failed 31 times, first by {first}"


def test_failures_that_are_asked_for_do_not_fail_a_run() -> None:
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


def test_a_condition_about_what_is_no_number_fails_the_run() -> None:
    screen = "@specification\n@modules P, S, A\nA uses_data_from S NotifyOnMax(3)\n"
    made = trial(BASE + '[devices.S]\nkind = "odometry"\n', screen)
    assert [failures.count for failures in made.executor.failures.values()] == [31]
    assert list(made.executor.failures) == ["S -> A"]


@pytest.mark.parametrize(
    ("robot", "told"),
    [
        ("S", "the robot's `module` is an effector, and `S` is not (sensor)"),
        ("C", "the robot's `module` is an effector, and `C` is not (control out)"),
        ("G", "the robot's `module` moves, and `G` has no motion function"),
        ("Q", "`Q` is no module of the specification"),
    ],
)
def test_what_cannot_move_is_no_robot(robot: str, told: str) -> None:
    blocks = "".join(
        f"@module_start\n@module_name {name}\n{annotation}\n@module_end\n"
        for name, annotation in (("S", "@Sense RequestWhenReady\nMap look();"), ("G", "@Grasp"))
    )
    text = DRIVE.replace("P, C", "P, C, S, G") + blocks
    with pytest.raises(MarsError) as raised:
        trial(f'duration = 3\n[robot]\nradius = 9\nmodule = "{robot}"\n{HAND}', text)
    (found,) = raised.value.diagnostics
    assert (found.message, found.span.line, found.span.column) == (told, 4, 1)


@pytest.mark.parametrize(
    ("binding", "place"),
    [
        ('[bindings.C]\nperiod = 9\npython = "b.py:go"\n', (6, 11)),
        ('[bindings]\nD = { period = 9 }\nC = { python = "b.py:go" }\n', (8, 1)),
        ('[bindings]\nC.python = "b.py:go"\n', (7, 1)),
        ('[devices.C]\nkind = "sonar"\n[bindings."C"]\npython = "b.py:go"\n', (8, 11)),
    ],
)
def test_a_binding_to_what_is_not_there_is_reported_at_its_line(
    binding: str, place: tuple[int, int], tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text("")
    text = f"seed = 0\n\n{BASE}{binding}".replace("[devices.C]", "[devices.D]")
    with pytest.raises(MarsError) as raised:
        trial(text, folder=tmp_path)
    found = raised.value.diagnostics[0]
    assert found.message.endswith("AttributeError: module '_behaviour_b' has no attribute 'go'")
    assert (found.span.line, found.span.column) == place


def test_a_module_with_nothing_to_run_it_is_reported_where_it_is_named() -> None:
    with pytest.raises(MarsError) as raised:
        trial(BASE)
    (found,) = raised.value.diagnostics
    assert (found.span.line, found.span.column) == (2, 13)


@pytest.mark.parametrize("name", ["P", "Cc"])
def test_a_fault_that_nothing_has_is_refused(name: str) -> None:
    with pytest.raises(MarsError, match="no module that a Python function or a sensing") as raised:
        trial(f'{BASE}{HAND}[faults.{name}]\nkind = "silent"\n')
    assert raised.value.diagnostics[0].span.line == 7


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ("low = 90\nhigh = -90", "`low` is 90, above `high`, which is -90"),
        ("high = 10\nvalue = 11.5", "`value` is 11.5, above `high`, which is 10"),
        ("value = -1\nlow = 0", "`low` is 0, above `value`, which is -1"),
        ("\nlow = inf\nhigh = inf\nvalue = 0", "`low` is inf, above `value`, which is 0"),
    ],
)
def test_bounds_of_a_joint_are_in_order(wrong: str, told: str) -> None:
    with pytest.raises(MarsError) as raised:
        read_scenario(f'{BASE}[devices.J]\nkind = "joint"\n{wrong}\n', Path("s.toml"))
    (found,) = raised.value.diagnostics
    assert found.message == told
    lines = f"{BASE}[devices.J]\n\n{wrong}\n".split("\n")
    assert lines[found.span.line - 1].startswith(told.split("`")[1])


def test_a_fault_ends_after_it_began() -> None:
    fault = '[faults.C]\nkind = "silent"\nuntil = 2\nfrom = 3\n'
    with pytest.raises(MarsError, match="`from` is 3, above `until`, which is 2"):
        read_scenario(BASE + fault, Path("s.toml"))


def test_a_device_without_a_kind_is_refused() -> None:
    with pytest.raises(MarsError, match="`C` has no `kind`"):
        trial(BASE + "[devices.C]\nperiod = 3\n")


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ("command_timeout = inf", "`inf` is no number for `command_timeout`"),
        ("command_timeout = -1e308", "`-1e+308` is no number for `command_timeout`"),
        (f"seed = {2**63}", f"`{2**63}` is no number for `seed`"),
        ("world.circles = [[0, nan, 1]]", "`nan` is no number for `circles`"),
        ("world.scatter = { count = 1000000 }", "`1000000` is no number for `count`"),
        ("faults.C = { kind = 'babbling', by = 0 }", "`0` is no number for `by`"),
        ("robot.limits = { Trans_Q = 3 }", "`Trans_Q` is no key here"),
        ("a = " + "[" * 5000 + "]" * 5000, "its lists and tables are too deep to be read"),
        ("seed = " + "9" * 5000, "Exceeds the limit (4300 digits)"),
    ],
)
def test_numbers_beyond_reason_are_refused_before_the_run(wrong: str, told: str) -> None:
    text = f'{wrong}\nduration = 3\n[robot]\nmodule = "P"\n'
    if wrong.startswith("robot"):
        text = f'{wrong}\nrobot.module = "P"\nduration = 3\n'
    with pytest.raises(MarsError) as raised:
        read_scenario(text, Path("s.toml"))
    (found,) = raised.value.diagnostics
    assert found.message.startswith(told)
    assert found.span.line == 1
    # What may be open stays open.
    moving = "[world]\nmoving = [{ from = [-9, -9], to = [0, 0], radius = 1, speed = 1 }]\n"
    assert read_scenario(BASE + moving, Path("s.toml")).world["moving"][0]["from"] == [-9, -9]
    joint = '[devices.J]\nkind = "joint"\nlow = -inf\nhigh = inf\nrate = inf\n'
    assert read_scenario(BASE + joint, Path("s.toml")).devices["J"]["low"] < 0


def test_a_scenario_of_mistakes_is_told_in_part() -> None:
    wrong = "".join(f"key{number} = 1\n" for number in range(5000))
    with pytest.raises(MarsError) as raised:
        read_scenario(wrong, Path("s.toml"))
    assert len(raised.value.diagnostics) == 200
