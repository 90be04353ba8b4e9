"""Derivation traces as plain values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TypeAlias

import clingo

from mars_asp.asp.messages import fill, shown
from mars_asp.asp.rules.declarations import Origin
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, text
from mars_asp.diagnostic import Span


@dataclass(frozen=True, slots=True)
class Given:
    """A fact and where it comes from; no place where nobody knows it.

    What was computed has the place of what it was computed from.
    """

    atom: str
    span: Span | None
    origin: Origin = "stated"


@dataclass(frozen=True, slots=True)
class Absent:
    """A premise `not atom` that holds because the atom does not; `_` stands for anything."""

    atom: str


@dataclass(frozen=True, slots=True, eq=False)
class Derived:
    """An atom that one firing of a rule gives.

    `chosen` is true where the rule only offers the atom and least cost picked it. `head` is the
    atom and `values` what the variables stand for, `v(n("X",...),1,...)`. Premises that several
    traces share are the same object.

    `others` are the other derivations of the atom, where they were asked for: all firings of which
    the premises stand without the atom. Premises alone never lead back to the atom; those of
    `others` can, for each has a derivation without it, but the one of least height may be another.
    """

    head: TermId
    rule: Rule
    values: TermId
    premises: tuple["Trace", ...]
    chosen: bool = False
    others: Sequence["Derived"] = ()

    # Written out when somebody asks: of many thousands of steps a reader sees few.
    @property
    def atom(self) -> str:
        """Return the text of the atom."""
        return text(self.head)

    @property
    def bindings(self) -> Mapping[str, clingo.Symbol]:
        """Return what the variables stand for."""
        return bindings_of(self.values)

    @property
    def message(self) -> str | None:
        """Return the rule's message, its holes filled; `None` where the rule has none."""
        return fill(self.rule.because, _terms_of(self.values), _shown)


@dataclass(frozen=True, slots=True)
class Unexplained:
    """A true atom that no rule with a supported construct gives; `reason` names what is missing."""

    atom: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """The nearest that a rule comes to an absent `atom`.

    `fails` is the literal that is false for these bindings, `value` what its aggregate amounts
    to; `cause` says why it is false, and `held` are premises that do hold. Where `fails` is
    `None`, a choice could give the atom and does not.
    """

    atom: str
    rule: Rule
    message: str | None
    bindings: Mapping[str, clingo.Symbol]
    fails: str | None
    value: clingo.Symbol | None
    cause: "Trace | None"
    held: tuple["Trace", ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Missing:
    """An atom that does not hold, with the nearest that each rule comes; `_` is any value.

    `followed` is false where no more was asked, as beyond a depth.
    """

    atom: str
    attempts: tuple[Attempt, ...]
    followed: bool = True


def bindings_of(values: TermId) -> dict[str, clingo.Symbol]:
    """Return what variables stand for, of a term `v(n("X",...),1,...)`."""
    return {name: as_symbol(value) for name, value in _terms_of(values).items()}


def _terms_of(values: TermId) -> dict[str, TermId]:
    names, *found = arguments(values)
    return dict(zip(_strings(names), found, strict=True))


@cache
def _strings(names: TermId) -> tuple[str, ...]:
    return tuple(as_symbol(name).string for name in arguments(names))


# The same few names stand in the messages of very many steps.
@lru_cache(maxsize=100_000)
def _shown(value: TermId) -> str:
    return shown(as_symbol(value))


Trace: TypeAlias = Given | Absent | Derived | Unexplained | Missing
