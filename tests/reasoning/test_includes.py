"""`@include`: the modules and relationships of another configuration, under a prefix."""

from pathlib import Path

import pytest

from mars_asp.model.declarations import Data
from mars_asp.reasoning.project import load_project
from tests.support.refusals import refusal


def test_names_get_the_prefix_of_the_include_and_keep_their_locations(tmp_path: Path) -> None:
    inner = "@configuration\n@modules A, /B\nA.x uses_data_from /B.y\n"
    (tmp_path / "inner.mars").write_text(inner)
    robot = tmp_path / "robot.mars"
    robot.write_text(
        '@configuration\n@include inner.mars as left\n@include inner.mars as "b c"\n@modules Z\n'
        "Z uses_data_from left/A\n"
    )
    found = load_project(str(robot)).configuration
    assert [name.text for name in found.modules] == ["left/A", "/left/B", "b c/A", "/b c/B", "Z"]
    lines = [each for each in found.relationships if isinstance(each, Data)]
    assert [(each.client, each.source, Path(each.span.path).name) for each in lines] == [
        ("left/A", "/left/B", "inner.mars"),
        ("b c/A", "/b c/B", "inner.mars"),
        ("Z", "left/A", "robot.mars"),
    ]


def test_an_error_of_a_file_that_is_included_twice_is_reported_once(tmp_path: Path) -> None:
    (tmp_path / "inner.mars").write_text("@configuration\n@modules A\nA uses_data A\n")
    robot = tmp_path / "robot.mars"
    robot.write_text(
        "@configuration\n@include inner.mars as left\n@include inner.mars as right\n@modules Z\n"
    )
    result = refusal(load_project, str(robot))
    assert (Path(result.span.path).name, result.span.line) == ("inner.mars", 3)


@pytest.mark.parametrize("target", ["robot.mars", "link.mars", "folder", "none.mars"])
def test_an_impossible_include_is_refused_at_its_name(target: str, tmp_path: Path) -> None:
    robot = tmp_path / "robot.mars"
    robot.write_text(f"@configuration\n@include {target}\n@modules Z\n")
    (tmp_path / "link.mars").symlink_to(robot)
    (tmp_path / "folder").mkdir()
    result = refusal(load_project, str(robot))
    assert (result.span.line, result.span.column) == (2, 10)


@pytest.mark.parametrize("line", ["@include none.mars", "@sources none"])
def test_paths_from_standard_input_are_relative_to_the_current_folder(line: str) -> None:
    result = refusal(load_project, "<stdin>", text=f"@configuration\n{line}\n@modules Z\n")
    assert "from standard input, paths of `@" in str(result.help)


def test_a_file_included_twice_counts_once(tmp_path: Path) -> None:
    (tmp_path / "shared.mars").write_text("@configuration\n@modules D, E\nD uses_data_from E\n")
    for name in ("b", "c"):
        text = f"@configuration\n@include shared.mars\n@modules {name}\n{name} uses_data_from E\n"
        (tmp_path / f"{name}.mars").write_text(text)
    robot = tmp_path / "robot.mars"
    robot.write_text("@configuration\n@include b.mars\n@include c.mars\n@modules A\n")
    found = load_project(str(robot)).configuration
    lines = [each.client for each in found.relationships if isinstance(each, Data)]
    assert lines == ["D", "b", "c"]
    assert [name.text for name in found.modules] == ["D", "E", "b", "c", "A"]


def test_a_file_counts_once_however_paths_lead_to_it(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    (tmp_path / "b" / "shared.mars").write_text("@configuration\n@modules D\nD uses_data_from D\n")
    (tmp_path / "link.mars").symlink_to(tmp_path / "b" / "shared.mars")
    (tmp_path / "a" / "a.mars").write_text(
        "@configuration\n@include ../b/shared.mars\n@modules A\n"
    )
    robot = tmp_path / "robot.mars"
    lines = ["@include a/a.mars", "@include b/shared.mars", "@include link.mars", "@modules Z"]
    robot.write_text("\n".join(["@configuration", *lines, ""]))
    (line,) = load_project(str(robot)).configuration.relationships
    assert line.span.path == str(tmp_path / "b" / "shared.mars")


@pytest.mark.parametrize("second", ["second.mars", "robot.mars"])
def test_a_module_that_two_files_describe_differently_is_refused(
    second: str, tmp_path: Path
) -> None:
    block = "@module_start\n@module_name Eye\n@Sense {}\nImage look();\n@module_end\n"
    files = {
        "first.mars": "@configuration\n@modules Eye\n",
        "second.mars": "@configuration\n@modules Eye\n",
        "robot.mars": "@configuration\n@include first.mars\n@include second.mars\n@modules A\n",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    robot, first, other = (tmp_path / name for name in ("robot.mars", "first.mars", second))
    first.write_text(files["first.mars"] + block.format("NotifyWhenReady"))
    # Comments and white space describe nothing.
    other.write_text(files[second] + block.format("  NotifyWhenReady -- as the first"))
    (eye,) = load_project(str(robot)).configuration.declared
    assert eye.span.path == str(first)
    other.write_text(files[second] + block.format("RequestWhenReady"))
    result = refusal(load_project, str(robot))
    assert (result.code, result.span.path, result.labels[0][0].path) == (
        "module-twice",
        str(other),
        str(first),
    )


def test_a_limit_of_includes_is_reported_once(tmp_path: Path) -> None:
    last = 120
    for number in range(last):
        line = f"@include {number + 1}.mars as {{}}\n"
        text = f"@configuration\n{line.format('a')}{line.format('b')}@modules A\n"
        (tmp_path / f"{number}.mars").write_text(text)
    (tmp_path / f"{last}.mars").write_text("@configuration\n@modules A\n")
    for first, limit in ((0, "100 includes within"), (last - 15, "1000 includes")):
        result = refusal(load_project, str(tmp_path / f"{first}.mars"))
        assert limit in result.message


def test_a_description_of_its_own_counts_and_is_reported(tmp_path: Path) -> None:
    block = "@module_start\n@module_name {}\n@Sense NotifyWhenReady\n{} look();\n@module_end\n"
    robot = tmp_path / "robot.mars"
    text = "@configuration\n@modules left: Camera, right: Camera\nleft uses_data_from right\n"
    robot.write_text(text + block.format("Camera", "Image") + block.format("left", "Depth"))
    project = load_project(str(robot))
    (result,) = project.diagnostics
    assert (result.code, result.span.line, result.span.column) == ("module-twice", 2, 10)
    assert project.modules["right"].services[0].output == "Image"
    assert "left" not in project.modules


def test_a_module_that_another_describes_is_not_taken_for_a_misspelt_one(tmp_path: Path) -> None:
    source = "// @module_start\n// @module_name Camera\n// @Sense NotifyWhenReady\nImage look();\n"
    (tmp_path / "robot.hpp").write_text(source + "// @module_end\n")
    robot = tmp_path / "robot.mars"
    text = "@configuration\n@sources robot.hpp\n@modules {}\nA uses_data_from {}\n"
    robot.write_text(text.format("A, /Camera0x: Camera", "/Camera0x"))
    assert load_project(str(robot)).diagnostics == ()
    robot.write_text(text.format("A, Camra", "Camra"))
    (result,) = load_project(str(robot)).diagnostics
    assert result.help == "did you mean `Camera`?"
    # One that describes an instance may be meant by no other name.
    robot.write_text(text.format("A, Camra, left: Camera", "Camra"))
    assert load_project(str(robot)).diagnostics == ()
