"""Accounts of consequences and nodes: a sentence, the user's lines behind it, and what follows.

What is told `rules/account` decides, words included; here it is read, and what its terms stand for
is written as users write it.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import TypeAlias

import clingo

from mars_asp.asp.fragments import joined
from mars_asp.asp.messages import Said, said, saying, shown
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, text
from mars_asp.diagnostic import Span
from mars_asp.reasoning.facts.identifiers import plain

#: The stage whose rules tell accounts.
STAGE = "account"
#: Kind, subject and case of what is told of, which part of that is told, its order and its thing.
ACCOUNT = Signature("account", 6)
#: What something is ordered by: numbers first, then modules, then others.
_Order: TypeAlias = tuple[tuple[int, int, str], ...]
#: What is told of: the texts of its kind, subject and case.
Key: TypeAlias = tuple[str, str, str]
#: The atoms of predicates, as far as they are true.
Atoms: TypeAlias = Callable[[Sequence[Signature]], Mapping[Signature, Sequence[TermId]]]
#: The name under which rules that decide are heard.
_DECIDING = "deciding"


@dataclass(frozen=True, slots=True)
class Cited:
    """A line of the user's, where that is in words, and what is said beside it."""

    span: Span
    place: str
    label: str


@dataclass(frozen=True, slots=True)
class Account:
    """What is told of a consequence or node: a sentence, lines, and further sentences."""

    answer: str | None
    cites: tuple[Cited, ...]
    notes: tuple[str, ...]


class UnnamedNodeError(Exception):
    """A sentence names a node of which the name is not known."""


@dataclass(frozen=True)
class Names:
    """What terms in sentences stand for: the places of things, and the names of nodes.

    Things are relationships and annotations by their numbers, modules by their names; nodes are
    known by the texts of their terms. `modules` are in the order of the configuration.
    """

    places: Mapping[int | str, Span]
    configuration: Span
    nodes: Mapping[str, str]
    modules: Mapping[str, int]
    #: What was found out of terms, of which few stand in very many accounts.
    _orders: dict[TermId, "_Order"] = field(default_factory=dict)
    _written: dict[TermId, str] = field(default_factory=dict)

    def written(self, term: TermId) -> str:
        """Return a term as a sentence shows it."""
        found = self._written.get(term)
        if found is None:
            found = self._written[term] = self._write(as_symbol(term))
        return found

    def _write(self, symbol: clingo.Symbol) -> str:
        if symbol.type == clingo.SymbolType.Function and len(symbol.arguments) == 1:
            write = _WORDS.get(symbol.name)
            if write is not None:
                return write(self, symbol.arguments[0])
        return shown(symbol)

    def place(self, thing: TermId) -> Span:
        """Return where a relationship, annotation or module is, or the configuration."""
        return self._place(as_symbol(thing))

    def order(self, term: TermId) -> "_Order":
        """Return what a term of an order is compared by: modules are in the order of the file."""
        found = self._orders.get(term)
        if found is None:
            found = self._orders[term] = tuple(map(self._place_of, _flat(as_symbol(term))))
        return found

    def _place_of(self, symbol: clingo.Symbol) -> tuple[int, int, str]:
        if symbol.type == clingo.SymbolType.Number:
            return 0, symbol.number, ""
        if symbol.type == clingo.SymbolType.String:
            return 1, self.modules.get(symbol.string, len(self.modules)), symbol.string
        return 2, 0, str(symbol)

    def _place(self, symbol: clingo.Symbol) -> Span:
        if symbol.type == clingo.SymbolType.Number:
            return self.places[symbol.number]
        if symbol.type == clingo.SymbolType.String:
            return self.places[symbol.string]
        return self.configuration

    def _at(self, thing: clingo.Symbol) -> str:
        return self.where(self._place(thing))

    def where(self, span: Span) -> str:
        """Return a line as `config.mars:3`: paths are relative to the folder of the configuration."""
        folder = self.configuration.path.rpartition("/")[0]
        path = span.path.removeprefix(f"{folder}/") if folder else span.path
        return f"{path}:{span.line}"

    def _node(self, node: clingo.Symbol) -> str:
        name = self.nodes.get(str(node))
        if name is None:
            raise UnnamedNodeError
        return name


#: How terms of one argument are written, by their names.
_WORDS: Mapping[str, Callable[[Names, clingo.Symbol], str]] = {
    "at": Names._at,
    "node": Names._node,
    "hz": lambda _, rate: f"{plain(Decimal(rate.number) / 1000)} Hz",
    "mm": lambda _, length: f"{round(length.number / 1000)} mm",
    "seconds": lambda _, time: f"{plain(Decimal(time.number) / 1000)} s",
}


