"""A robot in Python: each answer is that of the command, and mistakes are errors with help."""

import doctest
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import pytest

import mars_asp
from mars_asp import Budget, MarsError, Reasoner, Robot, load, load_project, loads
from mars_asp.cli import run_here
from tests.support.configurations import IMPOSSIBLE
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

LEVEL0 = "examples/level0/config.mars"
WORKSPACE = "examples/ros2_workspace"
SCENARIO = "examples/level0/scenario.toml"
TEXT = """@configuration
@modules A, B
A uses_data_from B NotifyAtFrequency 5
A is_controlled_by B 3
"""

#: The answer of a robot, and the words of the command that prints it; `FILE` is the robot.
ANSWERS: dict[str, tuple[Callable[[Robot], Any], str]] = {
    "specification": (lambda robot: robot.specification, "synthesise FILE"),
    "analyse": (lambda robot: robot.analyse(), "analyse FILE"),
    "explain": (lambda robot: robot.explain(), "explain FILE"),
    "explain nodes": (lambda robot: robot.explain(only="nodes"), "explain FILE --only nodes"),
    "explain subject": (lambda robot: robot.explain("Turn"), "explain FILE Turn"),
    "explain depth": (lambda robot: robot.explain(depth=2), "explain FILE --depth 2"),
    "why not": (
        lambda robot: robot.why_not("DataSplitter(Turn)"),
        "explain FILE --why-not DataSplitter(Turn)",
    ),
    "alternatives": (lambda robot: robot.alternatives(3), "explain FILE --alternatives 3"),
    "can": (
        lambda robot: robot.can("Trans_X of MobilePlatform"),
        "can FILE 'Trans_X of MobilePlatform'",
    ),
    "diff": (lambda robot: robot.diff(load("examples/level0/flat.mars")), f"diff {LEVEL0} FLAT"),
    "run": (lambda robot: robot.run(SCENARIO, seed=7), f"run FILE --scenario {SCENARIO} --seed 7"),
}


@pytest.fixture(autouse=True)
def _in_the_repository(monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="module")
def level0() -> Robot:
    return load(ROOT / LEVEL0)


def printed(words: str, capsys: Captured) -> str:
    """Return the output of a command."""
    parts = re.findall(r"'[^']*'|\S+", words)
    names = {"FILE": LEVEL0, "FLAT": "examples/level0/flat.mars"}
    run_here([names.get(part, part.strip("'")) for part in parts])
    return capsys.readouterr().out


@pytest.mark.parametrize("name", ANSWERS)
def test_answers_are_those_of_the_command(name: str, capsys: Captured) -> None:
    ask, words = ANSWERS[name]
    answer = ask(load(LEVEL0))
    assert str(answer) == answer.text == printed(words, capsys)
    # A trace of the text is cut, and that of JSON is whole.
    words = words.replace(" --depth 2", "")
    assert json.loads(json.dumps(answer.to_dict())) == json.loads(
        printed(f"{words} --format json", capsys)
    )


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda robot: robot.why_not("unmanaged_node"), "explain FILE --why-not unmanaged_node"),
        (lambda robot: robot.why_not("guard_bypass"), "explain FILE --why-not guard_bypass"),
        (lambda robot: robot.explain("guard_bypass"), "explain FILE guard_bypass"),
        (lambda robot: robot.analyse(), "analyse FILE"),
    ],
    ids=("absent", "present", "explained", "analysed"),
)
def test_answers_about_a_workspace_are_those_of_the_command(
    ask: Callable[[Robot], Any], words: str, capsys: Captured
) -> None:
    assert str(ask(load(WORKSPACE))) == printed(words.replace("FILE", WORKSPACE), capsys)


def test_findings_are_those_of_check(capsys: Captured) -> None:
    found = load(WORKSPACE).check()
    document = json.loads(printed(f"check {WORKSPACE} --format json", capsys))
    assert [each.to_dict() for each in found] == document["findings"]
    assert {each.kind for each in found} >= {"guard_bypass", "ambiguous_priority"}
    lines = printed(f"check {WORKSPACE} --format concise", capsys).splitlines()
    assert [str(each) for each in found] == lines
    first = next(each for each in found if each.kind == "guard_bypass")
    assert (first.subject, first.participants[:1]) == ("/cmd_vel", ("/dock",))
    assert first.code == "launch/commands/past-a-mux"


