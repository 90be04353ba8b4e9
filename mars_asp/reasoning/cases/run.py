"""Runs a case of either form with the rules of its stages."""

from pathlib import Path

from mars_asp.asp import cases
from mars_asp.asp.cases import Outcome
from mars_asp.asp.cases.coverage import Case
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.cases.configurations import SUFFIX, run_configuration
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.findings import CONSEQUENCE
from mars_asp.reasoning.project import load_project, project_facts, with_brought
from mars_asp.reasoning.rules import FOLLOWING, STAGES

#: Stages without choices.
DETERMINISTIC = ("base", "verify", "run", "repair")


def run_case(path: Path, rulebook: Rulebook) -> Outcome:
    """Run the cases of a file; `%=` compares consequences if a case shows no predicates.

    Raises:
        MarsError: clingo must not read it, or an expectation cannot be read.
    """
    if path.suffix == SUFFIX:
        return run_configuration(path, rulebook)
    return cases.run_case(path, rulebook, stages_of(path), CONSEQUENCE)


def stages_of(path: Path) -> tuple[str, ...]:
    """Return the stages whose rules a case needs, read from the names of the folders around it.

    They include the stages that always follow these, and `resolve` for a configuration.
    """
    named = cases.stages_of(path, STAGES)
    if path.suffix == SUFFIX:
        named = tuple(dict.fromkeys((*named, "resolve")))
    return tuple(dict.fromkeys((*named, *(FOLLOWING[s] for s in named if s in FOLLOWING))))


def tried(path: Path, rulebook: Rulebook) -> Case:
    """Return the cases in a file as texts of facts, with their stages and a function to run them.

    Raises:
        MarsError: clingo must not read it, or an expectation cannot be read.
    """
    if path.suffix == SUFFIX:
        # The facts of attributes depend on the packs that declare them.
        project = with_brought(load_project(str(path)), rulebook.brought)
        texts: tuple[str, ...] = (facts_text(project_facts(project)),)
    else:
        texts = tuple(map(rulebook.as_named, cases.case_texts(path)))
    stages = ("base", *stages_of(path))
    return Case(path, texts, stages, lambda rulebook: run_case(path, rulebook).passed)
