"""Folders with several launch files: how they are chosen, listed, judged and explained."""

import json
import shutil
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.cli.lines import forget_all
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

SENDER = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Sender(Node):
    def __init__(self):
        super().__init__("sender")
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)


def main():
    rclpy.init()
    rclpy.spin(Sender())
"""
LAUNCH = """\
<launch>
  <arg name="second" default="{default}"/>
  <node pkg="drive" exec="sender" name="one"/>
  <node pkg="drive" exec="sender" name="two" if="$(var second)"/>
</launch>
"""


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: Patch) -> Path:
    """Return a package with two launch files, whose senders meet by default in one of them."""
    package = tmp_path / "ws" / "src" / "drive"
    files = {
        "package.xml": "<package><name>drive</name></package>",
        "setup.py": "setup(entry_points={'console_scripts': ['sender = drive.sender:main']})",
        "drive/__init__.py": "",
        "drive/sender.py": SENDER,
        "launch/both.launch.xml": LAUNCH.format(default="true"),
        "launch/one.launch.xml": LAUNCH.format(default="false"),
    }
    for name, text in files.items():
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.chdir(tmp_path)
    # Lines are kept by their paths, which are the same in each test.
    forget_all()
    return Path("ws")


def findings(text: str) -> list[dict[str, object]]:
    """Return the findings of rules for launch trees in the document of `check`."""
    found = json.loads(text)["findings"]
    return [each for each in found if each["code"].startswith("launch/")]


def test_a_finding_names_its_launch_files_and_its_condition(
    workspace: Path, capsys: Captured
) -> None:
    assert run_here(["check", str(workspace), "--format", "json"]) == 0
    output = capsys.readouterr()
    trees = ["ws/src/drive/launch/both.launch.xml", "ws/src/drive/launch/one.launch.xml"]
    [finding] = findings(output.out)
    assert finding["kind"] == "ambiguous_priority"
    assert finding["launch_files"] == trees
    assert "`second` is `true` (both.launch.xml:4), as it is by default" in str(finding["effect"])
    assert json.loads(output.out)["files"][0]["launch_files"] == trees


def test_launch_takes_some_of_the_trees(workspace: Path, capsys: Captured) -> None:
    run_here(["check", str(workspace), "--launch", "one.launch.xml", "--format", "json"])
    [finding] = findings(capsys.readouterr().out)
    assert finding["launch_files"] == ["ws/src/drive/launch/one.launch.xml"]
    assert "as it is by default" not in str(finding["effect"])


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("on.launch.xml", "did you mean `one.launch.xml`?"),
        ("launch/on.launch.xml", "did you mean `one.launch.xml`?"),
        ("other/one.launch.xml", "did you mean `one.launch.xml`?"),
        ("one", "did you mean `one.launch.xml`?"),
        ("nosuch.launch.xml", "it has `both.launch.xml`, `one.launch.xml`"),
        ("nothing", "`nothing` is not a launch file of `ws`"),
    ],
)
def test_a_launch_file_that_is_not_there_is_an_error(
    workspace: Path, capsys: Captured, name: str, message: str
) -> None:
    assert run_here(["check", str(workspace), "--launch", name, "--format", "full"]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_import_lists_several_trees_and_takes_one(workspace: Path, capsys: Captured) -> None:
    assert run_here(["import", "ros2", str(workspace), "--format", "json"]) == 2
    error = json.loads(capsys.readouterr().err.splitlines()[-1])
    assert "both.launch.xml" in error["help"] and "one.launch.xml" in error["help"]
    assert run_here(["import", "ros2", str(workspace), "--launch", "one.launch.xml"]) == 0
    assert "@modules" in capsys.readouterr().out


def test_other_verbs_report_that_they_took_all_trees_for_one_robot(
    workspace: Path, capsys: Captured
) -> None:
    for words, way in ((["facts"], "`--launch"), (["verify"], "name one of them in place of")):
        run_here([*words, str(workspace)])
        message = " ".join(capsys.readouterr().err.split())
        assert "2 launch files were taken for one robot" in message and ":1:1" not in message
        assert way in message


def test_suggested_commands_are_about_the_same_launch_files(
    workspace: Path, capsys: Captured
) -> None:
    run_here(["draw", str(workspace), "--launch", "one.launch.xml", "--as", "dot"])
    message = " ".join(capsys.readouterr().err.split())
    assert "see `mars-asp check ws --launch one.launch.xml`" in message


def test_verbose_lists_the_trees(workspace: Path, capsys: Captured) -> None:
    run_here(["check", "-v", str(workspace)])
    assert "launch file ws/src/drive/launch/one.launch.xml" in capsys.readouterr().err


@pytest.mark.parametrize("subject", ["ambiguous_priority", "/cmd_vel", "/two", "sender.py:9"])
def test_a_finding_of_check_can_be_explained(
    workspace: Path, capsys: Captured, subject: str
) -> None:
    assert run_here(["explain", str(workspace), subject]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert any(line.startswith(f"{workspace}/src/drive/drive/sender.py:9") for line in lines)
    assert "only if `second` is `true`" in lines
    assert run_here(["explain", str(workspace), subject, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["topics"][0]["name"] == "ambiguous_priority(/cmd_vel)"
    assert document["traces"][0]["premises"]


@pytest.mark.parametrize(
    ("atom", "status", "text"),
    [
        ("ambiguous_priority(/cmd_vel)", 0, "ambiguous_priority(/cmd_vel) holds: `/one` and"),
        ('ambiguous_priority("/cmd_vel")', 0, "ambiguous_priority(/cmd_vel) holds: `/one` and"),
        ("ambiguous_priority", 0, "ambiguous_priority holds: `/one` and `/two` publish"),
        ("loose_end(/cmd_vel)", 0, "No loose_end(/cmd_vel): nothing that is started subscribes"),
        (
            "guard_bypass(/cmd_vel)",
            0,
            "no guard, such as a velocity smoother, publishes `/cmd_vel`.",
        ),
        ("duplicate_node(/one)", 0, "No duplicate_node(/one): no launch file starts `/one` twice."),
        ("dead_remap(_)", 0, "No dead_remap: no node is known to lack a topic that a launch file"),
        ("loose_end(/cmd_ve)", 2, "the launch files have no name `/cmd_ve`"),
        ("loose_end(cmd_vel)", 0, "No loose_end(/cmd_vel): nothing that is started subscribes"),
        ("loose_end(cmd_ve)", 2, "did you mean `/cmd_vel`?"),
        ("ambiguous_priority(cmd_vel)", 0, "ambiguous_priority(/cmd_vel) holds: `/one` and"),
        ("ambiguous_priority(/one)", 0, "ambiguous_priority(/one) holds: `/one` and `/two`"),
        ("data_cycle(/one)", 0, "`/one` feeds nothing, so nothing leads back to it"),
    ],
)
def test_why_not_knows_the_findings_in_launch_files(
    workspace: Path, capsys: Captured, atom: str, status: int, text: str
) -> None:
    words = ["explain", str(workspace), "--quiet", "--why-not", atom]
    assert run_here(words) == status
    output = capsys.readouterr()
    assert text in " ".join((output.err if status else output.out).split())
    if not status:
        run_here([*words, "--format", "json"])
        document = json.loads(capsys.readouterr().out)
        assert document["present"] == (" holds: " in text) and document["traces"]


def test_why_not_knows_that_a_robot_has_no_launch_file(tmp_path: Path, capsys: Captured) -> None:
    robot = tmp_path / "robot.mars"
    robot.write_text("@configuration\n@modules Camera\n")
    assert run_here(["explain", str(robot), "--quiet", "--why-not", "duplicate_node(Camera)"]) == 0
    reason = "No duplicate_node(Camera): launch files alone have such findings, and none was read."
    assert reason in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("subject", "status", "text"),
    [
        ("./ws/src/drive/drive/sender.py:9:5", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("{here}/ws/src/drive/drive/sender.py:9", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("ambiguous_priority(/one)", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("both.launch.xml:4", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("sender.py:1", 0, "no finding at `sender.py:1`"),
        ("sendre.py:1", 2, "the launch files have no name `sendre.py`"),
        ("cmd_vel", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("one", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("cmd_ve", 2, "the launch files have no name `cmd_ve` help: did you mean `/cmd_vel`?"),
        ("ambiguous_priority(cmd_vel)", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("ambiguous_priority(one)", 0, "ambiguous_priority(/cmd_vel), warning"),
        ("loose_end(cmd_vel)", 0, "No loose_end(/cmd_vel): nothing that is started subscribes"),
        ("ambiguos_priority", 2, "did you mean `ambiguous_priority`?"),
        ("nothing_alike", 2, "has no module, node"),
        ("/cmd_ve", 2, "did you mean `/cmd_vel`?"),
    ],
)
def test_subjects_of_launch_files(
    workspace: Path, capsys: Captured, subject: str, status: int, text: str
) -> None:
    subject = subject.format(here=Path.cwd())
    assert run_here(["explain", str(workspace), subject, "--quiet"]) == status
    output = capsys.readouterr()
    assert text in " ".join((output.err if status else output.out).split())


def test_a_node_is_drawn_with_or_without_its_slash(workspace: Path, capsys: Captured) -> None:
    drawn = []
    for name in ("/one", "one"):
        assert run_here(["draw", str(workspace), "--about", name, "--as", "mmd", "--quiet"]) == 0
        drawn.append(capsys.readouterr().out)
    assert drawn[0] == drawn[1] and "/one" in drawn[0]


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("drive/sender.py:9", "ambiguous_priority(/cmd_vel), warning"),
        ("drive/sender.py:9:5", "ambiguous_priority(/cmd_vel), warning"),
        ("drive/sender.py:1", "no finding at `ws/src/drive/drive/sender.py:1`"),
        ("package.xml:1", "no finding at `ws/src/drive/package.xml:1`"),
    ],
)
def test_a_line_of_a_source_is_explained_within_its_workspace(
    workspace: Path, capsys: Captured, file: str, text: str
) -> None:
    location = f"{workspace}/src/drive/{file}"
    for named in (location, f"./{location}", str(Path(location).absolute())):
        assert run_here(["explain", named, "--quiet"]) == 0
        shown = text.replace("ws/", f"{Path.cwd()}/ws/") if named.startswith("/") else text
        assert shown in " ".join(capsys.readouterr().out.split())
    for part in ("drive/sender.py", "drive"):
        assert run_here(["check", f"{workspace}/src/drive/{part}"]) == 2
        assert "name its workspace, `ws`" in capsys.readouterr().out


def test_a_line_of_a_file_that_cannot_be_read_is_explained(
    workspace: Path, capsys: Captured
) -> None:
    package = workspace / "src" / "drive"
    (package / "p.yaml").write_text("n:\n  ros__parameters:\n    x: 1\n    x: 2\n")
    loading = '<param from="$(find-pkg-share drive)/p.yaml"/>'
    text = f'<launch><node pkg="q" exec="n" name="n">{loading}</node></launch>'
    (package / "launch" / "one.launch.xml").write_text(text)
    assert run_here(["explain", f"{package}/p.yaml:4", "--quiet"]) == 0
    assert "`x` is given twice" in capsys.readouterr().out


def test_a_package_is_found_by_its_name(
    workspace: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(workspace)
    for words in (["check", "drive"], ["draw", "drive"]):
        assert run_here(words) == 2
        output = capsys.readouterr()
        assert "no such file" in output.out + output.err
        assert "the package is in `src/drive`" in output.out + output.err


def test_the_order_of_launch_files_changes_no_finding(workspace: Path, capsys: Captured) -> None:
    other = workspace / "src" / "base"
    (other / "launch").mkdir(parents=True)
    (other / "package.xml").write_text("<package><name>base</name></package>")
    (other / "launch" / "base.launch.xml").write_text(
        '<launch><node pkg="joy" exec="joy_node" name="joy"/></launch>'
    )
    package = workspace / "src" / "drive" / "package.xml"
    built = "<export><build_type>ament_python</build_type></export>"
    package.write_text(f"<package><name>drive</name>{built}</package>")
    files = [
        str(path) for path in sorted(workspace.rglob("*.launch.xml")) if path.stem[:3] != "one"
    ]
    shown = []
    for order in (files, files[::-1]):
        run_here(["check", *order, "--format", "json"])
        shown.append([each["message"] for each in findings(capsys.readouterr().out)])
    assert shown[0] == shown[1] and shown[0]


@pytest.mark.parametrize("guard", ["a_guard", "z_guard"])
@pytest.mark.parametrize("at", range(4))
def test_neither_the_order_of_nodes_nor_their_names_change_the_nodes_past_a_guard(
    workspace: Path, capsys: Captured, guard: str, at: int
) -> None:
    nodes = [f'<node pkg="drive" exec="sender" name="{name}"/>' for name in "pqr"]
    nodes.insert(
        at,
        '<node pkg="nav2_velocity_smoother" exec="velocity_smoother" '
        f'name="{guard}"><remap from="cmd_vel" to="raw"/>'
        '<remap from="cmd_vel_smoothed" to="cmd_vel"/></node>',
    )
    file = workspace / "src" / "drive" / "launch" / "both.launch.xml"
    file.write_text(f"<launch>{''.join(nodes)}</launch>")
    run_here(["check", str(file), "--format", "json"])
    (found,) = (f for f in findings(capsys.readouterr().out) if f["kind"] == "guard_bypass")
    assert str(found["message"]).startswith("commands of `/p`, `/q` and `/r` reach `/cmd_vel`")


def test_a_difference_of_workspaces_has_the_findings_of_check(
    workspace: Path, capsys: Captured
) -> None:
    shutil.copytree(workspace, "two")
    assert run_here(["diff", "ws", "two", "--quiet"]) == 0
    assert capsys.readouterr().out == ""
    launch = Path("two/src/drive/launch/one.launch.xml")
    launch.write_text(launch.read_text().replace('exec="sender" name="one"', 'exec="sendr"'))
    for order, how in ((["ws", "two"], "appeared"), (["two", "ws"], "vanished")):
        assert run_here(["diff", *order, "--quiet"]) == 0
        assert f"{how} missing_file: the package `drive` has no" in capsys.readouterr().out


def test_a_folder_whose_name_occurs_again_within_it_differs_by_its_edits_alone(
    workspace: Path, capsys: Captured
) -> None:
    shutil.copytree(workspace / "src" / "drive", "drive/src/my_drive")
    shutil.copytree("drive", "old")
    sender = Path("drive/src/my_drive/drive/sender.py")
    sender.write_text(sender.read_text().replace("cmd_vel", "other"))
    run_here(["diff", "old", "drive", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    lines = [[each["line"] for each in document[key]] for key in ("removed", "added")]
    assert lines == [[9], [9]]


def test_a_comment_is_judged_where_every_launch_file_is_read(
    workspace: Path, capsys: Captured
) -> None:
    package = workspace / "src" / "drive"
    sender, alone = package / "drive" / "sender.py", package / "launch" / "one.launch.xml"
    commented = SENDER.replace("10)", "10)  # mars: ignore[ambiguous_priority] in turns")
    sender.write_text(commented)
    alone.write_text('<launch><node pkg="drive" exec="sender"/></launch>')
    for words in (["ws"], ["ws", "--launch", str(alone)], [str(alone)]):
        assert run_here(["check", *words, "--fail-on", "warning"]) == 0
        assert "unused-ignore" not in capsys.readouterr().out
    (package / "launch" / "both.launch.xml").unlink()
    assert run_here(["check", "ws", "--fail-on", "warning"]) == 1
    assert "unused-ignore" in capsys.readouterr().out
    # A file with errors may start the program, or another package of the workspace.
    broken = package / "launch" / "both.launch.xml"
    broken.write_text("<launch><node")
    run_here(["check", "ws"])
    assert "unused-ignore" not in capsys.readouterr().out
    broken.unlink()
    assert run_here(["check", str(package), "--fail-on", "warning"]) == 0


def test_entries_of_a_baseline_are_kept_where_a_file_has_errors(
    workspace: Path, capsys: Captured
) -> None:
    assert run_here(["check", "ws", "--write-baseline", "k.json"]) == 0
    before = json.loads(Path("k.json").read_text())["findings"]
    assert before
    (workspace / "src" / "drive" / "drive" / "sender.py").write_text("def (\n")
    capsys.readouterr()
    assert run_here(["check", "ws", "--baseline", "k.json"]) == 0
    assert "match nothing" not in capsys.readouterr().err
    assert run_here(["check", "ws", "--write-baseline", "k.json"]) == 0
    after = json.loads(Path("k.json").read_text())["findings"]
    assert all(each in after for each in before)


def test_a_chosen_launch_file_has_the_faults_of_its_programs(
    workspace: Path, capsys: Captured
) -> None:
    setup = workspace / "src" / "drive" / "setup.py"
    setup.write_text(setup.read_text().replace(":main", ":mian"))
    (workspace / "mars.toml").touch()
    chosen = ["check", "ws", "--launch", "one.launch.xml", "-v", "--fail-on", "warning"]
    assert run_here(chosen) == 1
    output = capsys.readouterr()
    assert "is the function `drive.sender:mian`, which is not there [missing_file]" in output.out
    assert "mars-asp: settings ws/mars.toml\n" in output.err


@pytest.mark.parametrize(("output", "is_dead"), [("cmd_vel_uot", True), ("cmd_vel_out", False)])
def test_a_renaming_of_no_topic_of_a_mux_is_dead(
    workspace: Path, capsys: Captured, output: str, is_dead: bool
) -> None:
    package = workspace / "src" / "drive"
    (package / "launch" / "one.launch.xml").unlink()
    renaming = f'/config/mux.yaml"/><remap from="{output}" to="cmd_vel"/>'
    text = MUX.replace('/config/mux.yaml"/>', renaming)
    (package / "launch" / "both.launch.xml").write_text(text)
    (package / "config").mkdir()
    (package / "config" / "mux.yaml").write_text(INPUTS)
    run_here(["check", "ws", "--select", "dead_remap"])
    found = f"`/twist_mux` has no topic `/{output}`, which is renamed to `/cmd_vel`"
    assert (found in capsys.readouterr().out) == is_dead
    run_here(["explain", "ws", "--why-not", "dead_remap(/twist_mux)"])
    assert "no launch file renames" not in capsys.readouterr().out


def test_a_baseline_holds_in_every_working_folder(
    workspace: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    package = workspace / "src" / "drive"
    (package / "launch" / "both.launch.xml").unlink()
    (package / "launch" / "one.launch.xml").write_text(
        '<launch><node pkg="drive" exec="sender" name="one">'
        '<param from="$(find-pkg-share drive)/config/p.yaml"/></node></launch>'
    )
    (package / "config").mkdir()
    (package / "config" / "p.yaml").write_text("other:\n  ros__parameters:\n    x: 1\n")
    assert run_here(["check", "ws", "--write-baseline", "known.json"]) == 0
    finding = json.loads(Path("known.json").read_text())["findings"][0]
    assert finding["subject"] == "ws/src/drive/config/p.yaml"
    Path(".git").mkdir()
    capsys.readouterr()

    def fingerprints(path: str) -> list[dict[str, str]]:
        assert run_here(["check", path, "--format", "sarif", "-q"]) == 0
        [run] = json.loads(capsys.readouterr().out)["runs"]
        return [each["partialFingerprints"] for each in run["results"]]

    before = fingerprints("ws")
    monkeypatch.chdir(package)
    assert fingerprints(".") == before
    assert run_here(["check", ".", "--baseline", "../../../known.json"]) == 0
    assert "not reported: 1 in the baseline" in capsys.readouterr().err


MUX = """\
<launch>
  <node pkg="twist_mux" exec="twist_mux">
    <param from="$(find-pkg-share drive)/config/mux.yaml"/>
  </node>
  <node pkg="joy" exec="joy_node">
    <param from="$(find-pkg-share drive)/config/joy.yaml"/>
  </node>
