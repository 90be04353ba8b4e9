"""Files of behaviours: their imports, which no other file sees."""

import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from mars_asp.behaviour.imports import Folder, folder_of, place_of
from tests.support.fixtures import Patch


@pytest.fixture
def write(tmp_path: Path) -> Any:
    def written(**files: str) -> Path:
        for name, text in files.items():
            path = tmp_path / f"{name.replace('__in__', '/')}.py"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return tmp_path

    return written


def loaded(folder: Path, name: str) -> ModuleType:
    path = folder / f"{name}.py"
    return Folder(folder_of(path)).load(path, SEED=3)


def test_files_of_one_name_in_two_folders_are_two(write: Any) -> None:
    text = "import shape\ndef now():\n    import late\n    return shape.N, late.N\n"
    parts = {}
    for name, number in (("a", 1), ("b", 2)):
        files = {"do": text, "shape": f"N = {number}", "late": f"N = {10 * number}"}
        write(**{f"{name}__in__{file}": body for file, body in files.items()})
    before = set(sys.modules)
    root = write()
    for name in ("a", "b"):
        folder = Folder(root / name)
        parts[name] = folder, folder.load(root / name / "do.py")
    for _ in range(2):
        for name, number in (("a", 1), ("b", 2)):
            folder, module = parts[name]
            with folder:
                assert module.now() == (number, 10 * number)
    assert set(sys.modules) == before
    assert not any(isinstance(finder, Folder) for finder in sys.meta_path)


def test_each_run_imports_afresh(write: Any) -> None:
    folder = write(do="import shape\nshape.N.append(1)\nN = shape.N", shape="N = []")
    assert [loaded(folder, "do").N for _ in range(2)] == [[1], [1]]


def test_a_module_of_the_host_with_the_same_name_is_set_aside(
    write: Any, monkeypatch: Patch
) -> None:
    host, below = ModuleType("shape"), ModuleType("shape.round")
    monkeypatch.setitem(sys.modules, "shape", host)
    monkeypatch.setitem(sys.modules, "shape.round", below)
    assert loaded(write(do="import shape\nN = shape.N", shape="N = 5"), "do").N == 5
    assert (sys.modules["shape"], sys.modules["shape.round"]) == (host, below)


def test_libraries_take_precedence_over_some_files(write: Any) -> None:
    import numpy

    folder = write(
        do="import json, mars_asp, numpy, yaml\n"
        "seen = json.loads, mars_asp.explain, numpy.array, yaml.N",
        json="raise ValueError",
        mars_asp="raise ValueError",
        numpy__in__data="",  # no package, so that it gives way
        yaml="N = 1",
        random="import random\nN = random.Random(1).random() < 1",
    )
    assert loaded(folder, "do").seen[2:] == (numpy.array, 1)
    # A file of such a name can be bound all the same, and takes the place of none.
    assert loaded(folder, "random").N
    assert sys.modules["random"].Random


def test_packages_and_relative_imports(write: Any) -> None:
    folder = write(
        pkg__in____init__="BASE = 1",
        pkg__in__do="from . import BASE\nfrom .deep.more import N\nimport pkg.deep, plain.part",
        pkg__in__deep__in____init__="",
        pkg__in__deep__in__more="from pkg import BASE\nN = BASE + 1",
        plain__in__part="",
    )
    module = loaded(folder / "pkg", "do")
    assert (module.__name__, module.N, module.BASE) == ("pkg.do", 2, 1)
    assert not {"pkg", "plain"} & set(sys.modules)


def test_a_behaviour_finds_its_module_while_it_runs(write: Any) -> None:
    folder = write(
        do="from __future__ import annotations\n"
        "import pickle, typing\nfrom dataclasses import dataclass, KW_ONLY\nimport shape\n"
        "@dataclass\nclass Pose:\n    at: list[float]\n    _: KW_ONLY\n"
        "    shape: shape.Shape = None\n"
        "def go():\n"
        "    back = pickle.loads(pickle.dumps([Pose([1.0]), shape.Shape()]))\n"
        "    return back[0] == Pose([1.0]), typing.get_type_hints(Pose)['shape'] is shape.Shape\n",
        shape="class Shape: ...",
    )
    there = Folder(folder)
    module = there.load(folder / "do.py")
    with there:
        assert module.go() == (True, True)
    assert list(module.Pose.__dataclass_fields__) == ["at", "shape"]


def test_a_file_that_another_imported_is_one_module(write: Any) -> None:
    folder = write(do="import shape\nshape.N = 7", shape="N = 1")
    there = Folder(folder)
    there.load(folder / "do.py")
    assert there.load(folder / "shape.py").N == 7
    assert there.load(folder / "shape.py") is there.load(folder / "shape.py")


def test_a_file_that_raises_leaves_nothing_and_tells_its_line(write: Any) -> None:
    folder, before = (
        write(do="import shape", shape="x = 1\nraise ValueError('no')"),
        set(sys.modules),
    )
    with pytest.raises(ValueError, match="no") as raised:
        loaded(folder, "do")
    assert place_of(raised.value) == (str(folder / "shape.py"), 2)
    assert set(sys.modules) == before
    with pytest.raises(SyntaxError) as wrong:
        loaded(write(bad="x = 1\ndef f(:"), "bad")
    assert place_of(wrong.value) == (str(folder / "bad.py"), 2)
