"""Every node of a minimal specification is needed: without it a clause is violated at its lines."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.language import parse_text
from mars_asp.reasoning.project import Project, load_project
from mars_asp.reasoning.questions.without import ViolatedClause, without
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import sample, seeds
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.random_configurations import random_configuration, random_control
from tests.support.random_side_lines import random_side_lines
from tests.support.refusals import refusal

RULEBOOK = load_rulebook(stages=("resolve", "verify"))
EXAMPLES = sorted((ROOT / "examples").glob("*/*.mars"))
CHOICES = [ROOT / "tests" / "accounts" / f"{name}.mars" for name in ("conversions", "runs")]
LEVEL1 = "examples/level1/config.mars"

#: By a file and a node of its specification, what breaks without the node: the clause, the message
#: and the lines of the file.
CASES = [
    (
        "examples/figure04-divergence/config.mars",
        "DataSplitter1",
        [(1, "`Camera` feeds data to 2 receivers", [3, 4])],
    ),
    (LEVEL1, "DataSplitter1", [(1, "`SonarMap` feeds data to 2 receivers", [6, 7])]),
    (LEVEL1, "DataSplitter2", [(1, "`Runaway` feeds data to 2 receivers", [9, 10])]),
    (LEVEL1, "ArbitrationNode", [(1, "`MobilePlatform` has 4 controllers", [11, 12, 13, 14])]),
    (
        "examples/gripper-arm/config.mars",
        "InheritanceNode1",
        [
            (2, "`Operator` controls `MobilePlatform`, which is not declared", [6]),
            (
                5,
                "no InheritanceNode passes on to `MobilePlatform` exactly the commands for what "
                "`Gripper` inherits",
                [4, 5, 6],
            ),
        ],
    ),
    (
        "tests/accounts/conversions.mars",
        "DataSplitter3",
        [
            (1, "`Lidar` feeds data to 2 receivers", [6, 7, 8]),
            (3, "`Log` does not get the service from `Lidar` that it requires", [7]),
            (3, "`Plan` does not get the service from `Lidar` that it requires", [8]),
        ],
    ),
    (
        "tests/accounts/runs.mars",
        "ControlSplitter2",
        [(1, "`ArbitrationNode3` feeds control to 2 receivers", [4, 5, 7, 8, 10, 11])],
    ),
    (
        "tests/accounts/shared.mars",
        "ArbitrationNode",
        [(1, "`ControlSplitter1` has 2 controllers", [3, 4, 5, 6])],
    ),
]


@pytest.mark.parametrize(("path", "node", "expected"), CASES)
def test_clauses_broken_without_a_node(
    path: str, node: str, expected: list[tuple[int, str, list[int]]]
) -> None:
    found = without(node, Reasoner(load_project(str(ROOT / path)), RULEBOOK))
    assert found is not None
    assert [clause_and_lines(broken) for broken in found] == expected


def clause_and_lines(broken: ViolatedClause) -> tuple[int, str, list[int]]:
    lines = [each.span.line for each in broken.relationships]
    return broken.violation.clause, broken.violation.message, lines


def check_each_node(project: Project) -> None:
    reasoner = Reasoner(project, RULEBOOK)
    synthesis = reasoner.synthesis
    for node in () if synthesis is None else synthesis.specification.nodes:
        found = without(node.name, reasoner)
        assert found, node
        # A violation without lines is about a remaining node without a declared relationship.
        assert any(broken.relationships for broken in found), node


@pytest.mark.parametrize("path", sample([*EXAMPLES, *CHOICES], 4), ids=lambda path: path.name)
def test_something_breaks_without_a_node(path: Path) -> None:
    check_each_node(load_project(str(path)))


#: Side lines, and the lines of the file that are cited without each node of its specification.
SIDE_LINES = """\
@configuration hierarchical
@modules Q, T, V, B, G, H, L, M, Map
V uses_data_from T
B is_controlled_by G 1
M is_controlled_by H 1
B is_locked_by L 5
M is_locked_by L 5
G is_inhibited_by H 100
Q is_reset_by L
Map is_reset_by T
V uses_data_from Map
Map is_suppressed_by L 40
"""
SHARED = """\
@configuration hierarchical
@modules B, M, C, L, P, X, Y, T, N
B is_controlled_by C 1
M is_controlled_by C 1
B is_locked_by L 2
M is_locked_by L 2
P is_reset_by L
X.a uses_data_from Y.u
X.b uses_data_from Y.v
X.c uses_data_from Y.u
X.a is_suppressed_by T 30
X.c is_suppressed_by T 30
N uses_data_from T
"""


@pytest.mark.parametrize(
    ("text", "node", "expected"),
    [
        (SIDE_LINES, "DataSplitter1", [[3, 10]]),
        (SIDE_LINES, "DataSplitter2", [[6, 7, 9, 12]]),
        (SIDE_LINES, "ControlSplitter1", [[5, 8]]),
        (SIDE_LINES, "Gate1", [[4, 8]]),
        (SIDE_LINES, "Gate2", [[11, 12]]),
        (SHARED, "DataSplitter1", [[5, 6, 7]]),
        (SHARED, "DataSplitter2", [[11, 12, 13]]),
        (SHARED, "Gate1", [[8, 11], [10, 12]]),
    ],
)
def test_side_lines_are_cited_at_the_nodes_before_them(
    text: str, node: str, expected: list[list[int]]
) -> None:
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    found = without(node, Reasoner(project, RULEBOOK))
    assert found is not None
    assert [clause_and_lines(broken)[2] for broken in found] == expected


@pytest.mark.parametrize("kind", [random_configuration, random_control, random_side_lines])
def test_something_breaks_without_a_node_of_random_configurations(kind: type) -> None:
    for seed in seeds(1, 20):
        check_each_node(Project(parse_text(kind(seed), "c.mars").configuration, {}, ()))


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["verify", "--without", "DataSplitter2", LEVEL1], 1, "Without DataSplitter2:\n  clause 1"),
        (["verify", LEVEL1, "--without", "DataSplitter2", "--quiet"], 1, f"{LEVEL1}:10  Forward"),
        (["verify", LEVEL1, LEVEL1, "--without", "DataSplitter2"], 2, "leave out SPEC"),
        (["verify", LEVEL1], 2, "SPEC and CONFIG are needed"),
    ],
)
def test_the_command(
    words: list[str], status: int, message: str, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(words) == status
    captured = capsys.readouterr()
    assert message in captured.out + captured.err


@pytest.mark.parametrize(
    ("name", "message", "help_text"),
    [
        ("DataSpliter2", "is not a node", "did you mean `DataSplitter2`?"),
        ("x", "is not a node", "the nodes are DataSplitter1, DataSplitter2, ArbitrationNode"),
        ("Turn", "is a module of the configuration, not a node", "the nodes are"),
        ("", "is not a node", "the nodes are"),
    ],
)
def test_a_name_other_than_a_node_is_reported(name: str, message: str, help_text: str) -> None:
    diagnostic = refusal(without, name, Reasoner(load_project(str(ROOT / LEVEL1)), RULEBOOK))
    assert message in diagnostic.message
    assert help_text in str(diagnostic.help)


def test_json_has_the_keys_of_verify_and_one_more(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["verify", "--without", "DataSplitter2", LEVEL1, "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["without"] == "DataSplitter2"
    assert (found["realises"], found["minimal"], found["warnings"]) == (False, None, [])
    (violation,) = found["violations"]
    assert violation["clause"] == 1
    assert [each["line"] for each in violation["locations"]] == [9, 10]


def test_nothing_is_added_to_a_specification(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.mars").write_text("@specification\n@modules A, B\nA uses_data_from B\n")
    assert run_here(["verify", "--without", "/mux", "robot.mars"]) == 2
    assert "nothing is added to a file that is a specification already" in capsys.readouterr().err
    Path("robot.mars").write_text("@specification\n@modules A\n// imported from ros2\n")
    assert run_here(["verify", "--without", "/mux", "robot.mars"]) == 2
    output = " ".join(capsys.readouterr().err.split())
    assert "a configuration, as `mars-asp import ros2 --contract` prints it" in output


def test_a_mux_of_the_user_is_a_node(monkeypatch: Patch, capsys: Captured) -> None:
    monkeypatch.chdir(ROOT)
    assert run_here(["verify", "--without", "/twist_mux", "examples/ros2_workspace", "-q"]) == 1
    output = capsys.readouterr().out
    assert output.startswith("Without /twist_mux:")
    assert "`/velocity_smoother` has 3 controllers" in output
