"""The wheel brings rules and tables along, and works where there is no checkout."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib.metadata import Distribution, distributions
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from tests.support.documents import ROOT

#: One process builds the wheel, which takes long.
#: Does what a command does with a robot and our rules, where nothing of that can be made.
UNMADE = """
from pathlib import Path
from mars_asp.language import grammar, parse
from mars_asp.reasoning import rules
from mars_asp.asp.rules import statements
grammar._tables = rules._read_rules = rules._declared_names = statements._statements = None
parse.parse_file(Path("config.mars"))
grammar.parsed("A is_controlled_by B, C\\n")
texts = [rule.text for rule in rules.load_rulebook(stages=rules.STAGES).rules]
rules.seal()
statements.statements_of(texts)
"""


PAPER = "Modelling Robot Architectures for Modular Robotics Systems"
#: Bytes that the wheel has at most.
MOST_BYTES = 3 * 1024 * 1024


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the wheel, built anew."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def site(wheel: Path) -> Path:
    """Return the folder in which the wheel is unpacked, with a robot beside it."""
    folder = wheel.parent
    zipfile.ZipFile(wheel).extractall(folder / "site")
    shutil.copy(ROOT / "examples" / "level0" / "config.mars", folder)
    return folder / "site"


def python(site: Path, *words: str) -> str:
    """Return the output of Python with only the wheel installed."""
    done = subprocess.run(
        [sys.executable, *words],
        cwd=site.parent,
        env={**os.environ, "PYTHONPATH": str(site), "PYTHONSAFEPATH": "1"},
        check=True,
        capture_output=True,
        text=True,
    )
    return done.stdout


def test_the_wheel_is_small(wheel: Path) -> None:
    assert wheel.stat().st_size <= MOST_BYTES


def test_the_wheel_works_outside_the_checkout(site: Path) -> None:
    printed = python(site, "-m", "mars_asp", "synthesise", "config.mars")
    assert printed == (ROOT / "tests" / "specifications" / "level0.mars").read_text()
    assert "</svg>" in python(site, "-m", "mars_asp", "explain", "config.mars", "-o", "-")
    for carried in ("rules/vocabulary.lp", "py.typed", "execution/recording/replay.html"):
        assert (site / "mars_asp" / carried).is_file()


def test_rules_are_shown_with_the_values_of_their_examples(site: Path) -> None:
    """The cases that hold the examples are not in the wheel, but the sentences are."""
    shown = python(site, "-m", "mars_asp", "rules", "show", "dead_remap")
    assert "topic `/x`" in shown
    assert "{" not in shown + python(site, "-m", "mars_asp", "rules")


def test_results_of_the_build_are_not_computed_again(site: Path) -> None:
    python(site, "-c", UNMADE)


def test_a_damaged_table_changes_nothing(site: Path) -> None:
    words = ("-m", "mars_asp", "explain", "config.mars")
    whole = python(site, *words)
    tables = sorted((site / "mars_asp" / "__tables__").iterdir())
    held = [table.read_bytes() for table in tables]
    assert {table.name for table in tables} >= {"grammar", "rules", "firings", "dependencies"}
    for number, (table, content) in enumerate(zip(tables, held, strict=True)):
        torn = bytearray(content)
        torn[(len(torn) * (number + 1)) // (len(tables) + 1)] ^= 4
        table.write_bytes(torn)
    assert python(site, *words) == whole
    for table, content in zip(tables, held, strict=True):
        table.write_bytes(content)


def test_nothing_is_written_when_it_runs(site: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in (site / "mars_asp").rglob("*")}
    python(site, "-B", "-m", "mars_asp", "explain", "config.mars")
    python(site, "-B", "-m", "mars_asp", "check", "config.mars")
    assert {path: path.stat().st_mtime_ns for path in (site / "mars_asp").rglob("*")} == before


@pytest.fixture(scope="module")
def installed(site: Path) -> Distribution:
    (found,) = distributions(name="mars-asp", path=[str(site)])
    return found


def test_the_metadata_are_complete(installed: Distribution) -> None:
    fields = installed.metadata.json
    assert fields["maintainer"] == "mars-asp developers"
    assert str(fields["author_email"]).startswith("mars-asp developers <")
    keywords = installed.metadata["Keywords"].split(",")
    assert {"ros", "ros2", "robotics", "static-analysis", "asp"} <= set(keywords)
    assert str(fields["summary"]).startswith("Static analyser for developers of robots")
    urls = dict(each.split(", ") for each in fields["project_url"])
    assert urls.keys() == {"Documentation", "Source", "Issues", "Changelog"}
    assert {
        "Development Status :: 4 - Beta",
        "Operating System :: POSIX :: Linux",
        "Typing :: Typed",
        *(f"Programming Language :: Python :: 3.{minor}" for minor in range(11, 15)),
    } <= set(fields["classifier"])
    assert "Operating System :: OS Independent" not in fields["classifier"]


def test_the_long_description_has_no_relative_link(installed: Distribution) -> None:
    text = str(installed.metadata.json["description"])
    targets = re.findall(r"\]\(([^)]*)\)|(?m:^\[[^]]+\]: *(\S+))|(?:src|href)=\"([^\"]*)", text)
    links = ["".join(groups) for groups in targets]
    assert links
    assert [link for link in links if not link.startswith(("https://", "#"))] == []
    blob = "https://github.com/OWNER/mars-asp/blob/main/"
    paths = [link.removeprefix(blob).partition("#")[0] for link in links if blob in link]
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_versions_agree(installed: Distribution) -> None:
    package = ElementTree.parse(ROOT / "package.xml").getroot()
    assert package.findtext("version") == installed.version
    assert package.findtext("license") == installed.metadata.json["license_expression"]
    assert all(package.findtext(name) for name in ("name", "description", "maintainer"))
    # Of packages of this type colcon runs `setup.py`; without one it has to pass over the folder.
    assert package.findtext("export/build_type") == "ament_python"
    assert (ROOT / "setup.py").exists() or (ROOT / "COLCON_IGNORE").exists()
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == installed.version
    assert [each["title"] for each in citation["references"]] == [PAPER]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"(?m)^## \[(\S+)\]", changes)
    assert versions[:2] == ["Unreleased", installed.version]


def test_the_guide_for_contributors_is_short() -> None:
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()) <= 60


#: Does as `ros2` does with the command of an entry point, where modules of ROS are missing.
ROS2 = """
import argparse, sys
from importlib.metadata import entry_points
sys.modules |= dict.fromkeys(("ros2cli", "rclpy"))
(entry,) = entry_points(group="ros2cli.command", name="mars")
extension = entry.load()()
assert extension.__doc__
parser = argparse.ArgumentParser(prog="ros2")
parser.add_argument("--use-python-default-buffering", action="store_true")
commands = parser.add_subparsers(dest="command")
command = commands.add_parser(entry.name)
command.set_defaults(extension=extension)
extension.add_arguments(command, "ros2 mars", argv=None)
arguments = parser.parse_args()
sys.exit(arguments.extension.main(parser=parser, args=arguments))
"""


@pytest.mark.parametrize(
    "words",
    [
        (),
        ("--help",),
        ("--version",),
        ("check", "--help"),
        ("--quiet", "check", "config.mars", "--format=json"),
        ("synthesise", "config.mars"),
        ("check", "--", "config.mars"),
    ],
)
def test_ros2_passes_all_words(words: tuple[str, ...], site: Path) -> None:
    assert python(site, "-c", ROS2, "mars", *words) == python(site, "-m", "mars_asp", *words)


def test_the_linter_of_ament_checks(installed: Distribution, site: Path) -> None:
    (entry,) = (each for each in installed.entry_points if each.name == "ament_mars")
    call = f"import sys; from {entry.module} import {entry.attr} as main; sys.exit(main())"
    for words in (("config.mars", "--quiet"), ("--exclude", "site", ".")):
        assert python(site, "-c", call, *words) == python(site, "-m", "mars_asp", "check", *words)
    assert "--xunit-file" in python(site, "-c", call, "--help")
