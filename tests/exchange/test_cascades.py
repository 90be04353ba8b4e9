"""Muxes that feed muxes: one order in the configuration, and all of them in the specification."""

from dataclasses import replace

import pytest

from mars_asp.exchange.lift import lifted
from mars_asp.exchange.topics import configuration_of
from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import FOREVER
from mars_asp.model.graph import Graph, Mux, Relay
from tests.exchange.test_topics import at, mux, node

BASE = node("base", "", "cb")


def lines(*muxes: Mux, relays: tuple[Relay, ...] = (), lift: bool = False) -> list[str]:
    graph = Graph("x", (BASE, node("n", "cn")), muxes, relays=relays)
    found = configuration_of(graph)[0]
    result = (lifted(found) if lift else found).relationships
    return [print_relationship(line).removesuffix(" hold 500") for line in result]


#: The outer mux's inputs, the inner one's, and how the base is controlled.
ORDERS = [
    ((("cm", 5), ("ck", 50)), (("cn", 10), ("cr", 20)), {"/n 10", "cr 20", "ck 50"}),
    ((("cm", 5), ("ck", 6)), (("cn", 10), ("cr", 20)), {"/n 5", "cr 6", "ck 7"}),
    ((("ck", 3), ("cm", 5)), (("cn", 1), ("cr", 2)), {"/n 5", "cr 6", "ck 3"}),
    ((("cm", 5),), (("cn", 7), ("cr", 7)), {"/n 7", "cr 7"}),
]


@pytest.mark.parametrize(("outer", "inner", "expected"), ORDERS)
def test_the_order_of_a_cascade_is_that_of_one_mux(
    outer: tuple[tuple[str, int], ...], inner: tuple[tuple[str, int], ...], expected: set[str]
) -> None:
    found = lines(mux("o", "cb", *outer), mux("i", "cm", *inner))
    assert set(found) == {f"/base is_controlled_by {each}" for each in expected}


def test_the_specification_has_each_mux_with_the_numbers_that_are_written() -> None:
    outer = mux("o", "cb", ("cm", 5), ("ck", 6))
    inner = mux("i", "cm", ("cn", 10), ("ci", 20))
    third = mux("t", "ci", ("cr", 8), ("cs", 9))
    assert set(lines(outer, inner, third, lift=True)) == {
        "/base is_controlled_by ArbitrationNode",
        "ArbitrationNode is_controlled_by ArbitrationNode2 5",
        "ArbitrationNode is_controlled_by ck 6",
        "ArbitrationNode2 is_controlled_by /n 10",
        "ArbitrationNode2 is_controlled_by ArbitrationNode3 20",
        "ArbitrationNode3 is_controlled_by cr 8",
        "ArbitrationNode3 is_controlled_by cs 9",
    }


def test_a_mux_that_decides_differently_stays_apart() -> None:
    outer, inner = mux("o", "cb", ("cm", 5)), mux("i", "cm", ("cn", 10))
    kept = {"/base is_controlled_by /i 5", "/i is_controlled_by /n 10"}
    forever = replace(inner, inputs=(replace(inner.inputs[0], hold_ms=FOREVER),))
    assert "/i is_controlled_by /n 10 hold forever" in lines(outer, forever)
    assert set(lines(outer, replace(inner, engine="cmd_vel_mux"))) == kept
    never = mux("i", "cm", ("cn", 0))
    assert "/i is_controlled_by /n 0" in lines(outer, never)
    tied = mux("o", "cb", ("cm", 5), ("ck", 5))
    assert kept < set(lines(tied, inner))
    # Another publisher shares the input, with the inner mux as a whole.
    shared = mux("o", "cb", ("cn", 5))
    assert "/i is_controlled_by ck 7" in lines(shared, mux("i", "cn", ("ck", 7)))


def test_muxes_in_a_circle_come_to_an_end() -> None:
    first, second = mux("o", "ca", ("cb", 5)), mux("i", "cb", ("ca", 5))
    assert lines(first, second)
    assert lines(mux("o", "ca", ("ca", 5)))


def test_a_relay_between_two_muxes_is_a_renaming() -> None:
    relays = (Relay("/r", at(80), "/cm", "/cq"),)
    muxes = mux("o", "cb", ("cq", 5)), mux("i", "cm", ("cn", 7), ("cr", 9))
    assert set(lines(*muxes, relays=relays)) == {
        "/base is_controlled_by /n 7",
        "/base is_controlled_by cr 9",
    }
