"""Synthesis under a time limit: a specification that realises, and a lower bound of its cost."""

import random
from pathlib import Path

import pytest

from mars_asp.asp.solve import grounding
from mars_asp.cli import run_here
from mars_asp.language import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import COSTS, NODES, load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import verify
from tests.support.campaigns import seeds
from tests.support.fixtures import Captured, Patch

RULEBOOK = load_rulebook(stages=("resolve", "verify"))


def one_source(clients: int, representations: int, converters: int, seed: int) -> str:
    """Return clients of one source that accept few of the representations made of its own."""
    rng = random.Random(seed)
    names = [f"P{index}" for index in range(representations)]
    edges = [(rng.choice(names[:index]), names[index]) for index in range(1, representations)]
    edges += [(a, b) for a, b in (rng.sample(names, 2) for _ in range(converters - len(edges)))]
    blocks = [("S", "@Sense NotifyAtFrequency 20", "P0 get()")]
    blocks += [
        (f"K{n}", f"@Converts {rng.randint(1, 4)}", f"{b} f({a} x)")
        for n, (a, b) in enumerate(edges)
    ]
    lines = []
    for index in range(clients):
        accepted = ", ".join(f"{name} {name.lower()}" for name in rng.sample(names[1:], 2))
        blocks.append((f"C{index}", "@DataIn", f"void take({accepted})"))
        service = rng.choice(["", " NotifyAtFrequency 10", " RequestWhenReady"])
        lines.append(f"C{index} uses_data_from S{service}")
    written = [
        f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end"
        for name, annotation, declaration in blocks
    ]
    modules = ", ".join(["S", *(f"C{index}" for index in range(clients))])
    return "\n".join(["@configuration", f"@modules {modules}", *lines, *written])


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_without_time_an_answer_is_found_and_bounded(seed: int, monkeypatch: Patch) -> None:
    monkeypatch.setattr(grounding, "_LEAST_SECONDS", -1.0)
    project = Project(parse_text(one_source(8, 6, 9, seed), "c.mars").configuration, {}, ())
    hurried, proven = (
        synthesise(
            project,
            analyse(project_facts(project), RULEBOOK, project.configuration.span),
            RULEBOOK,
            Budget(seconds),
        )
        for seconds in (0.0, None)
    )
    assert hurried is not None
    assert proven is not None
    assert proven.resolution.proven
    assert verify(hurried.specification.configuration, project, RULEBOOK) == ()
    assert len(hurried.specification.nodes) == hurried.cost(NODES)
    least = [proven.cost(level) for level in COSTS.values()]
    assert [hurried.bound(level) for level in COSTS.values()] <= least
    assert least <= [hurried.cost(level) for level in COSTS.values()]


def test_the_best_solution_is_printed_with_its_bound(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    # A fast machine would prove this one in the time that every search has.
    monkeypatch.setattr(grounding, "_LEAST_SECONDS", -1.0)
    path = tmp_path / "c.mars"
    path.write_text(one_source(40, 14, 50, 1), encoding="utf-8")
    assert run_here(["synthesise", "--time-limit", "0.001", str(path)]) == 3
    printed, output = capsys.readouterr()
    assert printed.startswith("@specification")
    assert "best found" in output
    assert "lower bound" in output
