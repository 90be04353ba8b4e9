"""Does a specification realise a configuration: facts of both, judged by `rules/verify`."""

from collections.abc import Iterable
from dataclasses import dataclass

from mars_asp.analysis import fill
from mars_asp.atom import Atom, Fact
from mars_asp.facts import configuration_facts, facts_text
from mars_asp.model import Configuration
from mars_asp.project import Project, project_facts
from mars_asp.rulebook import Rule, Rulebook
from mars_asp.solve import Grounding

_VIOLATION = "violation"


@dataclass(frozen=True, slots=True)
class Violation:
    """A clause of the definition of `realises` that fails, and how."""

    clause: int
    message: str
    help: str | None
    rule: Rule


def verify(
    specification: Configuration, project: Project, rulebook: Rulebook
) -> tuple[Violation, ...]:
    """Return what keeps a specification from realising a project's configuration.

    `rulebook` holds the stage `verify`. Clause 5, on InheritanceNodes, is not judged yet.

    Raises:
        MarsError: numbers that do not fit, rules that clingo refuses.
    """
    facts = (*project_facts(project), *specification_facts(specification, project.configuration))
    judges = [r for r in rulebook.rules if r.text.startswith(f"{_VIOLATION}(")]
    said = "\n".join(_saying(number, rule) for number, rule in enumerate(judges))
    text = "\n".join((rulebook.text("base"), rulebook.text("verify"), said))
    grounding = Grounding(text, facts_text(facts))
    found: dict[tuple[int, str], Violation] = {}
    for symbol in grounding.symbols("_judged", 3):
        number, head, values = symbol.arguments
        rule = judges[number.number]
        named = dict(zip(rule.holes, values.arguments, strict=True))
        message = fill(rule.because, named) or str(head)
        clause = head.arguments[0].number
        found[clause, message] = Violation(clause, message, fill(rule.help, named), rule)
    return tuple(found[key] for key in sorted(found))


def specification_facts(
    specification: Configuration, configuration: Configuration
) -> Iterable[Fact]:
    """Yield the facts of a specification, each predicate under a name that begins with `spec_`."""
    names = {name.text for name in configuration.modules}
    for fact in configuration_facts(specification):
        if fact.atom.name == "spec_node" and fact.atom.arguments[0] in names:
            continue
        yield Fact(Atom(f"spec_{fact.atom.name}", fact.atom.arguments), fact.span)
    for conversion in specification.conversions:
        ends = (conversion.transformer, conversion.source, conversion.target)
        yield Fact(Atom("spec_converts", ends), conversion.span)


def _saying(number: int, rule: Rule) -> str:
    body = "; ".join(str(literal) for literal in rule.ast.body)
    return f"_judged({number},{rule.ast.head},v({','.join(rule.holes)})) :- {body}."
