"""What is kept between commands is what would be made anew, or nothing."""

import sys
from pathlib import Path

import pytest

from mars_asp.asp import cache


def test_what_is_kept_is_recalled(kept: Path) -> None:
    cache.keep("a", "1", ("x", 2))
    assert cache.recall("a", "1") == ("x", 2)
    assert [path.name for path in kept.iterdir()] == ["a"]


def test_nothing_is_recalled_of_another_version(kept: Path) -> None:
    cache.keep("a", "1", 2)
    assert cache.recall("a", "2") is None


@pytest.mark.parametrize("content", [b"", b"no pickle", b"\x80\x04N.", b"\x80\x04."])
def test_a_broken_file_holds_nothing(kept: Path, content: bytes) -> None:
    (kept / "a").write_bytes(content)
    assert cache.recall("a", "1") is None


def test_where_python_keeps_nothing_values_are_kept_for_the_process_alone(
    kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    cache.keep("a", "1", 2)
    assert list(kept.iterdir()) == []
    assert cache.recall("a", "1") == 2
    assert cache.recall("a", "2") is None


def test_a_version_changes_with_its_files(tmp_path: Path) -> None:
    path = tmp_path / "maker"
    path.write_text("one")
    version = cache.version_of([path])
    assert cache.version_of([path]) == version
    path.write_text("another")
    assert cache.version_of([path]) != version


def test_a_kept_value_is_recalled_for_its_version(kept: Path) -> None:
    cache.keep("name", "1", {"error": 40})
    assert cache.recall("name", "1") == {"error": 40}
    assert cache.recall("name", "2") is None


def test_a_kept_value_with_a_flipped_bit_is_made_anew(kept: Path) -> None:
    cache.keep("name", "1", ("error", 40))
    path = kept / "name"
    whole = path.read_bytes()
    for bit in range(8 * len(whole)):
        torn = bytearray(whole)
        torn[bit // 8] ^= 1 << bit % 8
        path.write_bytes(torn)
        assert cache.recall("name", "1") is None
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        assert cache.recall("name", "1") is None
