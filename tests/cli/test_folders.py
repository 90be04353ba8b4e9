"""Folders on the command line: which robots are in them, and which paths are passed over."""

import io
import json
import os
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured, Patch

MARS = "@configuration\n@modules A, B\nA uses_data_from B\n"
WRONG = "@configuration\n@modules A\nA uses_data_from Missing\n"
MUX = (
    "topics:\n- {name: a, topic: a, timeout: 0.5, priority: 1}\n"
    "- {name: b, topic: b, timeout: 0.5, priority: 1}\n"
)
DATAFLOW = "nodes:\n- id: camera\n  outputs: [image]\n- id: view\n  inputs: {image: camera/image}\n"
DUMP = "/talker\n  Subscribers:\n  Publishers:\n    /chatter: std_msgs/msg/String\n"
URDF = '<robot name="r"><link name="base"/></robot>'
LAUNCH = '<launch><node pkg="joy" exec="joy_node"/></launch>'
PACKAGE = "<package><name>{}</name><export><build_type>ament_cmake</build_type></export></package>"


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def package(name: str) -> dict[str, str]:
    last = name.rpartition("/")[2]
    return {f"{name}/package.xml": PACKAGE.format(last), f"{name}/launch/r.launch.xml": LAUNCH}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def judged(capsys: Captured, *words: str) -> list[str]:
    """Return the robots that `check` judges."""
    run_here(["check", "--format", "json", *words])
    document = json.loads(capsys.readouterr().out)
    return [each["path"] for each in document["files"]]


#: The files of a folder, and its robots.
FOLDERS = {
    "each configuration": ({"b/x.mars": MARS, "a.mars": MARS}, ["a.mars", "b/x.mars"]),
    "by content": (
        {"m.yaml": MUX, "d.yml": DATAFLOW, "r.urdf": URDF, "other.yaml": "a: 1", "p.py": "x = 1"}
        | {"graph.txt": DUMP, "other.txt": "talker", "other.xml": "<a/>"},
        ["d.yml", "graph.txt", "m.yaml", "r.urdf"],
    ),
    "a workspace": (package("ws/src/a") | package("ws/src/b"), ["ws"]),
    "packages in no workspace": (package("a") | package("b"), ["."]),
    "launch files alone": ({"r.launch.xml": LAUNCH}, ["."]),
    "two workspaces": (package("v/src/a") | package("w/src/deep/b"), ["v", "w"]),
    # What starts the programs of a package may be in a package anywhere beside it.
    "two workspaces and a package": (
        package("v/src/a") | package("w/src/deep/b") | package("c"),
        ["."],
    ),
    "a workspace and a repository without src": (
        package("v/src/a") | package("r/b") | {"v/.git/config": "", "r/.git/config": ""},
        ["."],
    ),
    "a workspace without a launch file": (
        package("v/src/a") | {"w/src/b/package.xml": PACKAGE.format("b")},
        ["v"],
    ),
    "a workspace within another": (package("w/src/a") | package("w/src/x/src/b"), ["w"]),
    "all of a workspace belongs to it": (
        package("ws/src/a") | {"ws/src/a/mux.yaml": MUX, "ws/src/a/r.mars": MARS, "mux.yaml": MUX},
        ["mux.yaml", "ws", "ws/src/a/r.mars"],
    ),
    "not to be built": ({"a/x.mars": MARS, "a/COLCON_IGNORE": "", "b.mars": MARS}, ["b.mars"]),
    "hidden": ({".a/x.mars": MARS, ".b.mars": MARS, "c.mars": MARS}, ["c.mars"]),
    "ignored by git": (
        {"a.mars": MARS, "b.mars": MARS, "w/c.mars": MARS, ".gitignore": "w/\n/b.mars\n"},
        ["a.mars"],
    ),
    "ignored in an inner folder": (
        {"w/a.mars": MARS, "w/.gitignore": "a.mars\n", "a.mars": MARS},
        ["a.mars"],
    ),
    "ignored in a workspace": (
        package("ws/src/a") | package("ws/src/b") | {"ws/.gitignore": "src/b\n"},
        ["ws"],
    ),
    "excluded by the settings": (
        {"a.mars": MARS, "b.old.mars": MARS, "mars.toml": 'exclude = ["*.old.mars"]\n'},
        ["a.mars"],
    ),
}


