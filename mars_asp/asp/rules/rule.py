"""One rule of a file: its metadata, its text, and its content."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import NamedTuple

from mars_asp.asp.rules.statements import Statement, statements, written
from mars_asp.asp.rules.trees import SyntaxNode
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span

#: A variable in a message, and the sort whose unit its value is written in, if any.
HOLE = re.compile(r"\{([^{}:]*)(?::([a-z_]+))?\}")


class Allow(NamedTuple):
    """A line of metadata that allows a lint: its code, its reason and its location."""

    code: str
    reason: str
    span: Span


@dataclass(frozen=True)
class Rule:
    """One rule in its written form, with its metadata and its content."""

    id: str
    because: str | None
    help: str | None
    span: Span
    text: str
    stage: str
    #: The reason why the arithmetic of the rule fits into 32 bits, if that is not evident.
    fits: str | None = None
    #: The subject of the rule and its importance.
    why: str | None = None
    #: The path of a case in which it fires.
    example: str | None = None
    #: Lines of metadata that expand to further rules: the key and the list.
    lists: tuple[tuple[str, str], ...] = ()
    #: The location of the metadata line from which this rule was made; no file has its text.
    listed: Span | None = None
    #: The effect, as a sentence that is readable by itself.
    effect: str | None = None
    #: The lints that do not apply to the rule.
    allows: tuple[Allow, ...] = ()
    #: The location of each line of metadata, by its key.
    places: tuple[tuple[str, Span], ...] = ()

    @property
    def node(self) -> SyntaxNode:
        """Return the syntax tree of the text, with its pools."""
        return written(self.text)

    @cached_property
    def written(self) -> tuple[str, str]:
        """Return the head and the body as clingo formats them."""
        return str(self.node.head), "; ".join(map(str, self.node.body))

    @property
    def statements(self) -> tuple[Statement, ...]:
        """Return the content of the rule, as one statement for each variant without pools."""
        return statements(self.text)

    @cached_property
    def heads(self) -> frozenset[Signature]:
        """Return the predicates that the head can derive, without signs of classical negation."""
        return frozenset(each.unsigned for one in self.statements for each in one.derives)

    def derives(self, signature: Signature) -> bool:
        """Whether the head can derive a predicate or its classical negation."""
        # A rule that does not contain the name need not be parsed.
        return signature.name in self.text and signature in self.heads

    @cached_property
    def reads(self) -> frozenset[Signature]:
        """Return the predicates that the rule reads or offers, without signs."""
        read = frozenset(each.unsigned for one in self.statements for each in one.reads)
        return read | self.heads if self.is_choice else read

    @cached_property
    def is_choice(self) -> bool:
        """Whether the rule offers atoms instead of forcing them."""
        return any(statement.offers for statement in self.statements)

    @cached_property
    def firsts(self) -> Mapping[Signature, frozenset[str]]:
        """Return the constants that are first arguments in the head, by predicate.

        Predicates with any other first argument are left out.
        """
        found: dict[Signature, set[str | None]] = {}
        for statement in self.statements:
            for head in statement.heads:
                literal = head.literal
                first = literal.terms[0].constant if literal.terms else None
                found.setdefault(literal.signature, set()).add(first)
        return {
            signature: frozenset(filter(None, firsts))
            for signature, firsts in found.items()
            if None not in firsts
        }

    def __getstate__(self) -> dict[str, object]:
        """Return the pickled state, which includes derived values that most questions need."""
        written = {field.name: getattr(self, field.name) for field in fields(self)}
        names = ["heads", "reads", "is_choice", "firsts"]
        # Every question makes another rule from a rule with a message.
        names += ["written"] if self.because is not None else []
        return {**written, **{name: getattr(self, name) for name in names}}

    @property
    def holes(self) -> tuple[str, ...]:
        """Return the variables that `because`, `help` and `effect` name, each once."""
        result = (HOLE.findall(text) for _, text in self.sentences)
        return tuple(dict.fromkeys(name for names in result for name, _ in names))

    @property
    def sentences(self) -> Iterator[tuple[str, str]]:
        """Yield the key and text of `because`, `help` and `effect`, if the rule has them."""
        for key, text in (("because", self.because), ("help", self.help), ("effect", self.effect)):
            if text:
                yield key, text

    def place_of(self, key: str) -> Span:
        """Return the location of the metadata line with a key, or else of the rule."""
        return dict(self.places).get(key, self.span)

    def place_of_hole(self, hole: str) -> Span:
        """Return the location of the first metadata line with a variable, or else of the rule."""
        for key, text in self.sentences:
            if any(name == hole for name, _ in HOLE.findall(text)):
                return self.place_of(key)
        return self.span
