"""What is kept between commands is what would be made anew, or nothing."""

import sys
from pathlib import Path

import pytest

from mars_asp.asp import cache
from mars_asp.reasoning.rules import load_rulebook


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(cache, "_place", lambda name: tmp_path / name)
    monkeypatch.setattr(cache, "_here", {})
    return tmp_path


def test_what_is_kept_is_recalled(place: Path) -> None:
    cache.keep("a", "1", ("x", 2))
    assert cache.recall("a", "1") == ("x", 2)
    assert [path.name for path in place.iterdir()] == ["a"]


def test_nothing_is_recalled_of_another_version(place: Path) -> None:
    cache.keep("a", "1", 2)
    assert cache.recall("a", "2") is None


@pytest.mark.parametrize("content", [b"", b"no pickle", b"\x80\x04N.", b"\x80\x04."])
def test_a_broken_file_holds_nothing(place: Path, content: bytes) -> None:
    (place / "a").write_bytes(content)
    assert cache.recall("a", "1") is None


def test_where_python_keeps_nothing_values_are_kept_for_the_process_alone(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    cache.keep("a", "1", 2)
    assert list(place.iterdir()) == []
    assert cache.recall("a", "1") == 2
    assert cache.recall("a", "2") is None


def test_a_version_changes_with_its_files(tmp_path: Path) -> None:
    path = tmp_path / "maker"
    path.write_text("one")
    version = cache.version_of([path])
    assert cache.version_of([path]) == version
    path.write_text("another")
    assert cache.version_of([path]) != version


def test_recalled_rules_are_those_that_were_read(place: Path) -> None:
    read = load_rulebook()
    assert list(place.iterdir())
    recalled = load_rulebook()
    assert recalled == read
    assert [rule.heads for rule in recalled.rules] == [rule.heads for rule in read.rules]
    assert str(recalled.rules[-1].ast) == str(read.rules[-1].ast)
