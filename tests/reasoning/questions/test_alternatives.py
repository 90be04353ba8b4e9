"""Alternatives are realisations and have the stated cost; certificates give lower bounds."""

from functools import cache
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text
from mars_asp.model.declarations import Control, Data
from mars_asp.reasoning.project import Project, load_project
from mars_asp.reasoning.questions.alternatives import Alternatives, alternatives
from mars_asp.reasoning.questions.needs import NEED
from mars_asp.reasoning.questions.without import without
from mars_asp.reasoning.rules import COSTS, NODES, RELATIONSHIPS, load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.verification import verify
from tests.support.campaigns import sample, seeds
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured, Patch
from tests.support.random_configurations import random_configuration

RULEBOOK = load_rulebook(stages=("resolve", "verify"))
TELLING = load_rulebook(stages=("resolve", "account"))
CASES = sorted(path.parent for path in (ROOT / "tests" / "alternatives").glob("*/config.mars"))


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.name)
def test_cases(case: Path, update_golden: bool) -> None:
    shown = run(f"mars-asp explain tests/alternatives/{case.name}/config.mars --alternatives 3")
    expected = case / "expected.txt"
    if update_golden:
        expected.write_text(shown, encoding="utf-8")
    assert shown == expected.read_text(encoding="utf-8")


def found(
    text: str, subject: str | None = None, most: int = 4
) -> tuple[Project, Alternatives | None]:
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    return project, alternatives(Reasoner(project, TELLING), subject, most)


@pytest.mark.parametrize("seed", seeds(8, 16))
def test_alternatives_realise_the_configuration_at_the_reported_cost(seed: int) -> None:
    project, answer = found(random_configuration(seed))
    if answer is None:
        return
    extras = []
    for other in answer.others:
        assert verify(other.specification.configuration, project, RULEBOOK) == ()
        cost = {
            level: answer.synthesis.cost(level) + other.extra[level] for level in COSTS.values()
        }
        lines = other.specification.configuration.relationships
        assert cost[NODES] == len(other.specification.nodes)
        assert cost[RELATIONSHIPS] == sum(isinstance(line, Data | Control) for line in lines)
        assert other.added or other.removed
        extras.append([other.extra[level] for level in COSTS.values()])
    assert extras == sorted(extras)
    assert all(extra >= [0, 0, 0] for extra in extras)


@pytest.mark.parametrize("seed", seeds(8, 16))
def test_needs_are_disjoint_and_bound_the_cost(seed: int) -> None:
    _, answer = found(random_configuration(seed), most=1)
    if answer is None:
        return
    nodes = [node for need in answer.needs for node in need.nodes]
    assert all(need.nodes for need in answer.needs)
    assert len(nodes) == len(set(nodes)) <= answer.candidates
    assert len(answer.needs) == answer.levels[NODES].bound <= answer.nodes
    assert answer.nodes == answer.synthesis.cost(NODES)
    assert all(0 <= each.bound <= each.cost for each in answer.levels.values())
    assert all(len(need.reasons) == len(need.nodes) for need in answer.needs)


#: Robots of `tests/node_kinds` in which packs bring nodes.
BROUGHT = {
    "two_effectors": "examples/packs/watchdog",
    "listeners_alone": "tests/node_kinds/packs/ears",
    "listeners_of_control": "tests/node_kinds/packs/ears",
}
NEEDS = [
    "examples/figure04-divergence/config.mars",
    "examples/figure07-representation/config.mars",
    "examples/figure15-control-divergence/config.mars",
    "examples/gripper-arm/config.mars",
    "examples/level1/config.mars",
    "examples/scara/config.mars",
    *(
        f"tests/accounts/{name}.mars"
        for name in (
            "lowered",
            "shared",
            "conversions",
            "runs",
            "services",
            "inherited",
            "part",
            "unconverted",
            "own_part",
            "three_alike",
            "twice_converted",
            "made_apart",
            "gates",
            "needed_for_bounds",
        )
    ),
]


@pytest.mark.parametrize("path", NEEDS)
def test_why_nothing_costs_less(
    path: str, capsys: Captured, monkeypatch: Patch, update_golden: bool
) -> None:
    monkeypatch.chdir((ROOT / path).parent)
    run_here(["explain", (ROOT / path).name, "--alternatives", "1"])
    first = capsys.readouterr().out.split("\n\n")[0].rstrip()
    text = f"{first}\n"
    name = path.split("/")[-2 if path.endswith("config.mars") else -1].removesuffix(".mars")
    expected = ROOT / "tests" / "alternatives" / f"{name}.txt"
    if update_golden:
        expected.write_text(text, encoding="utf-8")
    assert text == expected.read_text(encoding="utf-8")


@cache
def alternatives_of(path: str) -> tuple[Reasoner, Alternatives]:
    reasoner = Reasoner(load_project(str(ROOT / path)), TELLING)
    answer = alternatives(reasoner, most=1)
    assert answer is not None
    return reasoner, answer


