"""`verify` compares modules, not lines alone, and `analyse` follows services through nodes."""

import json
import random
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from mars_asp.cli import run_here
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import NODE_NAMES, Configuration
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.verification import judge_specification, verify
from tests.support.campaigns import sample, seeds
from tests.support.fixtures import Captured
from tests.support.mutants import mutant
from tests.support.random_configurations import random_configuration, random_mounts
from tests.support.subjects import RULEBOOK, read, synthesised

MODULES = "@modules left: Camera, Arm, Base, Pilot, Screen"
BODY = """
Screen uses_data_from left NotifyAtFrequency 50
Arm is_mounted_on Base
Arm is_controlled_by Pilot
"""
BLOCKS = """
@module_start
@module_name Camera
@Vertex 1 (_,_,_,_,_,_,10)
@Sense NotifyAtFrequency 50, NotifyWhenReady
@Port image
sensor_msgs::Image look();
@module_end
@module_start
@module_name Arm
@Rotn_Y -90 90 45
@module_end
@module_start
@module_name Pilot
@Guard
@ControlOut Rotn_Y
Command go();
@module_end
@module_start
@module_name Screen
@DataIn
void show(Image picture);
@module_end
@module_start
@module_name Other
@Converts 2
Lines find(Image picture);
@module_end
"""


def judged(
    specification: str, configuration: str, folder: Path, capsys: Captured
) -> dict[str, Any]:
    """Return the JSON that `verify` prints of two texts."""
    paths = [folder / "s.mars", folder / "c.mars"]
    for path, text in zip(paths, (specification, configuration), strict=True):
        path.write_text(text)
    run_here(["verify", *map(str, paths), "--format", "json"])
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("50, N", "10, N", "the output `image` of `left` the rate `10`, the configuration `50`"),
        (
            "50, NotifyWhenReady",
            "50, RequestWhenReady",
            "the modes `NotifyAtFrequency, RequestWhenReady`",
        ),
        ("@Sense", "@DataOut", "the annotation `@DataOut`, the configuration `@Sense`"),
        ("::Image look", "::Depth look", "the representation `sensor_msgs::Depth`"),
        ("@Port image", "@Port depth", "`left` has the output `image` in the configuration"),
        ("Image picture);\n@module_end\n@module_start\n@module_name O", None, "input `picture`"),
        ("@Guard", "", "`Pilot` has the annotation `@Guard` in the configuration, but not"),
        ("-90 90 45", "-90 90 _", "the motion `Rotn_Y` of `Arm` the limits `-90 90 _`"),
        ("10)", "11)", "the vertex `1` of `left` the transformation"),
        ("ControlOut Rotn_Y", "ControlOut", "the functions `none`, the configuration `Rotn_Y`"),
        ("left: Camera", "left: Other", "`left` is described by `Other` in the specification"),
        ("Converts 2", "Converts 3", "the converter `find` of `Other` the cost `3`"),
        ("Rotn_Y -90", "Rotn_Z -90", "`Arm` has the motion `Rotn_Z` in the specification, but"),
    ],
)
def test_a_difference_is_a_violation_that_names_both_locations(
    before: str, after: str | None, message: str, tmp_path: Path, capsys: Captured
) -> None:
    text = f"@specification\n{MODULES}{BODY}{BLOCKS}"
    changed = text.replace(before, before.replace("picture", "view") if after is None else after)
    assert changed != text
    found = judged(changed, text.replace("@specification", "@configuration"), tmp_path, capsys)
    violations = [each for each in found["violations"] if message in str(each["message"])]
    assert [each["clause"] for each in violations][:1] == [0]
    for violation in violations:
        paths = [Path(each["path"]).name for each in violation["locations"]]
        assert paths == ["s.mars", "c.mars"]


