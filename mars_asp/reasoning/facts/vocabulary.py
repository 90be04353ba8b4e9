"""The predicates of facts, as `rules/vocabulary.lp` and other rule files declare them."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.asp.units import NUMBERS

if TYPE_CHECKING:
    # Reading a configuration needs no rules.
    from mars_asp.asp.lint.values import Form
    from mars_asp.asp.rules.declarations import Declaration
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.rules.statements import Piece
    from mars_asp.asp.signature import Signature

#: Sorts of numbers that users state, however large.
UNBOUNDED = ("millihertz", "milliseconds", "priority", "cost")
#: The forms of the values of sorts other than measures; the forms of further sorts are unknown.
FORMS: "Mapping[str, Form]" = {
    **dict.fromkeys(("relationship", "annotation", "index", "vertex", "walk", "sign"), "number"),
    **dict.fromkeys(("priority", "cost", "count", "line", "column"), "number"),
    **dict.fromkeys(("module", "representation", "function", "text", "robot"), "string"),
    **dict.fromkeys(("mode", "term"), "function"),
    "kind": "name",
}
#: Sorts whose number of values grows with the configuration.
THINGS = frozenset({"relationship", "annotation", "module", "representation"})


def given_in(rulebook: "Rulebook", *stages: str) -> "tuple[Signature, ...]":
    """Return the predicates that the rule files of some stages declare as input facts."""
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


def _given(docstrings: "tuple[Piece, ...]") -> "tuple[Signature, ...]":
    from mars_asp.asp.rules.declarations import declarations  # noqa: PLC0415

    declared = declarations(docstrings, "rules", [])
    return tuple(each.signature for each in declared if each.origin is not None)


def unbounded(declared: "Iterable[Declaration]") -> "Mapping[Signature, tuple[int, ...]]":
    """Return the positions, from 0, of arguments that are numbers of any size stated by a user."""
    given = (each for each in declared if each.origin == "stated")
    # An attribute of a pack can be any number.
    return {
        each.signature: places
        for each in given
        if (places := each.places(*UNBOUNDED, *(NUMBERS if each.attribution else ())))
    }
