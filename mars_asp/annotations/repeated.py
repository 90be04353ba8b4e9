"""Modules that are annotated more than once, in files of sources or in module blocks."""

from collections.abc import Iterable, Iterator

from mars_asp.diagnostic import Diagnostic
from mars_asp.model.declarations import Module

#: The maximal number of locations that are shown for one name.
_MOST_PLACES = 5


def repeated(modules: Iterable[Module]) -> Iterator[Diagnostic]:
    """Yield one error for each name that several modules have."""
    found: dict[str, list[Module]] = {}
    for module in modules:
        found.setdefault(module.name, []).append(module)
    for name, (first, *again) in found.items():
        if not again:
            continue
        times = "twice" if len(again) == 1 else f"{len(again) + 1} times"
        places = [module.named or module.span for module in again]
        yield Diagnostic(
            "MARS121",
            "error",
            f"module `{name}` is annotated {times}, first at {first.span.path}:{first.span.line}",
            places[0],
            (
                (first.span, "first annotated here"),
                *((place, "and here") for place in places[1:_MOST_PLACES]),
            ),
            "give each a different name" if places[1:] else "give one of the two a different name",
        )
