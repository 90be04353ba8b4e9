"""The constraints of rule packs that leave a configuration without a specification.

Each constraint that could be the reason is relaxed: it derives its violation instead of excluding
the answer, and the search minimises the violations. No specification satisfies the constraints that
remain violated. This costs a second grounding, and is only done without a specification.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.messages import RenderedMessage, heard
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import bound_variables, without_rules
from mars_asp.asp.signature import Signature, plain
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.reasoning.facts.compile import given

_STAGE = "resolve"
_BROKEN = Signature("_broken", 3)
#: Higher than the levels of all other minimisation.
_LEVEL = 1_000_000
#: At most this many violated instances are reported.
_MOST = 20


class NoSpecificationError(MarsError):
    """Constraints of rule packs, or about their nodes, exclude every specification."""

    status = 1


def excluded(
    rulebook: Rulebook, facts: Iterable[Fact], wanted: str = ""
) -> NoSpecificationError | None:
    """Return the constraints that no specification satisfies, or None if these are not the reason.

    `wanted` is an atom that specifications must have, with `_` for any value, or empty.

    Raises:
        MarsError: clingo refuses the rules.
    """
    of_packs = set(map(id, rulebook.of_packs))
    rules = [rule for rule in rulebook.rules if rule.stage == _STAGE]
    constraints = (r for r in rules if not r.heads and not r.is_choice and r.listed is None)
    relaxed = [each for each in constraints if id(each) in of_packs or each.because]
    if not relaxed:
        return None
    grounding = Grounding([*rulebook.fragments("base"), given(facts)])
    left_out = set(map(id, relaxed))
    kept = [rule.text for rule in rules if id(rule) not in left_out]
    others = [without_rules(text) for stage, text in rulebook.texts if stage == _STAGE]
    broken = [_relaxed(number, rule) for number, rule in enumerate(relaxed)]
    cost = f"#minimize {{ 1@{_LEVEL},N,V : _broken(N,none,V) }}."
    demand = [f":- not {wanted}."] if wanted else []
    try:
        program = "\n".join([*others, *kept, *broken, *demand, cost])
        found = grounding.resolve([Fragment(program, "rules")])
        found.answer.check()
    except MarsError:
        return None
    entries = [heard(atom, relaxed) for atom in found.answer.true_of([_BROKEN])[_BROKEN]]
    return NoSpecificationError(_diagnostics(entries)) if entries else None


def _relaxed(number: int, rule: Rule) -> str:
    """Return the text of a constraint as a rule that derives its violation, numbered `number`."""
    holes = rule.holes if rule.because else tuple(sorted(bound_variables(rule.text)))
    return f"_broken({number},none,v({','.join(holes)})) :- {rule.written[1] or '#true'}."


def _diagnostics(messages: Sequence[RenderedMessage]) -> Iterator[Diagnostic]:
    for each in messages[:_MOST]:
        rule = each.rule
        message = each.message
        if message is None:
            holes = ", ".join(f"`{{{name}}}`" for name in sorted(bound_variables(rule.text)))
            about = f", here for {holes}" if holes else ""
            spoken = replace(rule, because=f"no specification meets this constraint{about}")
            message = each._replace(rule=spoken).message or ""
        yield Diagnostic(
            rule.id,
            "error",
            message,
            rule.span,
            help=each.help or "weaken the constraint, or change what it forbids",
            excerpt=plain(rule.text.partition("\n")[0]),
        )
