"""A specification is self-contained: with it alone every command gives the results that it
gives with the configuration, from any folder."""

import json
import os
import random
from pathlib import Path

import pytest

from mars_asp.annotations.files import find_paths
from mars_asp.cli import run_here
from mars_asp.language import parse_file
from mars_asp.language.relocate import relocated, sources_seen_from
from mars_asp.reasoning.project import load_project
from tests.support.campaigns import sample, seeds
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.random_configurations import random_configuration

EXAMPLES = [
    path
    for path in sorted(ROOT.glob("examples/*/*.mars"))
    if "module-conflict/config" not in str(path)
]
SCENARIOS = [
    ("level0/python.mars", "level0/scenario.toml"),
    ("level1/config.mars", "level1/scenario.toml"),
    ("fleet/config.mars", "fleet/scenario.toml"),
]
#: What a node resolves; other consequences are about mounts, and stay.
RESOLVED = {
    "data_divergence",
    "service_dependency",
    "representation_dependency",
    "control_convergence",
    "control_divergence",
}


def synthesised(configuration: Path, folder: Path) -> Path:
    """Write a specification of a configuration into a folder."""
    folder.mkdir(exist_ok=True)
    specification = folder / "spec.mars"
    assert run_here(["synthesise", str(configuration), "-o", str(specification), "--quiet"]) == 0
    return specification


def result_of(capsys: Captured, *words: str) -> dict[str, object]:
    capsys.readouterr()
    assert run_here([*words, "--format", "json"]) in (0, 1)
    found = json.loads(capsys.readouterr().out)
    assert isinstance(found, dict)
    return found


def stands_alone(configuration: Path, folder: Path, capsys: Captured) -> None:
    """Check that a specification, written elsewhere, needs nothing but itself."""
    specification = synthesised(configuration, folder)
    of, spec = str(configuration), str(specification)
    found = result_of(capsys, "analyse", spec)
    kinds = {each["kind"] for each in found["consequences"]}  # type: ignore[attr-defined]
    assert not kinds & RESOLVED
    again = result_of(capsys, "synthesise", spec)
    assert all(each["origin"] == "declared" for each in again["modules"])  # type: ignore[attr-defined]
    verdict = result_of(capsys, "verify", spec, of)
    assert (verdict["realises"], verdict["minimal"]) == (True, True)
    assert run_here(["synthesise", spec, "--quiet", "-o", str(folder / "again.mars")]) == 0
    assert (folder / "again.mars").read_text() == specification.read_text()


@pytest.mark.parametrize("path", sample(EXAMPLES, 10), ids=lambda path: str(path.relative_to(ROOT)))
def test_examples(path: Path, tmp_path: Path, capsys: Captured, monkeypatch: Patch) -> None:
    (tmp_path / "third").mkdir()
    monkeypatch.chdir(tmp_path / "third")
    stands_alone(path, tmp_path / "of its own", capsys)
    spec = str(tmp_path / "of its own" / "spec.mars")
    assert run_here(["check", spec, "--quiet"]) == 0
    assert run_here(["explain", spec, "--quiet"]) == 0
    assert run_here(["draw", spec, "-o", "picture.svg"]) == 0