@pytest.mark.parametrize(("files", "robots"), FOLDERS.values(), ids=FOLDERS)
def test_the_robots_of_a_folder(
    files: dict[str, str], robots: list[str], here: Path, capsys: Captured
) -> None:
    write(here, files)
    assert judged(capsys) == robots
    assert judged(capsys, str(here)) == [os.path.normpath(here / each) for each in robots]


@pytest.mark.parametrize(
    ("files", "named"),
    [
        ({"r.launch.xml": LAUNCH, "m.yaml": MUX, "r.urdf": URDF}, ["m.yaml", "r.urdf"]),
        ({"r.launch.xml": LAUNCH, "d.yml": DATAFLOW, "m.yaml": MUX}, ["m.yaml", "r.launch.xml"]),
        (package("p") | {"r.launch.xml": LAUNCH, "d.yml": DATAFLOW, "m.yaml": MUX}, ["m.yaml"]),
        # Files of a package, and those that a launch file loads, are judged with it.
        (package("p") | {"p/m.yaml": MUX, "p/r.urdf": URDF}, []),
        ({"r.launch.xml": f"<!-- r.urdf -->{LAUNCH}", "r.urdf": URDF, "x.yaml": "a: 1"}, []),
    ],
)
def test_a_note_names_the_robots_that_are_not_judged(
    files: dict[str, str], named: list[str], here: Path, capsys: Captured
) -> None:
    write(here, files)
    assert run_here(["check"]) == 0
    listed = ", ".join(f"`{name}`" for name in named)
    note = f"which `mars-asp check FILE` judges, not read: {len(named)} ({listed}) [not_read]"
    output = capsys.readouterr().err
    assert (note in output) == ("check FILE" in output) == bool(named)


def test_links_to_folders_are_passed_over(here: Path, capsys: Captured) -> None:
    write(here, {"a/x.mars": MARS, "b.mars": MARS})
    (here / "link").symlink_to(here / "a")
    assert judged(capsys) == ["a/x.mars", "b.mars"]
    assert judged(capsys, "link") == ["link/x.mars"]


@pytest.mark.parametrize(("others", "kind"), [({"b.mars": MARS}, "notes"), ({}, "findings")])
def test_links_to_files_are_not_passed_over_in_silence(
    others: dict[str, str], kind: str, here: Path, capsys: Captured
) -> None:
    write(here, {"w/x.yaml": "a: 1", **{f"w/{name}": text for name, text in others.items()}})
    (here / "w" / "a.mars").symlink_to("missing.mars")
    run_here(["check", "w", "--format", "json"])
    [message] = [each["message"] for each in json.loads(capsys.readouterr().out)[kind]]
    assert message.endswith("links to `.mars` files not read: 1 (`w/a.mars`)")


def test_a_package_that_git_ignores_is_not_read(here: Path, capsys: Captured) -> None:
    write(here, package("src/a") | package("src/b") | {".gitignore": "src/b\n"})
    run_here(["check", "--format", "json"])
    [robot] = json.loads(capsys.readouterr().out)["files"]
    assert robot["launch_files"] == ["src/a/launch/r.launch.xml"]


