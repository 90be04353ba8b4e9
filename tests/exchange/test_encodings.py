"""Files of workspaces in other encodings than UTF-8 are read where ROS 2 reads them."""

import shutil
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

PATROL = "src/scout_drive/scout_drive/patrol.py"
DECLARED = b'<?xml version="1.0" encoding="ISO-8859-1"?>\n<!-- caf\xe9 -->\n'


@pytest.mark.parametrize(
    ("name", "before"),
    [
        ("src/scout_base/src/base_driver.cpp", b"// caf\xe9\n"),
        ("src/scout_base/CMakeLists.txt", b"# caf\xe9\n"),
        ("src/scout_base/launch/base.launch.xml", DECLARED),
        (PATROL, b"# -*- coding: latin-1 -*- caf\xe9\n"),
        (PATROL, b"#!/usr/bin/python3\n# vim: set fileencoding=cp1252 : caf\xe9\n"),
        (PATROL, b"# coding: mac-roman caf\x8e\n"),
        (PATROL, b"# coding: latin-1\n# the output encoding: gbk \xe9 \xff\n"),
        (PATROL, b"# coding: latin-1-unix caf\xe9\n"),
        # Python imports a file with such a comment.
        (PATROL, b"\n\n# caf\xe9\n"),
        (PATROL, b"# coding: idna\n# caf\xe9\n"),
        ("src/scout_base/src/lidar.cpp", b"// file encoding: gb2312\n// caf\xe9\n"),
        ("src/scout_drive/launch/scout.launch.py", b"# coding: gbk\n# \xc4\xe3\n"),
    ],
)
def test_a_comment_in_another_encoding_changes_no_finding(
    name: str,
    before: bytes,
    tmp_path: Path,
    monkeypatch: Patch,
    capsys: Captured,
) -> None:
    shutil.copytree(ROOT / "examples/ros2_workspace", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    run_here(["check", "."])
    expected = capsys.readouterr().out.splitlines()
    path = tmp_path / name
    path.write_bytes(before + path.read_bytes())
    run_here(["check", "."])
    found = capsys.readouterr().out.splitlines()
    lines = before.count(b"\n")
    moved = [
        f"{path}:{int(line) + lines * (path == name)}:{rest}"
        for path, line, rest in (each.split(":", 2) for each in expected)
    ]
    assert found == moved


def test_yaml_and_xml_declare_no_encoding_of_python(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    shutil.copytree(ROOT / "examples/ros2_workspace", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    path = Path("src/scout_drive/config/twist_mux.yaml")
    path.write_bytes(b"# -*- coding: latin-1 -*- caf\xe9\n" + path.read_bytes())
    run_here(["check", "."])
    assert f"{path}:1:1: warning: the file is not UTF-8 [broken_file]" in capsys.readouterr().out
