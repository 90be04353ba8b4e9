"""The sentences and the trace of a rule in its example, which the wheel holds in a table."""

from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import digest, memoized
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.trace.text import traces_text
from mars_asp.asp.trace.tree import Derived
from mars_asp.cli.lines import line_at
from mars_asp.output import visible
from mars_asp.reasoning.cases.examples import example_of, example_trace

#: The width of traces, the same in the table of the wheel and beside the cases.
_WIDTH = 80


class RuleExample(NamedTuple):
    """The message, effect and help of a rule with the values of its example, and the trace.

    The table of the wheel has no traces, which are large.
    """

    because: str | None
    effect: str | None
    help: str | None
    trace: tuple[str, ...] = ()


def rule_example(rule: Rule, rulebook: Rulebook) -> RuleExample | None:
    """Return the example of a rule, solved if its case exists, else from the table; or None."""
    if rule.because is None:
        return None
    return _solve_example(rule, rulebook) or tabled_example(rule)


def tabled_example(rule: Rule, solved: RuleExample | None = None) -> RuleExample | None:
    """Return the example of a rule in the table of the wheel, else `solved`, which may be None.

    The first call for a rule decides: a build, with `solved`, thereby fills the table.
    """
    key = (rule.id, digest(rule.text.encode()))
    return memoized("examples", (Path(__file__),), [key], lambda _: solved)[key]


def table_examples(rulebook: Rulebook) -> None:
    """Solve the example of each rule, so that the build stores it in a table."""
    for rule in rulebook.rules:
        example = None if rule.because is None else _solve_example(rule, rulebook)
        if example is not None:
            tabled_example(rule, example._replace(trace=()))


def _solve_example(rule: Rule, rulebook: Rulebook) -> RuleExample | None:
    if example_of(rule) is None:
        return None
    found = example_trace(rule, rulebook)
    if found is None or not isinstance(found[1], Derived):
        return None
    lines = map(visible, traces_text([found], line_at, width=_WIDTH))
    because, effect, help_text = map(found[1].with_values, (rule.because, rule.effect, rule.help))
    return RuleExample(because, effect, help_text, tuple(lines))
