"""What `rules/vocabulary.lp` and others declare of given predicates, for those who give facts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mars_asp.asp.units import NUMBERS

if TYPE_CHECKING:
    # Who reads a configuration alone needs no rules.
    from mars_asp.asp.lint.values import Form
    from mars_asp.asp.rules.declarations import Declaration, Docstring, Origin
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.signature import Signature

#: Sorts of which each value belongs to one thing in a configuration.
IDENTIFYING = ("relationship", "annotation", "module")
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
THINGS = frozenset((*IDENTIFYING, "representation"))


class Given(NamedTuple):
    """A given predicate, and where its facts come from.

    `places` are the positions from 0 of the arguments by which its facts are found one by one, none
    where they are made together: what is computed is computed of all things. `joins` is whether a
    fact brings together what it names.
    """

    signature: "Signature"
    origin: "Origin"
    places: tuple[int, ...]
    joins: bool


@dataclass(frozen=True)
class Vocabulary:
    """The given predicates of configurations."""

    given: tuple[Given, ...]

    @cached_property
    def by_thing(self) -> Mapping[str, tuple[int, ...]]:
        """Return, by their names, the predicates whose facts are found by the things they name."""
        return {each.signature.name: each.places for each in self.given if each.places}

    @cached_property
    def keys(self) -> "Mapping[Signature, Sequence[int]]":
        """Return the positions of the arguments by which facts are found, of all predicates.

        Where all facts of a predicate are made together, any argument finds them.
        """
        return {each.signature: each.places or range(each.signature.arity) for each in self.given}

    @cached_property
    def connected(self) -> "Mapping[Signature, tuple[int, ...]]":
        """Return the positions of what a fact brings together.

        They are modules, relationships and annotations of one part of a configuration.
        """
        return {each.signature: each.places if each.joins else () for each in self.given}


def vocabulary(rulebook: "Rulebook") -> Vocabulary:
    """Return what rules are given: what those of the base declare, and attributes of packs."""
    given = given_in(rulebook.built_in, "base")
    packs = rulebook.documented[len(rulebook.documented) - rulebook.packs :]
    found = {
        each.signature: _given_by(each, "stated")
        for file in packs
        for each in file.declarations
        if each.attribution is not None
    }
    return Vocabulary((*given, *found.values()))


def given_in(rulebook: "Rulebook", *stages: str) -> tuple[Given, ...]:
    """Return the given predicates that files of some stages declare, made when we are built."""
    from mars_asp.asp.cache import made_of  # noqa: PLC0415 -- with rules alone
    from mars_asp.asp.rules import declarations  # noqa: PLC0415

    told = tuple(
        docstring
        for file in rulebook.documented
        if file.stage in stages
        for docstring in file.docstrings
    )
    makers = map(Path, (__file__, declarations.__file__))
    return made_of("given", makers, [told], _given)[told]


def _given(told: "tuple[Docstring, ...]") -> tuple[Given, ...]:
    from mars_asp.asp.rules.declarations import declarations  # noqa: PLC0415

    return tuple(
        _given_by(each, each.origin)
        for each in declarations(told, "rules", [])
        if each.origin is not None
    )


def _given_by(each: "Declaration", origin: "Origin") -> Given:
    places = each.places(*IDENTIFYING) if origin == "stated" else ()
    return Given(each.signature, origin, places, each.joins)


def unbounded(declared: "Iterable[Declaration]") -> "Mapping[Signature, tuple[int, ...]]":
    """Return the positions from 0 of numbers that a user states, however large."""
    stated = (each for each in declared if each.origin == "stated")
    return {each.signature: places for each in stated if (places := _unbounded(each))}


def _unbounded(each: "Declaration") -> tuple[int, ...]:
    # Of an attribute of a pack any number may be stated.
    return each.places(*UNBOUNDED, *(NUMBERS if each.attribution else ()))