def test_findings_are_selected_by_kind_or_rule(tmp_path: Path) -> None:
    robot = load(WORKSPACE)
    every = {each.kind for each in robot.check()}
    assert {each.kind for each in robot.check(select=["guard_bypass"])} == {"guard_bypass"}
    assert {each.kind for each in robot.check(ignore=["guard_bypass"])} == every - {"guard_bypass"}
    baseline = tmp_path / "baseline.json"
    assert run_here(["check", WORKSPACE, "--write-baseline", str(baseline)]) == 0
    assert robot.check(baseline=baseline) == ()


def test_a_picture_is_that_of_the_command(capsys: Captured) -> None:
    assert load(LEVEL0).draw() == printed("draw FILE", capsys) == load(LEVEL0)._repr_svg_()
    assert load(LEVEL0).draw(about="Turn", only="data") == printed(
        "draw FILE --about Turn --only data", capsys
    )
    assert load(LEVEL0).specification._repr_svg_().startswith("<svg")


def test_text_and_facts_are_those_of_the_commands(capsys: Captured) -> None:
    robot, workspace = load(LEVEL0), load(WORKSPACE)
    assert robot.text == (ROOT / LEVEL0).read_text()
    assert robot.facts == printed("facts FILE", capsys)
    assert workspace.text == printed(f"import ros2 {WORKSPACE}", capsys)
    assert robot.paths == (LEVEL0,)


def test_an_explanation_is_a_page_in_a_notebook(level0: Robot) -> None:
    page = level0.explain("DataSplitter1")._repr_html_()
    assert page.startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
    assert "DataSplitter1" in page


def test_a_specification_is_verified(tmp_path: Path, level0: Robot) -> None:
    path = tmp_path / "specification.mars"
    path.write_text(level0.specification.text)
    for given in (None, path, str(path), level0.specification, load(path)):
        found = level0.verify(given)
        assert found and found.realises and found.minimal and found.violations == ()
    own = level0.verify(level0)
    assert not own
    assert {each.clause for each in own.violations} == {1}
    assert own.to_dict()["realises"] is False
    assert str(own).startswith("clause 1: ")
    # The wiring of a workspace is judged against what it is there for.
    assert load(WORKSPACE).verify().realises


def test_repairs_have_a_title_and_lines(capsys: Captured) -> None:
    robot = load("examples/module-conflict/config.mars")
    words = "explain examples/module-conflict/config.mars --repair --format json"
    document = json.loads(printed(words, capsys))
    expected = [each for finding in document["repairs"] for each in finding["repairs"]]
    found = robot.repairs()
    assert [each.to_dict() for each in found] == expected
    assert found
    assert all(each.title and each.edits and each.to_dict()["lines"] for each in found)
    assert found[0].removes.partition("(")[0] == document["repairs"][0]["consequence"]["kind"]
    assert load(WORKSPACE).repairs() == ()


def test_the_graph_has_edges_from_source_controller_and_mounted_module() -> None:
    text = TEXT + "A 0 is_mounted_on B 0\n"
    robot = loads(text)
    assert robot.to_dict() == {
        "modules": [{"name": "A", "classes": []}, {"name": "B", "classes": []}],
        "relationships": [
            {"kind": "data", "from": "B", "to": "A", "mode": "NotifyAtFrequency", "hz": 5},
            {"kind": "control", "from": "B", "to": "A", "priority": 3},
            {"kind": "mount", "from": "A", "to": "B"},
        ],
    }
    edges = {(a, b, d["kind"]): d for a, b, d in robot.to_networkx().edges(data=True)}
    assert edges["B", "A", "data"] == {"kind": "data", "mode": "NotifyAtFrequency", "hz": 5}
    assert edges["A", "B", "mount"] == {"kind": "mount"}
    graph = load(LEVEL0).specification.to_networkx()
    assert graph.nodes["ArbitrationNode"]["classes"] == ("arbitration_node",)
    assert "sensor" in graph.nodes["Sonar"]["classes"] or graph.nodes["Sonar"]["classes"] == ()


