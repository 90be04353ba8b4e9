"""The results of the analysis of rules: predicates and their occurrences in all files."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from mars_asp.lsp.places import Place, Position
from mars_asp.lsp.rule_text import PredicateMention, RuleText, rule_text


class Predicate(NamedTuple):
    """A documented predicate: its head with arguments, its docstring and the location."""

    name: str
    written: str
    words: str
    place: Place


class Rules(NamedTuple):
    """The rules that a file is used with: predicates by name and arity, occurrences by file."""

    predicates: Mapping[tuple[str, int], tuple[Predicate, ...]] = {}
    files: Mapping[str, tuple[PredicateMention, ...]] = {}


def predicate_mentions(
    here: RuleText, rules: Rules, texts: Mapping[str, str], key: tuple[str, int]
) -> Iterator[tuple[Place, PredicateMention]]:
    """Yield the occurrences of a predicate in this text, then in other files."""
    path = here.text.path
    files = {path: here.mentions, **{p: m for p, m in rules.files.items() if p != path}}
    for name, mentions in files.items():
        if name != path and name in texts:
            mentions = rule_text(name, texts[name]).mentions  # noqa: PLW2901 -- as it is now
        for each in mentions:
            if each.key == key:
                yield Place(name, each.range), each


def predicate_definition(
    here: RuleText, rules: Rules, texts: Mapping[str, str], position: Position
) -> tuple[Place, ...]:
    """Return the rule heads and docstrings of the predicate at a position."""
    mention = here.at(position)
    if mention is None:
        return ()
    documented = (each.place for each in rules.predicates.get(mention.key, ()))
    derived = (
        place for place, each in predicate_mentions(here, rules, texts, mention.key) if each.is_head
    )
    return tuple(dict.fromkeys((*derived, *documented)))