def test_options_exclude_paths_that_are_not_named(here: Path, capsys: Captured) -> None:
    write(here, {"a.mars": MARS, "w/b.mars": MARS})
    assert judged(capsys, "--exclude", "w") == ["a.mars"]
    assert judged(capsys, "--exclude", "w", ".", "w/b.mars") == ["a.mars", "w/b.mars"]
    assert judged(capsys, ".", "a.mars") == judged(capsys, "a.mars", ".") == ["a.mars", "w/b.mars"]
    assert judged(capsys, "--exclude", "w", "w") == ["w/b.mars"]
    assert judged(capsys, "--exclude", "w", "--force-exclude", "w", "a.mars") == ["a.mars"]


@pytest.mark.parametrize("command", ["check --fix", "fmt"])
def test_an_excluded_text_of_standard_input_is_printed_unchanged(
    command: str, here: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"@modules A,,")))
    words = f"{command} - --stdin-filename w/x.mars --exclude w --force-exclude"
    assert run_here(words.split()) == 0
    assert capsys.readouterr().out == "@modules A,,"


def test_git_ignores_paths_below_the_folder_with_its_repository(
    here: Path, capsys: Captured
) -> None:
    write(here, {"r/s/a.mars": MARS, "r/s/b.mars": MARS, "r/.gitignore": "b.mars", "r/.git/x": ""})
    write(here, {"r/.git/info/exclude": "c.mars", "r/s/c.mars": MARS})
    assert judged(capsys, "r/s") == ["r/s/a.mars"]
    # The folder itself is named.
    write(here, {"r/.gitignore": "s/\n"})
    assert judged(capsys, "r/s") == ["r/s/a.mars", "r/s/b.mars"]


@pytest.mark.parametrize("pattern", ["a*" * 30 + "b", "**/a/" * 30 + "b", "?" * 600])
def test_a_pattern_that_takes_very_long_is_left_out(
    pattern: str, here: Path, capsys: Captured
) -> None:
    deep = "a/" * 40 + "a" * 200 + ".mars"
    write(here, {deep: MARS, "x.mars": MARS, ".gitignore": f"{pattern}\nx.mars\n"})
    assert judged(capsys) == [deep]


def test_a_folder_without_a_robot_is_refused(here: Path, capsys: Captured) -> None:
    write(here, {"empty/x.yaml": "a: 1", "a.mars": WRONG})
    assert run_here(["check", "empty", "a.mars"]) == 2
    output = " ".join("".join(capsys.readouterr()).split())
    assert "the folder has nothing to read" in output and "Missing" in output


@pytest.mark.parametrize("command", ["explain", "analyse", "synthesise", "facts"])
def test_other_commands_take_one_robot(command: str, here: Path, capsys: Captured) -> None:
    write(here, {"a/b.mars": MARS})
    assert run_here([command, "a"]) == 0
    write(here, {"a/c.mars": MARS})
    capsys.readouterr()
    assert run_here([command, "a"]) == 2
    output = " ".join(capsys.readouterr().err.split())
    assert "the folder has 2 robots" in output
    assert "name one of them: `a/b.mars`, `a/c.mars`; `mars-asp check a` judges all" in output


def test_a_workspace_beside_a_configuration_can_be_named(here: Path, capsys: Captured) -> None:
    write(here, package("w/src/a") | {"w/r.mars": MARS})
    assert run_here(["facts", "w"]) == 2
    assert "`--from ros2` takes `w`" in " ".join(capsys.readouterr().err.split())
    assert run_here(["facts", "w", "--from", "ros2"]) == 0
    capsys.readouterr()
    # Beside a `.mars` file, `--from` is the format of the other one, in either order.
    for words in ("diff w w/r.mars", "diff w/r.mars w", "verify w/r.mars w"):
        assert run_here([*words.split(), "--from", "ros2"]) < 2
        assert "another format" not in capsys.readouterr().err
    assert run_here(["diff", "w/r.mars", "w/r.mars", "--from", "ros2"]) == 2
    assert run_here(["facts", "w/r.mars", "--from", "dora"]) == 2
    assert "--from names another format" in " ".join(capsys.readouterr().err.split())


LOOSE = "@configuration\n@modules B,A\nA   uses_data_from B\n"