def test_several_files_of_others_are_one_robot(tmp_path: Path) -> None:
    workspace = ROOT / WORKSPACE
    launch = workspace / "src/scout_drive/launch/scout.launch.py"
    assert load(launch, format="ros2").modules
    with pytest.raises(MarsError, match="is a robot of its own"):
        load(LEVEL0, launch)


#: Calls that fail, and a part of the error with its help.
MISTAKES: dict[str, tuple[Callable[[Robot], Any], str]] = {
    "no file": (lambda _: load("nope.mars"), "nope.mars: no such file"),
    "several robots": (lambda _: load("examples"), "the folder has 4"),
    "syntax": (lambda _: loads("@configuration\n@modules A,\n"), "<text>:2:"),
    "format": (lambda _: load(LEVEL0, format="rso2"), "did you mean `ros2`?"),
    "kind": (lambda r: r.check(select=["unused_modul"]), "did you mean `unused_module`?"),
    "text for a list": (lambda r: r.check(ignore="loose_end"), 'ignore=["loose_end"]'),
    "module": (lambda r: r.explain("Sonr"), "did you mean `Sonar`?"),
    "atom": (lambda r: r.why_not("DataSpliter(Turn)"), "did you mean `DataSplitter`?"),
    "depth": (lambda r: r.draw(depth=2), "`depth` counts from a module: name it by `about`"),
    "box": (lambda r: r.draw(about="Sonr"), "did you mean `Sonar`?"),
    "relationships": (lambda r: r.draw(only="dat"), "did you mean `data`?"),
    "query": (lambda r: r.can("Trans_X of Mobile"), "MobilePlatform"),
    "pack": (lambda _: load(LEVEL0, rules=["no-such-pack"]), "no-such-pack: no such file or"),
    "path for a robot": (
        lambda r: r.diff(cast("Any", LEVEL0)),
        "`robot.diff(mars_asp.load(PATH))`",
    ),
    "no alternatives": (lambda r: r.alternatives(0), "ask for 1 or more"),
    "scenario": (lambda r: r.run("nope.toml"), "nope.toml: no such file"),
    "unrealisable": (
        lambda _: loads(IMPOSSIBLE).specification,
        "no specification realises",
    ),
}


#: Calls with a value of another type.
WRONG: Any = 3
WORD: Any = "x"
OTHER_TYPES: dict[str, tuple[Callable[[Robot], Any], str]] = {
    "path": (lambda _: load(WRONG), "`3` is not a path"),
    "format": (lambda _: load(LEVEL0, format=WRONG), "`format` is `3`, and not a text"),
    "sources": (lambda _: load(LEVEL0, sources=WRONG), "`3` is not a path"),
    "budget": (lambda _: load(LEVEL0, budget=WRONG), "`budget` is `3`, and not a `Budget`"),
    "text": (lambda _: loads(WRONG), "`text` is `3`, and not a text"),
    "name": (lambda _: loads(WORD, WRONG), "`name` is `3`, and not a text"),
    "select": (lambda r: r.check(select=WRONG), "`select` is `3`, and not a text"),
    "ignore": (lambda r: r.check(ignore=[WRONG]), "`ignore` is `3`, and not a text"),
    "baseline": (lambda r: r.check(baseline=WRONG), "`3` is not a path"),
    "specification": (lambda r: r.verify(WRONG), "`3` is not a path"),
    "query": (lambda r: r.can(WRONG), "`query` is `3`, and not a text"),
    "number": (lambda r: r.alternatives(WORD), "`n` is `'x'`, and not a whole number"),
    "topic": (lambda r: r.explain(WRONG), "`subject` is `3`, and not a text"),
    "depth": (lambda r: r.explain(depth=WORD), "`depth` is `'x'`, and not a whole number"),
    "atom": (lambda r: r.why_not(WRONG), "`atom` is `3`, and not a text"),
    "subject": (lambda r: r.repairs(WRONG), "`subject` is `3`, and not a text"),
    "about": (lambda r: r.draw(about=WRONG), "`about` is `3`, and not a text"),
    "only": (lambda r: r.draw(only=WRONG), "`only` is `3`, and not a text"),
    "scenario": (lambda r: r.run(WRONG), "`3` is not a path"),
    "seed": (lambda r: r.run("nope.toml", seed=WORD), "`seed` is `'x'`, and not a whole number"),
}
MISTAKES |= {f"{name} of another type": each for name, each in OTHER_TYPES.items()}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_errors_with_help(name: str, level0: Robot) -> None:
    call, expected = MISTAKES[name]
    with pytest.raises(MarsError) as raised:
        call(level0)
    assert raised.value.diagnostics
    assert expected in str(raised.value)
    assert len(repr(raised.value)) <= 200 and "\n" not in repr(raised.value)


