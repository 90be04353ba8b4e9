"""Muxes that feed muxes: of each cascade one mux, whose order is that of the whole.

An input of the outer mux that is the output of an inner one gives place to the inputs of that, in
their order. Where the outer numbers leave no room for them, those above are lifted.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from mars_asp.model.declarations import FOREVER, Inner
from mars_asp.model.graph import Mux, MuxInput
from mars_asp.model.ranges import MOST


def is_plain(mux: Mux) -> bool:
    """Whether each input of a mux can win and has a finite hold, so only their order matters."""
    return all(each.priority > 0 and each.hold_ms != FOREVER for each in mux.inputs)


def merged(outer: Mux, slot: MuxInput, inner: Mux) -> Mux | None:
    """Return `outer` with the inputs of `inner` in place of its input `slot`; None if impossible.

    It is impossible if the engines differ, a mux has locks (they state numbers of one mux), `inner`
    is not plain, another input has the priority of `slot`, or a priority would be too high.
    """
    ties = sum(each.priority == slot.priority for each in outer.inputs) > 1
    ranks = sorted({each.priority for each in inner.inputs}) or [slot.priority]
    if ties or outer.engine != inner.engine or not is_plain(inner) or outer.locks or inner.locks:
        return None
    higher = [each.priority for each in outer.inputs if each.priority > slot.priority]
    lower = [each.priority for each in outer.inputs if each.priority < slot.priority]
    ceiling = min(higher, default=MOST + 1)
    # Priorities stay as written where they already give the order of the cascade.
    fits = max(lower, default=-1) < ranks[0] and ranks[-1] < ceiling
    lift = 0 if fits else max(0, len(ranks) - (ceiling - slot.priority))
    if max(higher, default=0) + lift > MOST or slot.priority + len(ranks) - 1 > MOST:
        return None

    def lifted(number: int) -> int:
        return number + lift * (number > slot.priority)

    def placed(number: int) -> int:
        return number if fits else slot.priority + ranks.index(number)

    raised, taken = _numbered(outer, lifted), _numbered(inner, placed)
    numbers = tuple(pair for pair in raised.numbers if pair[0] != slot.priority)
    written = dict(raised.numbers)[slot.priority]
    within = Inner(inner.span, written, taken.numbers, taken.inner, inner.name, slot.topic)
    inputs = [each for each in raised.inputs if each.priority != slot.priority]
    at = [each.priority for each in outer.inputs].index(slot.priority)
    return replace(
        outer,
        inputs=(*inputs[:at], *taken.inputs, *inputs[at:]),
        numbers=numbers,
        inner=(*raised.inner, within),
    )


def _numbered(mux: Mux, number: Callable[[int], int]) -> Mux:
    """Return a mux whose priorities are mapped by `number`; it remembers the written ones."""
    own = mux.numbers or tuple({each.priority: each.priority for each in mux.inputs}.items())
    return replace(
        mux,
        inputs=tuple(replace(each, priority=number(each.priority)) for each in mux.inputs),
        numbers=tuple((number(now), before) for now, before in own),
        inner=_inner(mux.inner, number),
    )


def _inner(found: Sequence[Inner], number: Callable[[int], int]) -> tuple[Inner, ...]:
    return tuple(
        replace(
            each,
            numbers=tuple((number(now), before) for now, before in each.numbers),
            inner=_inner(each.inner, number),
        )
        for each in found
    )