</launch>
"""
INPUTS = """\
twist_mux:
  ros__parameters:
    topics:
      joystick: {topic: joy_vel, timeout: 0.5, priority: 100}
      tablet: {topic: tab_vel, timeout: 0.5, priority: 50}
"""


def with_mux(workspace: Path) -> Path:
    """Return the package of a workspace, which starts a mux and a joystick alone."""
    package = workspace / "src" / "drive"
    (package / "launch" / "one.launch.xml").unlink()
    (package / "launch" / "both.launch.xml").write_text(MUX)
    (package / "config").mkdir()
    (package / "config" / "mux.yaml").write_text(INPUTS)
    return package


def test_a_difference_has_no_line_that_caused_another_one(
    workspace: Path, capsys: Captured
) -> None:
    package = with_mux(workspace)
    (package / "setup.py").write_text(
        "setup(entry_points={'console_scripts': [\n    'sender = drive.sender:run',\n"
        "    'other = drive.sender:main',\n]})\n"
    )
    shutil.copytree(workspace, "two")
    new = Path("two/src/drive")
    (new / "config" / "joy.yaml").write_text("joy_node:\n  ros__parameters:\n    rate: 1\n")
    (new / "config" / "mux.yaml").write_text(INPUTS.replace(": 50", ": 40"))
    (new / "setup.py").write_text((new / "setup.py").read_text().replace(":run", ":main"))
    run_here(["diff", "ws", "two", "--format", "json"])
    found = {
        (each["change"], each["message"].split("`")[1 if "publishes" in each["message"] else 3]): [
            f"{sign} {Path(line['path']).name}:{line['line']}"
            for sign, key in (("-", "removed"), ("+", "added"), ("=", "unchanged"))
            for line in each[key]
        ]
        for each in json.loads(capsys.readouterr().out)["consequences"]
    }
    assert found == {
        ("vanished", "drive.sender:run"): ["- setup.py:2", "+ setup.py:2"],
        ("vanished", "config/joy.yaml"): ["= both.launch.xml:5"],
        ("appeared", "/joy_vel"): ["= both.launch.xml:5"],
        ("appeared", "/tab_vel"): [
            *("- mux.yaml:5", "+ mux.yaml:5", "= both.launch.xml:5"),
        ],
    }


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            'name="two" ',
            'name="two"\n   args="--ros-args -r cmd_vel:=other" ',
            [
                "vanished",
                '- 4: <node pkg="drive" exec="sender" name="two" if="$(var second)"/>',
                '+ 4: <node pkg="drive" exec="sender" name="two"',
                '+ 5: args="--ros-args -r cmd_vel:=other" if="$(var second)"/>',
            ],
        ),
        (
            'default="true"',
            'default="false"',
            [
                "changed",
                '- 2: <arg name="second" default="true"/>',
                '+ 2: <arg name="second" default="false"/>',
            ],
        ),
    ],
)
def test_a_difference_of_workspaces_has_the_lines_that_were_edited(
    workspace: Path, capsys: Captured, old: str, new: str, expected: list[str]
) -> None:
    Path("ws/src/drive/launch/one.launch.xml").unlink()
    shutil.copytree(workspace, "two")
    launch = Path("two/src/drive/launch/both.launch.xml")
    launch.write_text(launch.read_text().replace(old, new))
    run_here(["diff", "ws", "two", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    [finding] = document["consequences"]
    lines = [
        f"{sign} {each['line']}: {each['text']}"
        for sign, key in (("-", "removed"), ("+", "added"))
        for each in finding[key]
    ]
    assert [finding["change"], *lines] == expected
    assert finding["unchanged"]
    assert {each["line"] for each in finding["added"]} <= {e["line"] for e in document["added"]}


def test_a_file_that_is_installed_now_is_in_its_build_file(
    workspace: Path, capsys: Captured
) -> None:
    package = with_mux(workspace)
    (package / "config" / "joy.yaml").write_text("joy_node:\n  ros__parameters:\n    rate: 1\n")
    built = "<export><build_type>ament_python</build_type></export>"
    (package / "package.xml").write_text(f"<package><name>drive</name>{built}</package>")
    files = "        ('share/drive/launch', glob('launch/*')),\n"
    build = f"setup(\n    data_files=[\n{files}    ],\n)\n"
    (package / "setup.py").write_text(build)
    shutil.copytree(workspace, "two")
    config = "        ('share/drive/config', glob('config/*')),\n"
    Path("two/src/drive/setup.py").write_text(build.replace("    ],", f"{config}    ],"))
    run_here(["diff", "ws", "two", "--format", "json"])
    found = [
        each
        for each in json.loads(capsys.readouterr().out)["consequences"]
        if each["kind"] == "missing_file"
    ]
    lines = [(Path(line["path"]).name, line["line"]) for each in found for line in each["added"]]
    assert found and lines == [("setup.py", 4)] * len(found)


def test_a_file_of_another_name_differs_by_its_name_alone(
    workspace: Path, capsys: Captured
) -> None:
    with_mux(workspace)
    shutil.copytree(workspace, "two")
    new = Path("two/src/drive")
    (new / "config" / "mux.yaml").rename(new / "config" / "inputs.yaml")
    launch = new / "launch" / "both.launch.xml"
    launch.write_text(MUX.replace("mux.yaml", "inputs.yaml"))
    run_here(["diff", "ws", "two", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    for key in ("removed", "added"):
        places = [(Path(each["path"]).name, each["line"]) for each in document[key]]
        assert places == [("both.launch.xml", 3)]


def test_a_source_that_nothing_starts_any_more_is_not_removed(
    workspace: Path, capsys: Captured
) -> None:
    Path("ws/src/drive/launch/one.launch.xml").unlink()
    shutil.copytree(workspace, "two")
    launch = Path("two/src/drive/launch/both.launch.xml")
    launch.write_text(launch.read_text().replace('exec="sender"', 'exec="gone"'))
    run_here(["diff", "ws", "two", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    changes = [*document["consequences"], *document["nodes"]]
    cited = {Path(line["path"]).name for each in changes for line in each["removed"]}
    assert cited == {"both.launch.xml"}


def test_folders_are_judged_each_by_itself(workspace: Path, capsys: Captured) -> None:
    shutil.copytree(workspace, "two")
    run_here(["check", str(workspace), "two", "--format", "json"])
    places = [str(each["path"]).partition("/")[0] for each in findings(capsys.readouterr().out)]
    assert places == ["ws", "two"]
    run_here(["check", ".", "--launch", "two/src/drive/launch/both.launch.xml", "--format", "json"])
    places = [str(each["path"]).partition("/")[0] for each in findings(capsys.readouterr().out)]
    assert places == ["two"]
    Path("stray.launch.xml").write_text("<launch>")
    run_here(["check", ".", "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    assert [each["path"] for each in document["files"]] == ["stray.launch.xml", "two", "ws"]


def test_analyse_judges_as_check_does(workspace: Path, capsys: Captured) -> None:
    assert run_here(["analyse", str(workspace), "--format", "json"]) == 0
    [finding] = json.loads(capsys.readouterr().out)["consequences"]
    assert finding["kind"] == "ambiguous_priority"
    assert [each["variable"] for each in finding["conditions"]] == ["second"]
    assert finding["conditions"][0]["location"]["line"] == 4


@pytest.mark.parametrize("option", [["--ignore", "launch"], ["--select", "ambiguous_priority"]])
def test_messages_on_reading_are_selected_as_findings_are(
    workspace: Path, capsys: Captured, option: list[str]
) -> None:
    run_here(["check", str(workspace)])
    assert "on conditions, of" in capsys.readouterr().err
    for verb in ("check", "explain", "analyse"):
        run_here([verb, str(workspace), *option])
        assert "on conditions, of" not in capsys.readouterr().err


def test_a_comment_hides_a_message_on_reading(workspace: Path, capsys: Captured) -> None:
    file = workspace / "src" / "drive" / "launch" / "both.launch.xml"
    lines = file.read_text().splitlines()
    lines[3] += " <!-- mars: ignore[launch] both branches are known -->"
    file.write_text("\n".join(lines))
    run_here(["check", str(workspace)])
    output = capsys.readouterr().err
    assert "on conditions, of" not in output
    assert "1 hidden by a comment" in output


def test_packs_are_not_applied_in_silence(
    workspace: Path, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "pack").mkdir()
    (tmp_path / "pack" / "own.lp").write_text(
        "%! id: own/rule\nconsequence(own, warning, M, own) :- module(M).\n"
    )
    for command in ("check", "analyse", "explain"):
        run_here([command, str(workspace), "--rules", str(tmp_path / "pack")])
        assert "they were not applied" in capsys.readouterr().err


NODE = """\
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Made(Node):
    def __init__(self):
        super().__init__("made")
        self.create_{}