def test_all_problems_are_in_the_text_of_an_error() -> None:
    with pytest.raises(MarsError) as raised:
        loads("@configuration\n@modules A, B\nA uses_dat_from B\nB is_ A\n", "robot.mars")
    lines = str(raised.value).splitlines()
    assert len(lines) == len(raised.value.diagnostics) > 1
    assert all(re.match(r"robot\.mars:[0-9]+:[0-9]+: ", line) for line in lines)


def test_a_misspelt_public_name_has_a_proposal() -> None:
    with pytest.raises(AttributeError, match="did you mean `load_project`"):
        _ = mars_asp.load_projct
    assert set(mars_asp.__all__) <= set(dir(mars_asp))


def test_a_repr_is_one_short_line_and_solves_nothing(level0: Robot) -> None:
    robot = load(WORKSPACE)
    fresh = load(LEVEL0)
    assert repr(fresh) == f'Robot("{LEVEL0}": 8 modules, 10 relationships)'
    assert not {"specification", "_reasoner"} & vars(fresh).keys()
    changed = level0.diff(load("examples/level0/flat.mars"))
    assert repr(changed) == "RobotAnswer(1 consequence, 1 node)"
    analysis = robot.analyse()
    explanation = level0.explain()
    reasoner = mars_asp.Reasoner(level0.project)
    values = [
        *(robot, level0, analysis, analysis.consequences[0], level0.specification, explanation),
        *(explanation.topics[0], explanation.topics[0].trace, level0.project, reasoner),
        *(level0.why_not("DataSplitter(Turn)"), level0.verify(), robot.check()[0]),
        *(level0.can("Trans_X of MobilePlatform"), level0.diff(level0), reasoner.rulebook),
        *(mars_asp.explain(reasoner), mars_asp.why_not(reasoner, "DataSplitter(Turn)")),
        *(load("examples/module-conflict/config.mars").repairs()[0], loads(TEXT, "x" * 300)),
    ]
    for value in values:
        assert len(repr(value)) <= 200 and "\n" not in repr(value), type(value)


def test_public_names_have_examples_that_are_run() -> None:
    names = {name: getattr(mars_asp, name) for name in mars_asp.__all__}
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    without = []
    for name, value in names.items():
        tests = doctest.DocTestFinder(recurse=False).find(value, name, globs={**names})
        if not any(test.examples for test in tests):
            without.append(name)
        for test in tests:
            runner.run(test)
    methods = doctest.DocTestFinder().find(Robot, "Robot", globs={**names})
    for test in methods:
        runner.run(test)
        is_public = not test.name.rpartition(".")[2].startswith("_")
        if is_public and not test.examples:
            without.append(test.name)
    assert runner.summarize(verbose=False).failed == 0
    # A name for several types has no docstring of its own.
    assert without == ["Trace"]


