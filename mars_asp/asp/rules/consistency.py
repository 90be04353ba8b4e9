"""Rule packs that leave no answer set.

A minimal set of rules that together exclude every answer is reported. It is found by leaving out
one rule after the other, as deletion filters do (Chinneck and Dravnieks 1991); every rule in it is
needed. The built-in rules alone always have an answer.
"""

from collections.abc import Sequence

import clingo

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import BASE, Rulebook
from mars_asp.asp.rules.statements import without_rules
from mars_asp.diagnostic import Diagnostic, MarsError

#: The code of the error about packs that leave no answer.
INCONSISTENT = "rules-inconsistent"
_OPTIONS = ("--seed=1", "--warn=none", "--opt-mode=ignore")


def check_packs(control: clingo.Control, rulebook: Rulebook, facts: str, finding: str) -> None:
    """Raise MarsError if the rules of packs have no answer set with the facts.

    `control` holds all rules of the base and the facts, grounded; without packs nothing is done.
    `finding` is the predicate of findings, which the advice names.

    Raises:
        MarsError: there is none; it lists the conflicting rules with their locations.
    """
    if not rulebook.packs or control.solve().satisfiable:
        return
    fixed = [rulebook.built_in.text(BASE)]
    fixed += [without_rules(text) for text in rulebook.pack_texts(BASE)]
    rules = [rule for rule in rulebook.of_packs if rule.stage == BASE]
    conflict = _minimal(rules, "\n".join([*fixed, facts]))
    rule, *others = conflict
    count = len(conflict)
    message = "this rule excludes" if count == 1 else f"these {count} rules together exclude"
    raise MarsError(
        (
            Diagnostic(
                INCONSISTENT,
                "error",
                f"{message} every answer",
                rule.span,
                tuple((each.span, f"with `{' '.join(each.text.split())}`") for each in others),
                f"drop or weaken one of them; a pack derives `{finding}` instead of refusing",
                rule.text.partition("\n")[0],
            ),
        )
    )


def _minimal(rules: Sequence[Rule], fixed: str) -> list[Rule]:
    kept = list(rules)
    for rule in rules:
        rest = [other for other in kept if other is not rule]
        control = clingo.Control(_OPTIONS)
        control.add("base", [], "\n".join([fixed, *(each.text for each in rest)]))
        control.ground()
        if not control.solve().satisfiable:
            kept = rest
    return kept
