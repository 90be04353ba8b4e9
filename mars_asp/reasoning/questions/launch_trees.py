"""Explanations of findings in files of others: their places, their conditions and their traces."""

import re
from collections.abc import Iterator, Sequence

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.trace.tree import Unexplained
from mars_asp.model.graph import OPEN_BRANCH, OPEN_CONDITION
from mars_asp.reasoning.analysis import Analysis, Consequence, diagnostic
from mars_asp.reasoning.questions.account import Account, Cited
from mars_asp.reasoning.questions.explain import Explanation, Topic
from mars_asp.reasoning.session import Evidence

#: The order of findings, which are in the order of their places otherwise.
_GRAVITY = {"error": 0, "warning": 1, "note": 2}
#: Labels that compare a place with the first one.
_AGAIN = re.compile(r"\b(?:too|as well|again|same)\b")
_NAME = re.compile(r"`([^`]+)`")


def explain_findings(
    analysis: Analysis,
    rules: Rulebook,
    subject: str | None,
    *,
    every: bool,
    traced: bool,
) -> Explanation | None:
    """Explain the findings of an analysis, or those of a kind, name, file or line.

    Args:
        analysis: The findings in launch trees or a dataflow.
        rules: The rules that the analysis was made with.
        subject: The subject of the findings: their kind, `KIND(NAME)`, a node, a topic, or
            `FILE:LINE`; all if it is None.
        every: Whether steps of traces have all derivations.
        traced: Whether topics have traces.

    Returns:
        The findings, or None if none is about the subject.
    """
    chosen = sorted(
        (each for each in analysis.consequences if subject is None or is_about(each, subject)),
        key=lambda finding: _GRAVITY[finding.severity],
    )
    if subject is not None and not chosen:
        return None
    evidence = Evidence(rules, analysis.facts, analysis)
    traces = evidence.explainer.why([each.atom for each in chosen], every) if traced else {}
    topics = []
    for each in chosen:
        title = f"{each.kind}({each.subject})"
        trace = traces.get(each.atom) or Unexplained(title, "no trace was requested")
        account = Account(each.message, tuple(_finding_lines(each)), tuple(_notes(each)))
        topics.append(
            Topic(
                title,
                title,
                "consequence",
                each.severity,
                each.rule.id,
                (),
                account,
                trace,
                each.atom,
            )
        )
    return Explanation(subject, tuple(topics), analysis, None)


def is_about(finding: Consequence, subject: str) -> bool:
    """Whether a finding has a subject as its kind, rule, subject, participant or location.

    Names in its message count as participants: a finding about robots that are alike lists them.
    """
    names = {finding.subject, *finding.participants, *_NAME.findall(finding.message)}
    names |= {f"{finding.kind}({name})" for name in names}
    names |= {finding.kind, finding.rule.id, str(finding.atom)}
    conditions = (each.span for each in finding.conditions if each.span is not None)
    places = {f"{span.path}:{span.line}" for span in (*finding.spans, *conditions)}
    return subject in names or any(
        place == subject or place.endswith(f"/{subject}") for place in places
    )


def _finding_lines(finding: Consequence) -> Iterator[Cited]:
    """Yield the places of a finding, then those of its conditions."""
    labels = dict(finding.labels)
    if _AGAIN.search(labels.get(finding.spans[0], "") if finding.spans else ""):
        del labels[finding.spans[0]]
    lines = {span[:2]: (span, labels.get(span, "")) for span in reversed(finding.spans)}
    for condition in finding.conditions:
        if condition.span is not None:
            of = f"only {condition.how} `{condition.variable}` is `{condition.value}`"
            if condition.variable.startswith(OPEN_CONDITION):
                of = f"only {condition.how} this condition holds"
            elif condition.variable.startswith(OPEN_BRANCH):
                of = f"only {condition.how} the code takes branch {condition.value} here"
            lines.setdefault(condition.span[:2], (condition.span, of))
    # The places of the finding keep their order, and those of the conditions follow.
    order = {span: number for number, span in enumerate(finding.spans)}
    for span, label in sorted(
        lines.values(), key=lambda line: (order.get(line[0], len(order)), line)
    ):
        yield Cited(span, f"{span.path}:{span.line}", label)


def _notes(finding: Consequence) -> Sequence[str]:
    """Return the effect of a finding, its conditions and launch files, and the advice."""
    shown = diagnostic(finding)
    advice = finding.help and f"{finding.help[:1].upper()}{finding.help[1:].rstrip('.')}."
    advice = advice and advice.replace("?.", "?")
    return [text for text in (shown.effect, advice) if text]
