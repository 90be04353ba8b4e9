"""Files are written whole, and what a killed command left behind goes."""

import fcntl
import os
from pathlib import Path

import pytest

from mars_asp.output import GrowingFile, write_whole


def test_what_a_killed_command_left_behind_is_removed(tmp_path: Path) -> None:
    left, other = tmp_path / ".mars-asp.abc", tmp_path / ".mars-asp.def"
    left.write_text("half a spec")
    other.write_text("being written")
    link = tmp_path / ".mars-asp.link"
    link.symlink_to(tmp_path / "mine")
    (tmp_path / "mine").write_text("of somebody else")
    with other.open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        write_whole(str(tmp_path / "out.mars"), "whole")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        ".mars-asp.def",
        ".mars-asp.link",
        "mine",
        "out.mars",
    ]
    assert (tmp_path / "out.mars").read_text() == "whole"


def test_a_file_keeps_its_mode_and_a_link_leads_where_it_led(tmp_path: Path) -> None:
    there = tmp_path / "there"
    there.write_text("old")
    there.chmod(0o640)
    (tmp_path / "link").symlink_to(there)
    write_whole(str(tmp_path / "link"), b"new")
    assert (tmp_path / "link").is_symlink()
    assert there.read_text() == "new"
    assert there.stat().st_mode & 0o777 == 0o640


def test_a_pipe_that_looks_like_a_left_over_file_is_no_trap(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / ".mars-asp.fifo")
    write_whole(str(tmp_path / "out"), "whole")
    assert (tmp_path / "out").read_text() == "whole"


def test_a_file_grows_by_lines_after_what_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_bytes(b"one\ntwo\nto")
    growing = GrowingFile(str(path), 4, 10)
    assert path.read_bytes() == b"one\n"
    growing.append(b"three\n")
    assert path.read_bytes() == b"one\nthree\n"
    with pytest.raises(BlockingIOError, match="another command is writing to it"):
        GrowingFile(str(path), 0, 10)
    assert path.read_bytes() == b"one\nthree\n"
    growing.close()
    with pytest.raises(OSError, match="it has changed since it was read"):
        GrowingFile(str(path), 4, 4)
    GrowingFile(str(path), 10, 10).close()
    assert path.read_bytes() == b"one\nthree\n"


def test_what_is_not_a_regular_file_does_not_grow(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    for path in (tmp_path / "fifo", tmp_path, Path("/dev/null")):
        with pytest.raises(OSError):
            GrowingFile(str(path), 0, 0)
