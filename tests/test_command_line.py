"""Mistakes of users, in whole processes: status and message, never a traceback."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mars_asp.cli.limits import run_plain
from tests.support.configurations import IMPOSSIBLE
from tests.support.documents import ROOT
from tests.support.fixtures import Captured
from tests.support.processes import mars

LEVEL0 = "examples/level0/config.mars"
SCARA = "examples/scara/config.mars"
GOOD = "@configuration\n@modules A, B\nA uses_data_from B\n"


@pytest.mark.parametrize(
    ("words", "text", "status", "mentions"),
    [
        ([], None, 0, ""),
        (["analise", LEVEL0], None, 2, "did you mean `analyse`"),
        (["analyse"], None, 2, "FILE"),
        (["analyse", "missing.mars"], None, 2, "missing.mars"),
        (["analyse", "tests/rules"], None, 2, "tests/rules"),
        (["analyse", "-"], "", 2, "@configuration"),
        (["analyse", "-"], "\0\0", 2, "syntax"),
        (["analyse", "-"], "@configuration\n", 2, "@modules"),
        (["analyse", "-"], GOOD + "A uses_data_from C\n", 1, ""),
        (["check", "-"], GOOD + "A uses_data_from C\n", 1, "`C`"),
        (["can", "-", "Rotn_Y of A"], GOOD, 1, ""),
        (["can", "-", "Rotn_Z of"], GOOD, 2, "expected `FUNCTION of MODULE`"),
        (["can", "-", ""], GOOD, 2, "found nothing"),
        (["can", "-", "Rotn_y of A"], GOOD, 2, "did you mean `Rotn_Y`"),
        (["can", "-", " while ".join(["Grasp of A"] * 65)], GOOD, 2, "more than 64"),
        (["check", "-"], GOOD, 0, ""),
        (["analyse", "-", "--rules", "missing"], GOOD, 2, "missing"),
        (
            ["analyse", "-", "--sources", "missing"],
            GOOD,
            2,
            "mars-asp: error: `missing`: no such file or folder",
        ),
        (["analyse", "-", "--sources", "missing"], GOOD, 2, "paths of `--sources` are relative"),
        (["analyse", "-", "--time-limit", "0"], GOOD, 2, "positive"),
        (["synthesise", "-", "-o", "missing/folder/x"], GOOD, 2, "missing/folder"),
        (["explain", LEVEL0, "DataSpliter1"], None, 2, "did you mean `DataSplitter1`"),
        (["explain", LEVEL0, "--depth", "0"], None, 2, "depth"),
        (["explain", LEVEL0, ""], None, 2, "has no module, node, consequence or true atom ``"),
        (["explain", LEVEL0, "--about", ""], None, 2, "has no module"),
        (["explain", LEVEL0, "--repair", ""], None, 2, "`` is neither a module"),
        (["explain", LEVEL0, "--repair", "data_divergenc"], None, 2, "`data_divergence`"),
        (["explain", LEVEL0, "--repair", "data_divergence(FeelForce)"], None, 0, ""),
        (["explain", LEVEL0, "--alternatives", "2", "--", ""], None, 2, "`` is not a node"),
        (["explain", LEVEL0, "Turn", "--about", "Turn"], None, 2, "SUBJECT and --about"),
        (["explain", LEVEL0, "Turn", "--why-not", "a"], None, 2, "leave out SUBJECT"),
        (["explain", LEVEL0, "--about", "Turn", "--why-not", "a"], None, 2, "leave out --about"),
        (["explain", LEVEL0, "--repair", "--depth", "2"], None, 2, "--depth has no effect"),
        (["explain", LEVEL0, "--alternatives", "--depth", "all"], None, 2, "--depth has no effect"),
        (["explain", LEVEL0, "--alternatives", "--repair"], None, 2, "not allowed with"),
        (["explain", LEVEL0, "--only", "kinds"], None, 2, "invalid choice: 'kinds'"),
        (["explain", LEVEL0, "--only", "nodes", "--repair"], None, 2, "--only has no effect"),
        (["explain", LEVEL0, "--alternatives", "--only", "nodes"], None, 2, "--only has no effect"),
        (["explain", LEVEL0, "--why-not", "a", "--only", "nodes"], None, 2, "leave out --only"),
        (["explain", LEVEL0, "Trun", "--only", "nodes"], None, 2, "did you mean `Turn`"),
        (["explain", LEVEL0, "DataSplitter1", "--only", "nodes"], None, 2, "leave out `--only no"),
        (["explain", SCARA, "Tool", "--only", "nodes"], None, 2, "no node resolves what concerns"),
        (["explain", LEVEL0, "-o", "out.txt"], None, 2, "end it in .html"),
        (["explain", LEVEL0, "-o", "missing/folder/x.html"], None, 2, "missing/folder"),
        (["explain", LEVEL0, "-o", "-", "--repair"], None, 2, "leave out --repair"),
        (["explain", LEVEL0, "-o", "-", "--depth", "all"], None, 2, "leave out --depth"),
        (["explain", LEVEL0, "-o", "-", "--format", "json"], None, 2, "leave out `--format json`"),
        (["explain", "-", "-o", "-"], GOOD, 0, ""),
        (["explain", LEVEL0, "--all", "--repair"], None, 2, "not allowed with"),
        (["explain", LEVEL0, "--all", "--why-not", "a"], None, 2, "not allowed with"),
        (["rules", "show", "data/divergenc"], None, 2, "did you mean `data/divergence`"),
        (["draw", LEVEL0, "--format", "json"], None, 2, "leave out `--format json`, or type"),
        (["draw", LEVEL0, "-o", "picture.bmp"], None, 2, "`picture.bmp`"),
        (["draw", LEVEL0, "-o", "picture"], None, 2, ".svg, .png, .dot, .mmd"),
        (["draw", LEVEL0, "-o", "missing/folder/x.svg"], None, 2, "missing/folder"),
        (["draw", LEVEL0, "-o", "examples", "--as", "svg"], None, 2, "examples"),
        (["draw", "-", "-o", "picture.svg"], GOOD + "A uses_data_form B\n", 2, "`uses_data_from`"),
        (["draw", "missing.mars", "-o", "picture.svg"], None, 2, "missing.mars"),
        (["check", "-"], "@configuration\n@modules A, B,\nA uses_data_from B\n", 2, "drop it"),
        (["explain", "-", "DataSplitter1"], IMPOSSIBLE, 2, "no specification realises"),
        (["rules", "show"], None, 2, "needs the ID"),
        (["verify", LEVEL0, "tests/specifications/level0.mars"], None, 2, "SPEC comes first"),
        (["diff", "-", "-"], GOOD, 2, "for another file already"),
        (["verify", "-", "-"], GOOD, 2, "for another file already"),
        (["run", "-", "--scenario", "-"], GOOD, 2, "for another file already"),
        (
            ["run", LEVEL0, "--scenario", "-"],
            "durations = 1\n",
            2,
            "1:1: error: unknown key `duratio",
        ),
        (["test", "missing.lp"], None, 2, "missing.lp"),
        (["extract", LEVEL0], None, 2, "`mars-asp check` and `mars-asp analyse` read it"),
        (["extract", "README.md"], None, 2, "supported: .c, "),
        (["extract", "tests/extraction/h14_typo.cpp"], None, 1, "MARS109"),
    ],
)
def test_mistakes(words: list[str], text: str | None, status: int, mentions: str) -> None:
    done = mars(*words, text=text)
    assert done.returncode == status, done.stderr
    assert mentions in (done.stdout if words[:1] == ["check"] else done.stderr)
    assert "Traceback" not in done.stderr


def test_all_syntax_errors_come_at_once() -> None:
    text = "@configuration hierachical\n@modules A, B\nA uses_data_form B\nA is_controlled_by\n"
    done = mars("analyse", "-", "--format", "json", text=text)
    problems = [json.loads(line) for line in done.stderr.splitlines()]
    assert [(p["line"], p["column"]) for p in problems] == [(1, 16), (3, 3), (4, 19)]
    assert "`hierarchical`" in problems[0]["help"]
    assert "`uses_data_from`" in problems[1]["help"]


def test_a_file_of_another_language_does_not_fill_the_screen() -> None:
    text = "@configuration\n@modules A\n" + "what else is there to be said\n" * 700
    done = mars("check", "-", "--format", "json", text=text)
    assert done.returncode == 2
    problems = json.loads(done.stdout)["findings"]
    assert len(problems) == 501
    assert problems[-1]["line"] == 503
    assert problems[-1]["message"] == "500 errors above: the rest of the file was not read"


def test_a_text_is_not_a_robot(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("hello world\n")
    done = mars("check", str(text))
    assert done.returncode == 2
    assert "is not a robot" in done.stdout and "dumps of ROS graphs" in done.stdout
    text.write_text("A uses_data_from\n")
    assert "expected a module name" in mars("check", str(text)).stdout


def test_json_keeps_the_inputs_of_execution() -> None:
    found = json.loads(
        mars(
            "synthesise", "examples/mobile-camera/through-the-camera.mars", "--format", "json"
        ).stdout
    )
    assert found["period_ms"] is None
    assert not any("allocation" in line for line in found["control"])
    text = "@specification flat period 40\n@modules A, B, C, InheritanceNode1, DataTransformer1\n"
    text += "InheritanceNode1 is_controlled_by C hold 9 allocation root\n"
    text += "A is_controlled_by InheritanceNode1\nB uses_data_from DataTransformer1\n"
    text += "// DataTransformer1: Hough (Image -> Lines)\nDataTransformer1 uses_data_from A\n"
    done = mars("synthesise", "-", "--format", "json", text=text)
    found = json.loads(done.stdout)
    assert found["period_ms"] == 40
    assert {
        "controlled": "InheritanceNode1",
        "controller": "C",
        "priority": None,
        "hold_ms": 9,
        "allocation": "root",
    } in found["control"]
    kinds = {module["name"]: module for module in found["modules"]}
    assert kinds["InheritanceNode1"]["kind"] == "inheritance_node"
    assert kinds["DataTransformer1"] == {
        "name": "DataTransformer1",
        "kind": "data_transformer",
        "origin": "declared",
        "converter": "Hough",
        "from": "Image",
        "to": "Lines",
    }


def test_a_rule_is_shown_as_json_too() -> None:
    found = json.loads(mars("rules", "show", "data/divergence", "--format", "json").stdout)
    assert (found["id"], found["path"]) == ("data/divergence", "rules/data.lp")


def test_hostile_rules_end_with_a_message(tmp_path: Path) -> None:
    rules = tmp_path / "loop.lp"
    rules.write_text("p((X,X)) :- p(X).\np(1).\n")
    done = mars("analyse", "-", "--rules", str(rules), "--memory-limit", "500", text=GOOD)
    assert done.returncode in (2, 3)
    assert "Traceback" not in done.stderr
    assert done.stderr.strip()


@pytest.mark.parametrize(
    "text", ["#script (python)\n", '#include "x".\n', "p(\ufeff).\n", "p :- \n"]
)
def test_refused_rules_are_named(tmp_path: Path, text: str) -> None:
    rules = tmp_path / "bad.lp"
    rules.write_text(text, encoding="utf-8")
    done = mars("analyse", "-", "--rules", str(rules), text=GOOD)
    assert done.returncode == 2
    assert "bad.lp" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_pack_may_not_derive_predicates_of_built_in_rules(tmp_path: Path) -> None:
    rules = tmp_path / "forged.lp"
    rules.write_text('commanded(1, "A", "B").\n')
    done = mars("analyse", "-", "--rules", str(rules), text=GOOD)
    assert done.returncode == 2
    assert "commanded/3" in done.stderr


def test_an_output_file_is_written(tmp_path: Path) -> None:
    target = tmp_path / "out.mars"
    assert mars("synthesise", LEVEL0, "-o", str(target)).returncode == 0
    assert target.read_text().startswith("@specification hierarchical\n")


def test_clingo_itself_gives_the_same_consequences(tmp_path: Path) -> None:
    import clingo

    facts = mars("facts", "tests/mixed.mars").stdout
    control = clingo.Control(["--warn=none"])
    for path in sorted((ROOT / "rules").glob("*.lp")):
        control.load(str(path))
    control.add("base", [], facts)
    control.ground()
    shown: set[tuple[str, str]] = set()

    def keep(model: clingo.Model) -> None:
        shown.update(
            (str(s.arguments[0]), s.arguments[2].string) for s in model.symbols(shown=True)
        )

    control.solve(on_model=keep)
    found = json.loads(mars("analyse", "--format", "json", "tests/mixed.mars").stdout)
    assert shown == {(c["kind"], c["subject"]) for c in found["consequences"]}
    assert len(shown) > 5


def test_output_is_utf_8_whatever_the_system_prefers() -> None:
    text = "@configuration\n@modules Caméra, Ecran, Log\nEcran uses_data_from Caméra\n"
    done = subprocess.run(
        [sys.executable, "-m", "mars_asp", "synthesise", "-"],
        cwd=ROOT,
        input=text.encode(),
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.decode() == text.replace("@configuration", "@specification")
    assert b"`Log`" in done.stderr


def test_a_device_without_room_is_named_plainly() -> None:
    done = mars("synthesise", LEVEL0, "-o", "/dev/full")
    assert (done.returncode, done.stderr) == (
        2,
        "mars-asp: error: `/dev/full`: No space left on device\n",
    )


def test_a_file_is_read_once_by_however_many_paths(tmp_path: Path) -> None:
    folder = tmp_path / "sources"
    folder.mkdir()
    (folder / "a.py").write_text(
        "# @module_start\n# @module_name A\n# @DataIn\ndef f(x: X): ...\n# @module_end\n"
    )
    (folder / "README.md").write_text("What this is.\n")
    paths = (str(folder), str(folder / "a.py"), str(folder / "**"), str(folder / "*"))
    done = mars("extract", "--format", "json", *paths)
    assert (done.returncode, done.stderr) == (0, "")
    assert [module["name"] for module in json.loads(done.stdout)["modules"]] == ["A"]
    config = tmp_path / "robot.mars"
    config.write_text(
        "@configuration\n@sources sources/*, sources/a.py\n@modules A, B\nA uses_data_from B\n"
    )
    assert mars("check", str(config)).stdout == ""


def test_extraction_prints_only_the_content_of_annotations(tmp_path: Path) -> None:
    source = tmp_path / "a.py"
    source.write_text(
        "# @module_start\n# @module_name A\n# @ControlOut Rotn_Y, Trans_Z\n"
        "def steer(p: Pose) -> Command: ...\n# @DataIn\ndef show(p: Pose): ...\n# @module_end\n"
    )
    assert mars("extract", str(source)).stdout.splitlines()[1:] == [
        "  ControlOut Rotn_Y, Trans_Z: steer(Pose) -> Command",
        "  DataIn: show(Pose)",
    ]


def test_a_command_that_runs_out_of_time_reports_it(capsys: Captured) -> None:
    def late(arguments: argparse.Namespace) -> int:
        raise TimeoutError

    assert run_plain(late, argparse.Namespace()) == 3
    assert "the time limit ended this" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("missing/out.mars", "there is no folder `missing` to write to\n    help: make it first\n"),
        (".", "this is a folder, not a file to write\n    help: name a file in it\n"),
    ],
)
def test_an_output_that_cannot_be_a_file_is_refused_before_anything_is_read(
    output: str, message: str
) -> None:
    done = mars("synthesise", "nope.mars", "-o", output)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"mars-asp: error: {output}: {message}"


def test_a_controller_that_ranks_twice_counts_at_its_highest(tmp_path: Path) -> None:
    """It once stood below and above another one, and no specification could have both."""
    text = "@configuration hierarchical\n@modules P, A, B\nP is_controlled_by A 1\n"
    text += "P is_controlled_by B 2\nP is_controlled_by A 3\n"
    made = mars("synthesise", "-", text=text)
    assert made.returncode == 0
    assert "`A` controls `P` twice: its priority 3 counts, and 1 does not" in made.stderr
    assert made.stdout.splitlines()[2:] == [
        "P is_controlled_by ArbitrationNode",
        "ArbitrationNode is_controlled_by B 2",
        "ArbitrationNode is_controlled_by A 3",
    ]
    (tmp_path / "c.mars").write_text(text)
    assert mars("verify", "-", str(tmp_path / "c.mars"), text=made.stdout).returncode == 0


def test_outcomes_of_cases_come_as_json_too(tmp_path: Path) -> None:
    (tmp_path / "right.lp").write_text("%=\n")
    (tmp_path / "wrong.lp").write_text("%= foo(1)\n")
    done = mars("test", str(tmp_path), "--format", "json")
    result = json.loads(done.stdout)
    assert (done.returncode, result["passed"], result["failed"]) == (1, 1, 1)
    right, wrong = result["cases"]
    entries = {"path": str(tmp_path / "right.lp"), "passed": True, "difference": []}
    assert right == {**entries, "title": None, "line": 1, "failures": []}
    entries = {"path": str(tmp_path / "wrong.lp"), "passed": False, "difference": ["  - foo(1)"]}
    failure = {"path": str(tmp_path / "wrong.lp"), "line": 1, "column": 1, "nearest": None}
    failure |= {"expected": "exactly this answer set", "found": [""]}
    assert wrong == {**entries, "title": None, "line": 1, "failures": [failure]}


def test_rules_of_a_pack_are_not_cases(tmp_path: Path) -> None:
    rules, cases = tmp_path / "rules", tmp_path / "rules" / "cases"
    cases.mkdir(parents=True)
    (rules / "odd.lp").write_text("odd(M) :- module(M).\n")
    (cases / "one.lp").write_text('module("M").\n#show odd/1.\n%= odd("M")\n')
    for given in (rules, rules / "odd.lp"):
        done = mars("test", str(tmp_path), "--rules", str(given))
        assert (done.returncode, done.stdout) == (0, "1 passed, 0 failed\n")
    done = mars("test", str(rules), "--rules", str(rules / "odd.lp"), "--format", "json")
    assert [Path(case["path"]).name for case in json.loads(done.stdout)["cases"]] == ["one.lp"]
    # Without --rules the file is read as a case.
    done = mars("test", str(rules / "odd.lp"))
    assert done.returncode == 1
    assert "rules of your own go with --rules" in done.stdout


def test_a_folder_without_cases_is_reported(tmp_path: Path) -> None:
    done = mars("test", str(tmp_path))
    assert done.returncode == 1
    assert f"no case in {tmp_path}: " in done.stderr


def test_a_severity_that_a_rule_takes_from_its_body_is_checked(tmp_path: Path) -> None:
    pack = tmp_path / "grave.lp"
    pack.write_text(
        "%! id: grave/heavy\n%! because: `{M}` is heavy\n"
        "consequence(heavy, S, M, 1) :- graveness(M, S).\n"
        'graveness("Turn", eror). graveness("Forward", note).\n'
    )
    config = "examples/level0/config.mars"
    for verb in (["check"], ["analyse"], ["synthesise"], ["explain"], ["explain", "heavy(Turn)"]):
        done = mars(verb[0], config, *verb[1:], "--rules", str(pack))
        assert done.returncode == 2
        output = done.stdout if verb == ["check"] else done.stderr
        assert f"{pack}:3:20: error: `eror` is not a severity" in output
        assert "did you mean `error`?" in output
    pack.write_text(pack.read_text().replace("eror", "error"))
    assert mars("check", config, "--rules", str(pack)).returncode == 1
    assert "heavy" in mars("explain", config, "heavy(Turn)", "--rules", str(pack)).stdout


@pytest.mark.parametrize("name", [b"two\nlines.mars", b"\xff\xfe.mars", b"\x1b[31mred.mars"])
@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("analyse",),
        ("analyse", "--format", "json"),
        ("explain",),
        ("synthesise",),
        ("draw", "-o", "out.svg"),
        ("fmt", "--check"),
        ("facts",),
        ("synthesise", "-o", b"out\n\xff.mars"),
    ],
)
def test_a_path_is_shown_in_one_line_and_need_be_no_utf_8(
    words: tuple[str | bytes, ...], name: bytes, tmp_path: Path
) -> None:
    path = os.path.join(os.fsencode(tmp_path), name)  # noqa: PTH118 -- no text
    with open(path, "w") as file:  # noqa: PTH123 -- no text
        file.write("@configuration\n@modules A, B\nA is_controlled_by B\nA uses_data_from B\n  C\n")
    verb, *rest = map(os.fsdecode, words)
    done = mars(verb, os.fsdecode(path), *rest, folder=tmp_path)
    assert done.returncode in (0, 1, 2)
    printed = os.fsencode(done.stdout + done.stderr)
    assert b"Traceback" not in printed
    assert b"internal error" not in printed
    assert b"\x1b[31mred" not in printed
    assert not [line for line in printed.split(b"\n") if line.startswith(b"lines.mars")]
