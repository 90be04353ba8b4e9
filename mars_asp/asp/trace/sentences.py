"""Sentences for atoms and for absent atoms, from declarations of predicates."""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

from mars_asp.asp.rules.declarations import SENTENCE_HOLE, Declaration, PredicateArgument
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.asp.units import UNITS, measured, measured_alike

#: The value of an open argument.
OPEN = "_any"
_Index: TypeAlias = Mapping[tuple[Term, ...], Fact]


class _Hole(NamedTuple):
    """A hole of a sentence: an argument of the atom, or of a fact of the predicate `other`."""

    other: Declaration | None
    place: int
    argument: PredicateArgument


class _Form(NamedTuple):
    """A sentence as a `%` template, and its holes."""

    text: str
    holes: tuple[_Hole, ...]


class Sentence(NamedTuple):
    """A sentence, and the texts that fill its holes."""

    sentence: str
    values: tuple[str, ...]


class Sentences:
    """Writes sentences about atoms; values of other predicates come from the given facts."""

    def __init__(
        self,
        declarations: Mapping[Signature, Declaration],
        facts: Mapping[str, Sequence[Fact]],
    ) -> None:
        """Begin with declarations of predicates, and given facts by predicate name."""
        self._declared = {(s.signed, s.arity): each for s, each in declarations.items()}
        self._named = {name: each for (name, _), each in self._declared.items()}
        self._ordering = [each for each in declarations.values() if each.orders is not None]
        self._facts = facts
        self._found: dict[tuple[str, tuple[int, ...]], _Index] = {}
        self._alike: dict[tuple[int, int], tuple[tuple[int, int], ...]] = {}
        self._forms: dict[tuple[str, int, str], _Form | None] = {}

    def says(self, atom: Atom) -> Sentence | None:
        """Return the sentence of an atom, or None if none is declared."""
        declared = self._declared.get((atom.name, len(atom.arguments)))
        return None if declared is None else self._first(declared.says, declared, atom)

    def unless(self, pattern: Atom) -> str | None:
        """Return the sentence of an absence, in which `OPEN` arguments are any value.

        It is None if each declared sentence needs the value of such an argument.
        """
        declared = self._declared.get((pattern.name, len(pattern.arguments)))
        if declared is None:
            return None
        found = self._first(declared.unless, declared, pattern)
        return self._another_value(declared, pattern) or (found and found.sentence)

    def _another_value(self, declared: Declaration, pattern: Atom) -> str | None:
        """Return the sentence that a property has another value than the absent one, or None."""
        if declared.attribution is None or len(declared.arguments) != 2:
            return None
        thing, wanted = pattern.arguments
        fact = self._by_values(declared.name, 2, (0,)).get((thing,))
        if fact is None or _is_open(wanted) or fact.atom.arguments[1] == wanted:
            return None
        argument, values = declared.arguments[1], (fact.atom.arguments[1], wanted)
        sort = next((each for each in argument.sorts if each in UNITS), None)
        numbers = [each for each in values if isinstance(each, int)]
        words: Sequence[str | None]
        if sort is not None and len(numbers) == 2:
            words = measured_alike(numbers, sort)
        else:
            words = [_readable_value(value, argument) for value in values]
        return f"`{declared.name}` of `{thing}` is {words[0]}, not {words[1]}"

    def rank(self, atom: Atom) -> int | None:
        """Return the number by which an atom's thing is ordered, None without an order."""
        own = self._declared.get((atom.name, len(atom.arguments)))
        for ordering in self._ordering if own is not None else ():
            assert own is not None and ordering.orders is not None
            fact = self._joined(ordering, own, atom)
            number = None if fact is None else fact.atom.arguments[ordering.orders]
            if isinstance(number, int):
                return number
        return None

    def _first(
        self, sentences: Sequence[str], declared: Declaration, atom: Atom
    ) -> Sentence | None:
        for sentence in sentences:
            key = declared.name, len(declared.arguments), sentence
            if key not in self._forms:
                self._forms[key] = self._sentence_form(sentence, declared)
            form = self._forms[key]
            values = [] if form is None else self._hole_values(form, declared, atom)
            if form is not None and values is not None:
                return Sentence(form.text % tuple(values), tuple(values))
        return None

    def _sentence_form(self, sentence: str, declared: Declaration) -> _Form | None:
        """Return the parsed form of a sentence; None if a hole names no argument."""
        holes = []
        for match in re.finditer(SENTENCE_HOLE, sentence):
            of = declared if match[1] is None else self._named.get(match[1])
            names = [] if of is None else [argument.name for argument in of.arguments]
            if of is None or match[2] not in names:
                return None
            place = names.index(match[2])
            other = None if match[1] is None else of
            holes.append(_Hole(other, place, of.arguments[place]))
        return _Form(re.sub(SENTENCE_HOLE, "%s", sentence.replace("%", "%%")), tuple(holes))

    def _hole_values(self, form: _Form, declared: Declaration, atom: Atom) -> list[str] | None:
        found = []
        for other, place, argument in form.holes:
            about: Atom | None = atom
            if other is not None:
                fact = self._joined(other, declared, atom)
                about = None if fact is None else fact.atom
            value = None if about is None else _readable_value(about.arguments[place], argument)
            if value is None:
                return None
            found.append(value)
        return found

    def _joined(self, other: Declaration, own: Declaration, atom: Atom) -> Fact | None:
        """Return the fact of `other` that agrees in all arguments of equal names, or None."""
        # A declaration is hashed slowly, and all declarations live as long as this object.
        pairs = self._alike.get((id(other), id(own)))
        if pairs is None:
            pairs = self._alike[id(other), id(own)] = _alike(other, own)
        if any(_is_open(atom.arguments[mine]) for _, mine in pairs):
            pairs = tuple(pair for pair in pairs if not _is_open(atom.arguments[pair[1]]))
        if not pairs or other.name not in self._facts:
            return None
        key = tuple(atom.arguments[mine] for _, mine in pairs)
        places = tuple(theirs for theirs, _ in pairs)
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


def _alike(other: Declaration, own: Declaration) -> tuple[tuple[int, int], ...]:
    """Return the pairs of positions of arguments that have the same name in two predicates."""
    names = [argument.name for argument in own.arguments]
    return tuple(
        (place, names.index(argument.name))
        for place, argument in enumerate(other.arguments)
        if argument.name in names
    )


def _is_open(value: Term) -> bool:
    return isinstance(value, Atom) and value.name == OPEN


def _readable_value(value: Term, argument: PredicateArgument) -> str | None:
    """Return a value in readable form, or None if it is open or has no readable form."""
    if isinstance(value, int):
        unit = next((sort for sort in argument.sorts if sort in UNITS), None)
        return str(value) if unit is None else measured(value, unit)
    if isinstance(value, str):
        return value
    if value.name == OPEN:
        return None
    if not value.arguments:
        return value.name.replace("_", " ")
    # A term for something written: the strings among its arguments.
    return " ".join(each for each in value.arguments if each and isinstance(each, str)) or None
