"""Launch trees judged by rules of their own: the findings in each, and where they hold."""

from dataclasses import replace
from functools import lru_cache

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.facts.launched import launch_facts
from mars_asp.reasoning.project import Project

STAGE = "launch"


@lru_cache(maxsize=8)
def launch_rules(rulebook: Rulebook) -> Rulebook:
    """Return the built-in rules on launch trees, which read no other stage, as a base."""
    paths = [
        path for path, (at, _) in zip(rulebook.paths, rulebook.texts, strict=False) if at == STAGE
    ]
    return Rulebook(
        tuple(replace(rule, stage="base") for rule in rulebook.rules if rule.stage == STAGE),
        tuple(("base", text) for at, text in rulebook.texts if at == STAGE),
        paths=tuple(paths),
        documented=tuple(
            each._replace(stage="base") for each in rulebook.documented if each.stage == STAGE
        ),
    )


def analyse_trees(project: Project, rulebook: Rulebook) -> Analysis:
    """Return the findings in the launch trees of a project; `rulebook` has the launch rules.

    Raises:
        MarsError: rules that clingo refuses.
    """
    facts = launch_facts(project.trees)
    return analyse(facts, launch_rules(rulebook), project.configuration.span, with_labels=True)