def test_the_same_meaning_in_another_text_makes_no_difference(
    tmp_path: Path, capsys: Captured
) -> None:
    configuration = f"@configuration\n{MODULES}{BODY}{BLOCKS}"
    blocks = BLOCKS.replace("AtFrequency 50", "AtFrequency every 20 ms").replace("45", "45.0")
    blocks = blocks.replace("sensor_msgs::Image", "Image").replace("@Port image", '@Port "image"')
    for body in (blocks, ""):
        found = judged(f"@specification\n{MODULES}{BODY}{body}", configuration, tmp_path, capsys)
        assert found["realises"] and not found["warnings"]


def test_a_description_on_one_side_is_a_warning(tmp_path: Path, capsys: Captured) -> None:
    whole = f"{MODULES}{BODY}{BLOCKS}"
    pilot = BLOCKS[BLOCKS.index("@module_start\n@module_name Pilot") :].partition("@module_end\n")
    without = whole.replace("".join(pilot[:2]), "")
    for here, there, message in (
        (without, whole, "the specification describes other modules, but not `Pilot`"),
        (whole, without, "the specification describes `Pilot`, and the configuration does not"),
    ):
        found = judged(f"@specification\n{here}", f"@configuration\n{there}", tmp_path, capsys)
        assert found["realises"]
        assert [each["message"] for each in found["warnings"]] == [message]


def test_a_source_of_a_specification_describes_its_modules(
    tmp_path: Path, capsys: Captured
) -> None:
    source = (
        '"""A camera."""\n# @module_start\n# @module_name Camera\n# @Sense NotifyAtFrequency {}\n'
    )
    source += "def look() -> Image: ...\n# @module_end\n"
    for name, rate in (("a.py", 50), ("b.py", 10)):
        (tmp_path / name).write_text(source.format(rate))
    text = "@{}\n@sources {}\n@modules Camera, C\nC uses_data_from Camera NotifyAtFrequency 50\n"
    configuration = text.format("configuration", "a.py")
    found = judged(text.format("specification", "a.py"), configuration, tmp_path, capsys)
    assert found["realises"]
    found = judged(text.format("specification", "b.py"), configuration, tmp_path, capsys)
    assert {each["clause"] for each in found["violations"]} == {0, 3}
    # A source that is missing leaves the description to the configuration.
    found = judged(text.format("specification", "c.py"), configuration, tmp_path, capsys)
    assert found["realises"]


SOURCE = (
    "@module_start\n@module_name A\n@Sense NotifyWhenReady\n@Port out\nRep look();\n@module_end"
)
CLIENT = "@module_start\n@module_name B\n@DataIn\nvoid take(Rep in);\n@module_end"
OUTPUTS = ("A", "A.out", '"A"."out"')
FORMS = (("B", "A"), ("B.in", "A"), ("B", "A.out"), ("B.in", "A.out"), ('B."in"', '"A"."out"'))


@pytest.mark.parametrize(
    ("forms", "blocks"),
    [
        ([("B", output) for output in OUTPUTS], ""),
        ([("B", output) for output in OUTPUTS], SOURCE),
        (FORMS, CLIENT),
        (FORMS, f"{SOURCE}\n{CLIENT}"),
    ],
)
def test_a_port_may_be_left_out_where_there_is_one(
    forms: Sequence[tuple[str, str]], blocks: str
) -> None:
    line = "@{}\n@modules A, B\n{} uses_data_from {}\n{}\n"
    for here, there in sample([*product(forms, repeat=2)], 3):
        text = line.format("specification", *here, "")
        specification = parse_text(text, "s.mars").configuration
        project = read(line.format("configuration", *there, blocks))
        assert verify(specification, project, RULEBOOK) == ()


def test_one_of_several_outputs_of_an_unknown_source_is_not_left_out() -> None:
    lines = "@{}\n@modules A, B, C\nB uses_data_from {}\nC uses_data_from {}\n"
    project = read(lines.format("configuration", "A.x", "A.y"))
    for outputs in (("A.x", "A"), ("A", "A"), ("A.y", "A.x"), ("A.x", "A.z")):
        text = lines.format("specification", *outputs)
        assert verify(parse_text(text, "s.mars").configuration, project, RULEBOOK)


