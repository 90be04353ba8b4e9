"""Codes of messages on reading, rules as subjects, and answers without topics."""

import ast
import json
import re
from pathlib import Path

import pytest

from mars_asp.asp.lint.catalogue import CODES
from mars_asp.cli import run_here
from mars_asp.cli.input_codes import input_codes
from mars_asp.reasoning.lint import LintResult
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import mars


def test_each_code_has_a_meaning(capsys: Captured) -> None:
    assert run_here(["rules", "show", "catalogue"]) == 0
    output = capsys.readouterr().out
    assert output.startswith("## catalogue\n\nA node is described by the catalogue")
    assert "`--ignore` hides it" in output
    assert run_here(["explain", "syntax"]) == 0
    assert "It cannot be ignored." in capsys.readouterr().out
    assert run_here(["rules", "show", "MARS205", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["can_be_ignored"] is True
    assert all(code.meaning.endswith(".") for code in input_codes().values())
    assert run_here(["rules", "show", "catalogu"]) == 2
    assert "did you mean `catalogue`?" in capsys.readouterr().err


def test_each_code_in_the_package_is_listed() -> None:
    found = set[str]()
    for path in (ROOT / "mars_asp").rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        constants = {
            node.targets[0].id: node.value.value
            for node in tree.body
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        }
        for node in ast.walk(tree):
            match node:
                case ast.Constant(str(text)) if re.fullmatch(r"MARS[0-9]{3}", text):
                    found.add(text)
                case ast.Call(ast.Name("Diagnostic" | "refusal"), [ast.Constant(str(text)), *_]):
                    found.add(text)
                case ast.Call(ast.Name("Diagnostic" | "refusal"), [ast.Name(name), *_]):
                    found.update({constants[name]} if name in constants else ())
    assert len(found) > 100
    assert found <= input_codes().keys() | CODES.keys()
    listed = {code for code in input_codes() if code.startswith("MARS")}
    assert listed == {code for code in found if code.startswith("MARS")}


def test_codes_are_as_serious_as_the_page_of_annotations_has_them() -> None:
    page = (ROOT / "docs/reference/annotations.md").read_text(encoding="utf-8")
    serious = dict[str, bool]()
    for codes, remark in re.findall(
        r"^- \*\*(MARS[^*]*)\*\*:( \((?:note|warning)s?\))?", page, re.M
    ):
        first, *_ = numbers = [int(number) for number in re.findall("[0-9]{3}", codes)]
        if " to " in codes:
            numbers += range(first, numbers[1])
        serious.update({f"MARS{number}": not remark for number in numbers})
    # It is as serious as the gravest mistake in the file.
    assert serious.pop("MARS308")
    found = {code: not each.can_be_ignored for code, each in input_codes().items()}
    del found["MARS308"]
    assert serious == {code: is_error for code, is_error in found.items() if "MARS" in code}


def test_lints_are_explained(capsys: Captured) -> None:
    assert run_here(["explain", "rule-singleton"]) == 0
    output = capsys.readouterr().out
    assert output.startswith("## rule-singleton\n\n**A variable that occurs once.**")
    assert "`%! allow: rule-singleton REASON` above a rule hides it." in output
    assert run_here(["rules", "show", "rule-singleton", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["code"] == "rule-singleton"


def test_a_finding_is_explained_by_its_place(
    capsys: Captured, tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("la.mars").write_text("@configuration\n@modules A, B, C\nB is_controlled_by A\n")
    assert run_here(["explain", "la.mars:2:16"]) == 0
    assert capsys.readouterr().out.startswith("\nunused_module(C), warning: ")


def test_an_internal_predicate_is_not_suggested(capsys: Captured) -> None:
    assert run_here(["rules", "show", "starts_elsewher"]) == 2
    assert "did you mean" not in capsys.readouterr().err


def test_ids_of_older_versions_are_accepted(capsys: Captured) -> None:
    assert run_here(["rules", "show", "run/run/collision"]) == 0
    assert capsys.readouterr().out.startswith("## run/collision\n")


def test_the_rule_base_is_linted_as_itself(
    capsys: Captured, tmp_path: Path, monkeypatch: Patch
) -> None:
    with monkeypatch.context() as patch:
        # `test_lint_has_nothing_against_our_own_rules` lints them.
        patch.setattr(
            "mars_asp.cli.rules.lint_files", lambda packs: LintResult(tuple(packs), (), ())
        )
        assert run_here(["rules", "lint", str(ROOT / "rules")]) == 0
    assert capsys.readouterr().out == "no problems found in the built-in rules\n"
    assert run_here(["rules", "lint", str(tmp_path)]) == 2


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ("examples/level0/config.mars Sonar", "nothing concerns `Sonar`"),
        ("examples/level0/config.mars unused_module", "there is no `unused_module`"),
        ("examples/ros2_workspace dead_remap", "no finding of `dead_remap` in the launch files"),
        ("examples/ros2_workspace /lidar", "no finding about `/lidar` in the launch files"),
        (
            "examples/ros2_workspace loose_end(/cmd_vel)",
            "No loose_end(/cmd_vel): `/dock` publishes",
        ),
        ("examples/level0/config.mars config.mars:1", "no node rests on `config.mars:1`"),
        ("examples/level0/config.mars MARS207", "## MARS207\n\nBuilt-in types are used"),
        ("examples/ros2_workspace not_read", "## not_read\n\nA part of a foreign file was not"),
        ("examples/level0/config.mars checks/unused", "no consequence and no node rests on"),
    ],
)
def test_an_answer_without_topics_has_status_zero(
    words: str, answer: str, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["explain", *words.split(), "-q"]) == 0
    assert answer in capsys.readouterr().out


def test_a_subject_before_the_file_is_an_error(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT / "examples" / "level0")
    assert run_here(["explain", "Sonar", "config.mars"]) == 2
    assert "mars-asp explain config.mars Sonar" in capsys.readouterr().err
    assert run_here(["explain", "config.mars", "Turn", "Collide"]) == 2
    assert "one SUBJECT is explained at a time" in capsys.readouterr().err
    assert run_here(["explain", "gone.mars", "config.mars"]) == 2
    assert "gone.mars: no such file" in capsys.readouterr().err


def test_a_subject_may_be_a_rule(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["explain", "examples/level0/config.mars", "data/divergence"]) == 0
    output = capsys.readouterr().out
    assert output.count("[data/divergence]") == 2
    assert "ArbitrationNode" not in output
    assert run_here(["explain", "examples/ros2_workspace", "launch/commands/past-a-mux"]) == 0
    assert "guard_bypass(/cmd_vel)" in capsys.readouterr().out


def test_a_consequence_and_the_node_that_resolves_it_are_one_paragraph(
    capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["explain", "examples/level0/config.mars"]) == 0
    output = capsys.readouterr().out
    assert output.count("FeelForce uses_data_from SonarMap") == 1
    assert "Resolves data_divergence(SonarMap)." in output
    assert "\ndata_divergence(SonarMap)" not in output
    # Asked for alone, it has a paragraph of its own.
    assert run_here(["explain", "examples/level0/config.mars", "--only", "consequences"]) == 0
    assert "\ndata_divergence(SonarMap): " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "status", "expected"),
    [
        (["help", "nope"], 2, "there is no command `nope`"),
        (["help", "help"], 0, "usage: mars-asp COMMAND"),
        (["help", "check"], 0, "usage: mars-asp check"),
        (["explain", "guard_bypas"], 2, "did you mean `guard_bypass`?"),
        (["explain", "E501"], 2, "there is no file, kind or rule `E501` help: `mars-asp rules"),
        (["explain", "nope.mars"], 2, "nope.mars: no such file"),
        (["check", "rules.lp"], 2, "`mars-asp rules lint FILE` checks rules"),
        (["import", "ros2", "robot.mars"], 2, "`robot.mars` is a `.mars` file already"),
        (["import", "ros2", "mux.yaml"], 2, "this is a file of twist_mux, not a launch file"),
        (["extract", "-"], 2, "name the files; standard input is not read"),
        (["check", "dock.py"], 2, "`dock.py` is not a robot by itself"),
        (["check", "robot.mars", "loop.mars"], 2, "unused_module"),
        (
            ["check", "vendor/a.mars", "--exclude", "vendor", "--force-exclude"],
            0,
            "no file checked",
        ),
    ],
)
def test_words_that_users_type(
    words: list[str], status: int, expected: str, tmp_path: Path
) -> None:
    (tmp_path / "vendor").mkdir()
    (tmp_path / "loop.mars").symlink_to("loop.mars")
    (tmp_path / "dock.py").write_text("import rclpy\n")
    (tmp_path / "rules.lp").write_text("a.\nb :- a.\n")
    (tmp_path / "mux.yaml").write_text("topics: [{name: a, topic: a, priority: 1}]\n")
    for name in ("robot.mars", "vendor/a.mars"):
        (tmp_path / name).write_text("@configuration\n@modules A\n")
    done = mars(*words, folder=tmp_path)
    output = " ".join((done.stdout + done.stderr).split())
    assert (done.returncode, expected in output) == (status, True), output
    assert "internal error" not in output and "Traceback" not in output


def test_a_kind_is_shown_in_the_words_of_its_examples(capsys: Captured) -> None:
    assert run_here(["rules", "show", "guard_bypass"]) == 0
    output = capsys.readouterr().out
    assert "`Joy` commands `Base` past the guard `Monitor`" in output
    assert "{" not in output