def main():
    rclpy.init()
    rclpy.spin(Made())
"""
READS, SENDS = 'subscription(LaserScan, "{}", print, 10)', 'publisher(LaserScan, "{}", 10)'


@pytest.mark.parametrize(
    ("hand", "kinds"),
    [
        (SENDS.format("other"), ["loose_end"]),
        (SENDS.format("scan"), []),
        (READS.format("base/scan"), ["unfed_input"]),
    ],
)
def test_a_program_that_no_launch_file_starts_may_be_the_other_end(
    hand: str, kinds: list[str], tmp_path: Path, capsys: Captured
) -> None:
    programs = {"reader": READS.format("scan"), "sender": SENDS.format("base/scan"), "hand": hand}
    scripts = [f"{name} = drive.{name}:main" for name in programs]
    nodes = "".join(
        f'<node pkg="drive" exec="{name}" name="{name}"/>' for name in list(programs)[:2]
    )
    files = {
        "package.xml": "<package><name>drive</name></package>",
        "setup.py": f"setup(entry_points={{'console_scripts': {scripts}}})",
        "launch/bot.launch.xml": f"<launch>{nodes}</launch>",
        **{f"drive/{name}.py": NODE.format(made) for name, made in programs.items()},
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    run_here(["analyse", str(tmp_path), "--format", "json"])
    found = json.loads(capsys.readouterr().out)["consequences"]
    assert [each["kind"] for each in found] == kinds


def test_an_answer_has_one_line_on_the_notes_of_reading(capsys: Captured, tmp_path: Path) -> None:
    path = str(ROOT / "examples" / "ros2_workspace")
    assert run_here(["draw", path]) == 0
    lines = capsys.readouterr().err.split()
    assert " ".join(lines).startswith(f"mars-asp: note: {path}: 2 notes on reading: see `mars-asp")
    assert lines.count("note:") == 1
    assert run_here(["draw", path, "--format", "json", "-o", str(tmp_path / "robot.svg")]) == 0
    assert [json.loads(line)["code"] for line in capsys.readouterr().err.splitlines()] == [
        "launch",
        "catalogue",
    ]
    assert run_here(["can", path, "Trans_X"]) == 2
    assert capsys.readouterr().err.startswith("<query>:1:1: error: found `Trans_X`, expected")


TIED = """twist_mux:
  ros__parameters:
    topics:
      joy: {topic: joy_vel, timeout: 0.5, priority: 10}
      dock: {topic: dock_vel, timeout: 0.5, priority: 10}