@pytest.mark.parametrize("word", sample([*NODE_NAMES.values()], 3))
@pytest.mark.parametrize("body", ["", "B uses_data_from A\n", "B is_controlled_by A\n"])
def test_a_minimum_has_no_node_without_a_line(
    word: str, body: str, tmp_path: Path, capsys: Captured
) -> None:
    specification = f"@specification\n@modules A, B, {word}7\n{body}"
    configuration = f"@configuration\n@modules A, B\n{body}"
    for whole in (configuration, specification):
        found = judged(specification, whole, tmp_path, capsys)
        assert found["minimal"] is not True
    # A specification without the node realises one with it.
    found = judged(
        configuration.replace("configuration", "specification"), specification, tmp_path, capsys
    )
    assert found["realises"] and found["minimal"]


def reordered(configuration: Configuration, rng: random.Random) -> Configuration:
    """Return a configuration with its lines, names and blocks in another order."""
    lines = list(configuration.relationships)
    names, blocks = list(configuration.modules), list(configuration.declared)
    for each in (lines, names, blocks):
        rng.shuffle(each)
    return replace(
        configuration, relationships=tuple(lines), modules=tuple(names), declared=tuple(blocks)
    )


@pytest.mark.parametrize("seed", seeds(2, 5))
def test_the_order_of_lines_and_blocks_changes_no_verdict_and_no_sentence(seed: int) -> None:
    project = read(random_mounts(seed) if seed % 2 else random_configuration(seed))
    found = synthesised(project)
    if found is None:
        return
    rng = random.Random(seed)
    declared = project.configuration.declared
    specification = replace(found.specification.configuration, declared=declared)
    for _ in range(3):
        _, changed = mutant(specification, rng)
        other = replace(project, configuration=reordered(project.configuration, rng))
        one = judge_specification(changed, project, RULEBOOK)
        two = judge_specification(reordered(changed, rng), other, RULEBOOK)
        assert [v.message for v in one.violations] == [v.message for v in two.violations]
        assert [c.message for c in one.cautions] == [c.message for c in two.cautions]


def starved(configuration: Configuration) -> set[tuple[str, str]]:
    """Return subject and message of each infeasible service."""
    project = Project(configuration, {}, ())
    found = analyse(project_facts(project), RULEBOOK, configuration.span)
    return {
        (each.subject, each.message)
        for each in found.consequences
        if each.kind == "service_infeasible"
    }


@pytest.mark.parametrize("seed", seeds(3, 8))
def test_a_synthesis_serves_each_of_its_lines(seed: int) -> None:
    found = synthesised(project := read(random_configuration(2 * seed)))
    if found is None:
        return
    printed = print_configuration(
        replace(found.specification.configuration, declared=project.configuration.declared)
    )
    specification = parse_text(printed, "s.mars").configuration
    assert starved(specification) == set()


@pytest.mark.parametrize(
    "block", ["", "@module_start\n@module_name S\n@Sense {}\nR look();\n@module_end"]
)
def test_both_commands_find_a_client_of_a_slower_link(block: str) -> None:
    lines = (
        "DataSplitter1 uses_data_from S NotifyAtFrequency 10\n"
        "C uses_data_from DataSplitter1 NotifyAtFrequency 50\nD uses_data_from DataSplitter1\n"
    )
    text = f"@specification\n@modules S, C, D, DataSplitter1\n{lines}{block}"
    specification = parse_text(text.format("NotifyAtFrequency 10"), "s.mars").configuration
    assert {subject for subject, _ in starved(specification)} == {"C"}
    configuration = "@configuration\n@modules S, C, D\nC uses_data_from S NotifyAtFrequency 50\n"
    project = read(f"{configuration}D uses_data_from S NotifyAtFrequency 10\n")
    assert 3 in {violation.clause for violation in verify(specification, project, RULEBOOK)}
