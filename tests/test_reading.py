"""Files that a stranger's file names are read in its project and the working folder alone."""

import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from mars_asp.annotations import files
from mars_asp.cli import run_here
from mars_asp.reading import WallError, is_outside, read_file
from tests.support.fixtures import Captured, Patch

SECRET = "TOKEN=hunter2 is the secret\n"
FLAT = "@configuration flat\n@modules A\n"
ANNOTATED = (
    "// @module_start\n// @module_name Camera\n// @Sense hunter2\nImage grab();\n// @module_end\n"
)
#: What a stranger's folder holds, and the line that refuses it: `->` begins a link.
REFUSED: Mapping[str, tuple[dict[str, str], str]] = {
    "include": (
        {"a.mars": FLAT + "@include ../secret\n"},
        "a.mars:3:10: error: `../secret`: it lies outside of the project and of the working folder",
    ),
    "include of include": (
        {"a.mars": FLAT + "@include b.mars\n", "b.mars": FLAT + "@include ../secret\n"},
        "b.mars:3:10: error: `../secret`: it lies outside",
    ),
    "include by a link": (
        {"a.mars": FLAT + "@include b.mars\n", "b.mars": "-> ../secret"},
        "a.mars:3:10: error: `b.mars`: it lies outside",
    ),
    "include of the kernel": (
        {"a.mars": FLAT + "@include /proc/self/environ\n"},
        "a.mars:3:10: error: `/proc/self/environ`: nothing in /proc, /dev and /sys is read",
    ),
    "include of a device": (
        {"a.mars": FLAT + "@include /dev/zero\n"},
        "a.mars:3:10: error: `/dev/zero`: nothing in",
    ),
    "link": (
        {"a.mars": "-> ../secret"},
        "mars-asp: error: a.mars: it is a link out of its project",
    ),
    "link to the kernel": (
        {"a.mars": "-> /proc/self/environ"},
        "mars-asp: error: a.mars: nothing in /proc",
    ),
    "source of the kernel": (
        {"a.mars": FLAT + "@sources /proc/self/environ\n"},
        "a.mars:3:10: error: mistakes in `/proc/self/environ` are not shown",
    ),
    "source with mistakes": (
        {"a.mars": FLAT + "@sources ../wrong.cpp\n"},
        "a.mars:3:10: error: mistakes in `../wrong.cpp` are not shown: it lies outside",
    ),
    "everything": (
        {"a.mars": FLAT + "@sources /\n"},
        "a.mars:3:10: error: `/` holds all files of a user",
    ),
    "everything by a glob": (
        {"a.mars": FLAT + "@sources /**/*.cpp\n"},
        "a.mars:3:10: error: `/` holds all files of a user",
    ),
    "baseline": (
        {"a.mars": FLAT, "mars.toml": 'select = []\nbaseline = "../secret"\n'},
        "mars.toml:2:1: error: `../secret`: it lies outside",
    ),
    "baseline by a link": (
        {"a.mars": FLAT, "mars.toml": 'baseline = "b"\n', "b": "-> ../secret"},
        "mars.toml:1:1: error: `b`: it lies outside",
    ),
    "settings by a link": (
        {"a.mars": FLAT, "mars.toml": "-> ../secret"},
        "mars-asp: error: mars.toml: it is a link out of its project",
    ),
    "pack": (
        {"a.mars": FLAT, "mars.toml": 'rules = ["p", "../pack"]\n', "p/x.lp": "p(1).\n"},
        "mars.toml:1:15: error: `../pack`: it lies outside",
    ),
    "rules by a link": (
        {"a.mars": FLAT, "mars.toml": 'rules = ["p"]\n', "p/x.lp": "-> ../../secret"},
        "mars-asp: error: `p/x.lp` cannot be used as rules: it is a link out of its project",
    ),
    "manifest by a link": (
        {"a.mars": FLAT, "mars.toml": 'rules = ["p"]\n', "p/pack.toml": "-> ../../secret"},
        "mars-asp: error: p/pack.toml: it is a link out of its project",
    ),
}


def lay_out(folder: Path, texts: Mapping[str, str]) -> None:
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if text.startswith("-> "):
            path.symlink_to(text[3:])
        else:
            path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("case", REFUSED)
