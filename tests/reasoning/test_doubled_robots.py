"""A robot that is included twice has each of its findings twice, with its own names."""

from collections import Counter
from pathlib import Path

from mars_asp.reasoning.analysis import Consequence, analyse
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from tests.support.campaigns import seeds
from tests.support.random_configurations import random_faults, random_ports

#: Inputs, also of twins, that may be fed by outputs of their own and of the other half.
LOOSE = """@configuration
@modules Slam, Planner, Drive, Log, sub/Scan, sub/Grid
Drive uses_data_from Planner
@module_start
@module_name Slam
@DataOut NotifyWhenReady
Map build_map();
@DataIn
void refine(Map old_map);
@module_end
@module_start
@module_name Planner
@DataOut NotifyWhenReady
Path plan(Map map, Pose pose);
@module_end
@module_start
@module_name Log
@DataIn
void log(Map thing, Path path, Pose pose);
@module_end
@module_start
@module_name sub/Scan
@Sense NotifyWhenReady
Map scan_map();
@DataIn
void show(Map shown);
@module_end
@module_start
@module_name sub/Grid
@Sense NotifyWhenReady
Map grid();
@module_end
"""


def findings(path: Path) -> list[Consequence]:
    project = load_project(str(path))
    return list(
        analyse(project_facts(project), load_rulebook(), project.configuration.span).consequences
    )


def named(found: Consequence, prefix: str) -> tuple[str, ...]:
    """Return a finding with the names that it has without a prefix."""
    texts = (found.kind, found.severity, found.subject, found.message, *found.participants)
    return tuple(text.replace(prefix, "") for text in texts)


def test_doubling_a_robot_doubles_its_findings(tmp_path: Path) -> None:
    for text in (LOOSE, *map(random_ports, seeds(2, 6)), *map(random_faults, seeds(4, 12))):
        check_doubled(text, tmp_path)


def check_doubled(text: str, tmp_path: Path) -> None:
    (tmp_path / "robot.mars").write_text(text)
    heading = text.split("\n", maxsplit=1)[0]
    includes = "@include robot.mars as left\n@include robot.mars as right\n"
    (tmp_path / "two.mars").write_text(f"{heading}\n{includes}")
    single = Counter(named(found, "left/") for found in findings(tmp_path / "robot.mars"))
    halves: dict[str, Counter[tuple[str, ...]]] = {"left/": Counter(), "right/": Counter()}
    for found in findings(tmp_path / "two.mars"):
        words = f"{found.subject} {found.message} {' '.join(found.participants)}"
        (half,) = (prefix for prefix in halves if prefix in words)
        halves[half][named(found, half)] += 1
    assert halves == {"left/": single, "right/": single}
