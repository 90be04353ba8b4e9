"""The server finds the diagnostics that commands print, in saved and unsaved texts."""

from pathlib import Path

import pytest

from mars_asp.lsp.questions import CheckedFile, LintedFile
from tests.support.campaigns import sample
from tests.support.documents import ROOT
from tests.support.editor_answers import editor_answer, editor_findings, printed

FOLDERS = ("bad", "findings", "voice", "lsp/robot")
CONFIGURATIONS = [
    *sorted(ROOT.glob("examples/*/*.mars")),
    *(path for folder in FOLDERS for path in sorted(ROOT.glob(f"tests/{folder}/*.mars"))),
]
SOURCES = [
    path
    for path in sorted(ROOT.glob("tests/extraction/*.*"))
    if path.suffix in (".cpp", ".c", ".hpp", ".py", ".go", ".m", ".rs", ".java")
]
RULES = [
    *sorted(ROOT.glob("examples/own-rules/rules/*.lp")),
    *sorted(ROOT.glob("tests/lint/*.lp"))[:2],
]


def shown(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", sample(CONFIGURATIONS, 3), ids=shown)
def test_a_robot_has_the_diagnostics_of_check(path: Path) -> None:
    found = editor_answer("check", path)
    assert isinstance(found, CheckedFile)
    assert editor_findings(found.findings) == printed("check", str(path))


@pytest.mark.parametrize("path", SOURCES, ids=shown)
def test_a_source_has_the_diagnostics_of_extract(path: Path) -> None:
    found = editor_answer("source", path)
    assert isinstance(found, CheckedFile)
    assert editor_findings(found.findings) == printed("extract", str(path))


@pytest.mark.parametrize("path", RULES, ids=shown)
def test_rules_have_the_diagnostics_of_lint(path: Path) -> None:
    found = editor_answer("lint", path)
    assert isinstance(found, LintedFile)
    assert editor_findings(found.findings) == printed("rules", "lint", str(path))


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("robot.mars", "Joystick 1", "Joystick 2"),
        ("robot.mars", "uses_data_from Camera", "uses_data_fron Camera"),
        ("robot.mars", "Joystick 1", "Joystick 1  // mars: ignore[ambiguous_priority] 😀 wanted"),
        ("arm.mars", "Hand is_mounted_on", "Hnad is_mounted_on"),
        ("arm.mars", "@configuration", "@configuration flat"),
        ("camera.cpp", "Image grab", "Lines grab"),
        ("camera.cpp", "// @Sense Not", "// 😀\n// @Sense Nto"),
        ("plan.py", "@ControlOut Trans_Z", "@ControlOut Trans_Q"),
        ("plan.py", "# @module_end", "# end"),
    ],
)
def test_unsaved_text_is_checked_as_if_it_were_saved(
    name: str, old: str, new: str, tmp_path: Path
) -> None:
    for path in sorted((ROOT / "tests" / "lsp" / "robot").iterdir()):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    robot, changed = tmp_path / "robot.mars", tmp_path / name
    before = editor_findings(editor_answer("check", robot).findings)
    text = changed.read_text(encoding="utf-8")
    assert old in text
    unsaved = text.replace(old, new)
    found = editor_findings(editor_answer("check", robot, {str(changed): unsaved}).findings)
    assert editor_findings(editor_answer("check", robot).findings) == before
    changed.write_text(unsaved, encoding="utf-8")
    assert found == printed("check", str(robot))
    assert found != before


def test_unsaved_rules_are_checked_as_if_they_were_saved(tmp_path: Path) -> None:
    path = tmp_path / "mine.lp"
    path.write_text("%! id: mine/a\n%! because: `{M}`\nmine(M) :- module(M).\n")
    unsaved = "%! id: mine/a\n%! because: `😀 {N}`\nmine(M) :- modul(M).\n"
    found = editor_findings(editor_answer("lint", path, {str(path): unsaved}).findings)
    path.write_text(unsaved, encoding="utf-8")
    assert found
    assert found == printed("rules", "lint", str(path))
