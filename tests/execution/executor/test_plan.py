"""The plan of a specification: kinds, modes, rates, holds and depths."""

from fractions import Fraction

import pytest

from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.link import Link
from mars_asp.execution.executor.plan import DEFAULT_HOLD, Plan
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.language import parse_text
from mars_asp.model.declarations import Module, Service
from tests.support.execute_builders import (
    HERE,
    control_out,
    data_out,
    effector,
    mode,
    sensor,
    sink,
    specification,
)

PAIR = "ArbitrationNode is_controlled_by {a} 1\nArbitrationNode is_controlled_by {b} 2\n"


def planned(text: str, *modules: Module, periods: dict[str, int | None] | None = None) -> Plan:
    behaviours = {name: Behaviour(print, at) for name, at in (periods or {}).items()}
    return Plan(specification(text), {module.name: module for module in modules}, behaviours)


def link(plan: Plan, client: str, source: str) -> Link:
    (found,) = (each for each in plan.links if (each.client, each.source) == (client, source))
    return found


def data(client: str, source: str) -> str:
    return f"{client} uses_data_from {source}\n"


def control(controlled: str, controller: str) -> str:
    return f"{controlled} is_controlled_by {controller}\n"


# ---- Links ---------------------------------------------------------------------------------------


def test_a_link_has_the_properties_of_its_relationship() -> None:
    plan = planned(
        "B uses_data_from A NotifyAtFrequency 2.5\nC is_mounted_on B\n"
        "C is_controlled_by B 7 hold 30 allocation root\nD is_controlled_by B\nC uses_data_from B"
    )
    assert [(each.kind, each.client, each.source) for each in plan.links] == [
        ("data", "B", "A"),
        ("control", "C", "B"),
        ("control", "D", "B"),
        ("data", "C", "B"),
    ]
    first, second, third, fourth = plan.links
    assert (first.mode, first.hz) == (mode("NotifyAtFrequency"), Fraction(5, 2))
    assert (fourth.mode, fourth.hz) == (None, None)
    assert (second.priority, second.hold, second.allocation) == (7, 30 * MILLISECOND, "root")
    assert (third.priority, third.hold, third.allocation) == (0, None, None)
    assert (plan.data_in["B"], plan.data_out["B"]) == ([first], [fourth])
    assert (plan.control_in["C"], plan.control_out["B"]) == ([second], [second, third])
    assert plan.names == ("B", "A", "C", "D")


def test_depths_of_data_count_the_longest_way() -> None:
    """A cycle has no start: modules in it or fed only by it have depth 0."""
    straight = data("B", "A") + data("C", "B") + data("D", "A") + data("D", "C") + data("D", "B")
    plan = planned(straight + data("X", "Y") + data("Y", "X") + data("Z", "X") + data("Y", "D"))
    assert plan.data_depth == {
        "A": 0, "B": 1, "C": 2, "D": 3, "X": 0, "Y": 4, "Z": 0,
    }  # fmt: skip


# ---- Kinds ---------------------------------------------------------------------------------------


def test_a_described_module_has_the_kind_of_its_services() -> None:
    moving_x = effector("M", "Rotn_X").functions
    both = Module("B", HERE, (Service("DataIn", HERE), Service("DataOut", HERE)))
    commanding = Module("C", HERE, (Service("DataIn", HERE), Service("ControlOut", HERE)))
    seeing = Module("S", HERE, (Service("DataIn", HERE), Service("Sense", HERE)))
    moving = Module("M", HERE, (Service("DataIn", HERE),), moving_x)
    named = sensor("DataSplitter1")
    turning = effector("E", "Rotn_X")
    bare = Module("Bare", HERE)
    plan = planned(
        data("B", "S") + data("C", "B") + data("M", "DataSplitter1") + control("E", "Bare"),
        both, commanding, seeing, moving, named, turning, bare,
    )  # fmt: skip
    kinds = {name: plan.kind(name) for name in plan.names}
    assert kinds == {
        "B": "data_out", "S": "sensor", "C": "control_out", "M": "sink",
        "DataSplitter1": "sensor", "E": "effector", "Bare": "control_out",
    }  # fmt: skip
    assert plan.services("E") == ()
    assert plan.services("ArbitrationNode") == ()
    assert plan.services("S") == seeing.services


