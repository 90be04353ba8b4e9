"""Warnings of runs that show less than their verdicts seem to.

`python -m tests.execution.test_vain HOW_MANY FIRST_SEED` tries as many random robots as wanted.
"""

import random
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from mars_asp.execution.judgement import judge
from tests.support.campaigns import seeds
from tests.support.trials import BASE, DRIVE, HAND, WALL, trial

STILL = HAND.replace("200", "0")
REQUIRED = (
    '[requirements]\nno_collision = true\nclearance = 1\nexclusive = [["Trans_Z", "Rotn_Y"]]\n'
)
CIRCLE = "[world]\ncircles = [[1500, 0, 300]]\n"
MOVING = "[world]\nmoving = [{ from = [900, 900], to = [900, 1900], radius = 100, speed = 100 }]\n"


def warned(text: str, specification: str = DRIVE, folder: Path = Path()) -> set[str]:
    found = judge(trial(text, specification, folder)).warnings
    return {f"{each.kind}({each.subject})" for each in found}


def reach(at: str, radius: int = 200) -> str:
    return f"[requirements]\nreach = {{ at = {at}, radius = {radius} }}\n"


VAIN = "requirement_in_vain({})".format


@pytest.mark.parametrize(
    ("text", "warnings"),
    [
        pytest.param(BASE + HAND + WALL, set(), id="no requirement"),
        pytest.param(
            BASE + STILL + WALL + REQUIRED,
            {VAIN("no_collision"), VAIN("clearance"), VAIN("exclusive")},
            id="a robot that never moved",
        ),
        pytest.param(BASE + STILL + MOVING + REQUIRED, {VAIN("exclusive")}, id="obstacles move"),
        pytest.param(BASE + HAND + WALL + REQUIRED, {VAIN("exclusive")}, id="it never turned"),
        pytest.param(
            BASE + HAND + REQUIRED,
            {VAIN("no_collision"), VAIN("clearance"), VAIN("exclusive")},
            id="an empty world",
        ),
        pytest.param(BASE + HAND + reach("[0, 100]"), {VAIN("reach")}, id="it starts there"),
        pytest.param(BASE + HAND + reach("[500, 0]"), set(), id="it comes there"),
        pytest.param(
            BASE + HAND + CIRCLE + reach("[1500, 0]"),
            {"goal_in_obstacle(robot)"},
            id="the place is in an obstacle",
        ),
        pytest.param(
            BASE + HAND + CIRCLE + reach("[1250, 0]", 100),
            {"goal_in_obstacle(robot)"},
            id="the place has no room",
        ),
        pytest.param(BASE + HAND + CIRCLE + reach("[1500, 900]"), set(), id="the place has room"),
        pytest.param(
            BASE + HAND + WALL + "[requirements]\ncoverage = 0\n",
            {VAIN("coverage")},
            id="nothing is to be covered",
        ),
    ],
)
def test_requirements_that_could_not_be_violated(text: str, warnings: set[str]) -> None:
    assert warned(text) == warnings


def test_a_robot_without_a_command_is_a_warning_and_no_violation(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go(x):\n    return 'Trans_Z', x\ndef read():\n    pass\n")
    bound = '[bindings]\nC.python = "b.py:go"\nS = { python = "b.py:read", period = 100 }\n'
    robot = "@specification\n@modules P, C, S, DataSplitter1\nDataSplitter1 uses_data_from S\n"
    robot += "C uses_data_from DataSplitter1\nP is_controlled_by C\n"
    judgement = judge(trial(BASE + bound, robot, tmp_path))
    assert judgement.verdict == "pass"
    assert [each.message for each in judgement.warnings] == [
        "`P` got no command, so it never moved",
        "`C` never ran: it got nothing from `S`",
    ]
    assert [getattr(trace, "message", None) for _, trace in judgement.traces()] == [
        each.message for each in judgement.warnings
    ]


def random_robot(seed: int) -> tuple[str, str, str, set[str]]:
    """Return a robot, its code and bindings, and the modules that never run, by the data alone."""
    rng = random.Random(seed)
    lines, code, bound = [], [], []
    speaks: dict[str, bool] = {}
    silent = set()
    for k in range(7):
        name, known = ("S", "D")[k > 1] + str(k), [*speaks]
        sources = rng.sample(known, rng.randint(1, min(3, len(known)))) if k > 1 else []
        lines += [f"{name} uses_data_from {source}" for source in sources]
        runs, returns = all(speaks[s] for s in sources), rng.random() < 0.8
        silent |= set() if runs else {name}
        speaks[name] = runs and returns
        code.append(f"def {name.lower()}(*inputs):\n    return {int(returns) or None}")
        period = "" if sources else ", period = 100"
        bound.append(f'{name} = {{ python = "b.py:{name.lower()}"{period} }}')
    source = rng.choice([*speaks])
    lines += [f"C uses_data_from {source}", "P is_controlled_by C"]
    code.append("def c(x):\n    return 'Trans_Z', 9")
    bound.append('C = { python = "b.py:c" }')
    silent |= set() if speaks[source] else {"C", "P"}
    rng.shuffle(lines)
    blocks = "".join(
        f"@module_start\n@module_name {name}\n"
        f"{'@Sense' if name[0] == 'S' else '@DataOut'} NotifyWhenReady\nint f();\n@module_end\n"
        for name in speaks
    )
    names = ", ".join(["P", "C", *speaks])
    robot = "\n".join(["@specification", f"@modules {names}", *lines, blocks])
    return robot, "\n".join(code), "[bindings]\n" + "\n".join(bound) + "\n", silent


def differing(seeds: Iterable[int], folder: Path) -> list[int]:
    """Return the seeds whose run warns of other modules than those that never ran."""
    found = []
    for seed in seeds:
        robot, code, bound, silent = random_robot(seed)
        # Python may take a file of the same second and size for the one it has compiled.
        own = folder / str(seed)
        own.mkdir()
        (own / "b.py").write_text(code)
        warnings = judge(trial(BASE + bound, robot, own)).warnings
        if {each.subject for each in warnings} != silent:
            found.append(seed)
    return found


def test_warnings_name_the_modules_that_never_ran(tmp_path: Path) -> None:
    assert differing(seeds(10, 50), tmp_path) == []


if __name__ == "__main__":
    begin = int(sys.argv[2])
    with TemporaryDirectory() as folder:
        wrong = differing(range(begin, begin + int(sys.argv[1])), Path(folder))
    print(f"{len(wrong)} of {sys.argv[1]} runs warn of other modules: {wrong[:9]}")
