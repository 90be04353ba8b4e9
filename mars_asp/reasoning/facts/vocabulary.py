"""What `rules/vocabulary.lp` declares of given predicates, for those who look for their facts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # Who reads a configuration alone needs no rules.
    from mars_asp.asp.rules.declarations import Declaration
    from mars_asp.asp.rules.rulebook import Rulebook
    from mars_asp.asp.signature import Signature

#: Sorts of which each value belongs to one thing in a configuration.
IDENTIFYING = ("relationship", "annotation", "module")
#: Sorts of numbers that users state, however large.
UNBOUNDED = ("millihertz", "milliseconds", "priority", "cost")


@dataclass(frozen=True)
class Vocabulary:
    """The given predicates of configurations, by name and arity."""

    declarations: "Mapping[Signature, Declaration]"

    @cached_property
    def by_thing(self) -> Mapping[str, tuple[int, ...]]:
        """Return the predicates whose facts are found by the things that they name.

        By their names, the positions from 0 of arguments that identify a thing. What is computed
        is computed of all things together.
        """
        return {
            each.name: places
            for each in self.declarations.values()
            if each.origin == "stated" and (places := each.places(*IDENTIFYING))
        }

    @cached_property
    def keys(self) -> "Mapping[Signature, Sequence[int]]":
        """Return the positions of the arguments by which facts are found, of all predicates.

        Where all facts of a predicate are made together, any argument finds them.
        """
        return {each: self.by_thing.get(each.name, range(each.arity)) for each in self.declarations}

    @cached_property
    def connected(self) -> "Mapping[Signature, tuple[int, ...]]":
        """Return the positions of what a fact brings together.

        They are modules, relationships and annotations of one part of a configuration.
        """
        return {
            signature: self.by_thing.get(signature.name, ()) if each.joins else ()
            for signature, each in self.declarations.items()
        }


def vocabulary(rulebook: "Rulebook") -> Vocabulary:
    """Return what the rules of the base are given, as they declare it; packs are given no more."""
    declared = rulebook.built_in.declared_in("base")
    return Vocabulary({each.signature: each for each in declared if each.origin is not None})


def unbounded(declared: "Iterable[Declaration]") -> "Mapping[Signature, tuple[int, ...]]":
    """Return the positions from 0 of numbers that a user states, however large."""
    stated = (each for each in declared if each.origin == "stated")
    return {each.signature: places for each in stated if (places := each.places(*UNBOUNDED))}
