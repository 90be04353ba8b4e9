"""What is wrong with a file: each diagnostic beside the input that it is about."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.documents import ROOT

CASES = sorted((ROOT / "tests/bad").glob("*.mars"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_cases(
    path: Path,
    update_golden: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["check", str(path.relative_to(ROOT))]) == 2
    printed, told = capsys.readouterr()
    assert not printed
    if update_golden:
        path.with_suffix(".txt").write_text(told)
    assert told == path.with_suffix(".txt").read_text()