def test_each_rule_for_needs_speaks() -> None:
    telling = {rule.id for rule in TELLING.rules if rule.derives(NEED)}
    spoken = {
        rule
        for path in NEEDS
        for need in alternatives_of(path)[1].needs
        for reason in need.reasons
        for rule in reason.rules
    }
    for name, pack in BROUGHT.items():
        project = load_project(str(ROOT / "tests" / "node_kinds" / f"{name}.mars"))
        rulebook = load_rulebook([ROOT / pack], ("resolve", "account"))
        answer = alternatives(Reasoner(project, rulebook), most=1)
        assert answer is not None
        spoken |= {rule for need in answer.needs for each in need.reasons for rule in each.rules}
    assert spoken == telling


@pytest.mark.parametrize("path", sample(NEEDS, 6))
def test_verification_agrees_with_each_need(path: str) -> None:
    """`rules/verify` know nothing of needs: without the node it is that clause that breaks."""
    reasoner, answer = alternatives_of(path)
    assert all(each.bound == each.cost for each in answer.levels.values())
    judging = Reasoner(reasoner.project, RULEBOOK)
    for need in answer.needs:
        (name,), reason = need.names, need.reasons[0]
        broken = without(name, judging)
        assert broken is not None
        found = [each for each in broken if each.violation.clause == reason.clause]
        lines = {line.span for each in found for line in each.relationships}
        assert found, (name, reason)
        assert lines.issuperset(reason.lines), (name, reason)


def test_as_many_optima_as_are_counted_cost_the_same() -> None:
    text = (
        "@configuration\n@modules S, A, B\nA uses_data_from S\nB uses_data_from S\n"
        "@module_start\n@module_name S\n@Sense NotifyWhenReady\nRaw s();\n@module_end\n"
        "@module_start\n@module_name A\n@DataIn\nvoid a(X x);\n@module_end\n"
        "@module_start\n@module_name B\n@DataIn\nvoid b(X x);\n@module_end\n"
        "@module_start\n@module_name C\n@Converts\nX c(Raw r);\n@module_end\n"
        "@module_start\n@module_name D\n@Converts\nX d(Raw r);\n@module_end\n"
    )
    _, answer = found(text)
    assert answer is not None
    same = [other for other in answer.others if not any(other.extra.values())]
    assert answer.synthesis.resolution.count == 1 + len(same) == 2


def _twin(name: str) -> str:
    """Return lines and blocks of a source with two optima."""
    return (
        f"A{name} uses_data_from S{name}\nB{name} uses_data_from S{name}\n"
        f"@module_start\n@module_name S{name}\n@Sense NotifyWhenReady\nR{name} s();\n@module_end\n"
        f"@module_start\n@module_name A{name}\n@DataIn\nvoid a(X{name} x);\n@module_end\n"
        f"@module_start\n@module_name B{name}\n@DataIn\nvoid b(X{name} x);\n@module_end\n"
        f"@module_start\n@module_name C{name}\n@Converts\nX{name} c(R{name} r);\n@module_end\n"
        f"@module_start\n@module_name D{name}\n@Converts 3\nX{name} d(R{name} r);\n@module_end\n"
        f"@module_start\n@module_name E{name}\n@Converts\nX{name} e(R{name} r);\n@module_end\n"
    )


def test_components_vary_on_their_own_and_together() -> None:
    names = ", ".join(f"{each}{name}" for name in "PQR" for each in "ABS")
    text = f"@configuration\n@modules {names}\n{''.join(map(_twin, 'PQR'))}"
    _, answer = found(text, most=7)
    assert answer is not None
    assert answer.synthesis.resolution.count == 8
    assert len({(other.added, other.removed) for other in answer.others}) == 7
    assert not any(any(other.extra.values()) for other in answer.others)
    assert [len(other.added) for other in answer.others] == [1, 1, 1, 2, 2, 2, 3]
    assert not answer.complete
    _, more = found(text, most=20)
    assert more is not None
    assert sum(not any(other.extra.values()) for other in more.others) == 7


@pytest.mark.parametrize("seed", seeds(6, 12))
def test_as_many_cost_the_same_as_are_counted(seed: int) -> None:
    _, answer = found(random_configuration(seed), most=60)
    if answer is None or answer.synthesis.resolution.count is None:
        return
    same = sum(not any(other.extra.values()) for other in answer.others)
    assert same == min(answer.synthesis.resolution.count - 1, 60)


def test_a_subject_is_a_node() -> None:
    with pytest.raises(MarsError, match="not a node"):
        found("@configuration\n@modules A, B\nA uses_data_from B\n", "A")


@pytest.mark.parametrize("words", [["--alternatives", "0"], ["--alternatives", "many"]])
def test_a_wrong_number_is_reported(words: list[str], capsys: Captured) -> None:
    with pytest.raises(SystemExit) as end:
        run_here(["explain", str(CASES[0] / "config.mars"), *words])
    assert end.value.code == 2
    assert "expected a number from 1" in capsys.readouterr().err
