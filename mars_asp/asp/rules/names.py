"""Predicates of rules that share their name with another."""

from collections.abc import Iterator

from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import defined, pieces
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, Span, by_place, point


def shared_names(rulebook: Rulebook) -> tuple[Diagnostic, ...]:
    """Return, by place, the predicates that share their name with an earlier one of other arity.

    Who reads one of them takes it for the other, and a forgotten argument shows nowhere.
    """
    first: dict[str, dict[int, Span]] = {}
    for path, (_, text) in zip(rulebook.paths, rulebook.texts, strict=True):
        for (name, arity, _), span in (
            *_declarations(path, text),
            *(each for rule in rulebook.rules if rule.span.path == path for each in _named(rule)),
        ):
            first.setdefault(name, {}).setdefault(arity, span)
    return by_place(
        Diagnostic(
            "rule-name",
            "warning",
            f"`{name}/{other}` shares its name with `{name}/{arity}`",
            span,
            ((earlier, f"`{name}/{arity}`, first named here"),),
            help="one name has one meaning: give each predicate its own name",
        )
        for name, ((arity, earlier), *others) in (
            (name, places.items()) for name, places in first.items()
        )
        for other, span in others
    )


def _declarations(path: str, text: str) -> Iterator[tuple[Signature, Span]]:
    """Yield the predicates that a file declares as given, with their places."""
    for piece in pieces(text):
        if piece.sort == "declaration":
            for signature in defined(piece.text):
                yield signature, point(path, *piece.begin)


def _named(rule: Rule) -> Iterator[tuple[Signature, Span]]:
    """Yield the predicates that a rule names, with their places."""
    literals = {
        (literal.place, literal.signature.unsigned)
        for statement in rule.statements
        for literal in statement.literals
    }
    for place, signature in sorted(literals):
        yield signature, rule.listed or placed(rule.span, place)
