"""Kinds of findings and of nodes in the output of `rules show`."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.model.declarations import PackKind, node_names
from mars_asp.reasoning.findings import consequence_kinds, kinds_of

_OUTPUTS = {"none": "no output: it only listens", "one": "one output", "several": "several outputs"}
#: The stages of rules that only provide sentences of explanations.
_SENTENCES = frozenset({"account", "absence"})


@dataclass(frozen=True)
class Kind:
    """A kind of finding or node, with the rules that mention it."""

    name: str
    sort: str
    rules: tuple[Rule, ...]
    #: The definition of a kind of node in a pack.
    definition: PackKind | None = None
    #: The name of such nodes in `.mars` files.
    called: str | None = None


def kinds(rulebook: Rulebook) -> dict[str, Kind]:
    """Return the kinds of findings and nodes by name; nodes also by their names in files."""
    found: dict[str, Kind] = {}
    brought = {each.kind: each for each in rulebook.brought if isinstance(each, PackKind)}
    for kind, name in node_names(brought.values()).items():
        # A built-in rule with the word of a pack's kind means something else by it.
        rules = tuple(
            rule
            for rule in (rulebook.of_packs if kind in brought else rulebook.rules)
            if rule.because
            and rule.stage not in _SENTENCES
            and kind in re.split(r"[\s(),]+", rule.text)
        )
        node = Kind(kind, "node", rules, brought.get(kind), name)
        found |= {kind: node, name: node}
    for kind in consequence_kinds(rulebook):
        rules = tuple(rule for rule in rulebook.rules if kind in (kinds_of(rule) or ()))
        found[kind] = Kind(kind, "consequence", rules)
    return found


def kind_document(kind: Kind) -> Iterator[str]:
    """Yield the paragraphs about a kind, except those about its rules."""
    if kind.sort == "consequence":
        yield f"## {kind.name}"
        yield "A kind of finding."
    else:
        yield f"## {kind.called}"
        yield f"A kind of node, `{kind.name}` in rules."
    declared = kind.definition
    if declared is not None:
        takes = "several inputs" if declared.inputs == "several" else "one input"
        yield f"It carries {declared.carries}, with {takes} and {_OUTPUTS[declared.outputs]}."
        yield f"{declared.span.path}:{declared.span.line}"


def kind_json(kind: Kind) -> dict[str, object]:
    """Return a kind of consequence or node as JSON, with the ids of its rules."""
    declared = kind.definition
    more: dict[str, object] = {}
    if declared is not None:
        more = {
            "carries": declared.carries,
            "inputs": declared.inputs,
            "outputs": declared.outputs,
            "path": declared.span.path,
            "line": declared.span.line,
        }
    named = {} if kind.called is None else {"name": kind.called}
    rules = [rule.id for rule in kind.rules]
    return {"kind": kind.name, "sort": kind.sort, **named, **more, "rules": rules}
