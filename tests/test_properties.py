"""Laws that hold for every configuration."""

import json
import os
import random
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.asp.solve.grounding import Resolution
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Mount,
    Name,
    Relationship,
)
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import NODES, load_rulebook
from mars_asp.reasoning.synthesis.synthesise import Synthesis, synthesise
from tests.support.campaigns import examples, seeds
from tests.support.documents import ROOT
from tests.support.strategies import HERE, configurations, few

RULEBOOK = load_rulebook()
Found: TypeAlias = list[tuple[str, str, frozenset[str]]]


def without_places(configuration: Configuration) -> Configuration:
    def bare(relationship: Relationship) -> Relationship:
        return replace(relationship, span=HERE)

    return replace(
        configuration,
        span=HERE,
        modules=tuple(replace(name, span=HERE) for name in configuration.modules),
        relationships=tuple(map(bare, configuration.relationships)),
    )


def resolved(configuration: Configuration) -> Synthesis:
    facts = configuration_facts(configuration)
    analysis = analyse(facts, RULEBOOK, configuration.span)
    found = synthesise(Project(configuration, {}, ()), analysis, RULEBOOK)
    assert found is not None
    return found


def consequences(configuration: Configuration) -> Found:
    facts = configuration_facts(configuration)
    analysis = analyse(facts, RULEBOOK, configuration.span)
    return sorted((c.kind, c.subject, frozenset(c.participants)) for c in analysis.consequences)


def renamed(configuration: Configuration, rename: Callable[[str], str]) -> Configuration:
    def over(relationship: Relationship) -> Relationship:
        match relationship:
            case Data():
                return replace(
                    relationship,
                    client=rename(relationship.client),
                    source=rename(relationship.source),
                )
            case Control():
                return replace(
                    relationship,
                    controlled=rename(relationship.controlled),
                    controller=rename(relationship.controller),
                )
            case Mount():
                return replace(
                    relationship,
                    mounting=rename(relationship.mounting),
                    mounted=rename(relationship.mounted),
                )
            case _:
                return relationship

    return replace(
        configuration,
        modules=tuple(replace(n, text=rename(n.text)) for n in configuration.modules),
        relationships=tuple(map(over, configuration.relationships)),
    )


@few
@given(configurations)
def test_printed_configurations_read_back(configuration: Configuration) -> None:
    text = print_configuration(configuration)
    read = parse_text(text, "config.mars").configuration
    assert without_places(read) == configuration


@settings(few, max_examples=examples(6, 60))
@given(configurations)
def test_a_specification_reads_back_with_nothing_to_resolve(configuration: Configuration) -> None:
    printed = resolved(configuration).specification.configuration
    read = parse_text(print_configuration(printed), "config.mars").configuration
    assert without_places(read) == without_places(printed)
    again = resolved(read)
    assert again.cost(NODES) == 0
    printed_again = print_configuration(again.specification.configuration)
    assert printed_again == print_configuration(printed)
    resolvable = {"data_divergence", "control_convergence", "control_divergence"}
    assert not resolvable & {kind for kind, _, _ in consequences(read)}


@settings(few, max_examples=examples(6, 60))
@given(configurations, st.randoms(use_true_random=False))
def test_order_names_and_modules_without_lines_change_no_answer(
    configuration: Configuration, rng: random.Random
) -> None:
    """All laws compare with the same results, which are computed once."""
    found, answer = consequences(configuration), resolved(configuration).resolution
    order_changes_only_order(configuration, rng, found, answer)
    renaming_renames_the_answer(configuration, found, answer)
    more = replace(configuration, modules=(*configuration.modules, Name("Alone", HERE)))
    assert resolved(more).resolution.cost == answer.cost


def order_changes_only_order(
    configuration: Configuration, rng: random.Random, found: Found, answer: Resolution
) -> None:
    lines = list(configuration.relationships)
    rng.shuffle(lines)
    other = replace(configuration, relationships=tuple(lines))
    assert consequences(other) == found
    second = resolved(other).resolution
    assert answer.taken == second.taken
    assert (answer.cost, answer.bound) == (second.cost, second.bound)
    assert (answer.proven, answer.count) == (second.proven, second.count)


def renaming_renames_the_answer(
    configuration: Configuration, found: Found, answer: Resolution
) -> None:
    def rename(name: str) -> str:
        return f"Z{name}"

    expected = sorted(
        (kind, rename(subject), frozenset(map(rename, participants)))
        for kind, subject, participants in found
    )
    other = renamed(configuration, rename)
    assert consequences(other) == expected
    assert resolved(other).resolution.cost == answer.cost


#: Draws a robot, and prints the other answers about it.
PROGRAM = """\
import sys
from mars_asp.cli import run_here
for form in ("svg", "dot", "mmd", "png"):
    assert run_here(["draw", "tests/mixed.mars", "-o", f"{sys.argv[1]}/a.{form}"]) == 0
for verb in ("analyse", "synthesise", "explain"):
    run_here([verb, "tests/mixed.mars", "--format", "json"])
"""


def test_output_is_the_same_for_every_hash_seed(tmp_path: Path) -> None:
    outputs = set()
    for seed in seeds(2, 12):
        folder = tmp_path / str(seed)
        folder.mkdir()
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, str(folder)],
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
            capture_output=True,
            check=True,
        )
        drawings = tuple(each.read_bytes() for each in sorted(folder.iterdir()))
        outputs.add((done.stdout, drawings))
    ((output, drawings),) = outputs
    assert len([json.loads(line) for line in output.splitlines()]) == 3
    assert len(drawings) == 4 and all(drawings)
