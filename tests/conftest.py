"""Options of the test suite."""

import sys
from pathlib import Path

import pytest

from mars_asp.asp import cache


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="write what is printed as what is expected"
    )
    parser.addoption(
        "--fuzz", type=int, default=10_000, help="how many mutated sources are extracted"
    )


@pytest.fixture
def update_golden(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--update-golden"))


@pytest.fixture
def fuzz(request: pytest.FixtureRequest) -> int:
    return int(request.config.getoption("--fuzz"))


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder in which values are kept between commands."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(cache, "_place", lambda name: tmp_path / name)
    monkeypatch.setattr(cache, "_here", {})
    return tmp_path
