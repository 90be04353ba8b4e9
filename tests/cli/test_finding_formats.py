"""Findings as SARIF, by its schema, and as workflow commands of GitHub."""

import json
import re
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import jsonschema_rs
import pytest

from mars_asp.cli import run_here
from tests.support.campaigns import sample
from tests.support.configurations import FINDINGS as ROBOT
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.packages import write_package

SCHEMA = json.loads((ROOT / "tests/sarif/sarif-schema-2.1.0.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema_rs.Draft4Validator(SCHEMA, validate_formats=True)
#: What a message of a pack may hold: what ends commands, and what others read as marks.
PACK = """\
%! because: 100% of `{M}` :: crowded, [no](x) %0A ::error::x
%! help: line %25 and ::
consequence(crowded, error, M, here) :- module(M).
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a b.mars").write_text(ROBOT)
    return tmp_path


def sarif(capsys: Captured, *words: str) -> tuple[int, dict[str, Any]]:
    """Return the status of a command and the one run of its log, which the schema allows."""
    status = run_here([*words, "--format", "sarif"])
    shown = capsys.readouterr()
    # The log has the notes; standard error has the summary of `check` alone.
    assert re.search(r"(error|warning|note): ", shown.err) is None
    assert words[0] == "check" or shown.err == ""
    log = json.loads(shown.out)
    assert [error.message for error in VALIDATOR.iter_errors(log)] == []
    (run,) = log["runs"]
    assert run["invocations"][0]["exitCode"] == status
    assert run["invocations"][0]["executionSuccessful"] == (status < 2)
    rules = run["tool"]["driver"]["rules"]
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    return status, run


def placed(run: dict[str, Any]) -> list[tuple[str, str, int]]:
    """Return the level, the file and the line of each result."""
    found = []
    for result in run["results"]:
        (location,) = result["locations"]
        physical = location["physicalLocation"]
        uri = physical["artifactLocation"]["uri"]
        found.append((result["level"], unquote(uri), physical["region"]["startLine"]))
    return found


def test_a_schema_that_refuses_nothing_would_be_no_check() -> None:
    assert not VALIDATOR.is_valid({"version": "2.1.0", "runs": [{"tool": {}}]})


@pytest.mark.parametrize(
    ("verb", "expected"),
    [
        ("check", [("warning", 3), ("error", 5)]),
        ("analyse", [("warning", 3), ("note", 3), ("error", 5), ("note", 6)]),
    ],
)
def test_findings_are_results(verb: str, expected: list[tuple[str, int]], capsys: Captured) -> None:
    status, run = sarif(capsys, verb, "a b.mars")
    assert status == 1
    assert placed(run) == [(level, "a b.mars", line) for level, line in expected]
    warning = run["results"][0]
    assert warning["locations"][0]["physicalLocation"]["artifactLocation"] == {
        "uri": "a%20b.mars",
        "uriBaseId": "%SRCROOT%",
    }
    assert warning["message"]["text"].endswith("that differ. See [`B` also has priority 1](1).")
    (other,) = warning["relatedLocations"]
    assert other["physicalLocation"]["region"]["startLine"] == 4
    assert other["message"]["text"] == "`B` also has priority 1."
    rule = run["tool"]["driver"]["rules"][warning["ruleIndex"]]
    assert rule["name"] == rule["properties"]["kind"] == "ambiguous_priority"
    assert "priorities decide which controller wins" in rule["help"]["text"].lower()
    assert run_here(rule["properties"]["command"].split()[1:]) == 0
    assert capsys.readouterr().out.startswith("## ambiguous_priority\n")


def test_each_finding_of_the_examples_makes_a_log(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)
    files = sample(sorted((ROOT / "tests/findings").glob("*.mars")), 3)
    names = [str(path.relative_to(ROOT)) for path in files]
    _, run = sarif(capsys, "check", *names, "docs/how-to/twist_mux.yaml", *names[:3])
    assert len(run["results"]) > 15
    for rule in run["tool"]["driver"]["rules"]:
        # GitHub asks for all of these.
        assert all(rule[key]["text"] for key in ("shortDescription", "fullDescription", "help"))
    for _, uri, line in placed(run):
        assert line <= len((ROOT / uri).read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize("verb", ["check", "analyse"])
def test_wrong_input_is_a_result_too(verb: str, folder: Path, capsys: Captured) -> None:
    (folder / "bad.mars").write_text("@configuration\n@modules A,, B\nA uses_data_from\n")
    (folder / "own.lp").write_text("consequence(x, error, M, here) :- \n")
    status, run = sarif(capsys, verb, "bad.mars")
    assert (status, [place[:2] for place in placed(run)]) == (2, [("error", "bad.mars")] * 2)
    status, run = sarif(capsys, verb, "missing.mars")
    assert (status, placed(run)) == (2, [("error", "missing.mars", 1)])
    status, run = sarif(capsys, verb, "a b.mars", "--rules", "own.lp")
    assert (status, placed(run)[0][:2]) == (2, ("error", "own.lp"))
    status, run = sarif(capsys, verb, "a b.mars", "--select", "no")
    (result,) = run["invocations"][0]["toolConfigurationNotifications"]
    assert (status, run["results"], result["level"]) == (2, [], "error")
    assert result["message"]["text"].startswith("--select: No rule finds `no`.")


def edited(text: str, run: dict[str, Any]) -> str:
    """Return a text as the fixes of a log make it, from the last to the first."""
    lines = text.split("\n")
    starts = [sum(len(line) + 1 for line in lines[:number]) for number in range(len(lines))]
    edits = []
    for result in run["results"]:
        for fix in result.get("fixes", []):
            (change,) = fix["artifactChanges"]
            for each in change["replacements"]:
                at = each["deletedRegion"]
                begin, end = (
                    starts[at[f"{side}Line"] - 1] + at[f"{side}Column"] - 1
                    for side in ("start", "end")
                )
                edits.append((begin, end, each.get("insertedContent", {}).get("text", "")))
    for begin, end, new in sorted(set(edits), reverse=True):
        text = text[:begin] + new + text[end:]
    return text


#: Of these all repairs go together; lines are put otherwise, deleted and inserted.
FIXABLE = ("conversion", "left-over", "listed", "ports", "twice", "unused")


@pytest.mark.parametrize("name", sample(FIXABLE, 2))
def test_fixes_equal_the_edits_of_fix(name: str, folder: Path, capsys: Captured) -> None:
    text = (ROOT / "tests/repair" / name / "config.mars").read_text(encoding="utf-8")
    (folder / "r.mars").write_text(text)
    _, run = sarif(capsys, "check", "r.mars")
    made = edited(text, run)
    run_here(["check", "r.mars", "--fix"])
    assert made == (folder / "r.mars").read_text(encoding="utf-8") != text


def test_hidden_findings_are_marked_as_suppressed(folder: Path, capsys: Captured) -> None:
    path = folder / "a b.mars"
    assert (
        run_here(["check", path.name, "--select", "ambiguous_priority", "--write-baseline", "k"])
        == 0
    )
    capsys.readouterr()
    text = ROBOT.replace("on Arm", "on Arm // mars: ignore[module_conflict] it turns")
    path.write_text(f"{text}Camera is_mounted_on Camera\n")
    status, run = sarif(capsys, "check", path.name, "--baseline", "k")
    assert status == 1
    found = {
        result["locations"][0]["physicalLocation"]["region"]["startLine"]: (
            result["baselineState"],
            result.get("suppressions"),
        )
        for result in run["results"]
    }
    assert found == {
        3: ("unchanged", [{"kind": "external", "status": "accepted"}]),
        5: ("new", [{"kind": "inSource", "status": "accepted", "justification": "it turns"}]),
        8: ("new", None),
    }
    # A comment may hide what the baseline lists.
    path.write_text(ROBOT)
    lines = path.read_text().splitlines()
    lines[2] += " // mars: ignore[ambiguous_priority] in turns"
    path.write_text("\n".join(lines) + "\n")
    _, run = sarif(capsys, "check", path.name, "--baseline", "k", "--select", "ambiguous_priority")
    assert [each["baselineState"] for each in run["results"]] == ["unchanged"]


def test_fingerprints_stay_when_lines_move(folder: Path, capsys: Captured) -> None:
    def prints() -> list[str]:
        _, run = sarif(capsys, "check", "a b.mars")
        return [each["partialFingerprints"]["marsFinding/v1"] for each in run["results"]]

    before = prints()
    (folder / "a b.mars").write_text(ROBOT.replace("Base is", "\n\nBase is", 1))
    assert prints() == before
    assert len(set(before)) == 2


def test_paths_are_those_of_the_repository(
    folder: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    (folder / "repo/sub").mkdir(parents=True)
    (folder / "repo/.git").write_text("gitdir: elsewhere")
    (folder / "repo/sub/r.mars").write_text(ROBOT)
    monkeypatch.chdir(folder / "repo/sub")
    _, run = sarif(capsys, "check", "r.mars", str(folder / "a b.mars"))
    uris = [uri for _, uri, _ in placed(run)]
    assert uris == ["sub/r.mars"] * 2 + [f"file://{folder}/a b.mars"] * 2
    run_here(["check", "r.mars", "--format", "github", "--ignore", "module_conflict"])
    assert capsys.readouterr().out.startswith("::warning file=sub/r.mars,line=3,")


# ---- GitHub --------------------------------------------------------------------------------------


def github(capsys: Captured, *words: str) -> tuple[int, list[list[str]]]:
    """Return the status of a command, and the parts of each line as a runner reads them."""
    status = run_here([*words, "--format", "github"])
    lines = capsys.readouterr().out.splitlines()
    read = [re.fullmatch(r"::(error|warning|notice) ([^:]*)::(.*)", line) for line in lines]
    assert all(read)

    def plain(text: str) -> str:
        for code, sign in (("3A", ":"), ("2C", ","), ("0D", "\r"), ("0A", "\n"), ("25", "%")):
            text = text.replace(f"%{code}", sign)
        return text

    return status, [[m[1], *map(plain, m[2].split(",")), plain(m[3])] for m in read if m]


def test_findings_are_commands(folder: Path, capsys: Captured) -> None:
    (folder / "a b.mars").rename(folder / "a, 100%:b.mars")
    status, result = github(capsys, "check", "a, 100%:b.mars")
    assert status == 1
    assert [each[:-1] for each in result] == [
        [
            "warning",
            *("file=a, 100%:b.mars", "line=3", "endLine=3", "col=1", "endColumn=25"),
            "title=ambiguous_priority",
        ],
        [
            "error",
            *("file=a, 100%:b.mars", "line=5", "endLine=5", "col=1", "endColumn=21"),
            "title=module_conflict",
        ],
    ]
    assert result[0][-1].splitlines() == [
        "`A` and `B` control `Base` with the same priority, 1",
        "Among them, the latest message wins.",
        "help: give `A` and `B` priorities that differ",
    ]


def test_nothing_that_a_message_holds_ends_a_command(folder: Path, capsys: Captured) -> None:
    (folder / "own.lp").write_text(PACK)
    words = ("a b.mars", "--rules", "own.lp", "--select", "crowded")
    status, result = github(capsys, "analyse", *words)
    assert (status, len(result)) == (1, 5)
    assert result[0][-1].startswith("100% of `A` :: crowded, [no](x) %0A ::error::x\n")
    status, run = sarif(capsys, "analyse", *words)
    # Brackets in a message make no link in the log either.
    assert r"100% of `A` :: crowded, \[no\](x)" in run["results"][0]["message"]["text"]


def test_wrong_input_is_a_command_too(folder: Path, capsys: Captured) -> None:
    (folder / "bad.mars").write_text("@configuration\n@modules A,, B\n")
    for verb in ("check", "analyse"):
        status, (result,) = github(capsys, verb, "bad.mars")
        assert (status, result[0], result[1], result[-2]) == (
            2,
            "error",
            "file=bad.mars",
            "title=syntax",
        )
    status, (result,) = github(capsys, "check", "a b.mars", "--select", "no")
    assert (status, result[1], result[2][:31]) == (
        2,
        "title=kind",
        "--select: no rule finds `no`\nhe",
    )


def test_a_repair_is_not_mixed_into_results(capsys: Captured) -> None:
    assert run_here(["check", "a b.mars", "--fix", "--format", "sarif"]) == 2
    assert "leave out" in capsys.readouterr().err


# ---- GitLab and JUnit ----------------------------------------------------------------------------


def gitlab(capsys: Captured, *words: str) -> list[dict[str, Any]]:
    """Return the entries of a code quality report."""
    run_here(["check", *words, "--format", "gitlab"])
    entries: list[dict[str, Any]] = json.loads(capsys.readouterr().out)
    for entry in entries:
        assert {*entry} == {"description", "check_name", "fingerprint", "severity", "location"}
        assert entry["severity"] in ("info", "minor", "major", "critical", "blocker")
        assert {*entry["location"]} == {"path", "lines"}
        assert isinstance(entry["location"]["lines"]["begin"], int)
    return entries


def test_findings_are_entries_of_a_code_quality_report(folder: Path, capsys: Captured) -> None:
    (folder / "bad.mars").write_text("@configuration\n@modules A,, B\n")
    found = [
        (each["check_name"], each["severity"], each["location"]["path"])
        for each in gitlab(capsys, "a b.mars", "bad.mars")
    ]
    assert found == [
        ("ambiguous_priority", "major", "a b.mars"),
        ("module_conflict", "critical", "a b.mars"),
        ("syntax", "blocker", "bad.mars"),
    ]
    (first, _) = gitlab(capsys, str(folder / "a b.mars"))
    assert first["location"] == {"path": "a b.mars", "lines": {"begin": 3}}
    (wrong,) = gitlab(capsys, "a b.mars", "--select", "no")
    assert (wrong["severity"], wrong["location"]["path"]) == ("blocker", "--select")


def test_no_two_entries_share_a_fingerprint_and_lines_do_not_change_it(
    folder: Path, capsys: Captured
) -> None:
    twice = ROBOT + "A uses_data_from Camera\nBase is_controlled_by B 1\n"
    twice += "A uses_data_from Camera\nA uses_data_from Camera\n"
    for name in ("a b.mars", "c.mars"):
        (folder / name).write_text(twice)
    prints = [each["fingerprint"] for each in gitlab(capsys, "a b.mars", "c.mars")]
    assert len(prints) == len(set(prints)) > 4
    for name in ("a b.mars", "c.mars"):
        (folder / name).write_text(twice.replace("Base is", "\n\nBase is", 1))
    assert [each["fingerprint"] for each in gitlab(capsys, "a b.mars", "c.mars")] == prints


def test_each_robot_is_a_suite_and_each_finding_a_failed_case(
    folder: Path, capsys: Captured
) -> None:
    (folder / "clean.mars").write_text("@configuration\n@modules A, B\nA uses_data_from B\n")
    assert run_here(["check", "a b.mars", "clean.mars", "--format", "junit"]) == 1
    root = ElementTree.fromstring(capsys.readouterr().out)
    first, second = root
    assert (root.tag, first.get("name"), second.get("name")) == (
        "testsuites",
        "a b.mars",
        "clean.mars",
    )
    assert [(suite.get("tests"), suite.get("failures")) for suite in root] == [
        ("2", "2"),
        ("1", "0"),
    ]
    failures = [(case.get("file"), case.get("line"), case[0]) for case in first]
    assert [(file, line, failure.get("type")) for file, line, failure in failures] == [
        ("a b.mars", "3", "ambiguous_priority"),
        ("a b.mars", "5", "module_conflict"),
    ]
    assert failures[0][2].get("message") == "`A` and `B` control `Base` with the same priority, 1"
    assert "help: give `A` and `B` priorities" in str(failures[0][2].text)
    assert [len(case) for case in second] == [0]
    assert run_here(["check", "a b.mars", "--baseline", "gone", "--format", "junit"]) == 2
    ((case,),) = ElementTree.fromstring(capsys.readouterr().out)
    assert (case.get("file"), case[0].get("type")) == ("gone", "unreadable")
    stale = {"file": "gone.mars", "kind": "any", "subject": "A", "participants": []}
    known = {"format": "mars-baseline", "version": 1, "findings": [stale]}
    (folder / "known.json").write_text(json.dumps(known))
    assert run_here(["check", "clean.mars", "--baseline", "known.json", "--format", "junit"]) == 0
    (suite,) = ElementTree.fromstring(capsys.readouterr().out)
    assert suite.get("name") == "clean.mars"


def test_a_path_that_a_terminal_would_obey_is_shown_escaped(folder: Path, capsys: Captured) -> None:
    (folder / "a\x1b[2J.mars").write_text("@configuration\n@modules A\nA uses_data_from B\n")
    run_here(["check", "a\x1b[2J.mars", "--format", "github"])
    assert "::error file=a\\x1b[2J.mars,line=3," in capsys.readouterr().out


def test_a_message_is_a_sentence(folder: Path, capsys: Captured) -> None:
    write_package({"launch/robot.launch.py": "\n"}, folder / "package")
    _, run = sarif(capsys, "check", "package")
    [text] = [each["message"]["text"] for each in run["results"] if each["level"] == "warning"]
    assert text.startswith("The launch file is empty. ")
