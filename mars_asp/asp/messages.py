"""The messages of rules: metadata texts with holes, filled by values in readable form."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from typing import NamedTuple, TypeVar

import clingo

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.expansions import Label
from mars_asp.asp.rules.premises import premises_of_rule
from mars_asp.asp.rules.rule import HOLE, Rule
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, atoms, labelled
from mars_asp.asp.units import UNITS, measured
from mars_asp.diagnostic import Diagnostic, MarsError

_Value = TypeVar("_Value")


class RenderedMessage(NamedTuple):
    """The message of one rule instance: the atom of its head, and the values of its holes.

    `number` is the index of the rule in the sequence that was passed to `saying`.
    """

    number: int
    rule: Rule
    head: TermId
    values: TermId

    @property
    def message(self) -> str | None:
        """Return the rule's message, or None if it has none."""
        return self.filled(self.rule.because)

    @property
    def help(self) -> str | None:
        """Return the help of the rule, or None if it has none."""
        return self.filled(self.rule.help)

    @property
    def effect(self) -> str | None:
        """Return the effect that the rule states, or None if it states none."""
        return self.filled(self.rule.effect)

    def filled(self, text: str | None, show: Callable[[TermId], str] | None = None) -> str | None:
        """Return a text with values in its holes, as `show` renders them; None for None."""
        # Most help texts have no hole.
        if text is None or "{" not in text:
            return text
        values = dict(zip(self.rule.holes, arguments(self.values), strict=True))
        return fill(text, values, written if show is None else show)


def saying(stage: str, rules: Sequence[Rule]) -> list[Fragment]:
    """Return rules that derive atoms with the values of messages, one for each of `rules`.

    `rendered_messages` reads the atoms. The body is that of the rule; its head would make clingo
    join many atoms.
    """
    predicate = predicate_of(stage)
    return [_saying(predicate, number, rule) for number, rule in enumerate(rules)]


def _made_of(rule: Rule, text: str, gives: str) -> Fragment:
    """Return a fragment of a text made from a rule, with the premises of the rule."""
    return Fragment(text, "rules", rule.span, premises_of_rule(rule, text, gives))


def predicate_of(stage: str) -> str:
    """Return the name of the predicate that holds the messages of a stage."""
    return f"_said_{stage}"


def rendered_messages(
    control: clingo.Control, stage: str, rules: Sequence[Rule]
) -> Iterator[RenderedMessage]:
    """Yield the messages of rules; the fragments of `saying` must be grounded with them."""
    return (heard(atom, rules) for atom in atoms(control, predicate_of(stage), 3, True))


def heard(atom: TermId, rules: Sequence[Rule]) -> RenderedMessage:
    """Return the message in an atom of the predicate `predicate_of(stage)`."""
    place, head, values = arguments(atom)
    number = _number(place)
    return RenderedMessage(number, rules[number], head, values)


# Few rules have very many messages.
@lru_cache(maxsize=1024)
def _number(term: TermId) -> int:
    return as_symbol(term).number


class Labelled(NamedTuple):
    """The label that an instance of a rule gives a listed term; `head` is the atom of its head."""

    head: TermId
    term: TermId
    text: str


def labelling(stage: str, listed: Sequence[tuple[Rule, Label]]) -> list[Fragment]:
    """Return rules that derive an atom for each place with a label; `labels` reads the atoms.

    `listed` are the labels, each with the rule that has it in its metadata.
    """
    predicate = f"_label_{stage}"
    return [
        _made_of(
            rule,
            f"{predicate}({number},{head},{label.term},v({','.join(label.holes)})) :- "
            f"{label.body or '#true'}.",
            predicate,
        )
        for number, (rule, label) in enumerate(listed)
        for head in (rule.written[0],)
    ]


def labels(
    control: clingo.Control, stage: str, listed: Sequence[tuple[Rule, Label]]
) -> Iterator[Labelled]:
    """Yield the labels of terms, rule by rule, from a program grounded with `labelling`."""
    found = map(arguments, atoms(control, f"_label_{stage}", 4, True))
    for place, head, term, values in sorted(found, key=lambda each: list(map(as_symbol, each))):
        label = listed[as_symbol(place).number][1]
        filled = dict(zip(label.holes, arguments(values), strict=True))
        yield Labelled(head, term, fill(label.text, filled, written) or "")


def check_decided(control: clingo.Control, stage: str, rules: Sequence[Rule]) -> None:
    """Raise MarsError unless grounding alone decides which messages hold.

    Raises:
        MarsError: a choice or a cycle of negation would decide; it lists the rules with locations.
    """
    found = labelled(control, predicate_of(stage), 3, True)
    undecided = {as_symbol(arguments(atom)[0]).number for atom, _, is_fact in found if not is_fact}
    if undecided:
        raise MarsError(
            Diagnostic(
                "rule-undecided",
                "error",
                "whether this holds depends on a choice",
                rules[number].span,
                help="findings must follow from the facts: use no choice, and no predicate that "
                "depends on its own negation",
                excerpt=rules[number].text.partition("\n")[0],
            )
            for number in sorted(undecided)
        )


def fill(
    text: str | None, values: Mapping[str, _Value], show: Callable[[_Value], str]
) -> str | None:
    """Return a message with values, rendered by `show`, in its `{Variable}` holes; None for None.

    The number in a hole `{Variable:sort}` is written in the unit of the sort.
    """
    if text is None:
        return None
    form, holes, sorts = _message_form(text)
    if not holes:
        return text
    shown_values = [show(values[h]) if h in values else f"{{{h}}}" for h in holes]
    for at, sort in sorts:
        if shown_values[at].removeprefix("-").isdigit():
            shown_values[at] = measured(int(shown_values[at]), sort)
    return form % tuple(shown_values)


@cache
def _message_form(text: str) -> tuple[str, tuple[str, ...], tuple[tuple[int, str], ...]]:
    """Return the message as a `%` template, its variables, and the sort of each hole by index."""
    found = HOLE.findall(text)
    sorts = tuple((at, sort) for at, (_, sort) in enumerate(found) if sort in UNITS)
    return HOLE.sub("%s", text.replace("%", "%%")), tuple(name for name, _ in found), sorts


# The same few names occur in very many messages.
@lru_cache(maxsize=100_000)
def written(value: TermId) -> str:
    """Return a term as a message shows it."""
    return shown(as_symbol(value))


def shown(symbol: clingo.Symbol) -> str:
    """Return a term as a message shows it: a string without its quotes, a list in words."""
    if symbol.type == clingo.SymbolType.String:
        return symbol.string
    names, more = _list_items(symbol)
    if not names:
        return str(symbol)
    *others, last = [*names, *([f"{more} more"] if more else [])]
    return f"{', '.join(others)} and {last}" if others else last


def _list_items(symbol: clingo.Symbol) -> tuple[list[str], int]:
    """Return the names in `and("A",and("B",N))`, each in backquotes, and N, how many more, or 0."""
    names: list[str] = []
    while symbol.match("and", 2):
        first, symbol = symbol.arguments
        names.append(f"`{shown(first)}`")
    return names, symbol.number if symbol.type == clingo.SymbolType.Number else 0


# Each analysis needs the fragments of the same rules.
@lru_cache(maxsize=4096)
def _saying(predicate: str, number: int, rule: Rule) -> Fragment:
    head, body = rule.written
    # A choice offers several atoms, or none.
    term = "none" if rule.is_choice else head
    text = f"{predicate}({number},{term},v({','.join(rule.holes)})) :- {body or '#true'}."
    return _made_of(rule, text, predicate)
