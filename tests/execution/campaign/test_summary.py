"""Summaries of the runs of a campaign."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.execution.campaign.summary import Share, are_equal, cells, summary_json, worst

Z = 1.959963984540054


@given(st.integers(1, 10_000).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_ends_of_the_interval_are_where_the_score_test_turns(counts: tuple[int, int]) -> None:
    """They solve (share - x)^2 = z^2 x (1 - x) / n, which Wilson's formula is the solution of."""
    held, of = counts
    low, high = Share(held, of).interval
    assert 0 <= low <= held / of <= high <= 1
    for end in (low, high):
        if 0 < end < 1:
            assert (held / of - end) ** 2 == pytest.approx(Z * Z * end * (1 - end) / of, rel=1e-6)


@pytest.mark.parametrize(
    ("held", "of", "low", "high"),
    # Of Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I.
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_intervals_are_those_of_the_literature(held: int, of: int, low: float, high: float) -> None:
    assert Share(held, of).interval == pytest.approx((low, high), abs=5e-5)


def test_without_a_run_nothing_is_known() -> None:
    assert Share(0, 0).interval == (0, 1)


def result(seed: int, verdict: str, vary: Any = None, **more: Any) -> dict[str, Any]:
    holds = {"pass": True, "fail": False}.get(verdict)
    judged = [{"name": "r", "holds": holds}, {"name": "always", "holds": True}]
    run = {"seed": seed, "verdict": verdict, "vary": vary or {}, "requirements": judged}
    return {**run, "control_time": {}, **more}


def test_runs_are_equal_if_only_their_seeds_differ() -> None:
    equal = [result(seed, "pass", {"x": x}) for x in (1, 2) for seed in (1, 2)]
    assert are_equal(equal)
    assert not are_equal([*equal, result(3, "fail", {"x": 2})])
    assert not are_equal([result(1, "pass", {"x": x}) for x in (1, 2)])
    assert not are_equal([])


def test_undecided_runs_are_not_counted_for_their_requirement() -> None:
    results = [result(1, "pass"), result(2, "fail"), result(3, "not decided")]
    found = summary_json(results, lambda each: f"again {each['seed']}")
    assert (found["runs"], found["passed"]) == (3, 1)
    counted = {name: (r["held"], r["of"]) for name, r in found["requirements"].items()}
    assert counted == {"r": (1, 2), "always": (3, 3)}
    assert [each["command"] for each in found["worst"]] == ["again 2", "again 3"]
    low, high = Share(1, 2).interval
    assert found["requirements"]["r"]["low"] == round(low, 6)
    assert found["requirements"]["r"]["high"] == round(high, 6)


def test_the_worst_are_at_most_five_and_those_that_struck_most_come_first() -> None:
    results = [
        result(1, "pass"),
        result(2, "not decided"),
        result(3, "fail", collisions=0, min_clearance_mm=9.0),
        result(4, "fail", collisions=2, min_clearance_mm=0.0),
        result(5, "fail", collisions=0, min_clearance_mm=3.0),
        result(6, "fail", collisions=None, min_clearance_mm=None),
        result(7, "fail", collisions=0, min_clearance_mm=9.0),
    ]
    assert [each["seed"] for each in worst(results)] == [4, 5, 3, 7, 6]
    assert [each["seed"] for each in worst(results[:2])] == [2]


def judged(**holds: bool | None) -> list[dict[str, object]]:
    return [{"name": name, "holds": held} for name, held in holds.items()]


def test_the_worst_are_those_of_each_requirement_by_its_own_measure() -> None:
    far = [result(k, "fail", requirements=judged(reach=False)) for k in range(1, 5)]
    for k, each in enumerate(far):
        each |= {"places": {"robot": (None, 100.0 * k)}, "min_clearance_mm": 900.0 - k}
    struck = result(9, "fail", requirements=judged(reach=True, no_collision=False), collisions=7)
    near = result(8, "fail", requirements=judged(no_collision=False), collisions=1)
    assert [each["seed"] for each in worst([*far, near, struck])] == [4, 9, 3, 8, 2]
    assert [each["seed"] for each in worst(far)] == [4, 3, 2, 1]


def test_quantiles_count_a_place_that_was_not_reached_as_never() -> None:
    results = [result(k, "pass", min_clearance_mm=float(k)) for k in range(1, 41)]
    for k, each in enumerate(results):
        each["places"] = {"robot": (float(k) if k < 30 else None, 5.0)}
    found = summary_json(results, lambda each: "")["quantiles"]
    assert found["min_clearance_mm"] == {"of": 40, "5": 2, "25": 10, "50": 20, "75": 30, "95": 38}
    assert found["reached_s"] == {"of": 40, "5": 1, "25": 9, "50": 19, "75": 29, "95": None}
    assert found["nearest_to_place_mm"]["95"] == 5
    assert summary_json([result(1, "pass")], lambda each: "")["quantiles"] == {}


def test_places_of_several_robots_have_quantiles_of_their_own() -> None:
    places = {"left": (1.0, 5.0), "right": (None, 90.0)}
    found = summary_json([result(1, "fail", places=places)], lambda each: "")["quantiles"]
    assert (found["left.reached_s"]["50"], found["right.reached_s"]["50"]) == (1, None)


def test_warnings_are_counted_by_runs() -> None:
    results = [result(k, "pass", {"x": k % 2}, warnings=["w(A)"] * (k > 1)) for k in range(4)]
    found = summary_json(results, lambda each: "")
    assert found["warnings"] == {"w(A)": 2}
    assert [cell["warnings"] for cell in found["cells"]] == [{"w(A)": 1}, {"w(A)": 1}]


def test_each_combination_of_values_is_a_cell() -> None:
    results = [
        result(1, "pass", {"x": 1}),
        result(1, "fail", {"x": 2}),
        result(2, "fail", {"x": 1}),
    ]
    first, second = cells(results)
    assert (first.vary, first.passed, second.passed) == ({"x": 1}, Share(1, 2), Share(0, 1))
    assert first.requirements == {"r": Share(1, 2), "always": Share(2, 2)}


def test_a_controller_counts_in_the_runs_that_it_was_in_control_in() -> None:
    results = [
        result(1, "pass", {"x": 1}, control_time={"Collide": 0.0, "Turn": 0.1}),
        result(2, "fail", {"x": 1}, control_time={"Collide": 0.0, "Turn": 0.0}),
        result(1, "pass", {"x": 2}, control_time={"Collide": 0.0, "Turn": 20.0}),
        result(2, "fail", {"x": 2}, error="it took too long"),  # what it would have done is unknown
    ]
    found = summary_json(results, lambda each: "")
    assert {name: (c["held"], c["of"]) for name, c in found["in_control"].items()} == {
        "Collide": (0, 3),
        "Turn": (2, 3),
    }
    assert [cell.in_control["Turn"] for cell in cells(results)] == [Share(1, 2), Share(1, 1)]
