"""What declarations of predicates say of atoms, and of atoms that do not hold."""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple, TypeAlias

from mars_asp.asp.rules.declarations import SENTENCE_HOLE, Argument, Declaration
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.asp.units import UNITS, measured

#: A value of an argument that is left open.
OPEN = "_any"
_Index: TypeAlias = Mapping[tuple[Term, ...], Fact]


class _Form(NamedTuple):
    """A sentence for `%`, and its holes: the predicate of each, empty for its own, and argument."""

    text: str
    holes: tuple[tuple[str, str], ...]


class Told(NamedTuple):
    """A sentence, and the values that fill its holes as they are written in it."""

    sentence: str
    values: tuple[str, ...]


class Sentences:
    """Sentences about atoms; what these name is looked up among the given facts."""

    def __init__(
        self,
        declarations: Mapping[Signature, Declaration],
        facts: Mapping[str, Sequence[Fact]],
    ) -> None:
        """Prepare; `facts` are those given, by the names of their predicates."""
        self._declared = {(s.signed, s.arity): each for s, each in declarations.items()}
        self._named = {name: each for (name, _), each in self._declared.items()}
        self._ordering = [each for each in declarations.values() if each.orders is not None]
        self._facts = facts
        self._found: dict[tuple[str, tuple[int, ...]], _Index] = {}

    def says(self, atom: Atom) -> Told | None:
        """Return the sentence of an atom; `None` where nobody declares one."""
        declared = self._declared.get((atom.name, len(atom.arguments)))
        return None if declared is None else self._first(declared.says, declared, atom)

    def unless(self, pattern: Atom) -> str | None:
        """Return the sentence of an atom that does not hold, where `OPEN` arguments are any.

        It is `None` where nobody declares one for what is not open.
        """
        declared = self._declared.get((pattern.name, len(pattern.arguments)))
        found = None if declared is None else self._first(declared.unless, declared, pattern)
        return None if found is None else found.sentence

    def rank(self, atom: Atom) -> int | None:
        """Return the number that orders what an atom is about; `None` where nothing does."""
        own = self._declared.get((atom.name, len(atom.arguments)))
        for ordering in self._ordering if own is not None else ():
            assert own is not None and ordering.orders is not None
            fact = self._joined(ordering, own, atom)
            number = None if fact is None else fact.atom.arguments[ordering.orders]
            if isinstance(number, int):
                return number
        return None

    def _first(self, sentences: Sequence[str], declared: Declaration, atom: Atom) -> Told | None:
        for sentence in sentences:
            form = _form(sentence)
            values = tuple(self._values(form, declared, atom))
            if None not in values:
                written = tuple(filter(None, values))
                return Told(form.text % written, written)
        return None

    def _values(self, form: _Form, declared: Declaration, atom: Atom) -> Iterator[str | None]:
        for predicate, name in form.holes:
            other, about = declared, atom
            if predicate:
                found = self._named.get(predicate)
                fact = None if found is None else self._joined(found, declared, atom)
                if found is None or fact is None:
                    yield None
                    continue
                other, about = found, fact.atom
            at = next((n for n, each in enumerate(other.arguments) if each.name == name), None)
            yield None if at is None else _written(about.arguments[at], other.arguments[at])

    def _joined(self, other: Declaration, own: Declaration, atom: Atom) -> Fact | None:
        """Return the fact of another predicate with the arguments that are named alike."""
        values = {
            argument.name: value
            for argument, value in zip(own.arguments, atom.arguments, strict=True)
            if not _is_open(value)
        }
        places = tuple(n for n, each in enumerate(other.arguments) if each.name in values)
        if not places:
            return None
        key = tuple(values[other.arguments[place].name] for place in places)
        return self._by_values(other.name, len(other.arguments), places).get(key)

    def _by_values(self, name: str, arity: int, places: tuple[int, ...]) -> _Index:
        if (name, places) not in self._found:
            index: dict[tuple[Term, ...], Fact] = {}
            for fact in self._facts.get(name, ()):
                arguments = fact.atom.arguments
                if len(arguments) == arity:
                    index.setdefault(tuple(arguments[place] for place in places), fact)
            self._found[name, places] = index
        return self._found[name, places]


@cache
def _form(sentence: str) -> _Form:
    holes = tuple((m[1] or "", m[2]) for m in re.finditer(SENTENCE_HOLE, sentence))
    return _Form(re.sub(SENTENCE_HOLE, "%s", sentence.replace("%", "%%")), holes)


def _is_open(value: Term) -> bool:
    return isinstance(value, Atom) and value.name == OPEN


def _written(value: Term, argument: Argument) -> str | None:
    """Return a value as people read it; `None` where it is open, or a term of the encoding."""
    if isinstance(value, int):
        unit = next((sort for sort in argument.sorts if sort in UNITS), None)
        return str(value) if unit is None else measured(value, unit)
    if isinstance(value, str):
        return value
    if value.name == OPEN:
        return None
    if not value.arguments:
        return value.name.replace("_", " ")
    # Of a term that stands for something written, what is written.
    return " ".join(each for each in value.arguments if each and isinstance(each, str)) or None
