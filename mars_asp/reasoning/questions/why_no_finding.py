"""Why the launch files give no finding of a kind, or that they do."""

import clingo

from mars_asp.asp.messages import rendered_messages, saying
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.term_ids import as_symbol
from mars_asp.asp.trace.absence import explain_absence
from mars_asp.asp.trace.patterns import hole, strings_in
from mars_asp.asp.trace.tree import Trace
from mars_asp.diagnostic import MarsError, Span
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.findings import ABSENT, consequence_kinds
from mars_asp.reasoning.launch_trees import STAGE
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.absence_query import CALL
from mars_asp.reasoning.questions.launch_trees import is_about
from mars_asp.reasoning.questions.subject import wrong_subject
from mars_asp.reasoning.questions.why_not import WhyNot, holds
from mars_asp.reasoning.session import Evidence
from mars_asp.spelling import nearest


def why_no_finding(
    project: Project,
    analysis: Analysis,
    rules: Rulebook,
    subject: str,
    depth: int,
) -> WhyNot | None:
    """Return the finding that a subject names, or why the launch files have none.

    Args:
        project: The project of the launch trees.
        analysis: The findings in them.
        rules: The rules that these were made with.
        subject: `KIND` or `KIND(NAME)`.
        depth: The largest number of levels of the trace of an absence.

    Returns:
        The answer, or None if the subject is not a kind of `rules`.

    Raises:
        MarsError: neither the launch files nor the modules have NAME.
    """
    match = CALL.fullmatch(subject)
    if match is None or match[1] not in consequence_kinds(rules):
        return None
    kind, quoted, bare = match.groups()
    name = bare if quoted is None else quoted
    name = None if name in ("", "_") else name
    known = names_in(analysis) | {each.text for each in project.configuration.modules}
    title = kind if name is None else f"{kind}({name})"
    evidence = Evidence(rules, analysis.facts, analysis)
    found = next((each for each in analysis.consequences if is_about(each, title)), None)
    if found is None and f"/{name}" in known:
        # Names of ROS may be written without their first slash.
        title, name = f"{kind}(/{name})", f"/{name}"
        found = next((each for each in analysis.consequences if is_about(each, title)), None)
    if found is not None:
        return WhyNot(
            subject=title,
            answer=holds(title, found.message),
            evidence=found.spans,
            present=True,
            choosable=False,
            analysis=analysis,
            find_trace=lambda: evidence.explainer.why([found.atom])[found.atom],
            see=title if name is None else f"{kind}({found.subject})",
        )
    if name is not None and name not in known:
        raise unknown_name(project, analysis, name)
    about = hole() if name is None else clingo.String(name)
    pattern = clingo.Function("consequence", [clingo.Function(kind), hole(), about, hole()])

    def trace() -> Trace:
        return explain_absence(evidence.explainer, pattern, depth)

    because, cited = _reason(analysis, rules, kind, name)
    return WhyNot(
        subject=title,
        answer=f"No {title}: {because}.",
        evidence=cited,
        choosable=False,
        analysis=analysis,
        find_trace=trace,
    )


def _reason(
    analysis: Analysis, rules: Rulebook, kind: str, name: str | None
) -> tuple[str, tuple[Span, ...]]:
    """Return the reason that `rules/launch/absences.lp` states first, and the lines it cites."""
    query = Fact(Atom("in_question", (Atom(kind), name or Atom("any"))), analysis.configuration)
    facts = (*analysis.facts, query)
    speakers = [rule for rule in rules.rules if rule.because and rule.derives(ABSENT)]
    grounding = analyse(facts, rules, analysis.configuration).grounding
    grounding.derive(saying(STAGE, speakers))
    reasons = rendered_messages(grounding.control, STAGE, speakers)
    first = min(reasons, key=lambda each: (each.number, str(as_symbol(each.values))))
    span_of = {each.atom.arguments[0]: each.span for each in facts if each.atom.name == "place"}
    cited = (
        span_of[each.arguments[3].number]
        for each in grounding.symbols("cites", 4)
        if each.arguments[:3] == as_symbol(first.head).arguments
    )
    return first.message or kind, tuple(sorted(set(cited)))


def unknown_name(project: Project, analysis: Analysis, name: str) -> MarsError:
    """Return the error that neither launch files nor modules have a name, with a similar one."""
    names = names_in(analysis) | {each.text for each in project.configuration.modules}
    near = nearest(name, names)
    near = f"/{near}" if f"/{near}" in names else near
    help_text = f"did you mean `{near}`?" if near else "name a node or a topic"
    where = "the launch files have" if project.trees else "there is"
    return wrong_subject(project, f"{where} no name `{name}`", help_text)


def names_in(analysis: Analysis) -> frozenset[str]:
    """Return the strings in the facts of an analysis."""
    return frozenset().union(*(strings_in(symbol_of(fact.atom)) for fact in analysis.facts))
