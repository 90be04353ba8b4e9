"""Small configurations with side lines: least costs, and what is read back or hand-written."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from mars_asp.language.print import print_relationship
from mars_asp.reasoning.rules import CONVERSION, NODES, RELATIONSHIPS
from mars_asp.reasoning.verification import verify
from tests.reasoning.synthesis.test_exhaustive import cost_of
from tests.reasoning.synthesis.test_side_lines import compare_again
from tests.reasoning.test_verification import written
from tests.support.campaigns import sample
from tests.support.subjects import RULEBOOK, alarms, read, synthesised

ROOT = Path(__file__).parents[3]
BLOCK = "@module_start\n@module_name {}\n{}\n@module_end\n"
SENSE = "@Sense NotifyWhenReady"


def robot(head: str, *blocks: str) -> str:
    """Return a configuration of modules that blocks describe, as in `Map: Grid map();`."""
    first, _, lines = head.partition("\n")
    names = [block.split(":")[0] for block in blocks]
    declared = []
    for block in blocks:
        name, _, text = block.partition(": ")
        text = text if text.startswith("@") else f"{SENSE}\n{text}"
        declared.append(BLOCK.format(name, text))
    return f"{first}\n@modules {', '.join(names)}\n{lines}\n{''.join(declared)}"


TWO_OF_ONE_TRIGGER = robot(
    """@configuration
A uses_data_from Map
Map is_inhibited_by Over 20
Nav is_inhibited_by Over 20
B uses_data_from Nav""",
    *("Map: Num map();", "Nav: Num nav();", "Over: Tick over();"),
    *("A: @DataIn\nvoid a(Num x);", "B: @DataIn\nvoid b(Num x);"),
)
SUPPRESSED_SUPPRESSOR = robot(
    """@configuration