def test_answers_quote_the_text_of_their_own_robot() -> None:
    texts = [f"@configuration\n@modules A, {a}, {b}\n{a} uses_data_from A\n{b} uses_data_from A\n"
             for a, b in (("B", "C"), ("X", "Y"))]  # fmt: skip
    first, second = map(loads, texts)
    answer = first.explain("data_divergence")
    assert "X uses_data_from A" in second.explain("data_divergence").text
    assert "B uses_data_from A" in answer.text and "B uses_data_from A" in str(answer.to_dict())
    assert first.specification.draw().startswith("<svg")
    assert "B uses_data_from A" in first.explain("data_divergence").text


def test_a_path_alone_is_one_path(level0: Robot) -> None:
    assert load(LEVEL0, rules="examples/own-rules/rules").options.rules == (
        "examples/own-rules/rules",
    )
    with pytest.raises(MarsError, match="is not what is explained"):
        level0.explain(only="data")  # type: ignore[arg-type]
    with pytest.raises(MarsError, match="below 1"):
        level0.explain(depth=-1)


# ---- The signatures ------------------------------------------------------------------------------


def test_paths_are_text_or_path_likes(tmp_path: Path) -> None:
    text = (ROOT / LEVEL0).read_text(encoding="utf-8")
    (tmp_path / "robot.mars").write_text(text, encoding="utf-8")
    robot = load(tmp_path / "robot.mars")
    assert robot.paths == (str(tmp_path / "robot.mars"),)
    assert len(load_project(tmp_path / "robot.mars").configuration.modules) == 8
    assert bool(robot.verify(tmp_path / "robot.mars")) is False
    scenario = ROOT / "examples/level0/scenario.toml"
    assert load(ROOT / LEVEL0).run(scenario, seed=3).verdict == "pass"


def test_sources_and_the_time_of_searches_are_options(tmp_path: Path) -> None:
    source = tmp_path / "eye.py"
    source.write_text(
        "# @module_start\n# @module_name Eye\n# @Sense NotifyAtFrequency 5\n# @Output Image\n"
        "def look(): ...\n# @module_end\n",
        encoding="utf-8",
    )
    text = "@configuration\n@modules Eye, Map\nMap uses_data_from Eye\n"
    described = loads(text, sources=[source], budget=Budget(20))
    classes = {each["name"]: each["classes"] for each in described.to_dict()["modules"]}
    assert classes["Eye"] and not classes["Map"]
    assert described.specification.cost["nodes"] == 0


def test_a_specification_has_its_parts(level0: Robot) -> None:
    found = level0.specification
    assert level0.specification is found
    assert found.proven_minimal
    assert found.cost == {"nodes": 3, "conversion": 0, "relationships": 12}
    assert set(found.modules) >= {*level0.modules, "DataSplitter1", "ArbitrationNode"}
    assert found.resolves["ArbitrationNode"] == ("control_convergence(MobilePlatform)",)
    assert found.to_networkx().has_edge("Collide", "ArbitrationNode")
    assert found.draw().startswith("<svg") and found._repr_svg_().startswith("<svg")


def test_pictures_show_classes_where_it_is_requested() -> None:
    robot = load("examples/scara/config.mars")
    assert len(robot.draw(classes=True)) > len(robot.draw())
    assert "</svg>" in robot.draw(about=robot.modules[0], depth=1, only="mounts")


def test_a_verification_and_a_run_have_their_parts(level0: Robot) -> None:
    verification = level0.verify()
    assert (verification.realises, verification.minimal) == (True, True)
    assert (verification.violations, verification.warnings) == ((), ())
    run = level0.run("examples/level0/scenario.toml", seed=1)
    assert run.verdict == "pass" and bool(run)
    assert all(each.holds for each in run.requirements)
    assert run.to_dict()["verdict"] == "pass"
    assert level0.alternatives(2).to_dict()["proven_minimal"] is True


def test_the_lower_level_has_the_shipped_rules_as_default() -> None:
    assert len(Reasoner(load_project(LEVEL0)).analysis.consequences) == 3


def test_to_import_the_package_loads_no_solver() -> None:
    code = "import sys, mars_asp; sys.exit('clingo' in sys.modules or 'networkx' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
