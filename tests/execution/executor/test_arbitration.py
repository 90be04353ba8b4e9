"""Flat averages, priorities, holds, stops, cascades and inheritance."""

from typing import Any, TypeAlias

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.arbitration import HierarchicalArbitration
from mars_asp.model.declarations import GRASP
from tests.support.campaigns import examples
from tests.support.execute_builders import Inbox, control_out, effector, executed, ms, sensor
from tests.support.refusals import refusal

GO = "Trans_Z"
Script: TypeAlias = dict[int, float]


def scripted(script: Script, step: int = 10) -> Behaviour:
    """Return a controller that sends rate R at each time (ms) in {time: R}."""
    time = iter(range(0, 10**9, step))
    return Behaviour(lambda: _go(script.get(next(time))), ms(step))


def _go(rate: float | None) -> tuple[str, float] | None:
    return None if rate is None else (GO, rate)


def arbitrated(
    scripts: dict[str, Script],
    seconds: float,
    text: str | None = None,
    kind: str = "specification hierarchical",
) -> tuple[list[tuple[float, Any]], Executor]:
    """Run controllers A, B, ... with ascending priority; return the inputs of the effector."""
    inbox = Inbox()
    if text is None:
        text = "P is_controlled_by ArbitrationNode\n" + "\n".join(
            f"ArbitrationNode is_controlled_by {name} {rank} hold 100"
            for rank, name in enumerate(scripts)
        )
    executor = executed(
        text,
        [*(control_out(name) for name in scripts), effector("P", GO)],
        {"P": inbox, **{name: scripted(script) for name, script in scripts.items()}},
        seconds,
        kind,
    )
    return [(time, value.get(GO)) for time, value in inbox.got], executor


def test_priority_0_alone_passes_and_a_silent_controller_does_not_block() -> None:
    got, _ = arbitrated({"A": {0: 1}, "B": {}}, 0.05)
    assert got == [(0, 1)]


def test_the_highest_in_force_wins_and_is_forwarded_at_once() -> None:
    got, executor = arbitrated({"A": {0: 1, 30: 2}, "B": {20: 9}}, 0.05)
    assert got == [(0, 1), (20, 9)]
    arbiter = executor.arbiters["ArbitrationNode"]
    assert isinstance(arbiter, HierarchicalArbitration)
    assert arbiter.suppressed == {"A": 1}


def test_when_the_winner_falls_silent_the_next_in_force_resumes_after_the_hold() -> None:
    got, _ = arbitrated({"A": {0: 1, 60: 2}, "B": {20: 9}}, 0.15)
    assert got == [(0, 1), (20, 9), (120, 2)]


def test_one_stop_is_sent_when_all_fall_silent() -> None:
    got, _ = arbitrated({"A": {0: 1}, "B": {20: 9}}, 0.49)
    assert got == [(0, 1), (20, 9), (120, None)]


def test_a_controllers_next_message_replaces_its_last_and_renews_its_hold() -> None:
    got, _ = arbitrated({"A": {0: 1, 90: 2}}, 0.3)
    assert got == [(0, 1), (90, 2), (190, None)]


def test_a_hold_that_is_forever_never_lets_go() -> None:
    text = (
        "P is_controlled_by ArbitrationNode\n"
        "ArbitrationNode is_controlled_by A 0 hold 100\n"
        "ArbitrationNode is_controlled_by B 1 hold forever"
    )
    got, executor = arbitrated({"A": dict.fromkeys(range(0, 3000, 50), 1), "B": {20: 9}}, 3, text)
    assert [value for _, value in got if value is not None] == [1, 9]
    held = [h.holder for h in executor.arbiters["ArbitrationNode"].holdings]
    assert held == ["A", "B"]


def test_among_equals_the_latest_wins() -> None:
    text = (
        "P is_controlled_by ArbitrationNode\n"
        "ArbitrationNode is_controlled_by A 3 hold 100\n"
        "ArbitrationNode is_controlled_by B 3 hold 30"
    )
    got, _ = arbitrated({"A": {0: 1, 20: 2}, "B": {10: 9, 30: 8}}, 0.07, text)
    assert got == [(0, 1), (10, 9), (20, 2), (30, 8), (60, 2)]


