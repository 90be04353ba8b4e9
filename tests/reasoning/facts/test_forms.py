"""The declared sorts and keys hold for the facts of sample robots."""

from mars_asp.asp.solve.atoms import Atom, Term
from mars_asp.reasoning.facts.vocabulary import FORMS
from mars_asp.reasoning.project import project_facts
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.sample import samples


def form(term: Term) -> str:
    match term:
        case int():
            return "number"
        case str():
            return "string"
        case Atom(_, ()):
            return "name"
        case _:
            return "function"


def test_facts_are_of_the_forms_and_keys_that_are_declared() -> None:
    declared = load_rulebook(stages=()).declarations
    by_name = {(each.name, len(each.arguments)): each for each in declared.values()}
    seen: set[str] = set()
    for project in samples():
        rows: dict[tuple[object, ...], tuple[Term, ...]] = {}
        for fact in project_facts(project):
            atom = fact.atom
            each = by_name[atom.name, len(atom.arguments)]
            for argument, term in zip(each.arguments, atom.arguments, strict=True):
                forms = {FORMS.get(sort) for sort in argument.sorts}
                if argument.sorts and None not in forms and str(term) not in argument.constants:
                    seen |= argument.sorts
                    if isinstance(term, Atom) and term.name in argument.constants:
                        continue
                    assert form(term) in forms, (atom, argument)
            for key in each.keys:
                row = (atom.name, key, *(atom.arguments[at] for at in key))
                assert rows.setdefault(row, atom.arguments) == atom.arguments, (atom, key)
    assert {"module", "relationship", "annotation", "representation", "mode"} <= seen