def test_a_moving_or_carrying_module_is_an_effector() -> None:
    plan = planned(control("M", "E") + "M is_mounted_on Base\n", effector("E", "Rotn_X"))
    assert {name: plan.kind(name) for name in plan.names} == {
        "M": "effector",
        "E": "effector",
        "Base": "effector",
    }


def test_an_undescribed_module_has_the_kind_of_its_relationships() -> None:
    plan = planned(
        data("Filter", "Camera") + data("Planner", "Filter") + data("Display", "Filter")
        + control("Arm", "Planner") + data("Arm", "Filter") + data("Last", "DataSplitter1")
    )  # fmt: skip
    kinds = {name: plan.kind(name) for name in plan.names}
    assert kinds == {
        "Filter": "data_out", "Camera": "sensor", "Planner": "control_out", "Display": "sink",
        "Arm": "effector", "Last": "sink", "DataSplitter1": "data_splitter",
    }  # fmt: skip


# ---- Modes and rates -----------------------------------------------------------------------------


def test_a_module_offers_its_first_mode_or_the_one_of_its_single_client() -> None:
    several = sensor("S", "NotifyWhenReady | NotifyAtFrequency | RequestWhenReady", 20)
    ready, regular = mode("NotifyWhenReady"), mode("NotifyAtFrequency")
    for requested, expected in (
        ("", (ready, None)),
        (" NotifyAtFrequency", (regular, Fraction(20))),
        (" RequestWhenReady", (mode("RequestWhenReady"), None)),
        (" NotifyOnMax", (ready, None)),
        (" NotifyAtFrequency\nD uses_data_from S RequestWhenReady", (ready, None)),
        (" NotifyAtFrequency\nD uses_data_from S", (regular, Fraction(20))),
    ):
        assert planned(f"C uses_data_from S{requested}", several).offered("S") == expected, (
            requested
        )
    assert planned(data("C", "S"), sensor("S", "NotifyAtFrequency")).offered("S") == (regular, None)
    computed = planned(data("C", "S"), data_out("S", "NotifyAtFrequency", 4))
    assert computed.offered("S") == (regular, Fraction(4))
    assert planned(data("C", "S")).offered("S") == (ready, None)
    without = Module("S", HERE, (Service("DataIn", HERE), Service("DataOut", HERE)))
    assert planned(data("C", "S"), without).offered("S") == (ready, None)
    assert planned(data("C", "S"), sink("S")).offered("S") == (ready, None)
    taking = Module("S", HERE, (Service("DataIn", HERE), *computed.services("S")))
    assert planned(data("C", "S"), taking).offered("S") == (regular, Fraction(4))


def test_a_sensor_is_sampled_raw_for_a_condition() -> None:
    ready, regular = mode("NotifyWhenReady"), mode("NotifyAtFrequency")
    asking = mode("RequestWhenReady")
    for make in (sensor, data_out):
        assert planned(data("C", "S"), make("S", "NotifyOnMax")).made("S") == (ready, None)
        assert planned(data("C", "S"), make("S", "NotifyAtFrequency", 5)).made("S") == (
            regular,
            Fraction(5),
        )
        assert planned(data("C", "S"), make("S", "RequestWhenReady")).made("S") == (asking, None)


