"""Derivation traces as plain values."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Literal, NamedTuple, TypeAlias

import clingo

from mars_asp.asp.messages import fill, shown, written
from mars_asp.asp.rules.declarations import Declaration, Origin
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.symbols import term_of
from mars_asp.asp.signature import plain
from mars_asp.asp.solve.atoms import Atom
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, text
from mars_asp.asp.trace.sentences import Sentence, Sentences
from mars_asp.diagnostic import Span
from mars_asp.output import brief_repr

_HOLE = re.compile(r"\{[^{}]*\}")
_VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")


class SentenceRenderer(NamedTuple):
    """The sentence of an atom or of its absence, rendered at the first use."""

    sentences: Sentences
    given: Atom | TermId
    declared: Declaration | None = None

    # Converted at the first use, as of a derived atom.
    @property
    def atom(self) -> Atom:
        """Return the atom, or the pattern that no atom fits."""
        if isinstance(self.given, Atom):
            return self.given
        return atom_of(as_symbol(self.given))


def atom_of(symbol: clingo.Symbol) -> Atom:
    """Return a clingo atom as an `Atom`, whose name includes the sign `-`."""
    name = symbol.name if symbol.positive else f"-{symbol.name}"
    return Atom(name, tuple(map(term_of, symbol.arguments)))


@dataclass(frozen=True, slots=True, repr=False)
class Given:
    """A fact and its source; `span` is None if the location is unknown.

    A computed fact has the location of the text from which it was computed.

    >>> trace = Given("edge(a,b)", Span("graph.lp", 12, 1, 12, 11))
    >>> trace.span.line
    12
    """

    __repr__ = brief_repr

    atom: str
    span: Span | None
    origin: Origin | Literal["external"] = "stated"
    words: SentenceRenderer | None = field(default=None, compare=False, repr=False)

    @property
    def declared_sentence(self) -> Sentence | None:
        """Return the declared sentence of the fact with its values, or None without one."""
        return None if self.words is None else self.words.sentences.says(self.words.atom)

    @property
    def message(self) -> str | None:
        """Return the sentence as text, or None."""
        result = self.declared_sentence
        return None if result is None else result.sentence

    @property
    def rank(self) -> int | None:
        """Return the number that orders facts of this kind, the highest first, or None."""
        return None if self.words is None else self.words.sentences.rank(self.words.atom)

    @property
    def seconds(self) -> float | None:
        """Return the first instant that the fact names, in seconds, or None if it names none."""
        if self.words is None or self.words.declared is None:
            return None
        places = self.words.declared.places("instant")
        instant = self.words.atom.arguments[places[0]] if places else None
        return instant / 1000 if isinstance(instant, int) else None


@dataclass(frozen=True, slots=True, repr=False)
class Absent:
    """A premise `not atom` that holds because the atom does not; `_` is any value.

    `external` is the location of the statement if the atom is an external.

    >>> Absent("edge(b,a)").atom
    'edge(b,a)'
    """

    __repr__ = brief_repr

    atom: str
    words: SentenceRenderer | None = field(default=None, compare=False, repr=False)
    external: Span | None = None

    @property
    def message(self) -> str:
        """Return the declared or a generic sentence about the absence."""
        external = "" if self.external is None else ", external and false"
        return f"{_absence(self.atom, self.words)}{external}"

    @property
    def sentence(self) -> str | None:
        """Return the declared sentence of the absence, or None without one."""
        return None if self.words is None else self.words.sentences.unless(self.words.atom)


def _absence(atom: str, words: SentenceRenderer | None) -> str:
    """Return the declared sentence of an absence, else one that names the atom."""
    if words is None:
        return f"no {plain(atom)}"
    pattern = words.atom
    names = [f"`{each}`" for each in pattern.arguments if isinstance(each, str)]
    of = f" of {' and '.join(names)}" if names else ""
    name = plain(pattern.name).removeprefix("-").replace("_", " ").strip()
    return words.sentences.unless(pattern) or f"no {name}{of}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Derived:
    """An atom that one firing of a rule gives.

    `chosen` is true if the rule only offers the atom and minimal cost selects it. `head` is the
    atom, and `values` are the values of the variables, `v(n("X",...),1,...)`. Premises that several
    traces share are the same object.

    `others` are the other derivations of the atom, if they were requested: all firings whose
    premises can be derived without the atom. A path through `premises` alone never returns to the
    atom. One through `others` can: each premise has a derivation without the atom, but its
    derivation of minimal height may be another one.

    >>> from mars_asp.asp import Program
    >>> trace = Program.from_text("edge(a,b). reach(Y) :- edge(a,Y).").solve().why("reach(b)").trace
    >>> trace.atom, trace.premises[0].atom
    ('reach(b)', 'edge(a,b)')
    """

    __repr__ = brief_repr

    head: TermId
    rule: Rule
    values: TermId
    premises: tuple["Trace", ...]
    chosen: bool = False
    others: Sequence["Derived"] = ()

    # Rendered at the first use: a reader sees few of many thousands of steps.
    @property
    def atom(self) -> str:
        """Return the text of the atom."""
        return text(self.head)

    @property
    def bindings(self) -> Mapping[str, clingo.Symbol]:
        """Return the values of the variables."""
        return bindings_of(self.values)

    @property
    def values_written(self) -> dict[str, str]:
        """Return the values of the variables in the syntax of clingo."""
        return {name: _text(value) for name, value in _terms_of(self.values).items()}

    @property
    def message(self) -> str | None:
        """Return the rule's message, its holes filled, or None if the rule has none."""
        return self.with_values(self.rule.because)

    def with_values(self, text: str | None) -> str | None:
        """Return a text of the rule, such as its help, with values in its holes; None for None."""
        return fill(text, _terms_of(self.values), written)