A uses_data_from Map
C uses_data_from Map
A.x is_suppressed_by Over 80
C.x is_suppressed_by Over 80
C.x is_suppressed_by Oth 50
Over is_suppressed_by Oth 20""",
    *("Map: Num map();", "Over: Num over();", "Oth: Num oth();"),
    *("A: @DataIn\nvoid a(Num x);", "C: @DataIn\nvoid c(Num x);"),
)
WHEELS = ("W: @Rotn_Y\nvoid w();", "V: @Rotn_Y\nvoid v();")
DRIVERS = ("A: @ControlOut Rotn_Y\nCommand a();", "B: @ControlOut Rotn_Y\nCommand b();")
LOCK = "E: bool e();"
BOTH_BY_TWO = """@configuration {}
W is_controlled_by A 0
W is_controlled_by B 1
V is_controlled_by A 0
V is_controlled_by B 1
{}"""


def driven(architecture: str, *lines: str) -> str:
    """Return a configuration in which A and B control W and V."""
    head = BOTH_BY_TWO.format(architecture, "\n".join(lines))
    return robot(head, *WHEELS, *DRIVERS, LOCK)


def stacked(accepted: str) -> str:
    """Return a configuration in which Panic suppresses the suppressor of Map, with another type."""
    return robot(
        "@configuration\nA uses_data_from Map\nMap is_suppressed_by Over 200\n"
        "Over is_suppressed_by Panic 100",
        *("Map: Grid map();", "Over: Grid over();", "Panic: Pic panic();"),
        *(f"A: @DataIn\nvoid a({accepted} x);", "Cv: @Converts 2\nPic cv(Grid v);"),
    )


def at_input(mode: str, accepted: str, offers: str = "NotifyWhenReady") -> str:
    """Return a configuration in which Over suppresses an input, whose client requires a mode."""
    return robot(
        f"@configuration\nA uses_data_from Map {mode}\nA.x is_suppressed_by Over 20",
        *(f"Map: @Sense {offers}\nGrid map();", "Over: Grid over();"),
        *(f"A: @DataIn\nvoid a({accepted} x);", "Cv: @Converts 2\nNum cv(Grid v);"),
    )


BOTH_HIERARCHICAL = "W is_arbitrated_by hierarchical", "V is_arbitrated_by hierarchical"
#: Configurations and their costs: nodes, conversions, relationships.
EXAMPLES = {
    "ordered run of a flat file": (
        driven("flat", *BOTH_HIERARCHICAL, "W is_locked_by E"),
        (3, 0, 7),
    ),
    "mean of a flat file is no run": (
        driven("flat", "W is_arbitrated_by hierarchical"),
        (4, 0, 8),
    ),
    "default period": (
        driven(
            "hierarchical", "W is_arbitrated_by weighted", "V is_arbitrated_by weighted period 100"
        ),
        (2, 0, 5),
    ),
    "period of the file": (
        driven("flat period 50", "W is_arbitrated_by flat", "V is_arbitrated_by flat period 50"),
        (2, 0, 5),
    ),
    "strategy of the file": (driven("hierarchical", "W is_arbitrated_by hierarchical"), (2, 0, 5)),
    "strategy of a flat file": (driven("flat", "W is_arbitrated_by flat period 100"), (2, 0, 5)),
    "strategy of the file beside a lock": (
        driven("hierarchical", *BOTH_HIERARCHICAL, "W is_locked_by E"),
        (3, 0, 7),
    ),
    "number as a lock": (
        robot(
            "@configuration\nW is_controlled_by A\nW is_locked_by E",
            *(WHEELS[0], DRIVERS[0], "E: Num e();", "Cv: @Converts 1\nbool cv(Num v);"),
        ),
        (2, 1, 4),
    ),
    "converted suppressor": (
        robot(
            "@configuration\nA uses_data_from Map\nMap is_suppressed_by Over 20",
            *("Map: Grid map();", "Over: Pic over();", "A: @DataIn\nvoid a(Grid x);"),
            "Cv: @Converts 2\nGrid cv(Pic v);",
        ),
        (2, 2, 4),
    ),
    "converted before the Gate of a suppressor": (stacked("Pic"), (4, 4, 7)),
    "abstract before the Gate of a suppressor": (stacked("Grid"), (3, 0, 6)),
    "condition behind a conversion": (at_input("NotifyOnValue(30)", "Num"), (4, 4, 6)),
    "pull behind a Gate": (at_input("RequestWhenReady", "Grid"), (2, 0, 4)),
    "pull behind a Gate though offered": (
        at_input("RequestWhenReady", "Grid", "RequestWhenReady, NotifyWhenReady"),
        (2, 0, 4),
    ),
    "pull behind the Gate of an output": (
        at_input("RequestWhenReady", "Grid", "RequestWhenReady, NotifyWhenReady").replace(
            "A.x is_sup", "Map is_sup"
        ),
        (2, 0, 4),
    ),
    "pull behind a Gate and a conversion": (at_input("RequestWhenReady", "Num"), (3, 2, 5)),
}
READ_BACK = {
    **{name: text for name, (text, _) in EXAMPLES.items()},
    **{
        path.stem: path.read_text()
        for path in sorted((ROOT / "tests/execution/subsumption").glob("*.mars"))
        if path.suffixes == [".mars"]
    },
    **{
        name: re.sub("@sources.*", "", (ROOT / "examples" / name / "config.mars").read_text())
        for name in ("figure17", "figure20")
    },
    "two of one trigger": TWO_OF_ONE_TRIGGER,
    "suppressed suppressor": SUPPRESSED_SUPPRESSOR,
}


@pytest.mark.parametrize("name", sample([*READ_BACK], 3))
def test_a_specification_is_its_own_specification(name: str) -> None:
    assert compare_again(READ_BACK[name]) is None


@pytest.mark.parametrize(("text", "cost"), EXAMPLES.values(), ids=EXAMPLES)
def test_cost_of_an_example(text: str, cost: tuple[int, int, int]) -> None:
    project = read(text)
    found = synthesised(project)
    assert found is not None
    assert cost_of(found) == cost
    counted = written(found.specification.configuration, project)
    assert tuple(counted.get(level, 0) for level in (NODES, CONVERSION, RELATIONSHIPS)) == cost


def test_a_run_in_a_flat_file_states_its_strategy() -> None:
    text, _ = EXAMPLES["ordered run of a flat file"]
    project = read(text)
    found = synthesised(project)
    assert found is not None
    specification = found.specification.configuration
    lines = specification.relationships
    (run,) = (
        each for each in lines if print_relationship(each).startswith("ArbitrationNode2 is_arb")
    )
    without = replace(specification, relationships=tuple(each for each in lines if each != run))
    violated = {each.rule.id for each in verify(without, project, RULEBOOK)}
    assert "verify/bounds/run-strategy" in violated


def test_a_gate_passes_the_representation_of_its_suppressor() -> None:
    project = read(stacked("Pic"))
    assert not alarms(project)
