"""Small configurations with side lines: least costs, and what is read back or hand-written."""

import re
from pathlib import Path

import pytest

from tests.reasoning.synthesis.test_side_lines import compare_again

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
READ_BACK = {
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


@pytest.mark.parametrize("text", READ_BACK.values(), ids=READ_BACK)
def test_a_specification_is_its_own_specification(text: str) -> None:
    assert compare_again(text) is None
