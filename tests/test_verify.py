"""Rules of their own accept every synthesis and refuse every change of one."""

import json
import random
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from mars_asp.analysis import analyse
from mars_asp.language import parse_text, print_configuration
from mars_asp.model import Configuration, Control, Data
from mars_asp.project import Project, project_facts
from mars_asp.resolve import synthesise
from mars_asp.rulebook import load_rulebook
from mars_asp.verify import judge_specification, verify, written_cost
from tests.documents import run
from tests.random_configurations import random_configuration

RULEBOOK = load_rulebook(stages=("resolve", "verify", "cost"))
REPRESENTATIONS = ("P", "Q", "R", "S")
SERVICES = ("", "", " NotifyAtFrequency 10", " NotifyAtFrequency 5", " RequestWhenReady")
CONDITIONS = (*SERVICES, " NotifyOnMax(80)", " NotifyWhenReady")
OFFERS = (
    "NotifyAtFrequency 25",
    "NotifyWhenReady",
    "NotifyWhenReady, RequestWhenReady",
    "RequestWhenReady, NotifyAtFrequency 20",
)


def block(name: str, *lines: str) -> str:
    return "\n".join(["@module_start", f"@module_name {name}", *lines, "@module_end"])


def described(seed: int) -> str:
    """Return a random configuration with described modules, as text."""
    rng = random.Random(seed)
    kind = rng.choice(["", " hierarchical"])
    clients = [f"C{index}" for index in range(rng.randint(1, 4))]
    wheels = [f"W{index}" for index in range(rng.randint(0, 3))]
    drivers = [f"D{index}" for index in range(3)]
    names = ["Eye", *clients, *wheels, *drivers]
    lines = []
    for client in clients:
        lines.append(f"{client} uses_data_from Eye{rng.choice(CONDITIONS)}")
    for wheel in wheels:
        chosen = rng.sample(drivers, rng.randint(1, 3))
        for rank, driver in enumerate(chosen):
            hold = rng.choice(["", "", "", " hold 50"])
            lines.append(f"{wheel} is_controlled_by {driver} {rank * rng.randint(1, 2)}{hold}")
    blocks = [block("Eye", f"@Sense {rng.choice(OFFERS)}", "P look();")]
    for client in clients:
        taken = rng.sample(REPRESENTATIONS, rng.choice([1, 1, 2]))
        blocks.append(block(client, "@DataIn", f"void take({', '.join(f'{t} x' for t in taken)});"))
    for index in range(rng.randint(0, 4)):
        given, made = rng.sample(REPRESENTATIONS, 2)
        cost = rng.randint(1, 3)
        blocks.append(block(f"K{index}", f"@Converts {cost}", f"{made} turn({given} x);"))
    header = f"@configuration{kind}\n@modules {', '.join(names)}"
    return "\n".join([header, *lines, *blocks])


def carried(seed: int) -> str:
    """Return a random robot whose carried modules are commanded in what they inherit, as text."""
    rng = random.Random(seed)
    kind = rng.choice(["flat", "hierarchical"])
    functions = ("Rotn_X", "Rotn_Y", "Trans_Z")
    movers = ["Base", "Neck", "Head"]
    tools = [f"T{index}" for index in range(rng.randint(1, 3))]
    drivers = [f"D{index}" for index in range(rng.randint(1, 3))]
    lines = ["Neck is_mounted_on Base", "Head is_mounted_on Neck"]
    lines += [f"{tool} is_mounted_on {rng.choice(movers)}" for tool in tools]
    for module in (*tools, *movers):
        for rank, driver in enumerate(rng.sample(drivers, rng.randint(0, len(drivers)))):
            hold = rng.choice(["", "", " hold 50"])
            allocation = rng.choice(["", "", " allocation root", " allocation split"])
            lines.append(f"{module} is_controlled_by {driver} {rank}{hold}{allocation}")
    blocks = [
        block(
            name,
            *(f"@{f} -90 90 45\nvoid {f.lower()}(double r);" for f in rng.sample(functions, n)),
        )
        for name in movers
        for n in [rng.randint(1, 2)]
    ]
    for tool in tools:
        if rng.random() < 0.7:
            blocks.append(block(tool, "@Grasp 0 80", "void grasp(double width);"))
        else:
            blocks.append(block(tool, "@Sense NotifyWhenReady", "P look();"))
    for driver in drivers:
        said = rng.sample(functions, rng.randint(0, 2))
        blocks.append(block(driver, f"@ControlOut {', '.join(said)}", "Command go();"))
    header = f"@configuration {kind}\n@modules {', '.join((*movers, *tools, *drivers))}"
    return "\n".join([header, *lines, *blocks])


def synthesised(text: str) -> tuple[Project, Configuration] | None:
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    found = synthesise(project.configuration, {}, analysis, RULEBOOK)
    if found is None:
        return None
    printed = print_configuration(found.specification.configuration)
    return project, parse_text(printed, "s.mars").configuration


