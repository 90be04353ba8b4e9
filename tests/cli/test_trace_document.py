"""Explanations for programs fit the schemas that the package ships, and hold together."""

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

import jsonschema_rs
import pytest

from mars_asp.cli import run_command, run_here
from mars_asp.cli.schemas import schema_text
from mars_asp.cli.trace_document import topics_text
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.explain import Explanation, explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import sample
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured

EXAMPLES = sorted(ROOT.glob("examples/*/config.mars"))
_RULEBOOK = load_rulebook()


#: Predicates about gates without a sentence on their absence yet. The list may only shrink.
UNWORDED = frozenset(
    "commands_another enters_gate existing_gate gate_line_has gates_input of_other_sort sends "
    "merely_copied sent_apart several_passes strategy unfit".split()
)


@cache
def explained(path: str, every: bool) -> Explanation:
    return explain(Reasoner(load_project(path), _RULEBOOK), every=every)


def written(answer: Explanation, form: str) -> str:
    parts: list[str] = []
    parts += topics_text(answer.subject, answer.topics, form)
    return "".join(parts)


@pytest.mark.parametrize("every", [False, True])
@pytest.mark.parametrize("path", sample(EXAMPLES, 2), ids=lambda path: path.parent.name)
def test_both_forms_fit_their_schemas_and_tell_the_same(path: Any, every: bool) -> None:
    answer = explained(str(path), every)
    document = json.loads(written(answer, "json"))
    lines = list(map(json.loads, written(answer, "jsonl").splitlines()))
    of_document = jsonschema_rs.validator_for(json.loads(schema_text("explain", "json")))
    of_line = jsonschema_rs.validator_for(json.loads(schema_text("explain", "jsonl")))

    assert [error.message for error in of_document.iter_errors(document)] == []
    assert [error.message for line in lines for error in of_line.iter_errors(line)] == []
    assert faults_in_references(document) == []
    assert faults_in_lines(lines) == []
    in_document = {(s["atom"], s["message"]) for s in steps(document) if "shared" not in s}
    assert {(line["atom"], line["says"]) for line in lines if "step" in line} == in_document
    assert [line["title"] for line in lines if "topic" in line] == [
        topic["title"] for topic in document["topics"]
    ]
    # The absence of an atom is a sentence, never the atom itself.
    absent = (s for s in steps(document) if s["kind"] == "absent" and not s["message"])
    unworded = [s["atom"] for s in absent if s["atom"].partition("(")[0] not in UNWORDED]
    assert unworded == []


@pytest.mark.parametrize(
    ("name", "query"),
    [
        ("level1", "ArbitrationNode(Turn)"),
        ("level1", "ArbitrationNode(MobilePlatform)"),
        ("level1", "DataTransformer(SonarMap)"),
        ("level1", "data_cycle"),
        ("level1", "DataSplitter9"),
        ("level1", "uses_data_from(Turn,Runaway)"),
        ("gripper-arm", "missing_function(Gripper)"),
    ],
)
def test_why_there_is_none_fits_the_schema_of_explanations(
    name: str, query: str, capsys: Captured
) -> None:
    file = str(ROOT / "examples" / name / "config.mars")
    assert run_here(["explain", file, "--why-not", query, "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    of_document = jsonschema_rs.validator_for(json.loads(schema_text("explain", "json")))
    assert [error.message for error in of_document.iter_errors(document)] == []
    assert faults_in_references(document) == []
    assert [topic["answer"] for topic in document["topics"]] == [document["answer"]]
    del document["to_get"]
    assert list(of_document.iter_errors(document))


def steps(document: Any) -> Iterator[Any]:
    """Yield the steps of a document in its order."""
    stack = document["traces"][::-1]
    while stack:
        step = stack.pop()
        yield step
        stack += [*step.get("premises", ()), *step.get("others", ())][::-1]


def faults_in_references(document: Any) -> list[str]:
    """Return the faults of numbers: each has to be new, or to refer to an earlier step."""
    known: dict[int, str] = {}
    wrong = []
    for step in steps(document):
        if step.get("shared"):
            if known.get(step["ref"]) != step["atom"]:
                wrong.append(f"{step['atom']} refers to {known.get(step['ref'])}")
        elif step["id"] in known:
            wrong.append(f"{step['id']} is used twice")
        else:
            known[step["id"]] = step["atom"]
    return wrong


def faults_in_lines(lines: list[Any]) -> list[str]:
    """Return the faults of lines: numbers are defined before use, and no step occurs twice."""
    known: dict[str, set[int]] = {"rule": set(), "file": set(), "step": set(), "topic": set()}
    derivations: set[str] = set()
    wrong = []
    for line in lines[1:-1]:
        sort = next(key for key in ("step", "file", "topic", "rule") if key in line)
        used = [("step", n) for n in (*line.get("from", ()), *line.get("why", ()))]
        used += [("step", line["other_of"])] if "other_of" in line else []
        if sort == "step":
            used += [("rule", line["rule"])] if line["rule"] else []
            used += [("file", at[0]) for at in [line["at"], *line.get("computed_from", ())] if at]
            own = json.dumps({**line, "step": None})
            wrong += [f"{line['atom']} stands twice"] if own in derivations else []
            derivations.add(own)
        wrong += [f"{each} before its line" for each in used if each[1] not in known[each[0]]]
        wrong += [f"{sort} {line[sort]} again"] if line[sort] in known[sort] else []
        known[sort].add(line[sort])
    end = {"end": True, "steps": len(known["step"]), "topics": len(known["topic"])}
    return wrong if lines[-1] == end else [*wrong, f"{lines[-1]} is not {end}"]


@pytest.mark.parametrize("form", ["json", "jsonl"])
def test_schemas_are_printed_without_a_file(form: str, capsys: Any) -> None:
    assert run_command(["explain", "--schema", form]) == 0
    assert capsys.readouterr().out == schema_text("explain", form)


def test_diagnostics_are_json_beside_lines(tmp_path: Any) -> None:
    (tmp_path / "c.mars").write_text("@configuration\n@modules A\nA uses_data_from B\n")
    output = run("mars-asp explain c.mars --format jsonl", tmp_path)
    assert all(isinstance(json.loads(line), dict) for line in output.splitlines())
