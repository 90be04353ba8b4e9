"""Packs that distributions offer by entry points."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.cli.ament import check_words
from mars_asp.reasoning.packs import installed_pack, installed_packs
from mars_asp.reasoning.rules import load_rulebook
from tests.support.fixtures import Captured, Patch
from tests.support.refusals import refusals

FINDING = """\
%! id: rules/module
%! because: `{M}` is there
%! who: M
consequence(idle, warning, M, none) :- module(M).
"""
ROBOT = "@configuration\n@modules A, B\nA uses_data_from B\n"


def output(capsys: Captured) -> str:
    return "".join(capsys.readouterr())


def install(folder: Path, name: str, package: str, rules: str) -> Path:
    """Install a distribution that offers a pack; return the folder of the pack."""
    pack = folder.joinpath(*package.split("."))
    pack.mkdir(parents=True)
    # To find a pack runs no code of it.
    for outer in (pack, *pack.parents[: package.count(".")]):
        (outer / "__init__.py").write_text("raise RuntimeError('imported')")
    (pack / "rules.lp").write_text(rules)
    data = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    data.mkdir()
    (data / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (data / "entry_points.txt").write_text(f"[mars_asp.packs]\n{name} = {package}\n")
    return pack


@pytest.fixture
def site(tmp_path: Path, monkeypatch: Patch) -> Path:
    """Return a folder on the path of modules; the working folder has a robot."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    Path("robot.mars").write_text(ROBOT)
    return folder


def test_a_pack_is_found_by_its_name(site: Path, capsys: Captured) -> None:
    inner = install(site, "inner-pack", "some.packs.inner", FINDING)
    pack = install(site, "idle", "idle_pack", FINDING)
    assert installed_packs() == {"idle": pack, "inner-pack": inner}
    assert installed_pack("idle") == pack
    assert installed_pack("other") is None
    assert run_here(["check", "robot.mars"]) == 0
    assert "idle" not in output(capsys)
    run_here(["check", "robot.mars", "--rules", "idle"])
    assert "`A` is there [idle]" in output(capsys)
    Path("mars.toml").write_text('rules = ["inner-pack"]\n')
    Path("deep").mkdir()
    Path("robot.mars").rename("deep/robot.mars")
    run_here(["check", "deep/robot.mars"])
    assert "`A` is there [idle]" in output(capsys)


def test_a_path_counts_before_a_name(site: Path, capsys: Captured) -> None:
    install(site, "idle", "idle_pack", FINDING)
    Path("idle").mkdir()
    Path("idle/here.lp").write_text(
        FINDING.replace("rules/", "here/").replace("is there", "is here")
    )
    run_here(["check", "robot.mars", "--rules", "idle"])
    assert "`A` is here [idle]" in output(capsys)


def test_packs_are_listed_and_proposed(site: Path, capsys: Captured) -> None:
    assert run_here(["rules", "list"]) == 0
    assert "installed packs" not in output(capsys)
    pack = install(site, "idle", "idle_pack", FINDING)
    assert run_here(["rules", "list"]) == 0
    assert capsys.readouterr().out.endswith(f"applies\nidle  {pack}\n")
    assert run_here(["check", "robot.mars", "--rules", "idel"]) == 2
    assert "did you mean the installed pack `idle`?" in output(capsys)


@pytest.mark.parametrize(
    "rules",
    [
        'module("C").\n',
        "consequence(idle, warning, M, none) :- module(M), #external q.\n",
        "#script (python)\nprint(1)\n#end.\n",
        '#include "/etc/passwd".\n',
    ],
)
def test_an_installed_pack_passes_the_gates(rules: str, site: Path, capsys: Captured) -> None:
    install(site, "idle", "idle_pack", rules)
    assert run_here(["check", "robot.mars", "--rules", "idle"]) == 2
    error = output(capsys)
    Path("idle").mkdir()
    Path("idle/rules.lp").write_text(rules)
    for problem in refusals(load_rulebook, [Path("idle")]):
        assert f"[{problem.code}]" in error


def test_a_new_pack_builds_a_wheel(site: Path, tmp_path: Path, capsys: Captured) -> None:
    Path("blind.mars").write_text("@configuration\n@modules A, B\nA is_controlled_by B\n")
    run_here(["rules", "new", "no-eyes"])
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd="no-eyes", check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    zipfile.ZipFile(wheel).extractall(site)
    shutil.rmtree("no-eyes")
    capsys.readouterr()
    assert run_here(["check", "blind.mars", "--rules", "no-eyes"]) == 0
    assert "[no_eyes]" in output(capsys)
    assert run_here(["test", str(installed_packs()["no-eyes"])]) == 0


def test_a_missing_package_offers_nothing(site: Path) -> None:
    pack = install(site, "idle", "idle_pack", FINDING)
    for path in pack.iterdir():
        path.unlink()
    pack.rmdir()
    assert installed_packs() == {}


def test_words_of_the_linter_of_ament() -> None:
    assert check_words(None, []) == ["check"]
    words = ["check", "--format", "junit", "-o", "out.xml", "src", "--exclude", "old"]
    assert check_words("out.xml", ["src", "--exclude", "old"]) == words
