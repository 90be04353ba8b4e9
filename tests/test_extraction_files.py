"""Which files are read, what is told of the others, and how a configuration finds its sources."""

import os
from pathlib import Path

import pytest

from mars_asp.annotations.files import MOST_BYTES, extract
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.project import load_project

MODULE = (
    "// @module_start\n// @module_name {name}\n// @Sense NotifyWhenReady\nX f();\n// @module_end\n"
)


def only(path: Path) -> Diagnostic:
    (problem,) = extract([path]).diagnostics
    return problem


def test_a_file_that_is_too_large_is_told_and_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.cpp"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    assert (only(path).code, only(tmp_path).code) == ("MARS301", "MARS301")


def test_what_is_no_regular_file_is_told_where_it_is_named(tmp_path: Path) -> None:
    """Opening a pipe that nothing writes to would wait for ever."""
    path = tmp_path / "a.cpp"
    os.mkfifo(path)
    assert only(path).code == "MARS305"
    assert extract([tmp_path]).diagnostics == ()


def test_what_cannot_be_read_or_is_in_no_known_language(tmp_path: Path) -> None:
    (tmp_path / "gone.cpp").symlink_to(tmp_path / "nothing")
    (tmp_path / "notes.txt").write_text(MODULE.format(name="A"))
    assert only(tmp_path / "gone.cpp").code == "MARS300"
    assert only(tmp_path / "notes.txt").code == "MARS306"
    assert extract([tmp_path]).modules == ()


def test_one_file_behind_two_links_is_read_once(tmp_path: Path) -> None:
    (tmp_path / "a.cpp").write_text(MODULE.format(name="A"))
    os.link(tmp_path / "a.cpp", tmp_path / "b.cpp")
    (tmp_path / "c.cpp").symlink_to("a.cpp")
    found = extract([tmp_path])
    assert [module.name for module in found.modules] == ["A"]
    assert found.diagnostics == ()


@pytest.mark.parametrize(
    ("used", "annotated", "told"),
    [
        ("Camra", "Camera", True),
        ("camera", "Camera", True),
        ("Camera1", "Camera2", False),
        ("Screen", "Camera", False),
        ("Camera", "Camera", False),
    ],
)
def test_a_misspelt_module_is_told(tmp_path: Path, used: str, annotated: str, told: bool) -> None:
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "a.cpp").write_text(MODULE.format(name=annotated))
    path = tmp_path / "config.mars"
    path.write_text(
        f"@configuration\n@sources sources\n@modules {used}, B\nB uses_data_from {used}\n"
    )
    found = load_project(str(path)).diagnostics
    assert [(d.code, d.span.line, d.span.column, d.help) for d in found] == (
        [("annotations-missing", 3, 10, f"did you mean `{annotated}`?")] if told else []
    )


def test_a_module_in_sources_and_in_the_configuration_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.cpp").write_text(MODULE.format(name="A"))
    path = tmp_path / "config.mars"
    path.write_text(
        "@configuration\n@sources a.cpp\n@modules A\n" + MODULE.format(name="A").replace("// ", "")
    )
    with pytest.raises(MarsError) as raised:
        load_project(str(path))
    (problem,) = raised.value.diagnostics
    places = {problem.span.path, *(label[0].path for label in problem.labels)}
    assert {Path(place).name for place in places} == {"a.cpp", "config.mars"}