def test_a_link_carries_its_own_mode_or_the_one_of_its_source() -> None:
    ready, regular = mode("NotifyWhenReady"), mode("NotifyAtFrequency")
    chain = (
        data("DataSplitter1", "S") + data("DataTransformer1", "DataSplitter1")
        + "A uses_data_from DataTransformer1\nB uses_data_from DataSplitter1 NotifyAtFrequency\n"
        "C uses_data_from DataSplitter1 NotifyAtFrequency 2\nD uses_data_from DataSplitter1 "
        "RequestWhenReady"
    )  # fmt: skip
    plan = planned(chain, sensor("S", "NotifyAtFrequency", 10))
    assert plan.made("DataTransformer1") == plan.made("DataSplitter1") == (regular, Fraction(10))
    carried = {name: plan.carried(plan.data_in[name][0]) for name in "ABCD"}
    assert carried == {
        "A": (regular, Fraction(10)),
        "B": (regular, Fraction(10)),
        "C": (regular, Fraction(2)),
        "D": (mode("RequestWhenReady"), None),
    }
    # What the module itself offers is carried, though it only samples.
    plan = planned(data("C", "S"), sensor("S", "NotifyOnMax"))
    assert plan.carried(plan.links[0]) == (mode("NotifyOnMax"), None)
    plan = planned(data("C", "S") + data("B", "DataSplitter1"), data_out("S", "NotifyAtFrequency"))
    assert plan.carried(plan.links[0]) == (regular, None)
    assert plan.made("DataSplitter1") == plan.carried(plan.links[1]) == (ready, None)


def test_a_condition_of_a_link_drops_the_rate_of_its_source() -> None:
    plan = planned(
        data("DataSplitter1", "S") + "C uses_data_from DataSplitter1 NotifyOnMax",
        sensor("S", "NotifyAtFrequency", 10),
    )
    assert plan.carried(plan.links[1]) == (mode("NotifyOnMax"), None)


def test_the_mode_of_a_link_overrides_its_source() -> None:
    text = data("DataSplitter1", "S") + "C uses_data_from DataSplitter1 NotifyAtFrequency"
    plan = planned(text, sensor("S"))
    assert plan.carried(plan.links[1]) == (mode("NotifyAtFrequency"), None)
    ring = planned(
        "DataSplitter1 uses_data_from DataSplitter2 NotifyWhenReady\n"
        "DataSplitter2 uses_data_from DataSplitter1 NotifyWhenReady\n"
    )
    assert [ring.carried(each) for each in ring.links] == [(mode("NotifyWhenReady"), None)] * 2


