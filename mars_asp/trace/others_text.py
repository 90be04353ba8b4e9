"""What is said of an atom's several derivations to tell them apart."""

from mars_asp.analysis import shown
from mars_asp.trace.values import Derived


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
        names = [name for name in group[0].bindings if _differs(name, group)]
        for one in group:
            pairs = [f"{name} = {shown(one.bindings[name])}" for name in names]
            values[id(one)] = f" for {', '.join(pairs)}" if pairs else ""
    return {
        id(one): f"derivation {number} of {len(every)}{values[id(one)]}"
        for number, one in enumerate(every, 1)
    }


def _differs(name: str, group: list[Derived]) -> bool:
    return len({one.bindings.get(name) for one in group}) > 1
