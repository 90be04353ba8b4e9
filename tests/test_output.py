"""Files are written whole, and no file of the user is removed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mars_asp.output import AtomicFile, GrowingFile, fenced, markdown, write_whole


def test_only_temporary_files_of_killed_commands_are_removed(tmp_path: Path) -> None:
    (tmp_path / "mine").touch()
    other = (tmp_path / "mine").stat().st_ino
    users = (".mars-asp.abc", ".mars-asp.", f".mars-asp.{'0' * 16}.{other:x}", ".mars-asp.a.md")
    for name in users:
        (tmp_path / name).write_text("a file of the user")
    (tmp_path / ".mars-asp.link").symlink_to(tmp_path / "mine")
    killed, writing = AtomicFile(str(tmp_path / "a")), AtomicFile(str(tmp_path / "b"))
    # The lock of a killed command is gone.
    killed._file.close()
    write_whole(str(tmp_path / "out.mars"), "whole")
    assert (tmp_path / "out.mars").read_text() == "whole"
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        (*users, ".mars-asp.link", "mine", "out.mars", Path(str(writing._temporary)).name)
    )
    writing.drop()


def test_a_file_keeps_its_mode_and_a_link_leads_where_it_led(tmp_path: Path) -> None:
    there = tmp_path / "there"
    there.write_text("old")
    there.chmod(0o640)
    (tmp_path / "link").symlink_to(there)
    write_whole(str(tmp_path / "link"), b"new")
    assert (tmp_path / "link").is_symlink()
    assert there.read_text() == "new"
    assert there.stat().st_mode & 0o777 == 0o640


def test_a_pipe_that_looks_like_a_left_over_file_is_harmless(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / ".mars-asp.fifo")
    write_whole(str(tmp_path / "out"), "whole")
    assert (tmp_path / "out").read_text() == "whole"


def test_a_file_grows_by_lines_after_the_kept_ones(tmp_path: Path) -> None:
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


def test_only_regular_files_grow(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    for path in (tmp_path / "fifo", tmp_path, Path("/dev/null")):
        with pytest.raises(OSError):
            GrowingFile(str(path), 0, 0)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("`{A}` needs `x < y`: see [1]", r"`{A}` needs `x < y`: see \[1\]"),
        ("<img src=x onerror=y>", r"\<img src=x onerror=y\>"),
        ("![a](http://x)", r"!\[a\](http://x)"),
        ("a `b\n<c> `d`", "a \\`b\n\\<c\\> `d`"),
        ("&lt; \\", r"\&lt; \\"),
        ("# one\n- two\n  3. three\n4 four", "\\# one\n\\- two\n  3\\. three\n4 four"),
    ],
)
def test_markdown_of_others_is_shown_as_it_is_written(text: str, shown: str) -> None:
    assert markdown(text) == shown


def test_code_does_not_end_its_block() -> None:
    assert fenced("a ``` b\n````", "text") == "`````text\na ``` b\n````\n`````"


@pytest.mark.parametrize(
    "words", ["check gone.mars", "nothing", "check --nothing", "rules lint gone"]
)
def test_a_full_standard_error_is_status_2(words: str) -> None:
    command = [sys.executable, "-m", "mars_asp", *words.split()]
    with open("/dev/full", "w") as full:  # noqa: PTH123 -- no file
        done = subprocess.run(command, stderr=full, stdout=subprocess.DEVNULL, check=False)
    assert done.returncode == 2
