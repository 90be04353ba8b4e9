"""One rule of a file: what stands above it, its text, and what it says."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import NamedTuple

from mars_asp.asp.rules.statements import Statement, Tree, statements, tree
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span

#: A variable in a message, and the sort in the unit of which its value is written, if any.
HOLE = re.compile(r"\{([^{}:]*)(?::([a-z_]+))?\}")


class Allow(NamedTuple):
    """A line of metadata that allows a lint: its code, the reason, and where it stands."""

    code: str
    reason: str
    span: Span


@dataclass(frozen=True)
class Rule:
    """One rule as it is written, with its metadata and what it says."""

    id: str
    because: str | None
    help: str | None
    span: Span
    text: str
    stage: str
    #: Why what the rule computes fits into 32 bits, where that does not show.
    fits: str | None = None
    #: What the rule is about and why that matters.
    why: str | None = None
    #: The path of a case in which it fires.
    example: str | None = None
    #: Lines of metadata that stand for further rules: the key and what it lists.
    lists: tuple[tuple[str, str], ...] = ()
    #: Where the line of metadata is that stands for this rule; no file has its text.
    listed: Span | None = None
    #: What will happen, a sentence for those who read no more of the rule.
    effect: str | None = None
    #: The lints that have nothing to say of the rule.
    allows: tuple[Allow, ...] = ()
    #: Where each line of metadata is, by its key.
    places: tuple[tuple[str, Span], ...] = ()

    @cached_property
    def ast(self) -> Tree:
        """Return clingo's syntax tree of the text, for further rules to be made of it."""
        return tree(self.text)

    @cached_property
    def written(self) -> tuple[str, str]:
        """Return the head and the body as clingo writes them."""
        return str(self.ast.head), "; ".join(map(str, self.ast.body))

    @property
    def statements(self) -> tuple[Statement, ...]:
        """Return what the rule says, without pools."""
        return statements(self.text)

    @cached_property
    def heads(self) -> frozenset[Signature]:
        """Return the predicates that the head can derive, without signs of classical negation."""
        return frozenset(each.unsigned for one in self.statements for each in one.derives)

    def derives(self, signature: Signature) -> bool:
        """Whether the head can derive a predicate, or its contrary."""
        # What does not name it need not be read.
        return signature.name in self.text and signature in self.heads

    @cached_property
    def reads(self) -> frozenset[Signature]:
        """Return the predicates that the rule reads, without signs, and those that it offers."""
        read = frozenset(each.unsigned for one in self.statements for each in one.reads)
        return read | self.heads if self.is_choice else read

    @cached_property
    def is_choice(self) -> bool:
        """Whether the rule offers atoms instead of forcing them."""
        return any(statement.offers for statement in self.statements)

    @cached_property
    def firsts(self) -> Mapping[Signature, frozenset[str]]:
        """Return, by the predicates of its head, the constants that their first arguments are.

        Predicates of which one can be anything are left out.
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
        """Keep what most questions need of what the rule says."""
        written = {field.name: getattr(self, field.name) for field in fields(self)}
        names = ["heads", "reads", "is_choice", "firsts"]
        # Of a rule with a message every question makes another.
        names += ["written"] if self.because is not None else []
        return {**written, **{name: getattr(self, name) for name in names}}

    @property
    def holes(self) -> tuple[str, ...]:
        """Return the variables that `because`, `help` and `effect` name, each once."""
        result = (HOLE.findall(text) for _, text in self.sentences)
        return tuple(dict.fromkeys(name for names in result for name, _ in names))

    @property
    def sentences(self) -> Iterator[tuple[str, str]]:
        """Yield the texts of the rule for users, by the keys of their lines."""
        for key, text in (("because", self.because), ("help", self.help), ("effect", self.effect)):
            if text:
                yield key, text

    def place_of(self, key: str) -> Span:
        """Return where the line of metadata with a key is; without one, where the rule is."""
        return dict(self.places).get(key, self.span)

    def place_of_hole(self, hole: str) -> Span:
        """Return where the first line is that names a variable."""
        for key, text in self.sentences:
            if any(name == hole for name, _ in HOLE.findall(text)):
                return self.place_of(key)
        return self.span
