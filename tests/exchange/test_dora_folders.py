"""Folders of dataflows: which are found, and that each is judged by itself."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange import folders
from mars_asp.exchange.folders import robots_in
from tests.support.fixtures import Captured, Patch

GOOD = "nodes:\n- id: camera\n  outputs: [image]\n- id: view\n  inputs: {image: camera/image}\n"
WRONG = "nodes:\n- id: view\n  inputs: {tick: dora/timer/days/1}\n"


def write(folder: Path, **files: str) -> None:
    """Write files by their paths without the ending, with `__` for `/`."""
    for name, text in files.items():
        path = folder / (name.replace("__", "/") + ".yml")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def found_in(folder: Path) -> list[str]:
    """Return the paths of the robots in a folder."""
    return [path.relative_to(folder).as_posix() for path in robots_in(folder).paths]


def test_dataflows_are_found_at_any_depth_in_their_order(tmp_path: Path) -> None:
    write(tmp_path, a__b__c__d__deep=GOOD, near=GOOD, a__graph="nodes: [a]\nid: 1\n")
    assert found_in(tmp_path) == ["a/b/c/d/deep.yml", "near.yml"]


def test_builds_environments_and_links_are_skipped(tmp_path: Path) -> None:
    robot = tmp_path / "robot"
    write(robot, target__a=GOOD, node_modules__a=GOOD, x__build__a=GOOD, env__lib__a=GOOD, b=GOOD)
    write(robot / ".git", a=GOOD)
    (robot / "env" / "pyvenv.cfg").touch()
    write(tmp_path / "other", a=GOOD)
    (robot / "link").symlink_to(tmp_path / "other")
    (robot / "link.yml").symlink_to(tmp_path / "other" / "a.yml")
    assert found_in(robot) == ["b.yml"]


def test_a_workspace_of_ros_has_no_dataflow_deep_in_it(tmp_path: Path) -> None:
    write(tmp_path, a__b__c__d__deep=GOOD)
    (tmp_path / "a" / "b" / "c" / "package.xml").touch()
    assert found_in(tmp_path) == ["."]
    write(tmp_path, near=GOOD)
    assert found_in(tmp_path) == ["a/b/c/d/deep.yml", "near.yml"]


LAUNCH = '<launch><node pkg="x" exec="y" name="n"/><node pkg="x" exec="y" name="n"/></launch>'


def test_a_workspace_of_ros_and_a_dataflow_are_robots_of_their_own(
    tmp_path: Path, capsys: Captured
) -> None:
    write(tmp_path, near=GOOD.replace("camera/image", "camera/picture"))
    # A list of places has nodes and paths as well.
    write(tmp_path, config__places="nodes:\n- id: home\n  path: here\n")
    (tmp_path / "package.xml").write_text("<package><name>drive</name></package>")
    assert run_here(["check", str(tmp_path)]) == 1
    output = " ".join("".join(capsys.readouterr()).split())
    assert "packages of ROS not read: 1" in output and "1 error in 1 file" in output
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "drive.launch.xml").write_text(LAUNCH.replace('"/><', '"/>\n<'))
    assert run_here(["check", str(tmp_path)]) == 1
    output = " ".join("".join(capsys.readouterr()).split())
    assert "`camera` has no output" in output and "two nodes are named `/n`" in output
    assert "1 error, 1 warning in 1 file and 1 folder" in output
    assert run_here(["check", str(tmp_path), "--launch", "drive.launch.xml"]) == 0
    capsys.readouterr()
    assert run_here(["explain", str(tmp_path)]) == 2
    output = " ".join(capsys.readouterr().err.split())
    assert f"name one of them: `{tmp_path}/near.yml`; `mars-asp check" in output


@pytest.mark.parametrize(
    ("bound", "note"),
    [
        ("MOST_DATAFLOWS", "dataflows not read: 2"),
        ("MOST_READ", "files not read: 2"),
        ("MOST_ENTRIES", "folders not read: 1"),
    ],
)
def test_the_rest_of_a_large_folder_is_a_note(
    tmp_path: Path, monkeypatch: Patch, bound: str, note: str
) -> None:
    monkeypatch.setattr(folders, bound, 1)
    write(tmp_path, a=GOOD, b=GOOD, c__d=GOOD)
    (message,) = robots_in(tmp_path).notes
    assert message.message.startswith(note)


def test_a_wrong_dataflow_does_not_end_the_folder(tmp_path: Path, capsys: Captured) -> None:
    missing = GOOD.replace("camera/image", "camera/picture")
    write(tmp_path, a=WRONG, b=missing)
    assert run_here(["check", str(tmp_path)]) == 2
    output = " ".join("".join(capsys.readouterr()).split())
    assert "a.yml:3:18: error: input `tick` of `view` must take an output" in output
    assert "b.yml:5:19: error: `camera` has no output" in output
    assert "2 errors in 2 files" in output
    assert run_here(["check", str(tmp_path / "a.yml")]) == 2


def test_other_commands_take_the_only_dataflow_of_a_folder(
    tmp_path: Path, capsys: Captured
) -> None:
    write(tmp_path, a__b__c=GOOD)
    assert run_here(["analyse", str(tmp_path)]) == 0
    write(tmp_path, d=GOOD)
    assert run_here(["analyse", str(tmp_path)]) == 2
    assert "the folder has 2 robots" in " ".join(capsys.readouterr().err.split())


#: The settings of a node `a`, and the file that is reported as missing.
PROGRAMS = [
    ("path: ../x.py", "path ../x.py"),
    ("path: ./x", "path ./x"),
    ("path: nodes/x.py", "path nodes/x.py"),
    ("path: there.py", None),
    ("custom: {source: ./x.py}", "source ./x.py"),
    ("custom: {source: python, args: x.py}", "args x.py"),
    ("operator: {python: x.py}", "python x.py"),
    ("operators: [{id: b, python: {source: x.py}}]", "python x.py"),
    ("path: x.py\n  build: pip install -r needs.txt", "path x.py"),
    ("path: x.py\n  build: make", None),
    ("path: x.py\n  git: https://host/x", None),
    ("path: ../target/release/x", None),
    ("path: ./bin/x", None),
    ("path: camera-node", None),
    ("path: dynamic", None),
    ("path: shell\n  args: x.py", None),
    ("path: https://host/x.py", None),
    ("path: $HOME/x.py", None),
    ("path: /opt/x.py", None),
    ("operator: {shared-library: ./x}", None),
]


@pytest.mark.parametrize(("settings", "missing"), PROGRAMS)
def test_a_file_of_a_node_that_is_not_there_is_found_at_its_line(
    tmp_path: Path, capsys: Captured, settings: str, missing: str | None
) -> None:
    (tmp_path / "there.py").touch()
    write(tmp_path, d=f"nodes:\n- id: a\n  {settings}\n- id: c\n  path: there.py\n")
    assert run_here(["check", "--quiet", "--select", "missing_file", str(tmp_path / "d.yml")]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert ("warning" in output) == (missing is not None)
    if missing is not None:
        key, path = missing.split()
        node = "a/b" if "operators" in settings else "a"
        assert "d.yml:3:" in output
        assert f"warning: `{key}` of node `{node}` is `{path}`, which is not there" in output


def test_a_dataflow_away_from_all_its_programs_lacks_none(tmp_path: Path, capsys: Captured) -> None:
    write(tmp_path, d="nodes:\n- id: a\n  path: ./x.py\n- id: b\n  path: ./y.py\n")
    run_here(["check", str(tmp_path / "d.yml")])
    assert "which is not there" not in capsys.readouterr().out
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes/x.py").touch()
    run_here(["check", str(tmp_path / "d.yml")])
    assert "which is not there" not in capsys.readouterr().out
    # With all of them in one folder, the paths are wrong.
    (tmp_path / "nodes/y.py").touch()
    run_here(["check", str(tmp_path / "d.yml")])
    assert capsys.readouterr().out.count("which is not there") == 2


def test_nodes_that_lack_one_file_are_one_finding(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "there.py").touch()
    nodes = "".join(f"- id: {name}\n  path: x.py\n" for name in "abc")
    write(tmp_path, d=f"nodes:\n{nodes}- id: d\n  path: there.py\n")
    assert run_here(["check", "--format", "json", str(tmp_path / "d.yml")]) == 0
    findings = json.loads(capsys.readouterr().out)["findings"]
    [warning] = [each for each in findings if each["kind"] == "missing_file"]
    assert warning["message"] == "`path` of 3 nodes, such as `a`, is `x.py`, which is not there"
    assert [warning["line"], *(label["line"] for label in warning["labels"])] == [3, 5, 7]
