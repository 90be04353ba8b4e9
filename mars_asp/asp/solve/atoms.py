"""Ground atoms and facts, apart from clingo's own symbols."""

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
        """Return the atom as clingo reads it."""
        if not self.arguments and self.name:
            return self.name
        inside = ",".join(map(term_text, self.arguments))
        if not self.name and len(self.arguments) == 1:
            inside += ","
        return f"{self.name}({inside})"


def term_text(term: Term) -> str:
    r"""Return a term as clingo reads it: strings quoted, with `\\`, `\"` and `\n` escaped."""
    if isinstance(term, str):
        escaped = term.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{escaped}"'
    return str(term)


class Fact(NamedTuple):
    """A given atom and where it comes from."""

    atom: Atom
    span: Span
