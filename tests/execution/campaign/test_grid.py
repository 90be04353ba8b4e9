"""Which runs a campaign has."""

import pytest

from mars_asp.execution.campaign.grid import MOST_RUNS, Grid, read_seeds, run_name
from mars_asp.execution.scenario.vary import read_axes


@pytest.mark.parametrize(
    ("text", "seeds"),
    [
        ("7", (7,)),
        ("1-4", (1, 2, 3, 4)),
        ("1,5,9-12", (1, 5, 9, 10, 11, 12)),
        ("9, 3-4", (9, 3, 4)),
        ("-2-1", (-2, -1, 0, 1)),
        ("-3", (-3,)),
        ("9223372036854775807", (2**63 - 1,)),
    ],
)
def test_seeds_are_read_in_their_order(text: str, seeds: tuple[int, ...]) -> None:
    assert read_seeds(text) == seeds


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "`` is not a seed or a range of seeds such as 1-200"),
        ("a", "`a` is not a seed or a range of seeds such as 1-200"),
        ("1-", "`1-` is not a seed or a range of seeds such as 1-200"),
        ("1,,2", "`` is not a seed or a range of seeds such as 1-200"),
        ("1.5", "`1.5` is not a seed or a range of seeds such as 1-200"),
        ("4-1", "the range `4-1` is empty: 1 is below 4"),
        ("1-3,2", "seed 2 is given twice"),
        ("9223372036854775808", "`9223372036854775808` is out of range: seeds have 64 bits"),
        (f"1-{MOST_RUNS + 1}", f"a campaign has at most {MOST_RUNS} runs"),
        ("-9223372036854775808-9223372036854775807", f"a campaign has at most {MOST_RUNS} runs"),
    ],
)
def test_invalid_seeds_are_refused(text: str, message: str) -> None:
    with pytest.raises(ValueError) as wrong:
        read_seeds(text)
    assert str(wrong.value) == message


def test_the_first_key_changes_slowest_and_seeds_fastest() -> None:
    grid = Grid((2, 1), read_axes(["robot.radius=150,200", "modules.C=on,off"]))
    runs = [(run.seed, *run.changes.values()) for run in grid.runs()]
    assert len(grid) == len(runs) == 8
    assert runs[:4] == [(2, 150, "on"), (1, 150, "on"), (2, 150, "off"), (1, 150, "off")]


def test_the_name_of_a_run_is_independent_of_the_form_of_its_keys() -> None:
    names = [
        [run.name for run in Grid((1,), read_axes(declared)).runs()]
        for declared in (["b.x=1", "a.x=2"], ["a.x=2", "b.x=1"])
    ]
    assert names[0] == names[1] == [run_name(1, {"a.x": 2, "b.x": 1})]
    assert run_name(1, {"a": 150}) != run_name(1, {"a": 200})
