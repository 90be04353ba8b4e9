"""Explanations of consequences and nodes: a sentence, the user's lines, and further sentences.

`rules/account` decides the sentences and their wording; this module reads them, and replaces their
terms by the text that users write.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from decimal import Decimal
from functools import cache, partial
from pathlib import Path
from typing import TypeAlias

import clingo

from mars_asp.asp.messages import RenderedMessage, rendered_messages, saying, shown
from mars_asp.asp.rules.premises import fragment_of
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term, atoms, text
from mars_asp.diagnostic import Span
from mars_asp.model.rates import as_written
from mars_asp.output import counted
from mars_asp.reasoning.analysis import Consequence, Key, locations
from mars_asp.reasoning.facts.identifiers import plain
from mars_asp.reasoning.facts.rates import Rates
from mars_asp.reasoning.project import Project, has_mounts
from mars_asp.reasoning.questions.sharing import APART, Atoms, apart
from mars_asp.reasoning.session import Evidence
from mars_asp.reasoning.synthesis import IntroducedNode
from mars_asp.reasoning.synthesis.derived import decided_by

#: The stage whose rules derive explanations.
STAGE = "account"
#: Kind, subject and case of the explained thing, the component of its explanation, order and thing.
ACCOUNT = Signature("account", 6)
#: The sort key of a term: numbers first, then modules, then other terms.
_Order: TypeAlias = tuple[tuple[int, int, str], ...]
#: How functions would be combined without a motion or mount, and the modules with such functions.
OTHERWISE = Signature("made_otherwise", 3)
_BORROWS, _EMERGENT = Signature("borrows", 4), Signature("emergent", 2)
#: A node of a rule pack, and its kind.
INSERTED = Signature("inserted", 2)
#: The name under which the messages of deciding rules are read.
_DECIDING = "deciding"
#: The case of a node, in place of that of a consequence.
_NODE = clingo.Function("node")


@dataclass(frozen=True, slots=True)
class Cited:
    """A line of the user, the text of its location, and its label."""

    span: Span
    place: str
    label: str


@dataclass(frozen=True, slots=True)
class Account:
    """The explanation of a consequence or node: a sentence, lines, and further sentences.

    `rules` are the ids of the rules that derive it.
    """

    answer: str | None
    cites: tuple[Cited, ...]
    notes: tuple[str, ...]
    rules: tuple[str, ...] = ()


@dataclass(frozen=True)
class TermNames:
    """The texts of terms in sentences: locations of things, names of nodes, and rates.

    `places` are the locations of things; `nodes` has names by the texts of terms. `modules` are in
    the order of the configuration. `rates` converts numbers to rates.
    """

    places: Mapping[TermId, Span]
    configuration: Span
    nodes: Mapping[str, str]
    modules: Mapping[str, int]
    rates: Rates
    #: Results for terms; few terms occur in very many explanations.
    _orders: dict[TermId, "_Order"] = field(default_factory=dict)
    _written: dict[TermId, str] = field(default_factory=dict)
    #: The text before the line number in a location, by path.
    _shown: dict[str, str] = field(default_factory=dict)

    def written(self, term: TermId) -> str:
        """Return a term as a sentence shows it."""
        found = self._written.get(term)
        if found is None:
            found = self._written[term] = self.word(as_symbol(term))
        return found

    def word(self, symbol: clingo.Symbol) -> str:
        """Return a symbol as a sentence shows it."""
        if symbol.match("after", 2):
            gate = str(clingo.Function("gate", symbol.arguments))
            return self.nodes.get(gate, "a Gate")
        if symbol.type == clingo.SymbolType.Function and len(symbol.arguments) == 1:
            write = _WORDS.get(symbol.name)
            if write is not None:
                return write(self, symbol.arguments[0])
        return shown(symbol)

    def place(self, thing: TermId) -> Span:
        """Return the location of a relationship, annotation or module, or the configuration."""
        return self.places.get(thing, self.configuration)

    def order(self, term: TermId) -> "_Order":
        """Return the sort key of a term, by which modules have the order of the configuration."""
        found = self._orders.get(term)
        if found is None:
            found = self._orders[term] = tuple(map(self._place_of, _flatten(as_symbol(term))))
        return found

    def _place_of(self, symbol: clingo.Symbol) -> tuple[int, int, str]:
        if symbol.type == clingo.SymbolType.Number:
            return 0, symbol.number, ""
        if symbol.type == clingo.SymbolType.String:
            return 1, self.modules.get(symbol.string, len(self.modules)), symbol.string
        return 2, 0, str(symbol)

    def where(self, span: Span) -> str:
        """Return a location in a sentence: relative to the folder of the configuration."""
        folder = self.configuration.path.rpartition("/")[0]
        return self.location(span).removeprefix(f"{folder}/" if folder else "")

    def location(self, span: Span) -> str:
        """Return a location as `level0/config.mars:3`.

        A folder that was read as one robot has no lines: `workspace/`.
        """
        shown = self._shown.get(span.path)
        if shown is None:
            # Few files are cited very often.
            is_folder = Path(span.path).is_dir()
            shown = self._shown[span.path] = f"{span.path.rstrip('/')}{'/' if is_folder else ':'}"
        return shown if shown.endswith("/") else f"{shown}{span.line}"

    def _splitters_for(self, controllers: clingo.Symbol) -> str:
        if controllers == clingo.Number(0):
            return ""
        several = not (controllers.match("and", 2) and controllers.arguments[1] == clingo.Number(0))
        return f"; splitter{'s' * several} for {self.word(controllers)}"

    def _hz(self, number: clingo.Symbol) -> str:
        """Return a rate in Hertz, with the period after it if the user states a period."""
        rate = self.rates.hertz(number.number)
        words = as_written(rate)
        if words[0].isdigit():
            return f"{words} Hz"
        shown = Decimal(round(rate * 1000)) / 1000 or Decimal(f"{float(rate):.3g}")
        return f"{plain(shown)} Hz ({words})"


#: The writers of terms with one argument, by their names.
_WORDS: Mapping[str, Callable[[TermNames, clingo.Symbol], str]] = {
    "at": lambda names, thing: names.where(names.place(as_term(thing))),
    "node": lambda names, node: names.nodes[str(node)],
    "hz": TermNames._hz,
    "sends": lambda names, rate: f"delivers at {names.word(rate)}",
    "offers": lambda names, mode: f"offers {names.word(mode)}",
    "lines": lambda _, count: counted(count.number, "line"),
    "on_lines": lambda _, count: f" on {count.number} lines" if count.number else "",
    "splitters_for": TermNames._splitters_for,
    "ungated": lambda names, output: names.word(output),
    "itself": lambda names, module: f"`{names.word(module)}`",
    "inherits": lambda names, module: f"what `{names.word(module)}` inherits",
}


def _flatten(symbol: clingo.Symbol) -> Iterator[clingo.Symbol]:
    """Yield the elements of nested tuples, or a term itself."""
    if symbol.type == clingo.SymbolType.Function and not symbol.name:
        for each in symbol.arguments:
            yield from _flatten(each)
    else:
        yield symbol


def speakers(rulebook: Rulebook, kinds: Iterable[str] | None = None) -> tuple[Rule, ...]:
    """Return the rules that explain some kinds (None: all), with the rules they depend on."""
    wanted = None if kinds is None else frozenset(kinds)
    return telling(
        rulebook,
        lambda rule: (
            ACCOUNT in rule.heads
            and (
                wanted is None
                or ACCOUNT not in rule.firsts
                or not wanted.isdisjoint(rule.firsts[ACCOUNT])
            )
        ),
    )


def telling(rulebook: Rulebook, tells: Callable[[Rule], bool]) -> tuple[Rule, ...]:
    """Return the rules of `account` that `tells` accepts, with the rules they depend on."""
    own = [rule for rule in rulebook.rules if rule.stage == STAGE]
    found = {rule.text for rule in own if tells(rule)}
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
class Explanations:
    """Explanations by their things, the rule that forces each node, and the sentence of its pack.

    Only nodes of rule packs have such a sentence.
    """

    accounts: Mapping[Key, Account]
    rules: Mapping[TermId, str]
    sentences: Mapping[TermId, str]


def explanations(
    rules: Sequence[Rule],
    deciding: Sequence[Rule],
    atoms_of: Atoms,
    names: TermNames,
    wanted: Set[Key],
) -> Explanations:
    """Return the explanations of the things that are `wanted`.

    `deciding` are rules of other stages that force nodes; the first such rule of a node counts.
    `atoms_of` returns the true atoms of the predicates that all these rules read.

    Raises:
        MarsError: clingo refuses a rule.
    """
    telling = [rule for rule in rules if ACCOUNT in rule.heads]
    read = reads(rules).union(*(rule.reads | rule.heads for rule in deciding))
    grounding = Grounding((), atoms_of(sorted(read)))
    # No rule reads explanations, so only their messages are grounded.
    program = (fragment_of(rule) for rule in rules if ACCOUNT not in rule.heads)
    sayings = (*saying(STAGE, telling), *saying(_DECIDING, deciding))
    grounding.derive([*program, *sayings])
    found: dict[Key, dict[str, list[RenderedMessage]]] = {}
    word = cache(text)
    for each in rendered_messages(grounding.control, STAGE, telling):
        kind, subject, case, part, _, _ = arguments(each.head)
        key = kind, subject, case
        if key not in wanted:
            continue
        parts = found.setdefault(key, {})
        parts.setdefault(word(part), []).append(each)
    forced: dict[TermId, RenderedMessage] = {}
    by_rule = sorted(
        rendered_messages(grounding.control, _DECIDING, deciding),
        # The messages of one pack's node are in the order of their words.
        key=lambda each: (each.number, text(each.values) if _inserts(each) else ""),
    )
    for each in by_rule:
        forced.setdefault(arguments(each.head)[0] if _inserts(each) else each.head, each)
    accounts = {key: _account(parts, names) for key, parts in found.items()}
    return Explanations(
        accounts,
        {node: each.rule.id for node, each in forced.items()},
        {node: _sentence(each, names) for node, each in forced.items() if _inserts(each)},
    )


def _inserts(each: RenderedMessage) -> bool:
    return INSERTED in each.rule.heads


def _account(parts: Mapping[str, Sequence[RenderedMessage]], names: TermNames) -> Account:
    answers, notes = _sorted_messages(parts.get("answer", ()), names), parts.get("notes", ())
    return Account(
        _sentence(answers[0], names) if answers else None,
        tuple(_cited(parts.get("cites", ()), names)),
        tuple(dict.fromkeys(_sentence(each, names) for each in _sorted_messages(notes, names))),
        tuple(dict.fromkeys(each.rule.id for part in parts.values() for each in part)),
    )


def _cited(cites: Sequence[RenderedMessage], names: TermNames) -> Iterator[Cited]:
    """Yield the cited lines of messages in order, each once with all of its labels."""
    # Two things can be on one line.
    lines: dict[tuple[str, int], tuple[_Order, Span]] = {}
    labels: dict[tuple[str, int], dict[str, None]] = {}
    for each in _sorted_messages(cites, names):
        *_, order, thing = arguments(each.head)
        span = names.place(thing)
        lines.setdefault(span[:2], (names.order(order), span))
        if each.rule.because is not None:
            labels.setdefault(span[:2], {})[_sentence(each, names)] = None
    for line, (_, span) in sorted(lines.items(), key=lambda item: item[1]):
        yield Cited(span, names.location(span), "; ".join(labels.get(line, ())))


def _sentence(each: RenderedMessage, names: TermNames) -> str:
    return each.filled(each.rule.because, names.written) or ""


def _sorted_messages(
    reasons: Sequence[RenderedMessage], names: TermNames
) -> Sequence[RenderedMessage]:
    """Return messages by the order that their rules state, then by rule, then by values."""
    if len(reasons) < 2:
        return reasons
    # If each message has a rule of its own, the values decide no order.
    if len({each.number for each in reasons}) < len(reasons):
        reasons = sorted(reasons, key=lambda each: text(each.values))
    return sorted(reasons, key=lambda each: (names.order(arguments(each.head)[4]), each.number))


def key_of(thing: Consequence | IntroducedNode) -> Key:
    """Return the terms by which the rules identify the explanation of a consequence or node."""
    if isinstance(thing, IntroducedNode):
        term = as_term(clingo.parse_term(thing.term))
        return as_term(clingo.Function(thing.kind)), term, as_term(_NODE)
    kind, _, subject, case = arguments(as_term(thing.atom))
    return kind, subject, case


def explanations_of(
    project: Project,
    evidence: Evidence,
    nodes: Iterable[IntroducedNode],
    things: Sequence[Consequence | IntroducedNode],
) -> list[tuple[Account, str | None]]:
    """Return the explanations of consequences and nodes in their order, each with its rule's id.

    `nodes` are all named nodes.

    A consequence without an explaining rule has its message and locations. A node has no rule
    if it was chosen, or if several rules could force it.

    Raises:
        MarsError: clingo refuses a rule.
    """
    if not things:
        return []
    kinds = {thing.kind for thing in things}
    rules, deciding = speakers(evidence.rulebook, kinds), _deciding(evidence.rulebook, kinds)
    names = names_of(project, evidence.facts, nodes)
    atoms_of = partial(true_atoms, evidence)
    # Only if the question is about one node, as the price takes a search of its own.
    price = None
    if len(things) == 1 and isinstance(things[0], IntroducedNode):
        price = apart(project, evidence, things[0], atoms_of)
    given: dict[Signature, Sequence[TermId]] = {} if price is None else {APART: (price,)}
    if OTHERWISE in reads(rules):
        given |= _otherwise(project, atoms_of)
    keys = list(map(key_of, things))
    found = explanations(
        rules, deciding, lambda read: {**atoms_of(read), **given}, names, set(keys)
    )
    return [
        _account_and_rule(thing, key, found, names) for thing, key in zip(things, keys, strict=True)
    ]


def _otherwise(project: Project, atoms_of: Atoms) -> Mapping[Signature, Sequence[TermId]]:
    """Return the atoms on how functions combine without one of the motions or mounts, by predicate.

    They are empty if the project has no mounts or nothing inherits a motion.
    """
    true = atoms_of([_BORROWS, _EMERGENT])
    if not has_mounts(project):
        return {}
    heirs = {as_symbol(arguments(atom)[1]).string for atom in true[_BORROWS]}
    heirs |= {as_symbol(arguments(atom)[0]).string for atom in true[_EMERGENT]}
    if not heirs:
        return {}
    from mars_asp.reasoning.facts.otherwise import otherwise  # noqa: PLC0415 -- numpy

    result: dict[Signature, list[TermId]] = {}
    for atom in otherwise(project.configuration, project.modules, heirs):
        term = as_term(clingo.parse_term(str(atom)))
        result.setdefault(Signature(atom.name, len(atom.arguments)), []).append(term)
    return result


def _account_and_rule(
    thing: Consequence | IntroducedNode,
    key: Key,
    found: Explanations,
    names: TermNames,
) -> tuple[Account, str | None]:
    account = found.accounts.get(key, Account(None, (), ()))
    if isinstance(thing, IntroducedNode):
        because = found.sentences.get(key[1])
        if because is not None:
            answer = account.answer or ""
            sentence = f"{answer[:1].upper()}{answer[1:].rstrip('.')}."
            notes = (sentence, *account.notes) if answer else ()
            account = replace(account, answer=because, notes=notes)
        return account, found.rules.get(key[1])
    if account.answer and account.cites:
        return account, thing.rule.id
    cites = account.cites or tuple(Cited(span, names.location(span), "") for span in thing.spans)
    return replace(account, answer=account.answer or thing.message, cites=cites), thing.rule.id


def _deciding(rulebook: Rulebook, kinds: Iterable[str]) -> tuple[Rule, ...]:
    """Return the rules that force or introduce nodes of some kinds and have a message.

    A choice of a pack becomes one rule for each of its atoms, with its message.
    """
    predicates = {decided_by(rulebook, kind) or INSERTED for kind in kinds}
    deciding: list[Rule] = []
    for rule in rulebook.rules:
        if rule.because is None or rule.stage != "resolve" or predicates.isdisjoint(rule.heads):
            continue
        if not rule.is_choice:
            deciding.append(rule)
        elif INSERTED in rule.heads:
            deciding += _chosen(rule)
    return tuple(deciding)


def _chosen(rule: Rule) -> Iterator[Rule]:
    """Yield a rule for each node that a choice offers, which holds if the node was chosen."""
    body = rule.written[1]
    for statement in rule.statements:
        for head in statement.heads:
            literal = head.literal
            premises = "; ".join(filter(None, (literal.text, body)))
            if literal.signature == INSERTED:
                yield replace(rule, text=f"{literal.text} :- {premises}.")


def true_atoms(
    evidence: Evidence, read: Sequence[Signature]
) -> Mapping[Signature, Sequence[TermId]]:
    """Return the true atoms of predicates: facts, chosen atoms, and their consequences."""
    control = evidence.analysis.grounding.control
    derived = evidence.derived
    opened = {} if evidence.resolution is None else evidence.resolution.answer.true
    found: dict[Signature, Sequence[TermId]] = {}
    for signature in read:
        if derived is not None and signature in derived.predicates:
            found[signature] = derived.atoms(signature)
        else:
            # A choice may have left all atoms of a predicate false.
            true = opened.get(signature)
            found[signature] = atoms(control, *signature) if true is None else true
    return found


def names_of(project: Project, facts: Iterable[Fact], nodes: Iterable[IntroducedNode]) -> TermNames:
    """Return the texts of terms in sentences about a project and its nodes."""
    configuration = project.configuration
    described = {
        as_term(clingo.String(name)): module.span for name, module in project.described.items()
    }
    order = {name.text: place for place, name in enumerate(configuration.modules)}
    named = {node.term: node.name for node in nodes}
    places = described | locations(facts)
    return TermNames(places, configuration.span, named, order, project.rates)