def test_each_configuration_of_a_folder_is_laid_out(here: Path, capsys: Captured) -> None:
    write(here, {"a/x.mars": LOOSE, "y.mars": MARS, "mux.yaml": MUX})
    assert run_here(["fmt", "--check"]) == 1
    assert capsys.readouterr().out == "a/x.mars\n"
    assert run_here(["fmt", "--diff", "a", "y.mars"]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert printed[:2] == ["--- a/x.mars", "+++ a/x.mars"]
    assert "-A   uses_data_from B" in printed and "+A uses_data_from B" in printed
    assert (here / "a" / "x.mars").read_text() == LOOSE
    assert run_here(["fmt"]) == 0
    assert run_here(["fmt", "--diff"]) == 0
    assert run_here(["fmt", "--check", "--exclude", "a", "."]) == 0


def test_a_folder_without_a_configuration_is_not_laid_out(here: Path, capsys: Captured) -> None:
    write(here, {"a/mux.yaml": MUX})
    assert run_here(["fmt", "a"]) == 2
    assert "the folder has no `.mars` file" in capsys.readouterr().err


def test_in_a_folder_files_with_an_expectation_are_cases(here: Path, capsys: Captured) -> None:
    write(
        here, {"notes.lp": "a.\n", "case.lp": 'module("A").\n%not: consequence(_, error, _, _)\n'}
    )
    assert run_here(["test"]) == 0
    assert "1 passed" in capsys.readouterr().out
    assert run_here(["test", "notes.lp"]) == 1


def test_settings_are_those_of_a_file_that_is_named_or_none(here: Path, capsys: Captured) -> None:
    write(here, {"a.mars": MARS, "b.mars": MARS, "mars.toml": 'exclude = ["a.mars"]\n'})
    write(here, {"ci/mars.toml": 'exclude = ["../b.mars", "b.mars"]\n'})
    write(here, {"pyproject.toml": '[tool.mars-asp]\nexclude = ["*.mars"]\n'})
    assert judged(capsys) == ["b.mars"]
    assert judged(capsys, "--isolated") == ["a.mars", "b.mars"]
    assert judged(capsys, "--config", "ci/mars.toml") == ["a.mars", "b.mars"]
    assert run_here(["check", "--config", "pyproject.toml"]) == 2
    assert run_here(["check", "--config", "nowhere.toml"]) == 2


def test_verbose_lists_settings_robots_and_steps(here: Path, capsys: Captured) -> None:
    write(here, package("w/src/a") | {"b.mars": MARS, "x.yaml": "a: 1", "mars.toml": "ignore = []"})
    assert run_here(["check", "-v"]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("mars-asp: ")]
    found = [line.removeprefix("mars-asp: ").partition(": ")[0] for line in lines]
    assert found == [
        "settings mars.toml",
        "robot b.mars",
        "robot w",
        "1 other file in . passed over (no robot by content)",
        "reading b.mars",
        "analysing",
        "reading w",
        "launch file w/src/a/launch/r.launch.xml",
        "analysing",
    ]
    assert run_here(["check", "-v", "b.mars"]) == 0
    assert "settings mars.toml\nmars-asp: robot b.mars" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("check nope", "nope: no such file"),
        ("fmt nope", "nope: no such file"),
        ("explain nope.mars", "nope.mars: no such file"),
        ("extract nope.cpp", "nope.cpp: no such file"),
        ("test nope", "nope: no such file"),
        ("diff nope b.mars", "nope: no such file"),
        ("check b.mars --config b.mars --format full", "this file is read as TOML"),
        ("check b.mars --launch x.launch.py", "--launch chooses a robot of a folder"),
        ("explain b.mars --launch x.launch.py", "--launch chooses a robot of a folder"),
        ("fmt b.mars --config nope.toml", "nope.toml: no such file"),
        ("extract b.mars --config nope.toml", "nope.toml: no such file"),
        ("test b.mars --config nope.toml", "nope.toml: no such file"),
        ("check . --exclude *.mars", "each robot in the folder is excluded"),
        ("check a.md", "a.md` is not a robot by itself"),
        ("test empty", "no case in empty: cases are `.lp` and `.mars` files with an expectation"),
        ("extract empty", "no annotated module in empty"),
    ],
)
def test_paths_without_anything_to_read_are_named(
    command: str, message: str, here: Path, capsys: Captured
) -> None:
    write(here, {"b.mars": MARS, "empty/x.txt": "", "a.md": f"# Robots\n{MARS}"})
    run_here(command.split())
    assert message in " ".join("".join(capsys.readouterr()).split())