def _flat(symbol: clingo.Symbol) -> Iterator[clingo.Symbol]:
    """Yield what a tuple holds, or a term itself."""
    if symbol.type == clingo.SymbolType.Function and not symbol.name:
        for each in symbol.arguments:
            yield from _flat(each)
    else:
        yield symbol


def speakers(rulebook: Rulebook, kinds: Iterable[str] | None = None) -> tuple[Rule, ...]:
    """Return the rules that tell accounts of some kinds of things, with what these rules need."""
    own = [rule for rule in rulebook.rules if rule.stage == STAGE]
    if kinds is None:
        return tuple(own)
    wanted = frozenset(kinds)
    found = {rule.text for rule in own if not wanted.isdisjoint(rule.firsts.get(ACCOUNT, ()))}
    while True:
        read = frozenset[Signature]().union(*(rule.reads for rule in own if rule.text in found))
        more = {
            rule.text
            for rule in own
            if ACCOUNT not in rule.heads and not read.isdisjoint(rule.heads)
        }
        if more <= found:
            return tuple(rule for rule in own if rule.text in found)
        found |= more


def reads(rules: Iterable[Rule]) -> frozenset[Signature]:
    """Return the predicates that rules read and do not derive."""
    rules = tuple(rules)
    derived = frozenset[Signature]().union(*(rule.heads for rule in rules))
    return frozenset[Signature]().union(*(rule.reads for rule in rules)) - derived


@dataclass(frozen=True)
class Told:
    """What is told: accounts by what they are of, and by the texts of atoms the rule of each."""

    accounts: Mapping[Key, Account]
    rules: Mapping[str, str]


def told(
    rules: Sequence[Rule], deciding: Sequence[Rule], atoms_of: Atoms, names: Names
) -> Told:
    """Return what rules tell.

    `deciding` are rules of other stages: of the atoms that these force, the first of them is told.
    `atoms_of` gives the true atoms of what all these rules read.

    Raises:
        MarsError: clingo refuses a rule.
        UnnamedNodeError: a sentence names a node that has no name.
    """
    telling = [rule for rule in rules if ACCOUNT in rule.heads]
    read = reads(rules).union(*(rule.reads | rule.heads for rule in deciding))
    grounding = Grounding((), atoms_of(sorted(read)))
    program = "\n".join(rule.text for rule in rules)
    sayings = (*saying(STAGE, telling), *saying(_DECIDING, deciding))
    grounding.derive(f"{program}\n{joined(sayings)}")
    found: dict[Key, dict[str, list[Said]]] = {}
    for each in said(grounding.control, STAGE, telling):
        kind, subject, case, part, _, _ = arguments(each.head)
        parts = found.setdefault((text(kind), text(subject), text(case)), {})
        parts.setdefault(text(part), []).append(each)
    forced: dict[str, int] = {}
    for each in said(grounding.control, _DECIDING, deciding):
        atom = text(each.head)
        forced[atom] = min(each.number, forced.get(atom, each.number))
    accounts = {key: _account(parts, names) for key, parts in found.items()}
    return Told(accounts, {atom: deciding[number].id for atom, number in forced.items()})


def _account(parts: Mapping[str, Sequence[Said]], names: Names) -> Account:
    answers, notes = _in_order(parts.get("answer", ()), names), parts.get("notes", ())
    return Account(
        _sentence(answers[0], names) if answers else None,
        tuple(_cited(parts.get("cites", ()), names)),
        tuple(dict.fromkeys(_sentence(each, names) for each in _in_order(notes, names))),
    )


def _cited(cites: Sequence[Said], names: Names) -> Iterator[Cited]:
    """Yield the lines in their order, each once, with all that is said beside it."""
    orders: dict[Span, _Order] = {}
    labels: dict[Span, dict[str, None]] = {}
    for each in _in_order(cites, names):
        *_, order, thing = arguments(each.head)
        span = names.place(thing)
        orders.setdefault(span, names.order(order))
        if each.rule.because is not None:
            labels.setdefault(span, {})[_sentence(each, names)] = None
    for span in sorted(orders, key=lambda span: (orders[span], span)):
        yield Cited(span, names.where(span), "; ".join(labels.get(span, ())))


def _sentence(each: Said, names: Names) -> str:
    return each.filled(each.rule.because, names.written) or ""


def _in_order(told: Sequence[Said], names: Names) -> Sequence[Said]:
    """Return what is told by its order, then by rules, then by values."""
    if len(told) < 2:
        return told
    by_values = told if _are_few(told) else sorted(told, key=lambda each: text(each.values))
    return sorted(by_values, key=lambda each: (names.order(arguments(each.head)[4]), each.number))


def _are_few(told: Sequence[Said]) -> bool:
    """Whether each of them is told by a rule of its own, so that values decide nothing."""
    return len({each.number for each in told}) == len(told)
