"""The case that a rule names as its example, with a trace of the rule."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import clingo

from mars_asp.asp.cases import case_texts
from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.trace import Explainer, Trace
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.asp.trace.tree import Derived, atom_of
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.reasoning.cases.configurations import SUFFIX
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.launch_trees import launch_rules
from mars_asp.reasoning.packs import MANIFEST
from mars_asp.reasoning.project import load_project, project_facts, with_brought
from mars_asp.reasoning.rules import rules_directory


def example_of(rule: Rule) -> Path | None:
    """Return the file that a rule names as its example, or None if there is no such file.

    Its path is relative to the current folder, the folder of the rule's pack, or the sources.
    """
    if rule.example is None:
        return None
    above = (each for each in Path(rule.span.path).parents if (each / MANIFEST).is_file())
    places = (Path(), *above, rules_directory().parent)
    return next((each / rule.example for each in places if (each / rule.example).is_file()), None)


def example_trace(rule: Rule, rulebook: Rulebook) -> tuple[str, Trace] | None:
    """Return an atom that a rule derives in its example, with the trace of the atom.

    The result is None if the rule has no readable example, or derives nothing there. Only rules of
    the base and rules about launch files are supported.

    Raises:
        MarsError: the example cannot be read.
    """
    path = example_of(rule)
    if path is None or rule.stage not in ("base", "launch"):
        return None
    if rule.stage == "launch":
        rulebook = launch_rules(rulebook)
    for text, facts in _examples(path, rulebook):
        program = [*rulebook.fragments("base"), Fragment(text, str(path))]
        grounding = Grounding(program)
        atoms = [
            symbol
            for head in sorted(rule.heads)
            for symbol in grounding.symbols(head.name, head.arity)
            if _can_derive(rule, symbol)
        ]
        given = GivenFacts(facts, rulebook.declarations)
        explained = Explainer(rulebook, grounding.control, given, {}).why(atoms)
        for symbol, trace in explained.items():
            if isinstance(trace, Derived) and trace.rule.span == rule.span:
                return str(symbol), trace
    return None


def _can_derive(rule: Rule, symbol: clingo.Symbol) -> bool:
    """Whether the heads of a rule can derive an atom, judged by its first argument."""
    firsts = {name for named in rule.firsts.values() for name in named}
    return not firsts or not symbol.arguments or str(symbol.arguments[0]) in firsts


def _examples(path: Path, rulebook: Rulebook) -> Iterator[tuple[str, Sequence[Fact]]]:
    """Yield the facts of each case of a file, as a text and with their locations."""
    if path.suffix == SUFFIX:
        facts = project_facts(with_brought(load_project(str(path)), rulebook.brought))
        yield facts_text(facts), facts
        return
    for text in map(rulebook.as_named, case_texts(path)):
        problems: list[Diagnostic] = []
        read = read_rules(text, str(path), "base", problems)
        if read is None:
            raise MarsError(problems)
        yield text, tuple(_facts(read.rules))


def _facts(rules: Iterable[Rule]) -> Iterator[Fact]:
    for rule in rules:
        head, body = rule.written
        if not body:
            try:
                symbol = clingo.parse_term(head)
            except RuntimeError:
                continue
            if symbol.type == clingo.SymbolType.Function and symbol.name:
                yield Fact(atom_of(symbol), rule.span)