def test_fmt_refuses_documents_and_sources(tmp_path: Path, capsys: Captured) -> None:
    for name, text in (("a.md", "# Robots\n"), ("b.cpp", "int main() {}\n")):
        (tmp_path / name).write_text(text)
        assert run_here(["fmt", str(tmp_path / name)]) == 2
        message = " ".join(capsys.readouterr().err.split())
        assert message.endswith(f"{name}` is not a `.mars` file")


def test_invalid_patterns_are_passed_over(here: Path, capsys: Captured) -> None:
    write(here, {".gitignore": "!\nb\n", "a/x.mars": MARS, "b/y.mars": MARS})
    assert judged(capsys, "--exclude", "!") == ["a/x.mars"]


@pytest.mark.parametrize("pattern", ["a", "./a", "{here}/a", "./a/"])
def test_a_pattern_may_be_a_path(pattern: str, here: Path, capsys: Captured) -> None:
    write(here, {"a/x.mars": MARS, "b/a.mars": MARS})
    assert judged(capsys, "--exclude", pattern.format(here=here)) == ["b/a.mars"]


@pytest.mark.parametrize(
    "command", ["fmt a.mars", "fmt a.mars --format json", "test --snapshot a.mars"]
)
def test_a_read_only_file_is_not_reported_as_written(
    command: str, here: Path, capsys: Captured
) -> None:
    text = MARS.replace("\n", "   \n")
    write(here, {"a.mars": text})
    (here / "a.mars").chmod(0o444)
    assert run_here(command.split()) == 2
    output = capsys.readouterr()
    assert "a.mars" not in output.out
    assert "`a.mars`: it is read-only, so it was left alone" in output.err
    assert (here / "a.mars").read_text(encoding="utf-8") == text


def test_a_name_that_is_too_long_is_a_finding(here: Path, capsys: Captured) -> None:
    assert run_here(["check", "a" * 300, "--format", "json"]) == 2
    assert "file name too long" in str(json.loads(capsys.readouterr().out))


def test_a_closed_folder_is_named(here: Path, monkeypatch: Patch, capsys: Captured) -> None:
    write(here, {"closed/b.mars": MARS})
    # The tests may run as root, who can read each folder.
    monkeypatch.setattr("mars_asp.cli.inputs.os.access", lambda path, mode: path != "closed")
    assert run_here(["check", "closed"]) == 2
    assert "error: closed: permission denied" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "text", "code"),
    [
        ("r.launch.py", "def generate_launch_description(:\n", "launch"),
        ("r.launch.xml", "<launch><node", "launch"),
        ("r.launch.yaml", "launch: [\n", "yaml"),
        ("m.yaml", "topics: {a: [\n", "yaml"),
        ("r.mars", "@configuration\n@modules A uses\n", "syntax"),
        ("r.urdf", "<robot>", "urdf"),
        ("e.launch.py", "", "empty"),
        ("b.launch.py", "\0", "syntax"),
        ("e.launch.xml", "\n", "empty"),
        ("other.py", "x = 1\n", "unreadable"),
    ],
)
def test_a_named_file_that_is_broken_is_an_error(
    name: str, text: str, code: str, here: Path, capsys: Captured
) -> None:
    write(here, {name: text})
    assert run_here(["check", name, "--format", "json"]) == 2
    [finding] = json.loads(capsys.readouterr().out)["findings"]
    assert (finding["code"], finding["kind"], finding["severity"]) == (code, None, "error")


