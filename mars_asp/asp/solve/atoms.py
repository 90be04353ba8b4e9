"""Ground atoms and facts, apart from clingo's own symbols."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from mars_asp.diagnostic import Span

Term: TypeAlias = "int | str | Atom"


class Atom(NamedTuple):
    """A ground atom or function term; an `int` is a number, a `str` an ASP string.

    A constant is an atom without arguments; a tuple is an atom without a name.
    """

    name: str
    arguments: tuple[Term, ...] = ()

    def __str__(self) -> str:
        """Return the atom in clingo's syntax."""
        return function_text(self.name, [term_text(each) for each in self.arguments])


def function_text(name: str, arguments: Sequence[str]) -> str:
    """Return a constant, function or tuple in clingo's syntax; a tuple has no name."""
    if not arguments and name:
        return name
    comma = "," if not name and len(arguments) == 1 else ""
    return f"{name}({','.join(arguments)}{comma})"


def term_text(term: Term) -> str:
    r"""Return a term in clingo's syntax: strings quoted, with `\\`, `\"` and `\n` escaped."""
    if isinstance(term, str):
        escaped = term.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{escaped}"'
    return str(term)


class Fact(NamedTuple):
    """A given atom and its location."""

    atom: Atom
    span: Span


def fact_at(span: Span, name: str, *arguments: Term) -> Fact:
    """Return the fact `name(arguments)` with its location."""
    return Fact(Atom(name, arguments), span)
