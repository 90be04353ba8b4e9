"""The subjects of differential tests: a parsed text and its specification."""

from mars_asp.language import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import Synthesis, synthesise

RULEBOOK = load_rulebook(stages=("resolve", "verify"))


def read(text: str) -> Project:
    return Project(parse_text(text, "c.mars").configuration, {}, ())


def synthesised(project: Project) -> Synthesis | None:
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    return synthesise(project, analysis, RULEBOOK)


def alarms(project: Project) -> set[str]:
    """Return the kinds of consequences that warn or stop."""
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    return {each.kind for each in analysis.consequences if each.severity != "note"}
