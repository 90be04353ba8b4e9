"""Rules added to a program that show which of its rules fire, and which fail by one premise."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import chain

import clingo

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.trees import Kind, Sign, SyntaxNode, names_in, with_variables

FIRED, NEAR = "_fired", "_near"
#: The line of a statement that is not safe.
_UNSAFE = re.compile(r"<block>:(\d+):\S+ error: unsafe variables")
#: The maximal number of messages of clingo.
_MOST_NOTES = 10_000


def probes(number: int, rule: Rule) -> Iterator[tuple[str, str]]:
    """Yield pairs of a predicate and a rule that derives it with the number of a rule.

    `_fired` holds if the body holds, `_near` if all literals except one hold. Variables that only
    this literal binds match any value. Probes that clingo finds unsafe are left out. A rule made
    from metadata has no `_near`: it repeats the body of its rule, where each premise is tried.
    """
    for name, body in probed(rule):
        yield name, _probe_of(name, number, body)


@cache
def probed(rule: Rule) -> tuple[tuple[str, Sequence[SyntaxNode]], ...]:
    """Return the predicates that `probes` derives, each with the body of its probe."""
    found = list(_bodies(rule))
    safe = _are_safe([_probe_of(name, 0, body) for name, body in found])
    return tuple(probe for probe, is_safe in zip(found, safe, strict=True) if is_safe)


def fired(number: int, rule: Rule) -> str:
    """Return a rule that derives `_fired(number)` if the body of `rule` holds."""
    name, body = next(_bodies(rule))
    return _probe_of(name, number, body)


def _probe_of(name: str, number: int, body: Sequence[SyntaxNode]) -> str:
    return f"{name}({number}) :- {'; '.join(map(str, body)) or '#true'}."


def _are_safe(texts: Sequence[str]) -> list[bool]:
    """Return `is_safe` of each statement, found at once: a start of clingo takes long."""
    notes: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: notes.append(note), _MOST_NOTES)
    try:
        control.add("base", [], "\n".join(texts))
        control.ground()
    except RuntimeError:
        found = [note for note in map(_UNSAFE.match, notes) if note]
        if not found or len(found) < len(notes):
            return list(map(is_safe, texts))
        lines = {int(note[1]) for note in found}
        return [line not in lines for line in range(1, len(texts) + 1)]
    return [True] * len(texts)


def is_safe(text: str) -> bool:
    """Whether a statement parses, and whether its premises bind all its variables."""
    control = clingo.Control(["--warn=none"], logger=lambda *_: None)
    try:
        control.add("base", [], text)
        control.ground()
    except RuntimeError:
        return False
    return True


def _bodies(rule: Rule) -> Iterator[tuple[str, Sequence[SyntaxNode]]]:
    body = list(rule.node.body)
    yield FIRED, body
    if rule.listed is not None:
        return
    named = list(map(names_in, body))
    times = Counter(chain.from_iterable(named))
    for index, literal in enumerate(body):
        own = {name for name in named[index] if times[name] == 1}
        yield NEAR, [*body[:index], *body[index + 1 :], *_failing(literal, own)]


def _failing(literal: SyntaxNode, own: set[str]) -> Iterator[SyntaxNode]:
    """Yield the literal that holds exactly if `literal` fails, if there is one."""
    if literal.ast_type != Kind.Literal:
        return
    if literal.sign == Sign.NoSign:
        symbolic = literal.atom.ast_type == Kind.SymbolicAtom
        bare = with_variables(literal, dict.fromkeys(own, "_")) if symbolic else literal
        yield bare.updated(sign=Sign.Negation)
    else:
        yield literal.updated(sign=Sign.NoSign)
