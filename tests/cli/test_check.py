"""`check` of many files, and their changes by `--fix`."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import jsonschema_rs
import pytest

from mars_asp.cli import run_here
from mars_asp.cli.check_output import FORMATS
from mars_asp.cli.deliver import replace_files
from mars_asp.cli.schemas import schema_text
from mars_asp.robot import load
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import HANGING, mars

DOCUMENT = jsonschema_rs.validator_for(json.loads(schema_text("check")))
#: Each finding has exactly one repair.
TWICE = """\
@configuration hierarchical
@modules A, B, C, Base
Base is_controlled_by A 2
Base is_controlled_by B 1  // kept
Base is_controlled_by B 1
A uses_data_from C
B uses_data_from C
B uses_data_from C
"""
ONCE = "".join(TWICE.splitlines(keepends=True)[n] for n in (0, 1, 2, 3, 5, 6))
#: The error may be mended in several ways.
CHOICE = "@configuration\n@modules A, Sonar\nA uses_data_from Sonr\nA uses_data_from Sonar\n"
BAD = "@configuration\n@modules A,, B\n"
CLEAN = "@configuration\n@modules A, B\nA uses_data_from B\n"


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    texts = {"twice": TWICE, "choice": CHOICE, "bad": BAD, "clean": CLEAN}
    for name, text in texts.items():
        (tmp_path / f"{name}.mars").write_text(text)
    return tmp_path


FINDINGS = sorted((ROOT / "tests/findings").glob("*.mars"))


@pytest.mark.parametrize("path", FINDINGS, ids=lambda path: path.stem)
def test_findings_are_the_expected_ones_beside_their_files(
    path: Path, update_golden: bool, capsys: Captured
) -> None:
    run_here(["check", str(path.relative_to(ROOT)), "--format", "full"])
    output = "".join(capsys.readouterr())
    if update_golden:
        path.with_suffix(".txt").write_text(output, encoding="utf-8")
    assert output == path.with_suffix(".txt").read_text(encoding="utf-8")


def test_json_keeps_each_finding_of_instances(capsys: Captured) -> None:
    run_here(["check", "tests/findings/instances.mars", "--format", "json"])
    findings = json.loads(capsys.readouterr().out)["findings"]
    unused = [each["message"] for each in findings if each["code"] == "checks/unused"]
    assert len(unused) == 5
    assert not any(", in " in message for message in unused)


def heads(text: str) -> list[str]:
    """Return the diagnostics up to their severity; those without a line up to their path."""
    lines = (line for line in text.splitlines() if re.match(r"(\S+:\d+:\d+|mars-asp): ", line))
    parts = (line.split(": ") for line in lines)
    return [": ".join(each[: 3 if each[0] == "mars-asp" else 2]) for each in parts]


def test_each_file_is_a_robot_of_its_own_and_all_are_checked(
    robots: Path, capsys: Captured
) -> None:
    (robots / "empty").mkdir()
    names = ("bad.mars", "missing.mars", "twice.mars", "empty", "choice.mars", "clean.mars")
    assert run_here(["check", *names, "./bad.mars"]) == 2
    shown = capsys.readouterr()
    assert heads(shown.out) == [
        "bad.mars:2:12: error",
        "mars-asp: error: missing.mars",
        "twice.mars:4:1: warning",
        "twice.mars:7:1: warning",
        "mars-asp: error: empty",
        "choice.mars:3:1: error",
    ]
    assert shown.err == (
        "4 errors, 2 warnings in 5 files and 1 folder\n"
        "2 of them have exactly one repair; --fix applies those that go together\n"
    )
    assert (robots / "twice.mars").read_text() == TWICE


@pytest.mark.parametrize(
    ("words", "status", "summary"),
    [
        (["clean.mars"], 0, "no problems found in 1 file\n"),
        (["choice.mars"], 1, "1 error in 1 file\n"),
        (["choice.mars", "--quiet"], 1, ""),
        (["clean.mars", "bad.mars"], 2, "1 error in 2 files\n"),
        (["clean.mars", "--fix"], 0, "no problems found in 1 file\n"),
    ],
)
def test_the_summary_counts_the_findings(
    words: list[str], status: int, summary: str, robots: Path, capsys: Captured
) -> None:
    assert run_here(["check", *words]) == status
    shown = capsys.readouterr()
    assert shown.err == summary
    assert (shown.out == "") is (words[0] == "clean.mars" and status == 0)


def test_a_finding_with_one_repair_shows_it(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", "twice.mars", "--format", "full"]) == 0
    assert capsys.readouterr().out.splitlines()[:8] == [
        "twice.mars:4:1: warning: `B` controls `Base` twice [duplicate_relationship]",
        "    4 | Base is_controlled_by B 1  // kept",
        "      | ^^^^^^^^^^^^^^^^^^^^^^^^^",
        "    5 | Base is_controlled_by B 1",
        "      | ------------------------- stated again",
        "    The second line has no effect.",
        "    help: drop one of the two lines",
        "    fix: drop the repeated line",
    ]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_fix_applies_the_printed_edits_and_keeps_line_ends(
    end: str, robots: Path, capsys: Captured
) -> None:
    path = robots / "twice.mars"
    path.write_bytes(b"\xef\xbb\xbf" + TWICE.removesuffix("\n").replace("\n", end).encode())
    path.chmod(0o640)
    assert run_here(["check", "--fix", "twice.mars", "choice.mars"]) == 1
    assert path.read_bytes() == b"\xef\xbb\xbf" + ONCE.replace("\n", end).encode()
    assert path.stat().st_mode & 0o777 == 0o640
    assert (robots / "choice.mars").read_text() == CHOICE
    shown = capsys.readouterr()
    assert heads(shown.out) == ["choice.mars:3:1: error"]
    assert shown.err == (
        "fixed twice.mars:4:1: duplicate_relationship(Base): drop the repeated line\n"
        "    - twice.mars:5: Base is_controlled_by B 1\n"
        "fixed twice.mars:7:1: duplicate_relationship(B): drop the repeated line\n"
        "    - twice.mars:8: B uses_data_from C\n"
        "1 error in 2 files; 2 fixed\n"
    )


def test_fix_writes_an_included_file_once_for_all_its_instances(
    robots: Path, capsys: Captured
) -> None:
    main = "@configuration hierarchical\n@include part.mars as a\n@include part.mars as b\n"
    (robots / "main.mars").write_text(main)
    part = TWICE.replace(" hierarchical", "").replace("\n", "\r\n").encode()
    (robots / "part.mars").write_bytes(part)
    assert run_here(["check", "main.mars", "--fix"]) == 0
    output = capsys.readouterr().err
    assert "fixed part.mars:4:1: duplicate_relationship(a/Base): drop the repeated line" in output
    fixed = ONCE.replace(" hierarchical", "").replace("\n", "\r\n").encode()
    assert (robots / "part.mars").read_bytes() == fixed
    assert (robots / "main.mars").read_text() == main
    assert run_here(["check", "main.mars"]) == 0


@pytest.mark.parametrize("equal", [True, False])
def test_robots_that_share_a_file_fix_it_as_one(
    equal: bool, robots: Path, capsys: Captured
) -> None:
    spare = "@modules Spare, A, B, C, Base"
    part = TWICE.replace(" hierarchical", "").replace("@modules A, B, C, Base", spare)
    (robots / "part.mars").write_text(part)
    main = "@configuration hierarchical\n@include part.mars as a\n"
    (robots / "one.mars").write_text(main)
    # The second robot uses the module that the first does not.
    (robots / "two.mars").write_text(main if equal else f"{main}a/Spare uses_data_from a/C\n")
    assert run_here(["check", "one.mars", "two.mars", "--fix"]) == (0 if equal else 2)
    output = " ".join("".join(capsys.readouterr()).split())
    assert ("`part.mars` was not fixed: it is changed for `one.mars`" in output) is not equal
    assert "in 2 files; 3 fixed" in output
    assert (robots / "part.mars").read_text() == ONCE.replace(" hierarchical", "")


def test_applied_fixes_are_listed_in_json(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", "--fix", "--format", "json", "twice.mars", "choice.mars"]) == 1
    shown = capsys.readouterr()
    found = json.loads(shown.out)
    assert [found[key] for key in ("errors", "warnings", "fixed")] == [1, 0, 2]
    assert [each["path"] for each in found["files"]] == ["twice.mars", "choice.mars"]
    lines = [line for each in found["files"][0]["fixed"] for line in each["repairs"][0]["lines"]]
    assert [(line["line"], line["new"]) for line in lines] == [(5, None), (8, None)]
    assert shown.err == "1 error in 2 files; 2 fixed\n"
    (finding,) = found["findings"]
    assert (finding["code"], finding["line"], finding["fix"]) == ("checks/misspelt", 3, None)


def test_a_read_only_file_is_left_alone(robots: Path, capsys: Captured) -> None:
    (robots / "twice.mars").chmod(0o444)
    assert run_here(["check", "--fix", "twice.mars"]) == 2
    shown = capsys.readouterr()
    assert "was not fixed: it is read-only" in shown.out
    assert "\nfixed" not in shown.err
    assert (robots / "twice.mars").read_text() == TWICE


@pytest.mark.parametrize("command", ["check --fix twice.mars", "fmt twice.mars"])
def test_a_file_in_a_read_only_folder_is_left_alone(
    command: str, robots: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    (robots / "twice.mars").write_text(f"\n{TWICE}")
    # Modes of folders do not count for root.
    monkeypatch.setattr("os.access", lambda path, mode: str(path) != str(robots))
    assert run_here(command.split()) == 2
    output = "".join(capsys.readouterr())
    assert f"its folder `{robots}` is read-only" in output
    assert "\nfixed" not in output and "formatted" not in output


@pytest.mark.parametrize(
    ("text", "status", "expected"),
    [(TWICE, 0, ONCE), (CHOICE, 1, CHOICE), (BAD, 2, BAD), (CLEAN, 0, CLEAN)],
)
def test_the_text_of_standard_input_goes_to_the_output(
    text: str, status: int, expected: str
) -> None:
    done = mars("check", "--fix", "-", text=text)
    assert (done.returncode, done.stdout) == (status, expected)


def test_a_repair_that_adds_a_warning_announces_it(capsys: Captured) -> None:
    assert run_here(["check", "examples/module-conflict/two-cameras.mars", "--format", "full"]) == 0
    assert "then warns: `FollowBall` and `WatchDoor`" in capsys.readouterr().out


@pytest.mark.parametrize("fault", ["changed", "read-only", "gone"])
def test_files_are_replaced_together_or_not_at_all(fault: str, tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    first.write_bytes(b"1")
    second.write_bytes(b"other" if fault == "changed" else b"2")
    if fault == "read-only":
        second.chmod(0o444)
    if fault == "gone":
        second.unlink()
    with pytest.raises(OSError, match="b"):
        replace_files([(str(first), b"new", b"1"), (str(second), b"new", b"2")])
    assert first.read_bytes() == b"1"
    assert {path.name for path in tmp_path.iterdir()} <= {"a", "b"}


def test_a_rename_that_fails_restores_replaced_files(tmp_path: Path, monkeypatch: Patch) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    first.write_bytes(b"1")
    second.write_bytes(b"2")
    replace = Path.replace

    def fail(self: Path, target: Path) -> Path:
        if target == second:
            raise OSError(28, "no room")
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OSError, match="no room"):
        replace_files([(str(first), b"new", b"1"), (str(second), b"new", b"2")])
    assert (first.read_bytes(), second.read_bytes()) == (b"1", b"2")
    assert {path.name for path in tmp_path.iterdir()} == {"a", "b"}


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ([], 0),
        (["--fail-on", "error"], 0),
        (["--fail-on", "warning"], 1),
        (["--fail-on", "warning", "--ignore", "ambiguous_priority"], 0),
        (["--fail-on", "warning", "--baseline", "known.json"], 0),
    ],
)
def test_options_make_warnings_fail(
    words: list[str], status: int, tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = str(ROOT / "examples/level0/turn-priority-0.mars")
    run_here(["check", robot, "--write-baseline", "known.json"])
    assert run_here(["check", robot, *words]) == status


def test_changes_by_hand_name_the_other_files(monkeypatch: Patch, capsys: Captured) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("COLUMNS", "400")
    run_here(["explain", "examples/ros2_workspace", "--repair", "loose_end", "--quiet"])
    output = capsys.readouterr().out
    base = "examples/ros2_workspace/src/scout_base/src/base_driver.cpp"
    assert "by hand: give both one name: rename `/odometry` of `/patrol` to `/odom`" in output
    assert f"see also {base}:12" in output


@pytest.mark.parametrize("command", ["synthesise", "explain --repair"])
def test_findings_of_a_workspace_are_the_same_in_every_command(
    command: str, capsys: Captured
) -> None:
    workspace = str(ROOT / "examples" / "ros2_workspace")
    run_here([*command.split(), workspace])
    output = " ".join("".join(capsys.readouterr()).split())
    for finding in load(workspace).check():
        if finding.severity != "note":
            assert finding.message in output, finding
    assert "control `/velocity_smoother` with the same priority" not in output


# ---- Streams and formats -------------------------------------------------------------------------


def test_findings_go_to_standard_output_and_notes_to_standard_error(
    monkeypatch: Patch,
) -> None:
    done = mars("check", "examples/ros2_workspace")
    findings, notes = done.stdout.splitlines(), done.stderr.splitlines()
    assert done.returncode == 0
    assert [line.partition(": ")[2].partition(":")[0] for line in findings] == ["warning"] * 3
    assert all(re.fullmatch(r"\S+:\d+:\d+: warning: .* \[[a-z_]+\]", line) for line in findings)
    assert [": note: " in line for line in notes] == [True, True, False]
    assert notes[-1] == "3 warnings in 1 folder"


@pytest.mark.parametrize("form", FORMATS)
def test_a_clean_run_prints_nothing_but_documents(form: str, robots: Path) -> None:
    done = mars("check", "clean.mars", "--format", form, folder=robots)
    assert (done.returncode, done.stderr) == (0, "no problems found in 1 file\n")
    done = mars("check", "clean.mars", "--format", form, "--quiet", folder=robots)
    assert (done.returncode, done.stderr) == (0, "")
    if form == "json":
        document = json.loads(done.stdout)
        assert (document["findings"], document["notes"]) == ([], [])
        assert [each["path"] for each in document["files"]] == ["clean.mars"]
    else:
        assert bool(done.stdout) is (form in ("sarif", "junit", "gitlab"))


def test_concise_lines_and_heads_of_full_text_are_never_wrapped(
    capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    robot = "examples/level0/turn-priority-0.mars"
    line = (
        f"{robot}:11:1: warning: `Forward` and `Turn` control `MobilePlatform` with the same"
        " priority, 0 [ambiguous_priority]"
    )
    run_here(["check", robot])
    assert capsys.readouterr().out == f"{line}\n"
    run_here(["check", robot, "--format", "full"])
    head, *further = capsys.readouterr().out.splitlines()
    assert head == line
    assert len(further) > 5 and max(map(len, further)) <= 60


def test_text_is_full_and_wrapped_on_a_terminal(capsys: Captured) -> None:
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    words = ["check", "examples/level0/turn-priority-0.mars", "--color", "never"]
    environment = {**os.environ, "COLUMNS": "60"}
    command = [sys.executable, "-m", "mars_asp", *words]
    subprocess.run(command, cwd=ROOT, env=environment, stdout=theirs, stderr=theirs, check=True)
    os.close(theirs)
    output = os.read(ours, 1 << 16).decode().replace("\r\n", "\n")
    # A slow machine shows progress, and clears it.
    output = output.rpartition("\r")[2]
    os.close(ours)
    assert output.startswith("examples/level0/turn-priority-0.mars:11:1: warning:\n  `Forward` and")
    assert "\n       | ^^^^" in output
    # The summary is written after the findings, though to another stream.
    assert output.endswith("priorities that differ\n1 warning in 1 file\n")


@pytest.mark.parametrize("form", ["text", *FORMATS[3:]])
def test_any_format_is_written_to_a_file(form: str, robots: Path, capsys: Captured) -> None:
    words = ["check", "twice.mars", "--format", form]
    assert run_here(words) == 0
    printed = capsys.readouterr()
    assert run_here([*words, "-o", "found"]) == 0
    assert capsys.readouterr() == ("", printed.err)
    assert Path("found").read_text() == printed.out
    assert run_here([*words, "-o", "-"]) == 0
    assert capsys.readouterr() == printed
    assert run_here([*words, "-o", "twice.mars"]) == 2
    assert "`twice.mars` is an input or another output" in capsys.readouterr().err
    assert (robots / "twice.mars").read_text() == TWICE


def test_findings_go_to_standard_error_where_the_output_is_a_text_or_a_baseline() -> None:
    done = mars("check", "--fix", "-", text=CHOICE)
    assert done.stdout == CHOICE
    assert heads(done.stderr) == ["<stdin>:3:1: error"]
    done = mars("check", "-", "--write-baseline", "-", text=BAD)
    assert (done.returncode, done.stdout) == (2, "")
    assert heads(done.stderr) == ["<stdin>:2:12: error", "mars-asp: error: -"]
    done = mars("check", "--fix", "-", "--format", "json", text=TWICE)
    document = json.loads(done.stdout)
    assert document["files"][0]["text"] == ONCE
    assert list(DOCUMENT.iter_errors(document)) == []


def test_the_schema_of_the_document_is_printed_and_refuses_others() -> None:
    assert mars("check", "--schema").stdout == schema_text("check")
    assert not DOCUMENT.is_valid({"format": "mars-check", "version": 1})


def test_one_document_has_findings_notes_and_each_robot(robots: Path) -> None:
    names = ("bad.mars", "twice.mars", "clean.mars", str(ROOT / "examples/ros2_workspace"))
    done = mars("check", *names, "--format", "json", folder=robots)
    document = json.loads(done.stdout)
    assert done.returncode == 2
    assert done.stderr.startswith("1 error, 5 warnings in 3 files and 1 folder\n")
    assert list(DOCUMENT.iter_errors(document)) == []
    assert (document["format"], document["version"]) == ("mars-check", 1)
    assert [each["path"] for each in document["files"]] == list(names)
    first = document["findings"][0]
    assert (first["kind"], first["code"], first["severity"]) == (None, "syntax", "error")
    assert {each["kind"] for each in document["notes"]} == {"launch", "catalogue"}
    assert {each["severity"] for each in document["notes"]} == {"note"}
    assert [document[key] for key in ("errors", "warnings", "fixed")] == [1, 5, 0]


@pytest.mark.parametrize("wrong", ["baseline", "settings", "option", "rules"])
def test_errors_of_the_selection_are_in_the_document(
    wrong: str, robots: Path, capsys: Captured
) -> None:
    if wrong == "settings":
        (robots / "mars.toml").write_text("selct = []\n")
    words = {
        "baseline": ["--baseline", "gone"],
        "settings": [],
        "option": ["--select", "no"],
        "rules": ["--rules", "gone"],
    }
    assert run_here(["check", "clean.mars", "--format", "json", *words[wrong]]) == 2
    output = capsys.readouterr()
    document = json.loads(output.out)
    assert (output.err, document["errors"]) == ("", 1)
    assert list(DOCUMENT.iter_errors(document)) == []
    assert document["findings"][0]["kind"] is None


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["choice.mars", "--exit-zero"], 0),
        (["choice.mars", "--fail-on", "never"], 0),
        (["twice.mars", "--fail-on", "warning"], 1),
        (["twice.mars", "--fail-on", "warning", "--exit-zero"], 0),
        (["twice.mars", "--exit-zero", "--fail-on", "warning"], 0),
        (["bad.mars", "choice.mars", "--exit-zero"], 2),
        (["choice.mars", "bad.mars"], 2),
        (["choice.mars", "--exit-zero", "--select", "no"], 2),
    ],
)
def test_findings_need_not_count_but_bad_input_does(
    words: list[str], status: int, robots: Path, capsys: Captured
) -> None:
    assert run_here(["check", *words]) == status
    output = capsys.readouterr()
    # Wrong options are not findings.
    assert output.err.startswith("mars-asp: error: --select") if "no" in words else output.out


def test_a_baseline_replaces_no_other_file(robots: Path, capsys: Captured) -> None:
    words = ["check", "twice.mars", "--write-baseline"]
    assert run_here([*words, "clean.mars"]) == 2
    assert "clean.mars: the file is not a baseline" in capsys.readouterr().err
    assert (robots / "clean.mars").read_text() == CLEAN
    (robots / "empty").touch()
    for name in ("known.json", "known.json", "empty"):
        assert run_here([*words, name]) < 2
        assert (robots / name).read_text().startswith('{"format": "mars-baseline"')


def test_a_baseline_to_a_pipe_waits_for_no_writer(robots: Path) -> None:
    os.mkfifo("pipe")
    reader = os.open("pipe", os.O_RDONLY | os.O_NONBLOCK)
    words = ["check", "clean.mars", "--write-baseline", "pipe"]
    subprocess.run([sys.executable, "-m", "mars_asp", *words], check=True, timeout=HANGING)
    assert os.read(reader, 1000).startswith(b'{"format": "mars-baseline"')
    os.close(reader)


def test_an_error_of_settings_is_reported_once_for_all_robots(
    robots: Path, capsys: Captured
) -> None:
    (robots / "mars.toml").write_text('ignore = ["modul_conflict"]\n')
    assert run_here(["check", "clean.mars", "twice.mars"]) == 2
    assert capsys.readouterr().out.count("mars.toml:1:11: error") == 1
    (robots / "mars.toml").rename("own.toml")
    assert run_here(["check", "clean.mars", "twice.mars", "--config", "own.toml"]) == 2
    assert capsys.readouterr().out.count("own.toml:1:11: error") == 1
    assert run_here(["check", "clean.mars", "twice.mars", "--sources", "none"]) == 2
    assert capsys.readouterr().out.count("`none`: no such file or folder") == 1
    assert run_here(["check", "clean.mars", "--isolated", "--config", "own.toml"]) == 2
    assert "--isolated takes no settings, and --config names some" in capsys.readouterr().err


def test_missing_packs_of_settings_are_at_their_entries(robots: Path, capsys: Captured) -> None:
    (robots / "mars.toml").write_text('rules = ["gone", "lost"]\n')
    assert run_here(["check", "clean.mars"]) == 2
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(" error")[0] for line in lines] == ["mars.toml:1:10:", "mars.toml:1:18:"]


def test_the_note_that_packs_judge_no_launch_trees_can_be_ignored(capsys: Captured) -> None:
    pack = ROOT / "examples" / "packs" / "watchdog"
    words = ["check", str(ROOT / "examples" / "ros2_workspace"), "--rules", str(pack)]
    assert run_here(words) == 0
    assert "rule packs judge configurations" in capsys.readouterr().err
    assert run_here([*words, "--ignore", "launch"]) == 0
    assert "rule packs judge configurations" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "text", ["selct = []", 'select = ["nothing"]', "select = [", "baseline = 1"]
)
@pytest.mark.parametrize("named", [["own.toml"], []], ids=["config", "nearest"])
def test_errors_of_settings_are_findings_wherever_they_are(
    text: str, named: list[str], robots: Path, capsys: Captured
) -> None:
    name = "own.toml" if named else "mars.toml"
    (robots / "sub").mkdir()
    (robots / "sub" / "a.mars").write_text(CLEAN)
    (robots / "sub" / name).write_text(text)
    options = ["--config", f"sub/{name}"] if named else []
    for files in (["sub/a.mars"], ["clean.mars", "sub"]):
        assert run_here(["check", *files, *options]) == 2
        output = capsys.readouterr()
        assert output.out.startswith(f"sub/{name}:1:") and output.out.count("\n") == 1
        assert "error: " not in output.err
    # A difference alone is on standard output.
    assert run_here(["check", "sub/a.mars", *options, "--diff"]) == 2
    output = capsys.readouterr()
    assert output.out == "" and output.err.startswith(f"sub/{name}:1:")


def test_a_word_after_two_dashes_is_a_path(robots: Path) -> None:
    (robots / "-odd.mars").write_text(CLEAN)
    assert run_here(["check", "-vq", "--", "-odd.mars", "clean.mars"]) == 0


def test_an_empty_path_is_refused(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", ""]) == 2
    assert "a path is empty" in capsys.readouterr().err


def test_findings_go_to_a_pipe_that_is_named(robots: Path) -> None:
    words = ["check", "clean.mars", "--format", "json", "-o", "/dev/stdout"]
    ended = subprocess.run(
        [sys.executable, "-m", "mars_asp", *words], capture_output=True, text=True, check=True
    )
    assert json.loads(ended.stdout)["format"] == "mars-check"


def test_a_package_has_a_note_about_its_workspace(
    capsys: Captured,
) -> None:
    workspace = ROOT / "examples" / "ros2_workspace"
    assert run_here(["check", str(workspace / "src" / "scout_drive")]) == 0
    assert "the folder is a part of the workspace" in capsys.readouterr().err
    assert run_here(["check", str(workspace)]) == 0
    assert "a part of the workspace" not in capsys.readouterr().err


def test_a_folder_inside_a_package_is_read_like_its_launch_files(
    capsys: Captured,
) -> None:
    launch = ROOT / "examples" / "ros2_workspace" / "src" / "scout_drive" / "launch"
    assert run_here(["check", str(launch), "-q"]) == 0
    of_folder = capsys.readouterr().out
    assert run_here(["check", str(launch / "scout.launch.py"), "-q"]) == 0
    assert of_folder == capsys.readouterr().out
    assert "[guard_bypass]" in of_folder


def test_statistics_are_a_line_a_kind(robots: Path, capsys: Captured) -> None:
    (robots / "many.mars").write_text(TWICE + "A uses_data_from C\n" * 8)
    words = ["check", "bad.mars", "choice.mars", "many.mars", "--statistics"]
    assert run_here(words) == 2
    output = capsys.readouterr()
    lines = [line.split() for line in output.out.splitlines()]
    numbers = [int(number) for number, _ in lines]
    assert [name for _, name in lines] == ["duplicate_relationship", "syntax", "undeclared_module"]
    assert numbers == sorted(numbers, reverse=True) and numbers[1:] == [1, 1]
    assert f"2 errors, {numbers[0]} warnings in 3 files\n" in output.err
    run_here([*words, "--ignore", "undeclared_module,duplicate_relationship"])
    assert capsys.readouterr().out == "1 syntax\n"
    (robots / "empty").mkdir()
    assert run_here(["check", "empty", "gone.mars", "--statistics"]) == 2
    output = capsys.readouterr()
    assert output.out == "2 unreadable\n"
    assert "gone.mars: no such file" in output.err and "empty: " in output.err
    assert run_here([*words, "--format", "json"]) == 2
    assert "leave out `--format json`" in capsys.readouterr().err


def test_standard_input_has_the_locations_and_settings_of_a_name(
    robots: Path, capsys: Captured
) -> None:
    (robots / "sub").mkdir()
    (robots / "sub" / "mars.toml").write_text('ignore = ["duplicate_relationship"]\n')
    done = mars("check", "-", "--stdin-filename", "sub/new.mars", text=TWICE, folder=robots)
    assert "duplicate_relationship" not in done.stdout
    done = mars("check", "-", "--stdin-filename", "new.mars", text=TWICE, folder=robots)
    assert done.stdout.startswith("new.mars:4:1: warning: ")
    words = ("analyse", "-", "--stdin-filename", "new.mars", "--format", "json")
    document = json.loads(mars(*words, text=TWICE, folder=robots).stdout)
    assert document["consequences"][0]["locations"][0]["path"] == "new.mars"
    done = mars("fmt", "--check", "-", "--stdin-filename", "new.mars", text=BAD, folder=robots)
    assert done.stderr.startswith("new.mars:2:12: error: ")
    assert run_here(["check", "clean.mars", "--stdin-filename", "new.mars"]) == 2
    assert "add `-`" in capsys.readouterr().err


def test_a_difference_shows_repairs_and_writes_nothing(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", "--diff", "twice.mars", "clean.mars"]) == 1
    output = capsys.readouterr()
    assert output.out.startswith("--- twice.mars\n+++ twice.mars\n@@ ")
    removed = [line for line in output.out.splitlines()[3:] if line.startswith("-")]
    assert removed == ["-Base is_controlled_by B 1", "-B uses_data_from C"]
    assert output.err == "2 findings would be fixed in 1 file\n"
    for option in ("--diff", "--fix"):
        run_here(["check", option, "choice.mars"])
        message = " ".join(capsys.readouterr().err.split())
        assert "`mars-asp explain choice.mars --repair` shows those that there are" in message
    assert (robots / "twice.mars").read_text() == TWICE
    assert run_here(["check", "--diff", "clean.mars", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert run_here(["check", "--diff", str(ROOT / "examples" / "ros2_workspace")]) == 0
    output = capsys.readouterr()
    assert output.out == "" and "repairs are edits of `.mars` files" in output.err
    assert output.err.endswith("0 findings would be fixed\n")
    assert run_here(["check", "--diff", "bad.mars", "twice.mars"]) == 2
    output = capsys.readouterr()
    assert output.out.startswith("--- twice.mars\n")
    assert output.err.startswith("bad.mars:2:12: error: ")
    done = mars("check", "--diff", "-", text=TWICE)
    assert (done.returncode, done.stdout[:12]) == (1, "--- <stdin>\n")
    assert run_here(["check", "--diff", "--format", "json", "twice.mars"]) == 2
    assert "--diff prints a unified diff" in capsys.readouterr().err


def test_repairs_left_out_are_counted(robots: Path, capsys: Captured) -> None:
    (robots / "unused.mars").write_text("@configuration\n@modules Screen, Camera\n")
    left_out = "1 repair was left out, as it does not go together with the others\n"
    run_here(["check", "--diff", "unused.mars"])
    assert capsys.readouterr().err == f"1 finding would be fixed in 1 file; {left_out}"
    run_here(["check", "--fix", "unused.mars"])
    assert capsys.readouterr().err.endswith(f"1 warning in 1 file; 1 fixed\n{left_out}")


@pytest.mark.parametrize("form", ["github", "sarif", "json"])
def test_quiet_leaves_out_notes_except_the_unread_in_json(
    form: str, robots: Path, capsys: Captured
) -> None:
    node = '<node pkg="{}" exec="x" name="x"/>'
    launch = f"<launch>{node.format('nav2_planner')}{node.format('nowhere')}</launch>"
    (robots / "all.launch.xml").write_text(launch)
    words = ["check", "all.launch.xml", "--format", form]
    shown = []
    for options in ([], ["--quiet"]):
        run_here([*words, *options])
        shown.append(capsys.readouterr().out)
    not_read = [" not read: " in text for text in shown]
    assert not_read == [True, form == "json"]


@pytest.mark.parametrize(
    "words",
    [["--baseline", "gone"], ["--rules", "gone"], ["--select", "no"], ["--launch", "gone"]],
)
def test_wrong_values_of_options_go_to_standard_error(words: list[str], capsys: Captured) -> None:
    assert run_here(["check", str(ROOT / "examples" / "ros2_workspace"), *words]) == 2
    output = capsys.readouterr()
    assert output.out == "" and output.err.startswith("mars-asp: error: ")


def test_of_a_missing_file_a_similar_one_is_proposed(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a").mkdir()
    Path("a/robot.mars").touch()
    assert run_here(["check", "a/robt.mars"]) == 2
    assert "a/robt.mars: no such file (did you mean `a/robot.mars`?)" in capsys.readouterr().out
    assert run_here(["check", "a/x.mars"]) == 2
    assert "did you mean" not in capsys.readouterr().out


def test_an_error_without_a_line_names_its_file_once(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", "nope.mars"]) == 2
    assert capsys.readouterr().out == "mars-asp: error: nope.mars: no such file\n"
    assert run_here(["check", "nope.mars", "--format", "full"]) == 2
    assert capsys.readouterr().out == "mars-asp: error: nope.mars: no such file\n"
    assert run_here(["check", "nope.mars", "--format", "json"]) == 2
    found = json.loads(capsys.readouterr().out)["findings"][0]
    assert (found["path"], found["line"], found["column"]) == ("nope.mars", None, None)
    for name in ("sarif", "junit", "gitlab", "github"):
        assert run_here(["check", "nope.mars", "--format", name]) == 2
        assert ":1:1" not in capsys.readouterr().out


def test_a_printed_location_is_explained(robots: Path, capsys: Captured) -> None:
    run_here(["check", "twice.mars"])
    location = capsys.readouterr().out.partition(": ")[0]
    assert location == "twice.mars:4:1"
    assert run_here(["explain", location]) == 0
    pasted = capsys.readouterr().out
    for subject in ("twice.mars:4", location):
        run_here(["explain", "twice.mars", subject])
        assert pasted == capsys.readouterr().out
    assert "twice.mars:4" in pasted


def test_a_module_may_be_named_like_a_location(robots: Path, capsys: Captured) -> None:
    name = '"v1.x:2:3"'
    lines = f"B uses_data_from {name}\nC uses_data_from {name}\n"
    (robots / "named.mars").write_text(f"@configuration\n@modules {name}, B, C\n{lines}")
    assert run_here(["explain", "named.mars", "v1.x:2:3"]) == 0
    assert "DataSplitter1: `v1.x:2:3` feeds 2 modules" in capsys.readouterr().out


def test_excluded_paths_are_named_with_verbose(robots: Path, capsys: Captured) -> None:
    assert run_here(["check", "--exclude", "[bct]*.mars", "--exclude", "twice.mars", "-v"]) == 2
    assert "mars-asp: excluded bad.mars\n" in capsys.readouterr().err


def test_fix_reports_the_warnings_that_it_brings(tmp_path: Path, capsys: Captured) -> None:
    robot = tmp_path / "robot.mars"
    shutil.copy(ROOT / "examples/module-conflict/two-cameras.mars", robot)
    for option in ("--diff", "--fix"):
        run_here(["check", str(robot), option])
        output = " ".join(capsys.readouterr().err.split())
        assert "then warns: `FollowBall` and `WatchDoor` control `Head` with the same" in output


def test_a_finding_that_another_repair_fixes_is_not_left_out(
    tmp_path: Path, capsys: Captured
) -> None:
    robot = tmp_path / "robot.mars"
    shutil.copy(ROOT / "tests/cli/one_repair_of_two.mars", robot)
    run_here(["check", str(robot), "--fix"])
    output = capsys.readouterr().err
    assert "left out" not in output and "; 1 fixed" in output
    run_here(["check", str(robot)])
    assert "exactly one repair" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "first", "number"),
    [
        ("import os\n\nprint(os)\n@a\n", "mars-asp: error: `<stdin>` is not a robot: no line", 1),
        ("# Robot\n@configuratoin\n@modules A B\n", "<stdin>:2:1: error: found `@configurat", 2),
        ("A B\nC D\nA uses_data_from B\n", "<stdin>:1:3: error: found `B`, expected", 2),
        ("Camera\n", "<stdin>:1:7: error: found the end of the line", 1),
        ("", "<stdin>:1:1: error: the file has no `@configuration`", 1),
    ],
)
def test_another_text_at_standard_input_is_one_error(text: str, first: str, number: int) -> None:
    done = mars("check", "-", text=text)
    assert done.returncode == 2
    assert done.stdout.startswith(first) and done.stdout.count(" error: ") == number


def test_a_foreign_file_without_findings_has_nothing_to_fix(
    tmp_path: Path, capsys: Captured
) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(
        '<robot name="arm"><link name="a"/><link name="b"/><joint name="j" type="fixed">'
        '<parent link="a"/><child link="b"/></joint></robot>'
    )
    assert run_here(["check", str(path), "--fix"]) == 0
    assert capsys.readouterr() == ("", "no problems found in 1 file\n")


BLOCK = (
    "@module_start\n@module_name Docking\n@ControlOut\n@Output none\n@Input none\n"
    "void drive();\n@module_end\n"
)


@pytest.mark.parametrize("origin", ["", "// imported from ros2\n", "// imported from dora\n"])
@pytest.mark.parametrize(
    ("modules", "help"),
    [
        ("Base, Joy", "add `Docking` to `@modules`"),
        ("Base, Joy, Dockin", "did you mean `Dockin`? otherwise add `Docking` to `@modules`"),
    ],
)
def test_a_described_module_outside_of_modules_is_not_misspelt(
    modules: str, help: str, origin: str, tmp_path: Path, capsys: Captured
) -> None:
    lines = "Base is_controlled_by Joy 1\nBase is_controlled_by Docking 2\n"
    path = tmp_path / "robot.mars"
    path.write_text(f"@configuration hierarchical\n@modules {modules}\n{origin}{lines}{BLOCK}")
    assert run_here(["check", str(path), "--select", "undeclared_module", "--format", "json"]) == 1
    [found] = json.loads(capsys.readouterr().out)["findings"]
    assert "`@modules` does not name it" in found["message"]
    assert found["help"] == help