@pytest.mark.parametrize(("sources", "hold"), [(["S"], 100), (["S", "T"], 200)])
def test_the_default_hold_is_two_and_a_half_periods_or_200_ms(
    sources: list[str], hold: int
) -> None:
    inbox, once = Inbox(), iter([(GO, 1)])
    inputs = "\n".join(f"A uses_data_from {source}" for source in sources)
    executed(
        f"P is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by A 0\n{inputs}",
        [control_out("A"), effector("P", GO), *(sensor(source) for source in sources)],
        {
            "A": lambda *readings: next(once, None),
            "P": inbox,
            **{source: Behaviour(lambda: 0, ms(40)) for source in sources},
        },
        0.4,
    )
    assert inbox.got == [(0, {GO: 1}), (hold, {})]


def test_the_holder_of_control_is_recorded_with_instant_and_reason() -> None:
    _, executor = arbitrated({"A": {0: 1, 60: 2}, "B": {20: 9}}, 0.3)
    held = [(h.since / 1e6, h.holder, h.why) for h in executor.arbiters["ArbitrationNode"].holdings]
    assert held == [
        (0, "A", "alone in force"),
        (20, "B", "priority 1 outranks A (0)"),
        (120, "A", "the hold of B ran out; alone in force"),
        (160, "", "nothing is in force"),
    ]


def test_a_reason_names_the_controller_and_not_the_gate_that_its_command_passed() -> None:
    text = (
        "P is_controlled_by ArbitrationNode\nGate1 is_controlled_by A\n"
        "ArbitrationNode is_controlled_by Gate1 0 hold 100\n"
        "ArbitrationNode is_controlled_by B 1 hold 100"
    )
    _, executor = arbitrated({"A": {0: 1, 60: 2}, "B": {20: 9}}, 0.1, text)
    held = executor.arbiters["ArbitrationNode"].holdings
    assert [h.why for h in held] == ["alone in force", "priority 1 outranks A (0)"]


CASCADE = """P is_controlled_by ArbitrationNode2
ArbitrationNode2 is_controlled_by A 0 hold 100
ArbitrationNode2 is_controlled_by ArbitrationNode 1
ArbitrationNode is_controlled_by B 1 hold 50
ArbitrationNode is_controlled_by C 2 hold 70
"""
ONE = """P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by A 0 hold 100
ArbitrationNode is_controlled_by B 1 hold 50
ArbitrationNode is_controlled_by C 2 hold 70
"""
SCRIPT = st.dictionaries(st.integers(0, 40).map(lambda k: k * 10), st.integers(1, 99), max_size=8)


@given(SCRIPT, SCRIPT, SCRIPT)
@settings(max_examples=examples(30, 60), deadline=None)
def test_a_cascade_behaves_as_one_node(a: Script, b: Script, c: Script) -> None:
    scripts = {"A": a, "B": b, "C": c}
    cascade, _ = arbitrated(scripts, 0.7, CASCADE)
    one, _ = arbitrated(scripts, 0.7, ONE)
    assert cascade == one


@given(SCRIPT, SCRIPT, SCRIPT)
@settings(max_examples=examples(30, 60), deadline=None)
def test_a_cascade_of_equals_behaves_as_one_node(a: Script, b: Script, c: Script) -> None:
    def equal(text: str) -> str:
        return text.replace("B 1", "B 0").replace("C 2", "C 0").replace("Node 1", "Node 0")

    scripts = {"A": a, "B": b, "C": c}
    assert arbitrated(scripts, 0.7, equal(CASCADE))[0] == arbitrated(scripts, 0.7, equal(ONE))[0]


def test_an_inner_arbiter_sends_no_stop_of_its_own() -> None:
    _, executor = arbitrated({"A": {}, "B": {0: 1}, "C": {}}, 0.4, CASCADE)
    inner = next(link for link in executor.links if link.source == "ArbitrationNode")
    assert inner.delivered == 1


def test_flat_sends_the_mean_of_each_function_at_the_end_of_a_period() -> None:
    text = "P is_controlled_by ArbitrationNode\n" + "\n".join(
        f"ArbitrationNode is_controlled_by {name}" for name in "AB"
    )
    scripts: dict[str, Script] = {"A": {0: 1, 50: 3, 100: 5}, "B": {110: 7}}
    got, _ = arbitrated(scripts, 0.4, text, "specification flat")
    assert got == [(100, 3), (200, 7)]


