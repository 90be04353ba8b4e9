"""Derivation traces as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import clingo

from mars_asp.rulebook import Rule
from mars_asp.source import Span


@dataclass(frozen=True, slots=True)
class Given:
    """A fact and where it comes from; no place where nobody knows it."""

    atom: str
    span: Span | None


@dataclass(frozen=True, slots=True)
class Absent:
    """A premise `not atom` that holds because the atom does not; `_` stands for anything."""

    atom: str


@dataclass(frozen=True, slots=True, eq=False)
class Derived:
    """An atom that one firing of a rule gives.

    `chosen` is true where the rule only offers the atom and least cost picked it. `message` is
    the rule's, its holes filled; `None` where the rule has none. Premises that several traces
    share are the same object.
    """

    atom: str
    rule: Rule
    message: str | None
    bindings: Mapping[str, clingo.Symbol]
    premises: tuple["Trace", ...]
    chosen: bool = False


@dataclass(frozen=True, slots=True)
class Unexplained:
    """A true atom that no rule with a supported construct gives; `reason` names what is missing."""

    atom: str
    reason: str


Trace: TypeAlias = Given | Absent | Derived | Unexplained
