"""Cases of rules as the command runs them: `tests/cases` has packs, cases and outputs."""

import argparse
import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from shutil import copytree
from xml.etree import ElementTree

import pytest

from mars_asp.cli import run_here
from mars_asp.cli.cases_report import CaseFileResult, junit
from mars_asp.diagnostic import Diagnostic, Span, point, whole_file
from tests.support.documents import ROOT, answered, questions
from tests.support.fixtures import Captured, Patch
from tests.support.processes import HANGING, mars

QUESTIONS = ROOT / "tests" / "cases" / "questions.txt"
ODD = ROOT / "tests" / "cases" / "odd"


@pytest.mark.parametrize(("command", "expected"), questions(QUESTIONS))
def test_the_output_of_each_command_is_as_expected(
    command: str, expected: str, update_golden: bool
) -> None:
    answered(QUESTIONS, command, expected, update_golden)


@pytest.fixture
def odd(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    return copytree(ODD, tmp_path / "odd")


def test_an_update_writes_expected_findings_and_no_facts(odd: Path) -> None:
    facts, robot = odd / "cases" / "facts.lp", odd / "cases" / "robot.mars"
    before = {path: path.read_text().splitlines() for path in (facts, robot)}
    # What must hold is not updated, and still fails.
    assert run_here(["test", "odd", "--update"]) == 1
    assert [line for line in facts.read_text().splitlines() if line not in before[facts]] == [
        '%+ consequence(odd_idle,warning,"B",alone)',
        '%+ consequence(odd_idle,warning,"B",alone)',
        '%+ consequence(unused_module,warning,"A",declaration)',
        '%+ consequence(unused_module,warning,"B",declaration)',
    ]
    assert [line for line in robot.read_text().splitlines() if line not in before[robot]] == [
        "# expect: warning odd_idle(D) at 1",
        "# expect nodes: DataSplitter 1, ArbitrationNode 0",
        "# expect cost: nodes 1, conversion 0",
    ]
    once = facts.read_text(), robot.read_text()
    run_here(["test", "odd", "--update"])
    assert (facts.read_text(), robot.read_text()) == once


def test_the_cases_are_judged_as_the_update_leaves_them(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.mars").write_text("@configuration\n@modules A\n")
    assert run_here(["test", "a.mars", "--update"]) == 0
    assert capsys.readouterr().out == "wrote a.mars\n1 passed, 0 failed\n"
    assert run_here(["test", "a.mars", "-q"]) == 0
    assert capsys.readouterr().out == ""
    for place in ("a.mars:3", "a.mars::title"):
        assert run_here(["test", place]) == 2
        assert "`mars-asp test a.mars`" in capsys.readouterr().err


@pytest.mark.parametrize("order", [["a", "b"], ["b", "a"], ["."]])
def test_each_robot_has_the_packs_of_its_own_settings(
    order: list[str], tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    run_here(["rules", "new", "wheel-slip"])
    for name in ("a", "b"):
        Path(name).mkdir()
    Path("a/r.mars").write_text("@configuration\n@modules A\n# expect cost: nodes 0\n")
    Path("wheel-slip/cases/robot.mars").rename("b/robot.mars")
    Path("b/mars.toml").write_text('rules = ["../wheel-slip"]\n')
    Path("wheel-slip/cases/wheel-slip.lp").unlink()
    assert run_here(["test", *order]) == 0
    assert capsys.readouterr().out.endswith("2 passed, 0 failed\n")


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_an_update_adds_the_findings_to_a_case_without_expectations(odd: Path, end: str) -> None:
    case = odd / "cases" / "new.lp"
    case.write_bytes(f'module("A").{end}'.encode())
    assert run_here(["test", str(case), "--update"]) == 0
    expected = f'%only: consequence(odd_idle,warning,"A",alone){end}'
    expected += f"%not: consequence(odd_mount,_,_,_){end}"
    assert case.read_bytes().decode() == f'module("A").{end}{expected}'
    assert run_here(["test", str(case)]) == 0


FACTS = 'module("A").\n#show module/1.\n%= module("A")\n'


@pytest.mark.parametrize(
    ("words", "text", "status", "printed"),
    [
        ([], FACTS, 0, "1 passed, 0 failed\n"),
        ([], FACTS.replace('= module("A")', '= module("B")'), 1, "FAILED <stdin>.lp"),
        ([], "@configuration\n@modules A\n# expect nodes: Arbiter 0\n", 2, "<stdin>.mars:3:"),
        ([], "@configuration\n@modules A\n# expect cost: nodes 0\n", 0, "1 passed, 0 failed\n"),
        (["--update"], FACTS, 2, "--update: standard input cannot be changed"),
    ],
)
def test_a_case_comes_from_standard_input(
    words: list[str], text: str, status: int, printed: str
) -> None:
    done = mars("test", "-", *words, text=text)
    assert done.returncode == status
    assert printed in done.stdout + done.stderr


def test_junit_holds_each_case(odd: Path, capsys: Captured) -> None:
    assert run_here(["test", "odd", "--junit", "out.xml"]) == 1
    (suite,) = ElementTree.parse("out.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("7", "6", "0")
    first = suite[0]
    assert (first.get("name"), first.get("line")) == ("facts.lp: all that holds", "4")
    failure = suite[1].find("failure")
    assert failure is not None
    assert (failure.get("message") or "").startswith("odd/cases/facts.lp:10:7: expected")


@pytest.mark.parametrize(
    ("span", "place"), [(point("a.lp", 2, 1), "a.lp:2:1: "), (whole_file("a.lp"), "a.lp: ")]
)
def test_junit_has_the_place_of_an_error_or_its_file_alone(span: Span, place: str) -> None:
    wrong = Diagnostic("unreadable", "error", "the file is a pipe", span)
    (suite,) = ElementTree.fromstring(junit([CaseFileResult(Path("a.lp"), None, [wrong], 0.0)]))
    error = suite[0].find("error")
    assert error is not None and error.get("message") == f"{place}the file is a pipe"


def test_junit_is_xml_whatever_a_name_holds() -> None:
    wrong = Diagnostic("case", "error", "a \x00 and \ud800 and <&>", point("\x1b.lp", 1, 1))
    (suite,) = ElementTree.fromstring(junit([CaseFileResult(Path("\x1b.lp"), None, [wrong], 0.0)]))
    assert suite.get("errors") == "1"


def test_a_template_passes_its_lint_and_its_cases(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_here(["rules", "new", "wheel-slip"]) == 0
    assert run_here(["rules", "lint", "wheel-slip"]) == 0
    assert run_here(["test", "wheel-slip", "--coverage", "--mutate", "--jobs", "1"]) == 0
    output = capsys.readouterr().out.splitlines()
    assert output[-4:] == [
        "no problems found",
        "5 passed, 0 failed",
        "coverage of wheel-slip: 4 of 4 rules fire in a case",
        "mutants of wheel-slip: 6 of 6 are noticed by a case",
    ]
    held = {path: path.read_bytes() for path in Path("wheel-slip").rglob("*.*")}
    for topic in ("wheel-slip", "../up", "Wheel", "data_cycle", "mars-asp"):
        assert run_here(["rules", "new", topic]) == 2
    assert {path: path.read_bytes() for path in Path("wheel-slip").rglob("*.*")} == held
    assert [path.name for path in tmp_path.iterdir()] == ["wheel-slip"]


BATTERY = """\
%# Battery: what modules draw
%
% Purpose: find modules that draw too much.

%*! draws(M: module, P: milliwatts)
Module M draws P.
from: property
*%
#defined draws/2.

%! id:      battery/hungry
%! because: `{M}` draws {P:milliwatts}
%! example: cases/robot.mars
%! at:      draws(M, P) "{P:milliwatts} here"
consequence(hungry, warning, M, P) :- draws(M, P), P > 1500.
"""


def test_robots_among_the_cases_state_attributes_of_the_pack(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_here(["rules", "new", "battery"]) == 0
    Path("battery/consequences/battery.lp").write_text(BATTERY)
    Path("battery/cases/battery.lp").write_text(
        'draws("A",1500).\n%not: consequence(hungry,_,_,_)\n'
    )
    Path("battery/cases/robot.mars").write_text(
        "@configuration\n@modules A, B\nA uses_data_from B\n"
        "A @Property draws 1.501 W\n# expect: warning hungry(A) at 4\n"
    )
    assert run_here(["rules", "lint", "battery"]) == 0
    assert run_here(["test", "battery", "--coverage", "--mutate", "--jobs", "1"]) == 0
    assert run_here(["rules", "show", "battery/hungry", "--rules", "battery"]) == 0
    assert run_here(["rules", "diff", "battery", "battery/cases/robot.mars"]) == 0
    output = capsys.readouterr().out
    assert "coverage of battery: 2 of 2 rules fire in a case" in output
    assert "In its example:" in output
    assert output.endswith("  appeared warning hungry(A): `A` draws 1.501 W\n")


def test_a_mutant_survives_where_no_case_is_near(odd: Path, capsys: Captured) -> None:
    case = odd / "cases" / "facts.lp"
    case.write_text('module("A").\n%has: consequence(odd_idle,_,"A",_)\n')
    (odd / "cases" / "robot.mars").unlink()
    assert run_here(["test", "odd", "--mutate", "--jobs", "1"]) == 1
    output = capsys.readouterr().out
    assert "  survives: odd/consequences/odd.lp:10: drop `not busy(M)`" in output
    assert "odd.lp:10: delete" not in output


def test_documents_of_a_pack_are_pages(odd: Path) -> None:
    assert run_here(["rules", "doc", "odd", "-o", "pages"]) == 0
    assert {path.name for path in Path("pages").iterdir()} == {"index.md", "odd.md"}
    assert "[odd](odd.md)" in Path("pages/index.md").read_text()
    assert Path("pages/odd.md").read_text().startswith("# odd\n")


ROBOT = """\
@configuration hierarchical
@modules Base, Drive, Avoid, Idle

Base is_controlled_by Drive 1
Base is_controlled_by Avoid 2
"""


def test_a_snapshot_of_a_robot_fails_when_its_order_of_priorities_changes(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = Path("robot.mars")
    robot.write_text(ROBOT + "# never: control_cycle\n")
    assert run_here(["test", "--snapshot", "robot.mars"]) == 0
    written = robot.read_text()
    assert written.startswith(ROBOT + "# never: control_cycle\n\n# snapshot: ")
    assert written.splitlines()[8:] == [
        "# expect: warning unused_module(Idle) at 2",
        "# expect findings: error 0, warning 1",
        "# expect nodes: DataSplitter 0, DataTransformer 0, ArbitrationNode 1, ControlSplitter 0, "
        "InheritanceNode 0",
        "# expect cost: nodes 1, conversion 0, relationships 3",
        "# expect order: Base: Drive < Avoid",
    ]
    assert run_here(["test", "--snapshot", "robot.mars"]) == 0
    assert robot.read_text() == written
    assert run_here(["test", "robot.mars"]) == 0
    robot.write_text(written.replace("Drive 1", "Drive 3"))
    capsys.readouterr()
    assert run_here(["test", "robot.mars"]) == 1
    assert capsys.readouterr().out.splitlines()[1:] == [
        "  robot.mars:13:17: expected Base: Drive < Avoid",
        "    nearest: Base: Avoid < Drive",
        "0 passed, 1 failed",
    ]
    assert run_here(["test", "--snapshot", "facts.lp"]) == 2
    # An update leaves the line of a finding that is gone.
    robot.write_text(written.replace("Drive, Avoid, Idle", "Drive, Avoid"))
    capsys.readouterr()
    assert run_here(["test", "--update", "robot.mars"]) == 1
    assert "all lines of a snapshot: mars-asp test --snapshot robot.mars" in capsys.readouterr().err


PLUGIN = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
# An installation from before the plugin does not name it.
if not any(each.name == "mars_asp" for each in entry_points(group="pytest11")):
    PLUGIN += ["-p", "mars_asp.cli.pytest_plugin"]


def test_pytest_collects_cases_of_packs_and_snapshots_alone(odd: Path) -> None:
    (odd.parent / "cases").mkdir()
    (odd.parent / "cases" / "other.lp").write_text("%= never\n")
    (odd.parent / "other.mars").write_text(ROBOT)
    (odd.parent / "robot.mars").write_text(ROBOT)
    assert run_here(["test", "--snapshot", "robot.mars"]) == 0
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *PLUGIN, "."],
        capture_output=True, check=False, text=True, timeout=HANGING,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert "6 failed, 2 passed" in done.stdout, done.stdout + done.stderr
    assert 'odd/cases/facts.lp:10:37: expected `busy("C")`' in done.stdout
    assert "other.lp" not in done.stdout


def test_a_watch_runs_again_after_a_change_and_ends_by_a_signal(odd: Path) -> None:
    watching = subprocess.Popen(
        [sys.executable, "-m", "mars_asp", "test", "odd/cases/facts.lp", "--watch"],
        stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert watching.stderr is not None
    try:
        assert any("waiting" in line for line in watching.stderr)
        (odd / "consequences" / "odd.lp").write_text("busy(M) :- module(M).\n")
        output = next(line for line in watching.stderr if "passed" in line or "error" in line)
        assert "no rule finds the kind `odd_idle`" in output
        assert any("waiting" in line for line in watching.stderr)
    finally:
        watching.send_signal(2)
        assert watching.wait(HANGING) == 130
        watching.stderr.close()


def test_arguments_of_a_watch_name_its_files(odd: Path) -> None:
    from mars_asp.cli.cases_watch import _watched_files

    arguments = argparse.Namespace(paths=["odd/cases/facts.lp"], rules=[])
    assert Path("odd/consequences/odd.lp") in set(_watched_files(arguments))


def test_a_missing_case_hides_no_other(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.lp").write_text('%= module("A")\nmodule("A").\n#show module/1.\n')
    (tmp_path / "b.lp").write_text("%has: p(\n")
    (tmp_path / "mars.toml").touch()
    assert run_here(["test", "nope.lp", "a.lp", "b.lp", "-v", "--junit", "out.xml"]) == 2
    output = capsys.readouterr()
    assert output.out.endswith("1 passed, 0 failed, 2 files not run\n")
    assert "nope.lp: no such file" in output.err and "b.lp:1" in output.err
    assert "mars-asp: settings mars.toml\nmars-asp: nope.lp: 0." in output.err
    assert "mars-asp: a.lp: 0." in output.err
    (suite,) = ElementTree.parse("out.xml").getroot()
    assert [case.get("name") for case in suite] == ["nope.lp", "a.lp", "b.lp"]
    missing = suite[0].find("error")
    assert missing is not None and missing.get("message") == "nope.lp: no such file"
    assert run_here(["test", "nope.lp", "--junit", "alone.xml"]) == 2
    assert ElementTree.parse("alone.xml").getroot()[0].get("errors") == "1"


def test_a_continuation_of_nothing_is_an_error(tmp_path: Path, capsys: Captured) -> None:
    case = tmp_path / "a.lp"
    case.write_text('module("A").\n%+ module("B")\n')
    assert run_here(["test", str(case)]) == 2
    assert "`%+` continues nothing" in capsys.readouterr().err
    case.write_text('%+---+\n%= module("A")\nmodule("A").\n#show module/1.\n')
    assert run_here(["test", str(case)]) == 0


@pytest.mark.parametrize(
    ("lines", "place"),
    [
        ("# expect error class_mismatch(B)\n", "r.mars:4:1"),
        ("A is_controlled_by B  // expect: error class_mismatch(B)\n", "r.mars:4:23"),
        ("// expect\n# expect nodes: DataSplitter 0\n", "r.mars:4:1"),
    ],
)
def test_an_expectation_without_its_form_is_an_error(
    lines: str, place: str, tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("r.mars").write_text(f"@configuration\n@modules A, B\nB uses_data_from A\n{lines}")
    for path in (".", "r.mars"):
        assert run_here(["test", path]) == 2
        assert f"{place}: error: this is not an expectation" in capsys.readouterr().err
    Path("r.mars").write_text(
        "@configuration\n@modules A, B\nB uses_data_from A\n"
        "// expected: nothing\n# expect nodes: DataSplitter 0\n"
    )
    assert run_here(["test", "."]) == 0


def test_a_snapshot_of_a_folder_takes_its_robots(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    run_here(["rules", "new", "wheel-slip"])
    capsys.readouterr()
    assert run_here(["test", "wheel-slip", "--snapshot"]) == 0
    assert capsys.readouterr().out == "wrote wheel-slip/cases/robot.mars\n"
    for quiet in (["test", "wheel-slip", "--snapshot"], ["rules", "new", "other", "--trust"]):
        assert run_here([*quiet, "-q"]) == 0
        assert capsys.readouterr().out == ""
    assert run_here(["test", "wheel-slip/cases/wheel-slip.lp", "--snapshot"]) == 2
    Path("new").mkdir()
    Path("new/robot.mars").write_text(ROBOT)
    capsys.readouterr()
    assert run_here(["test", "new", "--snapshot"]) == 2
    assert "no robot in the folder has a snapshot yet" in capsys.readouterr().err