"""


def test_a_mux_file_is_a_part_of_its_workspace(workspace: Path, capsys: Captured) -> None:
    """A baseline of the workspace has findings that a file alone does not have."""
    package = workspace / "src/drive"
    mux = package / "config" / "twist_mux.yaml"
    mux.parent.mkdir()
    mux.write_text(TIED)
    given = '<param from="$(find-pkg-share drive)/config/twist_mux.yaml"/>'
    launch = f'<launch><node pkg="twist_mux" exec="twist_mux" name="twist_mux">{given}</node>'
    (package / "launch" / "mux.launch.xml").write_text(f"{launch}</launch>")
    assert run_here(["check", str(workspace), "--write-baseline", "known.json"]) == 0
    before = Path("known.json").read_text()
    assert "/twist_mux" in before
    capsys.readouterr()
    assert run_here(["check", str(mux), "--baseline", "known.json"]) == 0
    assert "nothing any more" not in capsys.readouterr().err
    assert run_here(["check", str(mux), "--write-baseline", "known.json"]) == 0
    listed = [line.strip(" ,") for line in Path("known.json").read_text().splitlines()]
    assert {line.strip(" ,") for line in before.splitlines()} <= {*listed}


def test_a_finding_of_one_launch_file_of_several_names_it(
    workspace: Path, capsys: Captured
) -> None:
    assert run_here(["check", str(workspace), "--format", "full"]) == 0
    assert "It holds in" in capsys.readouterr().out
    (workspace / "src/drive/launch/one.launch.xml").unlink()
    assert run_here(["check", str(workspace), "--format", "full"]) == 0
    assert "It holds in" not in capsys.readouterr().out
    twins = "".join(f'<node pkg="joy" exec="joy_node" name="{n}"/>' for n in ("a", "a", "b"))
    launch = workspace / "src/drive/launch/twins.launch.xml"
    launch.write_text(f"<launch>{twins}</launch>")
    assert run_here(["check", str(workspace), "--format", "full"]) == 0
    named = " ".join(capsys.readouterr().out.split())
    assert "It holds in the launch file `ws/src/drive/launch/twins.launch.xml`." in named