def mutations(specification: Configuration, rng: random.Random) -> Iterator[Configuration]:
    """Yield specifications with a line dropped, redirected or its priority swapped."""
    lines = specification.relationships
    names = [name.text for name in specification.modules]
    for index, line in enumerate(lines):
        yield replace(specification, relationships=(*lines[:index], *lines[index + 1 :]))
        if isinstance(line, Data):
            other = rng.choice([n for n in names if n not in (line.source, line.client)])
            changed: Data | Control = replace(line, source=other)
        elif isinstance(line, Control):
            other = rng.choice([n for n in names if n not in (line.controller, line.controlled)])
            changed = replace(line, controller=other)
        else:
            continue
        yield replace(specification, relationships=(*lines[:index], changed, *lines[index + 1 :]))


@pytest.mark.parametrize("seed", range(12))
def test_a_changed_synthesis_is_refused(seed: int) -> None:
    found = synthesised(described(seed))
    if found is None:
        return
    project, specification = found
    for changed in mutations(specification, random.Random(seed)):
        assert verify(changed, project, RULEBOOK), print_configuration(changed)


@pytest.mark.parametrize("seed", range(12))
def test_commands_for_what_is_inherited_are_passed_on(seed: int) -> None:
    found = synthesised(carried(seed))
    assert found is not None
    project, specification = found
    assert verify(specification, project, RULEBOOK) == ()
    for changed in mutations(specification, random.Random(seed)):
        assert verify(changed, project, RULEBOOK), print_configuration(changed)


def test_a_broken_priority_names_its_clause() -> None:
    done = json.loads(
        run("mars-asp verify --format json tests/swapped.mars examples/level0/config.mars")
    )
    assert not done["realises"]
    assert {violation["clause"] for violation in done["violations"]} == {4}


def written(specification: Configuration, project: Project) -> dict[int, int]:
    verification = judge_specification(specification, project, RULEBOOK)
    assert verification.violations == ()
    return written_cost(verification, RULEBOOK).cost


@pytest.mark.parametrize("seed", range(60))
def test_a_synthesis_costs_what_its_text_says(seed: int) -> None:
    """Without comments the cheapest converters are meant, and a synthesis has those."""
    project = Project(parse_text(random_configuration(seed), "c.mars").configuration, {}, ())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    found = synthesise(project.configuration, {}, analysis, RULEBOOK)
    if found is None:
        return
    specification = found.specification.configuration
    cost = {level: value for level, value in found.resolution.cost.items() if level >= 10}
    levels = {10: 0, 20: 0, 30: 0}
    assert {**levels, **written(specification, project)} == {**levels, **cost}
    silent = replace(specification, conversions=())
    assert {**levels, **written(silent, project)} == {**levels, **cost}


CHOICE = """
@configuration
@modules Eye, C, D
C uses_data_from Eye
D uses_data_from Eye
@module_start
@module_name Eye
@Sense NotifyWhenReady
sensor_msgs::Image look();
@module_end
@module_start
@module_name C
@DataIn
void take(Lines x);
@module_end
@module_start
@module_name D
@DataIn
void take(Image x);
@module_end
@module_start
@module_name Cheap
@Converts 2
geo::Lines turn(Image x);
@module_end
@module_start
@module_name Dear
@Converts 3
geo::Lines turn(Image x);
@module_end
"""
CHOSEN = """
@specification
@modules Eye, C, D, DataSplitter1, DataTransformer1
DataSplitter1 uses_data_from Eye
{comment}
DataTransformer1 uses_data_from DataSplitter1
C uses_data_from DataTransformer1
D uses_data_from DataSplitter1
"""


@pytest.mark.parametrize(
    ("comment", "minimal", "conversion"),
    [
        ("", True, 2),
        ("// DataTransformer1: Cheap (Image -> Lines)", True, 2),
        ("// DataTransformer1: Dear (sensor_msgs::Image -> geo::Lines)", False, 3),
        ("// DataTransformer1: no converter declared (Image -> geo::Lines)", True, 2),
    ],
)
def test_conversion_cost_decides_what_is_minimal(
    comment: str, minimal: bool, conversion: int, tmp_path: Path
) -> None:
    (tmp_path / "c.mars").write_text(CHOICE)
    (tmp_path / "s.mars").write_text(CHOSEN.format(comment=comment))
    done = json.loads(run(f"mars-asp verify --format json {tmp_path}/s.mars {tmp_path}/c.mars"))
    assert done["realises"]
    assert done["minimal"] is minimal
    assert done["cost"] == {"nodes": 2, "conversion": conversion, "relationships": 4}
    assert done["least"] == {"nodes": 2, "conversion": 2, "relationships": 4}
