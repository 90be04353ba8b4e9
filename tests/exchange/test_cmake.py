"""Targets of packages that CMake builds, with their macros, loops, patterns and subfolders."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.ros2.cmake import read_cmake
from tests.support.packages import write_package

FILES = ("src/a.cpp", "src/b.cpp", "src/deep/c.cpp", "src/a.hpp", "more/d.cpp")
#: Files of a package, and the sources of each of its executables.
TARGETS: list[tuple[Mapping[str, str], dict[str, list[str]]]] = [
    (
        {"": "macro(add_node name sources)\n add_executable(${name} ${sources} ${ARGN})\n"
         "endmacro()\nadd_node(n src/a.cpp src/b.cpp)"},
        {"n": ["src/a.cpp", "src/b.cpp"]},
    ),
    (
        {"": "function(Add_Node name)\n set(x y)\n add_executable(${name} ${ARGV1})\n"
         "endfunction()\nadd_node(n src/a.cpp)"},
        {"n": ["src/a.cpp"]},
    ),
    ({"": "file(GLOB ALL src/*.cpp)\nadd_executable(n ${ALL})"}, {"n": ["src/a.cpp", "src/b.cpp"]}),
    (
        {"": "file(GLOB_RECURSE ALL CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)\n"
         "add_executable(n ${ALL})"},
        {"n": ["src/a.cpp", "src/b.cpp", "src/deep/c.cpp"]},
    ),
    ({"": "aux_source_directory(src ALL)\nadd_executable(n ${ALL})"},
     {"n": ["src/a.cpp", "src/b.cpp"]}),
    (
        {"": "foreach(name a b)\n add_executable(${name} src/${name}.cpp)\nendforeach()"},
        {"a": ["src/a.cpp"], "b": ["src/b.cpp"]},
    ),
    (
        {"": "set(ALL a b)\nforeach(name IN LISTS ALL)\n"
         " add_executable(run_${name} src/${name}.cpp)\nendforeach()"},
        {"run_a": ["src/a.cpp"], "run_b": ["src/b.cpp"]},
    ),
    ({"": "set(ALL src/a.cpp)\nlist(APPEND ALL src/b.cpp)\nadd_executable(n ${ALL})"},
     {"n": ["src/a.cpp", "src/b.cpp"]}),
    (
        {"": "add_subdirectory(more)",
         "more/CMakeLists.txt": "add_executable(n d.cpp ../src/a.cpp)"},
        {"n": ["more/d.cpp", "src/a.cpp"]},
    ),
    (
        {"": "include(cmake/all.cmake)\nadd_node(n)",
         "cmake/all.cmake": "macro(add_node name)\n add_executable(${name} src/a.cpp)\nendmacro()"},
        {"n": ["src/a.cpp"]},
    ),
    ({"": "add_executable(n ${CMAKE_SOURCE_DIR}/src/a.cpp)"}, {"n": ["src/a.cpp"]}),
    # What calls itself or repeats without end is given up.
    ({"": "macro(m)\n m()\n m()\nendmacro()\nm()"}, {}),
    ({"": "add_subdirectory(.)\nadd_executable(n src/a.cpp)"}, {"n": ["src/a.cpp"]}),
    (
        {"": "include(a.cmake)\n" * 9_000, "a.cmake": "# a long comment\n" * 60_000},
        {},
    ),
    (
        {"": "macro(m)\nendmacro()\nset(X " + "a " * 9_000 + ")\n" + "m(${X})\n" * 9_000},
        {},
    ),
    ({"": "foreach(x " + "a " * 999 + ")\n" * 9}, {}),
    ({"": "foreach(a)\nendforeach()\nmacro()\nendmacro()\nfile(GLOB)\nlist(APPEND)\nset()"}, {}),
]  # fmt: skip


@pytest.mark.parametrize(("texts", "sources"), TARGETS)
def test_targets_have_the_sources_that_cmake_gives_them(
    texts: Mapping[str, str], sources: dict[str, list[str]]
) -> None:
    files = {name: lambda text=text: text for name, text in texts.items() if name}
    files |= {name: str for name in FILES}
    targets = read_cmake(texts[""], files)
    assert {name: targets.sources[of] for name, of in targets.executables.items()} == sources


def test_a_header_beside_a_file_is_the_one_that_it_includes(tmp_path: Path) -> None:
    source = '#include "own.hpp"\nint main() { n.advertise<A>("/%s", 1); }'
    files = {
        "CMakeLists.txt": "add_executable(a a/a.cpp)\nadd_executable(b b/b.cpp)\n",
        **{f"{name}/{name}.cpp": source % name for name in "ab"},
        **{f"{name}/own.hpp": f'void f() {{ n.advertise<A>("/h_{name}", 1); }}' for name in "ab"},
        "launch/x.launch": '<launch><node pkg="mine" type="a" name="a"/></launch>',
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [end.topic for node in tree.nodes for end in node.published] == ["/a", "/h_a"]
