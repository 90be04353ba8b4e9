"""Predicates of rules that share their name with another."""

from collections.abc import Iterator, Sequence
from itertools import chain

from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import defined_at
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span, point

NAME = "rule-name"


def shared_names(rulebook: Rulebook) -> Iterator[LintFinding]:
    """Yield the predicates that share their name with an earlier one of other arity.

    A reader confuses them, and a forgotten argument shows nowhere. With packs, a name in built-in
    rules counts only if packs may read the predicate: others are outside of their name space.
    """
    hidden = frozenset(rulebook.built_in.paths) if rulebook.packs else frozenset()
    open_to_packs = {
        signature
        for signature, each in rulebook.declarations.items()
        if each.public or each.origin is not None
    }

    def is_hidden(path: str, signature: Signature) -> bool:
        return path in hidden and signature not in open_to_packs

    declared = [
        (path, tuple(_declarations(path, text)))
        for path, (_, text) in zip(rulebook.paths, rulebook.texts, strict=True)
    ]
    # Finding the locations in rules takes long, and hardly any name is shared.
    arities: dict[str, set[int]] = {}
    for signature, _ in chain.from_iterable(found_in for _, found_in in declared):
        arities.setdefault(signature.name, set()).add(signature.arity)
    for rule in rulebook.rules:
        for signature in rule.heads | rule.reads:
            if not is_hidden(rule.span.path, signature):
                arities.setdefault(signature.name, set()).add(signature.arity)
    shared = {name for name, found_ in arities.items() if len(found_) > 1}
    by_path: dict[str, list[Rule]] = {}
    for rule in rulebook.rules:
        if any(signature.name in shared for signature in rule.heads | rule.reads):
            by_path.setdefault(rule.span.path, []).append(rule)
    first: dict[str, dict[int, tuple[Span, Rule | None]]] = {}
    for path, found_in in declared:
        for (name, arity, _), place in found_in:
            first.setdefault(name, {}).setdefault(arity, (place, None))
        for rule in by_path.get(path, ()):
            for signature, place in _named_predicates(rule):
                if not is_hidden(path, signature):
                    name, arity, _ = signature
                    first.setdefault(name, {}).setdefault(arity, (place, rule))
    for name, places in first.items():
        (arity, (earlier, _)), *others = places.items()
        for other, (place, owner) in others:
            message = f"`{name}/{other}` shares its name with `{name}/{arity}`"
            labels = ((earlier, f"`{name}/{arity}`, first named here"),)
            advice = "one name has one meaning: give each predicate its own name"
            yield found(NAME, message, place, owner, advice, labels=labels)


def declared_in(rulebook: Rulebook, texts: Sequence[tuple[str, str]]) -> dict[Signature, Span]:
    """Return the locations of the `#defined` statements of some texts, by predicate."""
    return {
        signature: place
        for path, each in zip(rulebook.paths, rulebook.texts, strict=True)
        if each in texts
        for signature, place in _declarations(path, each[1])
    }


def _declarations(path: str, text: str) -> Iterator[tuple[Signature, Span]]:
    """Yield the predicates that a file declares by `#defined`, with their locations."""
    for signature, place in defined_at(text):
        yield signature, point(path, *place)


def _named_predicates(rule: Rule) -> Iterator[tuple[Signature, Span]]:
    """Yield the predicates that occur in a rule, with their locations."""
    literals = {
        (literal.place, literal.signature.unsigned)
        for statement in rule.statements
        for literal in statement.literals
    }
    for place, signature in sorted(literals):
        yield signature, rule.listed or placed(rule.span, place)