@pytest.mark.parametrize("seed", seeds(2, 8))
def test_random_configurations(seed: int, tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "config.mars"
    path.write_text(random_configuration(seed))
    if (
        result_of(capsys, "analyse", str(path))
        and run_here(["synthesise", str(path), "--quiet"]) == 0
    ):
        stands_alone(path, tmp_path / "elsewhere", capsys)


@pytest.mark.parametrize(("configuration", "scenario"), SCENARIOS)
def test_a_run_is_the_same(
    configuration: str, scenario: str, tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    path, result = ROOT / "examples" / configuration, str(ROOT / "examples" / scenario)
    monkeypatch.chdir(tmp_path)
    spec = synthesised(path, tmp_path / "specs")
    records = []
    for file in (path, spec):
        words = ["run", str(file), "--scenario", result, "--duration", "2", "--record", "r.jsonl"]
        found = result_of(capsys, *words)
        records.append((found, Path("r.jsonl").read_text().splitlines()[1:]))
    assert records[0] == records[1]


BLOCK = """@module_start
@module_name Eye // keeps its remarks
@Sense NotifyAtFrequency 25, NotifyOnMin(3, of=nearest)
@Vertex 1 (_,_,_,_,0,0,100)
# DataTransformer1: Wrong (A -> B)
RawImage look(void);
@module_end"""
OTHERS = """@module_start
@module_name DataSplitter1
@DataIn
void show(RawImage image);
@module_end
"""
CONFIG = (
    "@configuration\n@sources {}\n@modules Eye, A, B\nA uses_data_from Eye\nB uses_data_from Eye\n"
)
SOURCE = (
    "# @module_start\n# @module_name A\n# @DataIn\ndef a(image: RawImage): ...\n# @module_end\n"
)


def test_blocks_are_repeated_as_they_are_written(tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "config.mars"
    body = "@modules Eye, A, B\nA uses_data_from Eye\nB uses_data_from Eye\n"
    path.write_text(f"{BLOCK}\n@configuration\n{body}{OTHERS}")
    stands_alone(path, tmp_path / "there", capsys)
    text = (tmp_path / "there" / "spec.mars").read_text()
    assert f"\n\n{BLOCK}\n\n{OTHERS}" in text
    # A node may not have the name of an unused module, or it would be read as that module.
    assert "DataSplitter2 uses_data_from Eye\n" in text


@pytest.mark.parametrize(
    "written",
    ["src", "./src/", "src/a.py", "src/*.py", "../up/a.py", "../up", "link/../a.py", "way/a.py"],
)
@pytest.mark.parametrize("place", ["robot", "robot/out", "out", "[v1] a", "up/é", "way"])
def test_sources_are_found_from_elsewhere(
    written: str, place: str, tmp_path: Path, monkeypatch: Patch
) -> None:
    for folder in ("robot/src", "robot/out", "up/é", "out", "[v1] a", "target/deep"):
        (tmp_path / folder).mkdir(parents=True)
    for folder in ("robot/src", "up", "target"):
        (tmp_path / folder / "a.py").write_text(SOURCE)
    (tmp_path / "robot/link").symlink_to(tmp_path / "target/deep")
    (tmp_path / "robot/way").symlink_to(tmp_path / "target")
    (tmp_path / "way").symlink_to(tmp_path / "target/deep")
    path = tmp_path / "robot/config.mars"
    path.write_text(CONFIG.format(written))
    monkeypatch.chdir(tmp_path / "up")
    declared = parse_file(path).configuration
    (seen,) = sources_seen_from(tmp_path / place, declared)
    assert str(tmp_path) not in seen.text
    spec = tmp_path / place / "spec.mars"
    spec.write_text(CONFIG.format(seen.text))
    assert list(load_project(str(spec)).modules) == ["A"]


def test_sources_of_the_command_line_are_repeated(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    for folder in ("robot", "src", "out"):
        (tmp_path / folder).mkdir()
    (tmp_path / "src/a.py").write_text(SOURCE)
    (tmp_path / "src/b.py").write_text(SOURCE.replace(" A", " B"))
    path = tmp_path / "robot/config.mars"
    path.write_text(CONFIG.format("../src/a.py"))
    monkeypatch.chdir(tmp_path)
    words = [
        "--sources",
        "src/b.py",
        "--sources",
        str(tmp_path / "src/a.py"),
        "--sources",
        "src/b.py",
    ]
    assert run_here(["synthesise", str(path), "-o", "out/spec.mars", *words]) == 0
    text = (tmp_path / "out/spec.mars").read_text()
    named = text[text.index("@sources") : text.index("@modules")].split()
    assert named == ["@sources", "../src/a.py,", "../src/b.py,", str(tmp_path / "src/a.py")]


def test_on_standard_output_sources_are_relative_to_the_folder(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot/a.py").write_text(SOURCE)
    path = tmp_path / "robot/config.mars"
    path.write_text(CONFIG.format("a.py"))
    monkeypatch.chdir(tmp_path)
    assert run_here(["synthesise", str(path)]) == 0
    assert "@sources robot/a.py\n" in capsys.readouterr().out


def test_a_path_that_cannot_be_written_is_reported(tmp_path: Path, capsys: Captured) -> None:
    folder = tmp_path / "a, b"
    folder.mkdir()
    (folder / "a.py").write_text(SOURCE)
    (folder / "config.mars").write_text(CONFIG.format("a.py"))
    words = ["synthesise", str(folder / "config.mars"), "-o", str(tmp_path / "spec.mars")]
    assert run_here(words) == 2
    output = " ".join(capsys.readouterr().err.split())
    assert "config.mars:2:10: error: `a, b/a.py`" in output
    assert "Traceback" not in output
    assert not (tmp_path / "spec.mars").exists()


def test_a_missing_folder_is_reported(tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "config.mars"
    path.write_text("@configuration\n@modules A\n")
    assert run_here(["synthesise", str(path), "-o", str(tmp_path / "none" / "spec.mars")]) == 2
    assert "there is no folder" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("seed", range(60))
def test_a_relocated_path_names_the_same_files(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    folders = [tmp_path]
    for index in range(8):
        folder = rng.choice(folders) / rng.choice(["a", "b c", "[d]", "é", f"e{index}"])
        if folder.exists():
            continue
        if rng.random() < 0.3:
            folder.symlink_to(rng.choice(folders))
        else:
            folder.mkdir()
        folders.append(folder)
        (folder / f"f{index}.py").touch()
    origin, target = rng.choice(folders), rng.choice(folders)
    steps = [
        rng.choice(["..", *(path.name for path in rng.choice(folders).iterdir()), "*.py"])
        for _ in range(3)
    ]
    for written in ("/".join(steps[:1]), "/".join(steps[:2]), "/".join(steps)):
        names = {os.path.realpath(path) for path in find_paths(written, origin)}
        if names:
            moved = relocated(written, origin, target)
            assert {os.path.realpath(path) for path in find_paths(moved, target)} == names
