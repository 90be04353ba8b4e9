"""What is said of an atom's several derivations to tell them apart."""

from collections.abc import Mapping, Sequence

import clingo

from mars_asp.asp.messages import shown
from mars_asp.asp.trace.tree import Derived


def numbered(step: Derived) -> dict[int, str]:
    """Return what is said of a step and of its others, by their `id`: `derivation 1 of 2`.

    Where the same rule says the same in several, the values that are not the same in all of these
    follow.
    """
    every = (step, *step.others)
    alike: dict[tuple[int, str | None], list[Derived]] = {}
    for one in every:
        alike.setdefault((id(one.rule), one.message), []).append(one)
    values: dict[int, str] = {}
    for group in alike.values():
        bindings = [one.bindings for one in group]
        names = [name for name in bindings[0] if _differs(name, bindings)]
        for one, bound in zip(group, bindings, strict=True):
            pairs = [f"{name} = {shown(bound[name])}" for name in names]
            values[id(one)] = f" for {', '.join(pairs)}" if pairs else ""
    return {
        id(one): f"derivation {number} of {len(every)}{values[id(one)]}"
        for number, one in enumerate(every, 1)
    }


def _differs(name: str, bindings: Sequence[Mapping[str, clingo.Symbol]]) -> bool:
    return len({bound.get(name) for bound in bindings}) > 1
