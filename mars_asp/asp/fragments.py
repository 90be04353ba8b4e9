"""Texts that clingo grounds as one, their premises, and the locations of its error messages."""

import re
from collections.abc import Hashable, Iterable, Iterator, Sequence, Set
from functools import lru_cache
from itertools import chain
from typing import NamedTuple, TypeVar

from mars_asp.asp.signature import plain
from mars_asp.diagnostic import Diagnostic, Span, point

_Name = TypeVar("_Name", bound=Hashable)
_UNDEFINED = "operation undefined: "
#: A string, or the text between strings.
_TEXT = re.compile(r'"(?:\\.|[^"\\])*"?|[^"]+')
#: A word that may be the name of a predicate.
_NAME = re.compile(r"[a-z][\w']*")
_NOTE = r"(?s)<block>:(\d+):(\d+)(?:-[\d:]+)?: (?:error|info): (.*)"
_UNSAFE = r"<block>:(\d+):(\d+)(?:-[\d:]+)?: note: '(\w+'*)' is unsafe"


class Premises(NamedTuple):
    """The rules of a text, and the names of the predicates that each needs and derives.

    `rest` are the texts before each rule and after the last one. A rule cannot fire unless each
    predicate that it needs has an atom.
    """

    rest: tuple[str, ...]
    rules: tuple[str, ...]
    needs: tuple[frozenset[str], ...]
    gives: tuple[frozenset[str], ...]


class Fragment(NamedTuple):
    """A text, and its file; a text that was made from a rule has the location of that rule.

    Without `premises`, the text may derive any predicate that it names.
    """

    text: str
    path: str
    rule: Span | None = None
    premises: Premises | None = None


class Note(NamedTuple):
    """A message of clingo with its location; `is_copy` is true in a text that was made from a rule.

    `unsafe` are unbound variables, each with its first location.
    """

    place: Span
    message: str
    is_copy: bool
    unsafe: tuple[tuple[str, Span], ...] = ()


def joined(fragments: Iterable[Fragment]) -> str:
    """Return the texts of fragments as one program."""
    return "\n".join(fragment.text for fragment in fragments)


def fact_fragment(text: str, names: Iterable[str]) -> Fragment:
    """Return a fragment of facts, with the names of their predicates."""
    premises = Premises(("", ""), (text,), (frozenset(),), (frozenset(names),))
    return Fragment(text, "facts", premises=premises)


def firing(rules: Sequence[tuple[Set[_Name], Set[_Name]]], known: Iterable[_Name]) -> Set[int]:
    """Return the indices of the rules that can fire, given the predicates in `known`.

    A rule is (needed names, derived names). It can fire if each needed predicate is known or
    derived by a rule that can fire.
    """
    there = {*known}
    found: set[int] = set()
    waiting = list(range(len(rules)))
    previous = len(waiting) + 1
    while len(waiting) < previous:
        previous, idle = len(waiting), []
        for number in waiting:
            needs, gives = rules[number]
            if needs <= there:
                there |= gives
                found.add(number)
            else:
                idle.append(number)
        waiting = idle
    return found


def able_to_fire(program: Sequence[Fragment], present: Iterable[str] = ()) -> list[Fragment]:
    """Return a program without the rules that cannot fire; all others keep their locations.

    `present` are predicates that have atoms already. clingo would find the same, but at most of the
    cost of a small program.
    """
    known, rules = {*present}, list[tuple[Set[str], Set[str]]]()
    for text, _, _, premises in program:
        if premises is None:
            known.update(_NAME.findall(text))
        else:
            rules += zip(premises.needs, premises.gives, strict=True)
    able, first, found = firing(rules, known), 0, []
    for each in program:
        found.append(_of_rules(each, able, first))
        first += len(each.premises.rules) if each.premises else 0
    return found


def _of_rules(fragment: Fragment, able: Set[int], first: int) -> Fragment:
    """Return a fragment with the rules blanked whose number, from `first` on, is not in `able`."""
    if fragment.premises is None:
        return fragment
    rest, rules, _, _ = fragment.premises
    left_out = [at for at in range(len(rules)) if first + at not in able]
    if not left_out:
        return fragment
    kept = [*rules, ""]
    for at in left_out:
        kept[at] = blank(rules[at])
    text = "".join(chain.from_iterable(zip(rest, kept, strict=True)))
    return Fragment(text, fragment.path, fragment.rule, fragment.premises)


@lru_cache(maxsize=4096)
def blank(text: str) -> str:
    """Return the line ends of a text, and as many blanks as its last line has characters."""
    return "\n" * text.count("\n") + " " * len(text.rpartition("\n")[2])


def notes(messages: Iterable[str], fragments: Sequence[Fragment]) -> Iterator[Note]:
    """Yield clingo's messages about some fragments, with locations, in their order."""
    for match in filter(None, (re.match(_NOTE, each) for each in messages)):
        found = _located(fragments, int(match[1]), int(match[2]))
        if found is not None:
            place, is_copy = found
            variables: dict[str, Span] = {}
            for line, column, name in sorted(
                (int(line), int(column), name)
                for line, column, name in re.findall(_UNSAFE, match[3])
            ):
                location = _located(fragments, line, column)
                variables.setdefault(name, place if location is None else location[0])
            text = " ".join(match[3].split())
            yield Note(place, text, is_copy, tuple(variables.items()))


def _located(fragments: Sequence[Fragment], line: int, column: int) -> tuple[Span, bool] | None:
    """Return the location of a line and column, and whether in a copied rule; None if nowhere."""
    for fragment in fragments:
        lines = fragment.text.count("\n") + 1
        if line <= lines:
            if fragment.rule is not None:
                return fragment.rule, True
            return point(fragment.path, line, _column(fragment, line, column)), False
        line -= lines
    return None


def unbound(note: Note) -> Iterator[Diagnostic]:
    """Yield an error for each unbound variable, at its own location."""
    for name, place in note.unsafe:
        message = f"nothing in the body binds `{name}`"
        advice = "name it in a literal of the body that is not negated"
        yield Diagnostic("rule-unsafe", "error", message, place, help=advice)


def refusals(messages: Iterable[str], fragments: Sequence[Fragment]) -> Iterator[Diagnostic]:
    """Yield the reasons why clingo cannot use some fragments, once for each location."""
    found = dict.fromkeys(notes(dict.fromkeys(messages), fragments))
    # An error in a text made from a rule repeats the error of the rule, and is a fallback.
    for note in [note for note in found if not note.is_copy] or found:
        yield from unbound(note)
        if note.unsafe:
            continue
        place, result = note.place, note.message
        what, colon, term = result.partition(_UNDEFINED)
        if colon and not what:
            message = f"`{term}` has no value" if term.startswith("(") else f"{term}"
            advice = (
                "bind what it is computed from in the body: numbers, and no divisor 0; leave out"
                " other values in a rule of its own, since clingo may compute before it compares"
            )
            yield Diagnostic("rule-undefined", "error", message, place, help=advice)
        else:
            yield Diagnostic("rules-refused", "error", result, place)


def _column(fragment: Fragment, line: int, column: int) -> int:
    """Return the column in characters of a column in bytes, without the names of name spaces."""
    before = fragment.text.split("\n")[line - 1].encode()[: column - 1].decode(errors="ignore")
    return sum(len(text if text[0] == '"' else plain(text)) for text in _TEXT.findall(before)) + 1
