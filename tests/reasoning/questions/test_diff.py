"""What changed between two configurations, and which lines caused it."""

import json
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings

from mars_asp.cli import run_here
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.diff import diff
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.documents import ROOT, run
from tests.support.strategies import configurations, few

RULEBOOK = load_rulebook()
CASES = sorted((ROOT / "tests/diff").glob("*/"))


@pytest.mark.parametrize("folder", CASES, ids=lambda path: path.name)
def test_cases(folder: Path, update_golden: bool) -> None:
    place = folder.relative_to(ROOT)
    found = run(f"mars-asp diff {place}/old.mars {place}/new.mars")
    if update_golden:
        (folder / "expected.txt").write_text(found)
    assert found == (folder / "expected.txt").read_text()


def _reasoner(configuration: Configuration) -> Reasoner:
    return Reasoner(Project(configuration, {}, ()), RULEBOOK)


@settings(few, max_examples=8)
@given(configurations)
def test_nothing_differs_from_itself(configuration: Configuration) -> None:
    found = diff(_reasoner(configuration), _reasoner(configuration))
    assert found.is_empty
    assert (found.added, found.removed) == ((), ())


@settings(few, max_examples=8)
@given(configurations, configurations)
def test_what_appears_one_way_vanishes_the_other(old: Configuration, new: Configuration) -> None:
    one, other = _reasoner(old), _reasoner(new)
    forth, back = diff(one, other), diff(other, one)
    mirror = {"appeared": "vanished", "vanished": "appeared", "changed": "changed"}
    assert sorted((mirror[c.how], c.item.kind, c.item.subject) for c in forth.consequences) == (
        sorted((c.how, c.item.kind, c.item.subject) for c in back.consequences)
    )
    assert sorted((mirror[c.how], c.item.kind) for c in forth.nodes) == (
        sorted((c.how, c.item.kind) for c in back.nodes)
    )
    assert (forth.added, forth.removed) == (back.removed, back.added)


def test_an_error_that_appears_is_told_by_the_status() -> None:
    case = ROOT / "tests/diff/error"
    old, new = str(case / "old.mars"), str(case / "new.mars")
    assert run_here(["diff", old, new, "--quiet"]) == 1
    assert run_here(["diff", new, old, "--quiet"]) == 0
    assert run_here(["diff", new, new, "--quiet"]) == 0


def test_json_names_the_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("old.mars", "new.mars"):
        shutil.copy(ROOT / "tests/diff/divergence" / name, tmp_path)
    words = ["diff", str(tmp_path / "old.mars"), str(tmp_path / "new.mars"), "--format", "json"]
    assert run_here(words) == 0
    found = json.loads(capsys.readouterr().out)
    line = {"path": str(tmp_path / "new.mars"), "line": 3, "column": 1}
    line |= {"text": "Edges uses_data_from Camera"}
    assert found["added"] == [line]
    assert found["consequences"][0]["change"] == "appeared"
    assert found["consequences"][0]["added"] == [line]
    assert found["nodes"][0] == {
        "change": "appeared",
        "name": "DataSplitter1",
        "kind": "data_splitter",
        "resolves": ["data_divergence(Camera)"],
        "added": [line],
        "removed": [],
    }
    assert found["cost"]["new"] == {"nodes": 1, "conversion": 0, "relationships": 4}