@pytest.mark.parametrize(("period", "first"), [("", 100), (" period 50", 50), (" period 200", 200)])
def test_flat_sends_every_100_ms_or_at_its_period(period: str, first: int) -> None:
    text = "P is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by A"
    got, _ = arbitrated({"A": {30: 7}}, 0.4, text, f"specification flat{period}")
    assert got == [(first, 7)]


def test_flat_outvotes_a_10_hz_controller_by_a_50_hz_one() -> None:
    text = "P is_controlled_by ArbitrationNode\n" + "\n".join(
        f"ArbitrationNode is_controlled_by {name}" for name in "AB"
    )
    scripts: dict[str, Script] = {"A": {k: 12 for k in range(20, 101, 20)}, "B": {100: 0}}
    got, _ = arbitrated(scripts, 0.1, text, "specification flat")
    assert got == [(100, 10)]


def test_a_flat_mean_may_name_several_functions() -> None:
    inbox = Inbox()
    executed(
        "P is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by A\n"
        "ArbitrationNode is_controlled_by B",
        [control_out("A"), control_out("B"), effector("P", GO, "Rotn_Y")],
        {
            "A": Behaviour(lambda: (GO, 4), ms(100)),
            "B": Behaviour(lambda: ("Rotn_Y", 6), ms(100)),
            "P": inbox,
        },
        0.1,
        "specification flat",
    )
    assert inbox.got == [(100, {GO: 4, "Rotn_Y": 6})]


def test_a_control_splitter_copies() -> None:
    first, second = Inbox(), Inbox()
    executed(
        "ControlSplitter1 is_controlled_by A\nP is_controlled_by ControlSplitter1\n"
        "Q is_controlled_by ControlSplitter1",
        [control_out("A"), effector("P", GO), effector("Q", GO)],
        {"A": scripted({0: 1, 20: 2}), "P": first, "Q": second},
        0.05,
    )
    assert first.got == second.got == [(0, {GO: 1}), (20, {GO: 2})]


def test_an_inheritance_node_maps_into_the_providers_frames_and_the_nearest_takes_it() -> None:
    head, base = Inbox(), Inbox()
    executed(
        "Camera is_mounted_on Head (z, 90)\nHead is_mounted_on Base\n"
        "InheritanceNode1 is_controlled_by A\nHead is_controlled_by InheritanceNode1\n"
        "Base is_controlled_by InheritanceNode1".replace("(z, 90)", "(z, 90, _, _, 0, 0, 0)"),
        [control_out("A"), effector("Head", "Rotn_Y"), effector("Base", "Rotn_Y", "Trans_X")],
        {
            "A": Behaviour(iter([("Rotn_X", 5), ("Trans_Y", 8)]).__next__, ms(100)),
            "Head": head,
            "Base": base,
        },
        0.1,
    )
    # What a command does not name is zero, so the head turns no further.
    assert head.got == [(0, {"Rotn_Y": 5}), (100, {})]
    assert base.got == [(100, {"Trans_X": -8})]


def test_a_provider_that_nothing_describes_is_taken_where_it_is_the_only_one() -> None:
    base = Inbox()
    lines = (
        "Camera is_mounted_on Head\nHead is_mounted_on Base\n"
        "InheritanceNode1 is_controlled_by A\nBase is_controlled_by InheritanceNode1\n"
    )
    behaviours = {
        "A": Behaviour(lambda: ("Rotn_X", 5), ms(100)),
        "Base": base,
        "Head": Inbox(),
    }
    executed(lines, [control_out("A")], behaviours, 0.0)
    assert base.got == [(0, {"Rotn_X": 5})]
    lines += "Head is_controlled_by InheritanceNode1\n"
    found = refusal(
        executed, lines, [control_out("A"), effector("Base", "Rotn_X")], behaviours, 0.0
    )
    assert found.message == "the functions that `Head` provides to `InheritanceNode1` are unknown"