def test_a_named_file_that_is_broken_hides_no_finding_in_others(
    here: Path, capsys: Captured
) -> None:
    write(here, {"m.yaml": MUX, "other.yaml": "a: 1", "r.urdf": "<robot", "s.urdf": URDF})
    assert run_here(["check", "other.yaml", "m.yaml", "r.urdf", "s.urdf", "--format", "json"]) == 2
    findings = json.loads(capsys.readouterr().out)["findings"]
    assert {(each["path"], each["kind"]) for each in findings} == {
        ("other.yaml", None),
        ("r.urdf", None),
        ("m.yaml", "ambiguous_priority"),
    }
    assert run_here(["check", "other.yaml", "r.urdf", "--format", "json"]) == 2
    findings = json.loads(capsys.readouterr().out)["findings"]
    assert [each["path"] for each in findings] == ["other.yaml", "r.urdf"]


def test_a_broken_part_of_a_workspace_is_a_warning(here: Path, capsys: Captured) -> None:
    write(here, package("src/a"))
    broken = {"b.launch.py": "\0", "p.launch.py": "def generate_launch_description(:\n"}
    broken |= {"x.launch.xml": "<launch><node", "y.launch.yaml": "launch: [\n"}
    write(here / "src/a/launch", broken)
    assert run_here(["check", "--format", "json"]) == 0
    findings = json.loads(capsys.readouterr().out)["findings"]
    found = [(Path(f["path"]).name, f["kind"], f["severity"]) for f in findings]
    assert found == [(name, "broken_file", "warning") for name in broken]


#: A pack that declares a tag, and a robot that states it.
PACK = {
    "p/pack.toml": 'name = "p"\nversion = "1.0"\nneeds = ["q >= 1.0"]\n',
    "p/consequences/p.lp": "%*! slow(M: module)\nsays: `{M}` is slow\nfrom: tag\n*%\n"
    "#defined slow/1.\n",
    "q/pack.toml": 'name = "q"\nversion = "1.0"\n',
    "p/robots/r.mars": MARS + "@module_start\n@module_name A\n@Tag slow\n@module_end\n",
}
PLACES = {".": (".", "p", "p/robots/r.mars"), "p": (".", "robots"), "p/robots": (".", "r.mars")}


@pytest.mark.parametrize(("folder", "path"), [(a, b) for a, each in PLACES.items() for b in each])
def test_robots_in_a_pack_are_judged_with_it(
    folder: str, path: str, here: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    write(here, {**PACK, "a.mars": MARS})
    monkeypatch.chdir(here / folder)
    assert run_here(["check", path]) == 0
    assert run_here(["check", path, "--isolated"]) == 2
    assert "no rule pack declares the tag `slow`" in capsys.readouterr().out


def test_an_error_in_a_pack_is_reported_once(here: Path, capsys: Captured) -> None:
    write(here, {**PACK, "p/pack.toml": 'name = "P"\n', "p/s.mars": MARS, "a.mars": WRONG})
    assert run_here(["check", "."]) == 2
    output = capsys.readouterr().out
    assert output.count("p/pack.toml:1:1: error: `name`") == 1
    assert "a.mars:3:1: error:" in output


def test_an_output_replaces_an_older_one_in_the_folder(here: Path, capsys: Captured) -> None:
    write(here, {**package("ws/src/a"), "a.mars": MARS})
    for _ in range(2):
        assert run_here(["check", ".", "--format", "junit", "-o", "found.xml"]) == 0
    # Robots are inputs.
    assert run_here(["check", ".", "-o", "ws/src/a/launch/r.launch.xml"]) == 2
    assert "was read as an input" in capsys.readouterr().err