def test_how_often_a_message_is_made() -> None:
    sampled = sensor("S", "NotifyAtFrequency", 10)
    assert planned(data("A", "S"), sampled, periods={"S": SECOND}).rate("S") == 10
    chain = data("A", "S") + "B uses_data_from A NotifyAtFrequency 4\n" + data("C", "B")
    plan = planned(chain, sampled)
    assert [plan.rate(name) for name in "SABC"] == [10, 10, 4, 4]
    plan = planned(chain + data("C", "A"), sampled, periods={"A": SECOND // 2, "B": None})
    assert [plan.rate(name) for name in "SABC"] == [10, 2, 4, None]
    for service in ("RequestWhenReady", "NotifyOnMax"):
        plan = planned(f"A uses_data_from S {service}", sampled)
        assert plan.rate("A") is None, service
    assert planned(data("A", "B") + data("B", "A")).rate("A") is None
    assert planned(data("A", "S"), sensor("S")).rate("A") is None
    assert planned(data("A", "S"), periods={"S": SECOND}).rate("A") == 1


# ---- Holds and depths ----------------------------------------------------------------------------


def test_a_command_stays_in_force_for_two_and_a_half_periods() -> None:
    text = PAIR.format(a="P", b="Q hold 70").replace("Q hold 70 2", "Q 2 hold 70")
    plan = planned(text + control("M", "ArbitrationNode"), periods={"P": SECOND // 10, "Q": 1})
    assert plan.hold(link(plan, "ArbitrationNode", "P")) == 250 * MILLISECOND
    assert plan.hold(link(plan, "ArbitrationNode", "Q")) == 70 * MILLISECOND
    plan = planned(text)
    assert plan.hold(link(plan, "ArbitrationNode", "P")) == DEFAULT_HOLD == 200 * MILLISECOND


@pytest.mark.parametrize("node", ["ControlSplitter1", "InheritanceNode1", "ArbitrationNode2"])
def test_a_hold_depends_on_the_period_of_the_module_before_the_nodes(node: str) -> None:
    text = PAIR.format(a=node, b="Q") + control("M", "ArbitrationNode")
    periods: dict[str, int | None] = {"P": SECOND // 5, "R": SECOND}
    alone = planned(text + control(node, "P"), periods=periods)
    assert alone.hold(link(alone, "ArbitrationNode", node)) == 500 * MILLISECOND
    two = planned(text + control(node, "P") + control(node, "R"), periods=periods)
    assert two.hold(link(two, "ArbitrationNode", node)) == DEFAULT_HOLD
    silent = planned(text, periods=periods)
    assert silent.hold(link(silent, "ArbitrationNode", node)) == DEFAULT_HOLD
    round_ = planned(text + control(node, "ControlSplitter3") + control("ControlSplitter3", node))
    assert round_.hold(link(round_, "ArbitrationNode", node)) == DEFAULT_HOLD


def test_depth_counts_the_arbiters_in_sequence() -> None:
    chain = (
        control("M", "ArbitrationNode") + PAIR.format(a="InheritanceNode1", b="Q")
        + control("InheritanceNode1", "ArbitrationNode2") + control("ArbitrationNode2", "P")
        + control("ArbitrationNode2", "R")
    )  # fmt: skip
    plan = planned(chain)
    names = ("P", "ArbitrationNode2", "InheritanceNode1", "ArbitrationNode", "M")
    assert [plan.depth(name) for name in names] == [0, 1, 1, 2, 2]
    ring = planned(
        control("ArbitrationNode", "ArbitrationNode2")
        + control("ArbitrationNode2", "ArbitrationNode")
    )
    assert ring.depth("ArbitrationNode") == 2


def test_names_that_reach_an_effector_without_another_arbiter() -> None:
    chain = (
        control("M", "ControlSplitter1") + control("ControlSplitter1", "ArbitrationNode")
        + control("ArbitrationNode", "ControlSplitter2") + control("ControlSplitter2", "P")
        + control("N", "InheritanceNode1") + control("InheritanceNode1", "P")
        + control("ControlSplitter3", "ControlSplitter4")
        + control("ControlSplitter4", "ControlSplitter3")
    )  # fmt: skip
    plan = planned(chain)
    reaching = {name for name in plan.names if plan.reaches_effector(name)}
    assert reaching == {"ControlSplitter1", "ArbitrationNode", "P", "InheritanceNode1"}
    plan = planned(
        chain.replace(
            control("N", "InheritanceNode1"), control("ArbitrationNode", "InheritanceNode1")
        )
    )
    reaching = {name for name in plan.names if plan.reaches_effector(name)}
    assert reaching == {"ControlSplitter1", "ArbitrationNode"}


# ---- InheritanceNodes ----------------------------------------------------------------------------

TOWER = """
High is_mounted_on Low
Cam is_mounted_on High
InheritanceNode1 is_controlled_by Pilot
Low is_controlled_by InheritanceNode1
{high} is_controlled_by InheritanceNode1
"""
TOWER_MODULES = (
    effector("Low", "Rotn_Y", "Trans_X"),
    effector("High", "Rotn_Y"),
    effector("Cam", "Rotn_Z"),
)


def test_providers_are_ordered_nearest_first() -> None:
    plan = planned(TOWER.format(high="High"), *TOWER_MODULES, control_out("Pilot", "Rotn_Y"))
    found = plan.providers("InheritanceNode1")
    assert [(name, each.client) for name, each in found.items()] == [
        ("High", "High"),
        ("Low", "Low"),
    ]
    through = TOWER.format(high="ControlSplitter1") + control("High", "ControlSplitter1")
    plan = planned(through, *TOWER_MODULES, control_out("Pilot", "Rotn_Y"))
    found = plan.providers("InheritanceNode1")
    assert [(name, each.client) for name, each in found.items()] == [
        ("High", "ControlSplitter1"),
        ("Low", "Low"),
    ]


def test_of_several_providers_each_must_be_described() -> None:
    text = TOWER.format(high="High")
    assert planned(text, *TOWER_MODULES).unknown_providers("InheritanceNode1") == []
    assert planned(text, TOWER_MODULES[0]).unknown_providers("InheritanceNode1") == ["High"]
    alone = text.replace("High is_controlled_by InheritanceNode1\n", "")
    assert planned(alone).unknown_providers("InheritanceNode1") == []


def test_a_module_that_carries_none_has_no_carriers() -> None:
    fixed = "\n".join(
        line for line in TOWER.format(high="High").splitlines() if "mount" not in line
    )
    plan = planned(fixed, *TOWER_MODULES)
    assert plan.carrying("InheritanceNode1", lambda _: {}) is None
    assert (
        planned(control("InheritanceNode1", "P")).carrying("InheritanceNode1", lambda _: {}) is None
    )
    plan = planned(TOWER.format(high="High"), *TOWER_MODULES, control_out("Pilot", "Rotn_Y"))
    carrying = plan.carrying("InheritanceNode1", lambda _: {})
    assert carrying is not None
    assert (carrying.name, list(carrying.carriers)) == ("Cam", ["High", "Low"])


def test_a_controller_of_a_module_and_its_node_leaves_motions_to_the_providers() -> None:
    """The camera turns itself about z; its carriers give all motions of the plane across y."""
    pilot = control_out("Pilot", "Rotn_Y", "Rotn_Z")
    apart = planned(TOWER.format(high="High"), *TOWER_MODULES, pilot)
    assert apart.led_by_both("InheritanceNode1") is None
    assert apart.left_to_providers() == {}
    text = TOWER.format(high="High") + control("Cam", "Pilot")
    both = planned(text, *TOWER_MODULES, pilot)
    assert both.led_by_both("InheritanceNode1") == "Cam"
    assert both.left_to_providers() == {"Cam": frozenset({"Rotn_Y", "Trans_X", "Trans_Z"})}
    other = planned(TOWER.format(high="High") + control("Cam", "Other"), *TOWER_MODULES, pilot)
    assert other.led_by_both("InheritanceNode1") is None
    assert other.left_to_providers() == {}


def test_an_arc_that_one_carrier_gives_is_left_to_it() -> None:
    """A rotation at a lever of 100 mm also translates, and yet the carrier provides it."""
    text = (
        "Cam is_mounted_on High (100,_,_)\nInheritanceNode1 is_controlled_by Pilot\n"
        "High is_controlled_by InheritanceNode1\nCam is_controlled_by Pilot"
    )
    modules = effector("High", "Rotn_Z"), effector("Cam", "Rotn_X")
    plan = planned(text, *modules, control_out("Pilot", "Rotn_X", "Rotn_Z"))
    assert plan.left_to_providers() == {"Cam": frozenset({"Rotn_Z"})}


def test_a_module_that_is_mounted_nowhere_leaves_nothing_to_providers() -> None:
    text = (
        "@specification\n@modules Loose, Base, Pilot, InheritanceNode1\n"
        "// InheritanceNode1: Loose\nInheritanceNode1 is_controlled_by Pilot\n"
        "Base is_controlled_by InheritanceNode1\nLoose is_controlled_by Pilot\n"
    )
    plan = Plan(parse_text(text, "s.mars").configuration, {}, {})
    assert plan.led_by_both("InheritanceNode1") == "Loose"
    assert plan.left_to_providers() == {"Loose": frozenset()}
