"""The GitHub action and the pre-commit hooks, and the page about both."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from mars_asp.cli import run_here
from mars_asp.cli.settings import settings_for
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
PAGE = ROOT / "docs/how-to/ci.md"
ROBOT = ROOT / "docs/how-to/ci/robot.mars"


def blocks(language: str) -> list[str]:
    """Return the blocks of the page that are in a language."""
    return re.findall(rf"(?ms)^```{language}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"))


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Return a folder with robots, and a command installed as the action does."""
    command = tmp_path / "temp/mars-asp/bin/mars-asp"
    command.parent.mkdir(parents=True)
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m mars_asp "$@"\n')
    command.chmod(0o755)
    (tmp_path / "work/robots/deep er").mkdir(parents=True)
    shutil.copy(ROBOT, tmp_path / "work/robots/a b.mars")
    shutil.copy(ROBOT, tmp_path / "work/robots/deep er/$(touch marker).mars")
    return tmp_path


def checked(workspace: Path, **inputs: str) -> subprocess.CompletedProcess[str]:
    """Run the step of the action that checks, with its inputs as they are when not given."""
    (step,) = (each for each in ACTION["runs"]["steps"] if each.get("name") == "Check")
    values = {name: each["default"] for name, each in ACTION["inputs"].items()} | inputs
    given = {
        name: re.sub(r"\$\{\{ inputs\.([\w-]+) \}\}", lambda match: values[match[1]], text)
        for name, text in step["env"].items()
    }
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "RUNNER_TEMP": str(workspace / "temp")}
    # As GitHub runs `shell: bash`.
    return subprocess.run(
        ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
        cwd=workspace / "work",
        env={**environment, **given},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_action_checks_the_whole_repository_by_default(workspace: Path) -> None:
    done = checked(workspace, options="--ignore data_cycle --quiet")
    assert (done.returncode, done.stderr) == (0, "")
    files = re.findall(r"(?m)^::warning file=([^,]*),line=5,", done.stdout)
    assert files == ["robots/a b.mars", "robots/deep er/$(touch marker).mars"]


def test_the_action_checks_all_that_matches(workspace: Path) -> None:
    done = checked(
        workspace, files="**/*.mars", sarif="out log.sarif", options=" --ignore data_cycle  --quiet"
    )
    assert (done.returncode, done.stderr) == (0, "")
    files = re.findall(r"(?m)^::warning file=([^,]*),line=5,", done.stdout)
    assert files == ["robots/a b.mars", "robots/deep er/$(touch marker).mars"]
    log = json.loads((workspace / "work/out log.sarif").read_text())
    # Findings that comments hide are in the log.
    assert len(log["runs"][0]["results"]) == 2 + 2
    assert not list(workspace.rglob("marker"))


@pytest.mark.parametrize(
    ("files", "status", "expected"),
    [
        ("robots/a b.mars\n\nrobots/**/no*.mars\n", 0, "::warning file=robots/a b.mars,"),
        ("robots/*.yaml", 2, "::error title=mars-asp::no file matches robots/*.yaml"),
        ("robots/missing.mars", 2, "::error file=robots/missing.mars,"),
    ],
)
def test_the_action_fails_as_the_command_does(
    files: str, status: int, expected: str, workspace: Path
) -> None:
    done = checked(workspace, files=files)
    assert (done.returncode, done.stdout[: len(expected)]) == (status, expected)


def test_the_documented_workflow_uses_inputs_of_the_action() -> None:
    (text,) = (block for block in blocks("yaml") if "jobs:" in block)
    steps = yaml.safe_load(text)["jobs"]["check"]["steps"]
    (ours,) = (step for step in steps if "/mars-asp@" in step["uses"])
    assert ours["with"].keys() <= ACTION["inputs"].keys()
    (upload,) = (step for step in steps if "upload-sarif" in step["uses"])
    assert upload["with"]["sarif_file"] == ours["with"]["sarif"]
    for step in ACTION["runs"]["steps"]:
        for name in re.findall(r"inputs\.([\w-]+)", json.dumps(step)):
            assert name in ACTION["inputs"]
        assert "${{" not in step.get("run", ""), "values must reach scripts as text"


def test_the_hooks_work_as_documented(tmp_path: Path, monkeypatch: Patch, capsys: Captured) -> None:
    (text,) = (block for block in blocks("yaml") if "hooks:" in block)
    (repository,) = yaml.safe_load(text)["repos"]
    known = {hook["id"]: hook for hook in HOOKS}
    assert [hook["id"] for hook in repository["hooks"]] == ["mars-asp-fmt", "mars-asp"]
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROBOT, "robot.mars")
    run_here(["check", "robot.mars", "--write-baseline", "known.json"])
    capsys.readouterr()
    for hook in repository["hooks"]:
        manifest = known[hook["id"]]
        assert re.search(manifest["files"], "robots/a.mars")
        assert not re.search(manifest["files"], "robots/a.mars.txt")
        assert manifest["language"] == "python"
        command, *words = manifest["entry"].split()
        scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
        assert command in scripts
        assert run_here([*words, *hook.get("args", []), "robot.mars"]) == 0
    assert "2 in the baseline" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("path", "runs"),
    [
        ("src/pkg/launch/robot.launch.py", True),
        ("launch/robot.launch.xml", True),
        ("bringup.launch", True),
        ("config/mux.yaml", True),
        ("config/mux.yml", True),
        ("src/node.cpp", True),
        ("include/pkg/node.hpp", True),
        ("robot.mars", True),
        ("CMakeLists.txt", True),
        ("docs/README.md", False),
        ("robot.mars.orig", False),
        ("maps/site.pgm", False),
    ],
)
def test_the_hook_of_a_ros_repository_runs_when_its_files_change(path: str, runs: bool) -> None:
    (hook,) = (each for each in HOOKS if each["id"] == "mars-asp-ros")
    assert (hook["entry"], hook["pass_filenames"]) == ("mars-asp check", False)
    assert bool(re.search(hook["files"], path)) == runs


def test_the_settings_of_the_page_are_settings(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    (text,) = blocks("toml")
    shutil.copy(ROBOT, "robot.mars")
    run_here(["check", "robot.mars", "--select", "data_cycle", "--write-baseline", "known.json"])
    Path("mars.toml").write_text(text)
    declared: dict[str, Any] = tomllib.loads(text)
    settings = settings_for(Path())
    assert [*(settings.select or ())] == declared["select"]
    capsys.readouterr()
    assert run_here(["check", "robot.mars"]) == 0
    assert "1 warning in 1 file\nnot reported: 1 hidden by a comment\n" in capsys.readouterr().err
