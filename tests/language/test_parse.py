"""Faults of files: each diagnostic is beside its input."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

CASES = sorted((ROOT / "tests/bad").glob("*.mars"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_cases(path: Path, update_golden: bool, capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["check", str(path.relative_to(ROOT)), "--format", "full"]) == 2
    output = "".join(capsys.readouterr())
    if update_golden:
        path.with_suffix(".txt").write_text(output)
    assert output == path.with_suffix(".txt").read_text()
