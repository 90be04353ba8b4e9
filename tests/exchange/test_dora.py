"""Dataflows of dora: files with expected imports beside them, and files that are refused."""

import json
import re
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.exchange import ports
from mars_asp.exchange.dora import import_dora
from mars_asp.exchange.recognise import recognised
from mars_asp.language import parse_text, print_configuration
from mars_asp.language.print import print_relationship
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.imported import findings_of, golden_lines, meaning, place

FILES = sorted((ROOT / "tests" / "dora").glob("*.yml"))
named = pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)


@named
def test_each_file_gives_the_expected_output(file: Path, update_golden: bool) -> None:
    text = file.read_text(encoding="utf-8")
    assert recognised(text) == "dora"
    found = "\n".join(golden_lines(import_dora([(text, file.name)]))) + "\n"
    golden = file.with_suffix(".txt")
    if update_golden:
        golden.write_text(found, encoding="utf-8")
    assert golden.read_text(encoding="utf-8") == found


@named
def test_printed_imports_have_the_meaning_of_the_file(file: Path) -> None:
    found = import_dora([(file.read_text(encoding="utf-8"), file.name)]).configuration
    assert meaning(parse_text(print_configuration(found), "a.mars").configuration) == meaning(found)


NODE = "nodes:\n- id: a\n  "
#: A text, and all that is wrong with it.
REFUSED = [
    ("nodes: {}\n", ["1:1: error: the dataflow has no list of nodes"]),
    ("nodes: [a, {path: x}]\n",
     ["1:9: error: a node is not a map", "1:12: error: a node has no id"]),
    ("nodes:\n- id: a/b\n", ["2:7: error: the id `a/b` holds a `/`"]),
    ('nodes:\n- id: "a\\n"\n', ["2:7: error: `a\n` cannot be a name"]),
    ("nodes:\n- id: a\n- id: a\n", ["3:7: error: two nodes have the id `a`"]),
    (NODE + "outputs: 1\n", ["3:12: error: the outputs of `a` are not a list"]),
    (NODE + "outputs: [x, [], x]\n",
     ["3:16: error: an output of `a` is not a name", "3:20: error: `a` has two outputs `x`"]),
    (NODE + "inputs: [b/x]\n", ["3:11: error: the inputs of `a` are not a map"]),
    (NODE + "inputs: {i: , j: {queue_size: 1}}\n",
     ["3:12: error: input `i` of `a` has no source",
      "3:17: error: input `j` of `a` has no source"]),
    (NODE + "inputs:\n    i: x\n    j: dora/timer/millis/0\n    k: dora/timer/days/1\n",
     ["4:8: error: input `i` of `a` must take an output, not `x`",
      "5:8: error: input `j` of `a` must take an output, not `dora/timer/millis/0`",
      "6:8: error: input `k` of `a` must take an output, not `dora/timer/days/1`"]),
    (NODE + "inputs:\n    i: dora/timer/millis\n    j: dora/timer/hz/-1\n"
     "    k: dora/timer/secs/.5\n",
     ["4:8: error: input `i` of `a` must take an output, not `dora/timer/millis`",
      "5:8: error: input `j` of `a` must take an output, not `dora/timer/hz/-1`",
      "6:8: error: input `k` of `a` must take an output, not `dora/timer/secs/.5`"]),
    (NODE + "operator: 1\n",
     ["3:3: error: `a` is not one of `custom`, `operator` and `operators`"]),
    (NODE + "operators: [1, {}]\n",
     ["3:15: error: an operator is not a map", "3:18: error: an operator has no id"]),
    (NODE + "x: !!python/name:os.system y\n",
     ["3:6: error: tag `tag:yaml.org,2002:python/name:os.system` is not read"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "wrong"), REFUSED, ids=lambda value: str(value)[:30])
def test_each_refused_file_reports_all_its_errors(text: str, wrong: list[str]) -> None:
    with pytest.raises(MarsError) as caught:
        import_dora([(text, "d.yml")])
    assert [place(d) for d in caught.value.diagnostics] == wrong
    assert all(d.help for d in caught.value.diagnostics)


@pytest.mark.parametrize(
    ("source", "line"),
    [
        ("dora/timer/hz/0.5", '"dora/timer/hz/0.5".tick NotifyAtFrequency 0.5'),
        ("dora/timer/micros/250", "dora/timer/micros/250.tick NotifyAtFrequency 4000"),
        ("dora/timer/nanos/3000000", "dora/timer/nanos/3000000.tick NotifyAtFrequency every 3 ms"),
        ("dora/timer/micros/300", "dora/timer/micros/300.tick"),
        ("dora/timer/hz/1e2", "dora/timer/hz/1e2.tick"),
        ("dora/logs", "dora/logs.out"),
        ("dora/logs/warn/camera", "dora/logs/warn/camera.out"),
        ("_mod/goal", "_mod/goal.out"),
    ],
)
def test_a_virtual_input_is_a_source_without_a_node(source: str, line: str) -> None:
    found = import_dora([(NODE + f"inputs:\n    i: {source}\n", "d.yml")])
    (printed,) = map(print_relationship, found.configuration.relationships)
    assert printed == f"a.i uses_data_from {line}"
    assert findings_of(found) == []


def test_an_output_of_a_module_is_taken_outside_of_its_file() -> None:
    text = "module: {inputs: [goal], outputs: [path]}\n" + NODE
    text += "inputs: {goal: _mod/goal}\n  outputs: [path, state]\n"
    (module, _) = import_dora([(text, "m.yml")]).configuration.declared
    assert [service.port for service in module.services if service.port] == ["state"]


def test_more_ports_than_any_robot_has_are_refused(monkeypatch: Patch) -> None:
    monkeypatch.setattr(ports, "MOST", 2)
    with pytest.raises(MarsError, match=r"d\.yml:3:19: there are more than 2 inputs and outputs"):
        import_dora([(NODE + "outputs: [x, y, z]\n", "d.yml")])


def test_a_wire_to_nothing_is_found_at_its_line(tmp_path: Path, capsys: Captured) -> None:
    path = tmp_path / "d.yml"
    path.write_text(
        "nodes:\n- id: camera\n  outputs: [image]\n- id: plot\n  inputs:\n"
        "    image: camera/imgae\n    boxes: detector/boxes\n",
        encoding="utf-8",
    )
    assert run_here(["analyse", "--quiet", str(path)]) == 1
    found = " ".join(capsys.readouterr().out.split())
    assert "d.yml:6:12: error: undeclared_port: `camera` has no output" in found
    assert "d.yml:7:12: error: undeclared_module: no node is called `detector`" in found


#: A dataflow with a finding of each kind.
FOUND = """nodes:
- id: camera
  path: ./camera.py
  inputs: {tick: planner/tick}
  outputs: [image, depth]
  output_types: {image: std/media/v1/Image}
- id: planner
  inputs: {image: camera/image, pose: locator/pose, map: view/map}
  outputs: [path, state, tick]
- id: view
  path: ./viewer.py
  inputs: {image: camera/image, path: planner/pth}
  input_types: {image: std/media/v1/Audio}
- id: simulator
"""
KINDS = {
    "missing_file", "data_cycle", "undeclared_module", "undeclared_port", "data_divergence",
    "no_conversion", "unused_output", "unused_module",
}  # fmt: skip
#: Words of configurations, which files of dora do not have.
OURS = re.compile(r"@|`?uses_data_from|clause|at most one|\bmodules?\b|annotation|Splitter|_name")


@pytest.mark.parametrize("kind", [None, *sorted(KINDS)])
@pytest.mark.parametrize("options", [[], ["--repair"]])
def test_explanations_are_in_the_words_of_dataflows(
    tmp_path: Path, capsys: Captured, kind: str | None, options: list[str]
) -> None:
    path = tmp_path / "d.yml"
    path.write_text(FOUND, encoding="utf-8")
    (tmp_path / "viewer.py").write_text("")
    run_here(["explain", str(path), *([kind] if kind else []), *options])
    output = capsys.readouterr().out.replace("undeclared_module", "").replace("unused_module", "")
    assert OURS.search(output.replace(str(tmp_path), "")) is None
    if not kind and not options:
        run_here(["analyse", str(path), "--format", "json"])
        found = json.loads(capsys.readouterr().out)["consequences"]
        assert {each["kind"] for each in found} >= KINDS
        severe = {each["kind"] for each in found if each["severity"] == "error"}
        assert severe == {"undeclared_module", "undeclared_port"}


def test_a_dataflow_without_findings_is_explained_in_a_line(
    tmp_path: Path, capsys: Captured
) -> None:
    path = tmp_path / "d.yml"
    path.write_text("nodes:\n- id: a\n  inputs: {t: dora/timer/hz/1}\n", encoding="utf-8")
    assert run_here(["explain", str(path)]) == 0
    assert capsys.readouterr().out.strip() == "nothing found in the dataflow"


# ---- Real files ----------------------------------------------------------------------------------

SHARED = ROOT.parents[1] / "shared" / "cases" / "imports" / "dora"
#: How many modules and lines there are, and the findings, as the files' README tells them.
KNOWN = {
    "dora-typed-dataflow-dataflow": (3, 2, []),
    "dora-python-operator-dataflow-dataflow": (4, 5, ["data_divergence(webcam)"]),
    "dora-benchmark-dataflow": (2, 2, []),
}


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"the real files are not here: {SHARED}")
@pytest.mark.parametrize("name", KNOWN)
def test_real_files_give_their_known_answers(name: str) -> None:
    path = SHARED / f"{name}.yml"
    found = import_dora([(path.read_text(encoding="utf-8"), str(path))])
    modules, lines, _ = KNOWN[name]
    configuration = found.configuration
    assert (len(configuration.modules), len(configuration.relationships)) == (modules, lines)
    assert findings_of(found) == KNOWN[name][2]