def test_a_file_outside_is_refused_without_an_excerpt(
    case: str, tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    texts, expected = REFUSED[case]
    outside = {"secret": SECRET, "wrong.cpp": ANNOTATED, "pack/x.lp": "hunter2(secret) x.\n"}
    lay_out(tmp_path, outside)
    lay_out(tmp_path / "stranger", texts)
    monkeypatch.chdir(tmp_path / "stranger")
    monkeypatch.setenv("TOKEN", "hunter2")
    monkeypatch.setenv("COLUMNS", "500")
    assert run_here(["check", "a.mars", "--format", "full"]) == 2
    output, errors = capsys.readouterr()
    assert expected in output + errors
    assert "hunter2" not in output + errors


@pytest.mark.parametrize(
    ("named", "mark", "folder"),
    [
        # The folder of the file, whatever the working folder is.
        ("config/more.mars", "", "/"),
        # The working folder.
        ("src/more.mars", "", "robot"),
        # The repository, or the project, from elsewhere.
        ("src/more.mars", ".git/HEAD", "/"),
        ("src/more.mars", "package.xml", "/"),
    ],
)
def test_a_file_inside_is_read(
    named: str, mark: str, folder: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    robot = tmp_path / "robot"
    texts = {named: "@configuration flat\n@modules B\n"}
    texts["config/robot.mars"] = f"@configuration flat\n@include ../{named}\n"
    lay_out(robot, {mark: "", **texts} if mark else texts)
    monkeypatch.chdir(tmp_path / folder)
    assert run_here(["check", str(robot / "config/robot.mars")]) == 0


def test_sources_beside_the_configuration_are_read_from_anywhere(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    source = ANNOTATED.replace("hunter2", "NotifyWhenReady")
    lay_out(
        tmp_path,
        {
            "robot/config/robot.mars": FLAT.replace("A", "Camera") + "@sources ../src/*.cpp\n",
            "robot/src/a.cpp": source,
            "elsewhere/x": "",
        },
    )
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert run_here(["analyse", "--format", "json", "../robot/config/robot.mars"]) == 0
    assert '"unchecked": []' in capsys.readouterr().out


def test_options_name_files_anywhere(tmp_path: Path, monkeypatch: Patch, capsys: Captured) -> None:
    baseline = '{"format": "mars-baseline", "version": 1, "findings": []}\n'
    lay_out(tmp_path, {"b.json": baseline, "pack/x.lp": "p(1).\n", "wrong.cpp": ANNOTATED})
    lay_out(tmp_path / "robot", {"a.mars": FLAT})
    monkeypatch.chdir(tmp_path / "robot")
    words = ["check", "a.mars", "--baseline", "../b.json", "--rules", "../pack"]
    assert run_here(words) == 0
    assert run_here([*words, "--sources", "../wrong.cpp", "--format", "full"]) == 2
    assert "@Sense hunter2" in capsys.readouterr().out


def test_no_project_holds_a_home_folder(tmp_path: Path, monkeypatch: Patch) -> None:
    lay_out(tmp_path, {".git/HEAD": "", "secret": SECRET, "stranger/a.mars": ""})
    monkeypatch.chdir(tmp_path / "stranger")
    assert not is_outside(tmp_path / "secret", str(tmp_path / "stranger" / "a.mars"))
    home = tmp_path / "home"
    lay_out(home, {".git/HEAD": "", "secret": SECRET, "stranger/a.mars": ""})
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.chdir(home / "stranger")
    assert is_outside(home / "secret", str(home / "stranger" / "a.mars"))


def test_a_pipe_without_a_writer_is_not_waited_for(tmp_path: Path, monkeypatch: Patch) -> None:
    monkeypatch.setattr("mars_asp.reading._PIPE_SECONDS", 0.1)
    os.mkfifo(tmp_path / "fifo")
    with pytest.raises(WallError, match="a pipe that no process writes into"):
        read_file(tmp_path / "fifo", 10)
    with pytest.raises(WallError, match="not a regular file"):
        read_file(tmp_path / "fifo", 10, str(tmp_path / "a.mars"))
    reading, writing = os.pipe()
    os.write(writing, b"text")
    os.close(writing)
    assert read_file(f"/dev/fd/{reading}", 3) == b"text"
    assert read_file("/dev/null", 3) == b""


def test_folders_are_listed_up_to_a_bound(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.setattr(files, "MOST_ENTRIES", 20)
    lay_out(tmp_path, {f"s/{number}.txt": "" for number in range(15)})
    lay_out(tmp_path, {"a.mars": FLAT + "@sources s, s/*.cpp\n", "b.mars": FLAT + "@sources s\n"})
    # A link to a folder around it is not followed for ever.
    lay_out(tmp_path, {"s/loop": "-> .."})
    monkeypatch.chdir(tmp_path)
    assert run_here(["check", "b.mars"]) == 0
    (tmp_path / "b.mars").write_text(FLAT + "@sources s/**/*.cpp, s/**/*.py\n")
    assert run_here(["check", "b.mars"]) == 2
    assert "b.mars:3:22: error: more than 20 files and folders" in capsys.readouterr().out
