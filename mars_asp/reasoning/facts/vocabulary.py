"""What `rules/vocabulary.lp` and others declare of given predicates, for those who give facts."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.asp.units import NUMBERS

if TYPE_CHECKING:
    # Who reads a configuration alone needs no rules.
    from mars_asp.asp.lint.values import Form
    from mars_asp.asp.rules.declarations import Declaration, Docstring
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.signature import Signature

#: Sorts of numbers that users state, however large.
UNBOUNDED = ("millihertz", "milliseconds", "priority", "cost")
#: What the values of sorts are that are no measures; of others it is not known.
FORMS: "Mapping[str, Form]" = {
    **dict.fromkeys(("relationship", "annotation", "index", "vertex", "walk", "sign"), "number"),
    **dict.fromkeys(("priority", "cost", "count", "line", "column"), "number"),
    **dict.fromkeys(("module", "representation", "function", "text", "robot"), "string"),
    **dict.fromkeys(("mode", "term"), "function"),
    "kind": "name",
}
#: Sorts of which a configuration has as many values as it is large.
THINGS = frozenset({"relationship", "annotation", "module", "representation"})


def given_in(rulebook: "Rulebook", *stages: str) -> "tuple[Signature, ...]":
    """Return the given predicates that files of some stages declare, from a table of the build."""
    from mars_asp.asp.cache import memoized  # noqa: PLC0415 -- with rules alone
    from mars_asp.asp.rules import declarations  # noqa: PLC0415

    docstrings = tuple(
        docstring
        for file in rulebook.documented
        if file.stage in stages
        for docstring in file.docstrings
    )
    makers = map(Path, (__file__, declarations.__file__))
    return memoized("given", makers, [docstrings], _given)[docstrings]


def _given(docstrings: "tuple[Docstring, ...]") -> "tuple[Signature, ...]":
    from mars_asp.asp.rules.declarations import declarations  # noqa: PLC0415

    declared = declarations(docstrings, "rules", [])
    return tuple(each.signature for each in declared if each.origin is not None)


def unbounded(declared: "Iterable[Declaration]") -> "Mapping[Signature, tuple[int, ...]]":
    """Return the positions from 0 of numbers that a user states, however large."""
    given = (each for each in declared if each.origin == "stated")
    # Any number may be stated of an attribute of a pack.
    return {
        each.signature: places
        for each in given
        if (places := each.places(*UNBOUNDED, *(NUMBERS if each.attribution else ())))
    }
