"""The selection of files, messages about skipped ones, and the sources of a configuration."""

import os
from pathlib import Path

import pytest

from mars_asp.annotations.files import MOST_BYTES, extract
from mars_asp.diagnostic import Diagnostic
from mars_asp.reasoning.project import load_project
from tests.support.fixtures import Patch
from tests.support.refusals import refusal

MODULE = (
    "// @module_start\n// @module_name {name}\n// @Sense NotifyWhenReady\nX f();\n// @module_end\n"
)


def only(path: Path) -> Diagnostic:
    (problem,) = extract([path]).diagnostics
    return problem


def test_a_file_that_is_too_large_is_reported_and_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.cpp"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    assert (only(path).code, only(tmp_path).code) == ("MARS301", "MARS301")


def test_a_special_file_is_reported_where_it_is_named(tmp_path: Path) -> None:
    """Opening a pipe that nothing writes to would wait for ever."""
    path = tmp_path / "a.cpp"
    os.mkfifo(path)
    assert only(path).code == "MARS305"
    assert extract([tmp_path]).diagnostics == ()


def test_unreadable_files_and_unknown_languages_are_reported(tmp_path: Path) -> None:
    (tmp_path / "gone.cpp").symlink_to(tmp_path / "nothing")
    (tmp_path / "notes.txt").write_text(MODULE.format(name="A"))
    assert only(tmp_path / "gone.cpp").code == "MARS300"
    assert only(tmp_path / "notes.txt").code == "MARS306"
    assert extract([tmp_path]).modules == ()


def test_one_file_under_two_links_is_read_once(tmp_path: Path) -> None:
    (tmp_path / "a.cpp").write_text(MODULE.format(name="A"))
    os.link(tmp_path / "a.cpp", tmp_path / "b.cpp")
    (tmp_path / "c.cpp").symlink_to("a.cpp")
    found = extract([tmp_path])
    assert [module.name for module in found.modules] == ["A"]
    assert found.diagnostics == ()


def test_one_name_in_many_places_is_one_error(tmp_path: Path) -> None:
    path = tmp_path / "a.cpp"
    path.write_text(MODULE.format(name="A") * 20 + MODULE.format(name="B") * 2)
    many, two = extract([path]).diagnostics
    assert "`A` is annotated 20 times" in many.message
    assert [span.line for span, _ in many.labels] == [1, 12, 17, 22, 27]
    assert "`B` is annotated twice" in two.message
    assert (many.span.line, two.span.line) == (7, 107)


def test_messages_are_in_the_order_of_locations(tmp_path: Path) -> None:
    """A missing name is found at the end of its module, a repeated one after all files."""
    unnamed = "// @module_start\n// @Sence X\nX f();\n// @module_end\n"
    for name in ("b.cpp", "a.cpp"):
        (tmp_path / name).write_text(MODULE.format(name="A") + MODULE.format(name="A") + unnamed)
    found = extract([tmp_path / "b.cpp", tmp_path / "a.cpp"]).diagnostics
    assert [(Path(d.span.path).name, d.span.line, d.code) for d in found] == [
        ("a.cpp", 11, "MARS104"),
        ("a.cpp", 12, "MARS109"),
        ("b.cpp", 7, "MARS121"),
        ("b.cpp", 11, "MARS104"),
        ("b.cpp", 12, "MARS109"),
    ]


def test_a_folder_is_read_in_order_and_links_to_folders_are_not_followed(tmp_path: Path) -> None:
    for name in ("b/x.cpp", "b/a/y.cpp", "a.cpp", ".git/z.cpp", "b/__pycache__/z.cpp"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        letter = name.replace("/", "_").partition(".cpp")[0].replace(".", "")
        (tmp_path / name).write_text(MODULE.format(name=letter))
    (tmp_path / "c").symlink_to(tmp_path / "b")
    assert [module.name for module in extract([tmp_path]).modules] == ["a", "b_x", "b_a_y"]


@pytest.mark.parametrize(
    ("used", "annotated", "is_reported"),
    [
        ("Camra", "Camera", True),
        ("camera", "Camera", True),
        ("Camera1", "Camera2", False),
        ("Screen", "Camera", False),
        ("Camera", "Camera", False),
    ],
)
def test_a_misspelt_module_is_reported(
    tmp_path: Path, used: str, annotated: str, is_reported: bool
) -> None:
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "a.cpp").write_text(MODULE.format(name=annotated))
    path = tmp_path / "config.mars"
    path.write_text(
        f"@configuration\n@sources sources\n@modules {used}, B\nB uses_data_from {used}\n"
    )
    found = load_project(str(path)).diagnostics
    assert [(d.code, d.span.line, d.span.column, d.help) for d in found] == (
        [("annotations-missing", 3, 10, f"did you mean `{annotated}`?")] if is_reported else []
    )


def test_a_module_in_sources_and_in_the_configuration_is_reported(tmp_path: Path) -> None:
    (tmp_path / "a.cpp").write_text(MODULE.format(name="A"))
    path = tmp_path / "config.mars"
    path.write_text(
        "@configuration\n@sources a.cpp\n@modules A\n" + MODULE.format(name="A").replace("// ", "")
    )
    problem = refusal(load_project, str(path))
    places = {problem.span.path, *(label[0].path for label in problem.labels)}
    assert {Path(place).name for place in places} == {"a.cpp", "config.mars"}


@pytest.mark.parametrize(
    ("files", "names", "columns"),
    [
        ({}, "src", [10]),
        ({"src/x.py": "x = 1\n", "src/y.txt": ""}, "src", [10]),
        ({"src/x.py": "x = 1\n"}, "src/*.py", [10]),
        ({"src/a.cpp": MODULE.format(name="A")}, "src, other", [15]),
        ({"src/a.cpp": MODULE.format(name="A"), "src/x.py": "x = 1\n"}, "src, src/a.cpp", []),
        ({"src/a.cpp": MODULE.format(name="A"), "src/x.py": "x = 1\n"}, "src/*", []),
    ],
)
def test_sources_without_annotations_are_reported(
    files: dict[str, str], names: str, columns: list[int], tmp_path: Path
) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "other").mkdir()
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    path = tmp_path / "config.mars"
    path.write_text(f"@configuration\n@sources {names}\n@modules A, B\nB uses_data_from A\n")
    found = load_project(str(path)).diagnostics
    assert [(d.code, d.severity) for d in found] == [("annotations-missing", "warning")] * len(
        columns
    )
    assert [d.span.column for d in found] == columns


def test_a_source_in_another_language_is_reported_where_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").touch()
    path = tmp_path / "config.mars"
    path.write_text("@configuration\n@sources notes.txt\n@modules A\n")
    problem = refusal(load_project, str(path))
    assert (problem.code, problem.span.location) == ("MARS306", f"{path}:2:10")


@pytest.mark.parametrize("names", [".", "./", "./src", "src/../src"])
def test_a_folder_has_annotations_by_any_of_its_names(
    names: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("src").mkdir()
    Path("src/a.cpp").write_text(MODULE.format(name="A"))
    Path("config.mars").write_text(
        f"@configuration\n@sources {names}\n@modules A, B\nB uses_data_from A\n"
    )
    assert load_project("config.mars").diagnostics == ()