def test_a_module_led_both_ways_does_its_own_motion_and_leaves_inherited_ones() -> None:
    arm, base = Inbox(), Inbox()
    executor = executed(
        "Arm is_mounted_on Base (z, 90, _, _, 0, 0, 0)\nControlSplitter1 is_controlled_by A\n"
        "Arm is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by ControlSplitter1\n"
        "ArbitrationNode is_controlled_by B 1\nInheritanceNode1 is_controlled_by ControlSplitter1\n"
        "Base is_controlled_by InheritanceNode1",
        [
            control_out("A", GRASP, "Trans_Y", "Trans_Z"),
            control_out("B", GRASP),
            effector("Arm", GRASP),
            effector("Base", "Trans_X"),
        ],
        {
            "A": Behaviour(
                iter([("Trans_Y", 8), (GRASP, 3), ("Trans_Y", 4), ("Trans_Z", 1)]).__next__, ms(100)
            ),
            "B": Behaviour(lambda: None, ms(100)),
            "Arm": arm,
            "Base": base,
        },
        0.3,
    )
    assert base.got == [(0, {"Trans_X": -8}), (100, {}), (200, {"Trans_X": -4}), (300, {})]
    # No module has the last function: the command passes unchanged, and the node reports it.
    assert arm.got == [(0, {}), (100, {GRASP: 3}), (200, {}), (300, {"Trans_Z": 1})]
    assert list(executor.failures) == ["A -> Base"]


@pytest.mark.parametrize(
    ("allocation", "at_head", "at_base"),
    [
        ("", [(0, {"Rotn_Y": 6})], []),
        (" allocation root", [], [(0, {"Rotn_Y": 6})]),
        (" allocation split", [(0, {"Rotn_Y": 3})], [(0, {"Rotn_Y": 3})]),
    ],
)
def test_an_inheritance_node_allocates_by_its_input(
    allocation: str, at_head: list[object], at_base: list[object]
) -> None:
    """The base has another controller, so an arbiter is between node and base."""
    head, base = Inbox(), Inbox()
    executed(
        f"Camera is_mounted_on Head\nHead is_mounted_on Base\n"
        f"InheritanceNode1 is_controlled_by A{allocation}\nHead is_controlled_by InheritanceNode1\n"
        "Base is_controlled_by ArbitrationNode\n"
        "ArbitrationNode is_controlled_by InheritanceNode1 1\n"
        "ArbitrationNode is_controlled_by B 0",
        [
            control_out("A"),
            control_out("B"),
            effector("Head", "Rotn_Y"),
            effector("Base", "Rotn_Y", "Trans_X"),
        ],
        {
            "A": Behaviour(iter([("Rotn_Y", 6)]).__next__, ms(100)),
            "B": Behaviour(lambda: None, ms(100)),
            "Head": head,
            "Base": base,
        },
        0.1,
        "specification hierarchical",
    )
    assert head.got == at_head
    assert base.got == at_base


def test_a_suppressed_message_counts_for_its_sender() -> None:
    text = """
        P is_controlled_by ArbitrationNode
        ArbitrationNode is_controlled_by ControlSplitter1 0 hold 100
        ArbitrationNode is_controlled_by B 1 hold 100
        ControlSplitter1 is_controlled_by A
    """
    _, executor = arbitrated({"A": {0: 1, 30: 2}, "B": {20: 9}}, 0.05, text)
    arbiter = executor.arbiters["ArbitrationNode"]
    assert isinstance(arbiter, HierarchicalArbitration)
    assert arbiter.suppressed == {"A": 1}


def test_an_inheritance_node_beside_a_led_module_serves_another_on_the_same_carrier() -> None:
    # `Arm` has the commanded functions, so the node is that of `Eye`, and forwards all.
    base = Inbox()
    executed(
        "Arm is_mounted_on Base\nEye is_mounted_on Base\nControlSplitter1 is_controlled_by A\n"
        "Arm is_controlled_by ControlSplitter1\n"
        "InheritanceNode1 is_controlled_by ControlSplitter1\n"
        "Base is_controlled_by InheritanceNode1",
        [control_out("A", GO), effector("Arm", GO), effector("Base", GO), effector("Eye")],
        {"A": scripted({0: 1}), "Arm": Inbox(), "Base": base, "Eye": Inbox()},
        0.05,
    )
    assert base.got == [(0, {GO: 1})]


def test_a_message_stays_in_force_for_two_and_a_half_periods_whatever_copies_it() -> None:
    base = Inbox()
    executed(
        "ControlSplitter1 is_controlled_by A\nOther is_controlled_by ControlSplitter1\n"
        "ArbitrationNode is_controlled_by ControlSplitter1 1\n"
        "ArbitrationNode is_controlled_by B 0\nBase is_controlled_by ArbitrationNode",
        [control_out("A"), control_out("B"), effector("Base", GO), effector("Other", GO)],
        {"A": scripted({0: 1}), "B": scripted({}), "Base": base, "Other": Inbox()},
        0.05,
    )
    assert base.got == [(0, {GO: 1}), (25, {})]
