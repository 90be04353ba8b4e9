"""Files are written whole, and what a killed command left behind goes."""

import fcntl
import os
from pathlib import Path

from mars_asp.output import write_whole


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