@dataclass(frozen=True, slots=True)
class Unexplained:
    """A true atom that no rule with a supported construct gives; `reason` names the obstacle."""

    atom: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class NearMiss:
    """The nearest that a rule comes to an absent `atom`.

    `fails` is the literal that is false for these bindings, `value` the value of its aggregate,
    `cause` the reason why the literal is false, and `held` are premises that do hold. If `fails` is
    None, a choice could give the atom and does not.
    """

    atom: str
    rule: Rule
    message: str | None
    bindings: Mapping[str, clingo.Symbol]
    fails: str | None
    value: clingo.Symbol | None
    cause: "Trace | None"
    held: tuple["Trace", ...] = ()

    @property
    def sentence(self) -> str:
        """Return the sentence that this instance of the rule does not fire.

        Unbound variables are shown as `...`; its message may hold by another derivation.
        """
        if self.message is not None:
            return f"{self.atom} would hold because {_HOLE.sub('...', self.message)}, but"
        return self.cause.message if isinstance(self.cause, Underivable) else self.failure

    @property
    def failure(self) -> str:
        """Return the sentence that the literal fails, with its value or variables."""
        if self.fails is None:
            return "it may be chosen, and is not"
        if self.value is not None:
            return f"`{self.fails}` fails: its value is {self.value}"
        names = dict.fromkeys(_VARIABLE.findall(self.fails))
        values = [f"{n} = {shown(self.bindings[n])}" for n in names if n in self.bindings]
        return f"`{self.fails}` fails{' for ' if values else ''}{', '.join(values)}"

    def reasons(self, go_on: bool) -> "Sequence[Trace | NearMiss | str]":
        """Return the entries below it; with `go_on`, also the reasons of a failing premise."""
        cause = self.cause
        if cause is None:
            return () if self.message is None else (self.failure,)
        if not isinstance(cause, Underivable):
            return (cause,)
        # An attempt without message and without underivable premise is a single line.
        if cause.attempts and (
            go_on
            or all(
                attempt.message is None and not isinstance(attempt.cause, Underivable)
                for attempt in cause.attempts
            )
        ):
            return cause.nearest
        return (cause,) if go_on else (cause.message,)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Underivable:
    """An atom that does not hold, with the nearest miss of each rule; `_` is any value.

    `followed` is false if the search ended here, as at the maximal depth.

    >>> from mars_asp.asp import Program
    >>> answer = Program.from_text("edge(a,b). reach(Y) :- edge(a,Y).").solve()
    >>> answer.why_not("reach(c)").trace.atom
    'reach(c)'
    """

    __repr__ = brief_repr

    atom: str
    attempts: tuple[NearMiss, ...]
    followed: bool = True
    words: SentenceRenderer | None = None

    @property
    def message(self) -> str:
        """Return the declared or a generic sentence about the absence."""
        return _absence(self.atom, self.words)

    @property
    def sentence(self) -> str | None:
        """Return the declared sentence of the absence, or None without one."""
        return None if self.words is None else self.words.sentences.unless(self.words.atom)

    @property
    def nearest(self) -> list[NearMiss]:
        """Return the near misses; one without message is replaced by any that its cause has."""
        found: list[NearMiss] = []
        seen: set[int] = set()
        stack = list(reversed(self.attempts))
        while stack:
            attempt = stack.pop()
            if id(attempt) in seen:
                continue
            seen.add(id(attempt))
            cause = attempt.cause
            if attempt.message is None and isinstance(cause, Underivable) and cause.attempts:
                stack += reversed(cause.attempts)
            else:
                found.append(attempt)
        return found


def is_pseudo(span: Span) -> bool:
    """Whether a location is in no file: its path has the form `<...>`."""
    return span.path.startswith("<")


def bindings_of(values: TermId) -> dict[str, clingo.Symbol]:
    """Return the values of variables in a term `v(n("X",...),1,...)`."""
    return {name: as_symbol(value) for name, value in _terms_of(values).items()}


def _terms_of(values: TermId) -> dict[str, TermId]:
    names, *found = arguments(values)
    return dict(zip(_string_names(names), found, strict=True))


@cache
def _string_names(names: TermId) -> tuple[str, ...]:
    return tuple(as_symbol(name).string for name in arguments(names))


# The same few names occur in the messages of very many steps.
_text = lru_cache(maxsize=100_000)(text)


Trace: TypeAlias = Given | Absent | Derived | Unexplained | Underivable
