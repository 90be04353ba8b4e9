"""Differences between two configurations, and the lines that caused them."""

import json
import random
import shutil
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given, settings

from mars_asp.cli import run_here
from mars_asp.cli.lines import lines_of
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.project import Project, load_project
from mars_asp.reasoning.questions.diff import diff
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import examples, seeds
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured
from tests.support.random_configurations import random_faults, random_ports
from tests.support.strategies import configurations, few

RULEBOOK = load_rulebook()
CASES = sorted((ROOT / "tests/diff").glob("*/"))


@pytest.mark.parametrize("folder", CASES, ids=lambda path: path.name)
def test_cases(folder: Path, update_golden: bool) -> None:
    place = folder.relative_to(ROOT)
    found = run(f"mars-asp diff {place}/old.mars {place}/new.mars")
    if update_golden:
        (folder / "expected.txt").write_text(found)
    assert found == (folder / "expected.txt").read_text()


def _reasoner(configuration: Configuration) -> Reasoner:
    return Reasoner(Project(configuration, {}, ()), RULEBOOK)


@settings(few, max_examples=examples(4, 12))
@given(configurations)
def test_nothing_differs_from_itself(configuration: Configuration) -> None:
    found = diff(_reasoner(configuration), _reasoner(configuration))
    assert found.is_empty
    assert (found.added, found.removed) == ((), ())


@settings(few, max_examples=examples(2, 12))
@given(configurations, configurations)
def test_a_reversed_diff_swaps_appeared_and_vanished(
    old: Configuration, new: Configuration
) -> None:
    one, other = _reasoner(old), _reasoner(new)
    forth, back = diff(one, other), diff(other, one)
    mirror = {"appeared": "vanished", "vanished": "appeared", "changed": "changed"}
    assert sorted((mirror[c.how], c.item.kind, c.item.subject) for c in forth.consequences) == (
        sorted((c.how, c.item.kind, c.item.subject) for c in back.consequences)
    )
    assert sorted((mirror[c.how], c.item.kind) for c in forth.nodes) == (
        sorted((c.how, c.item.kind) for c in back.nodes)
    )
    assert (forth.added, forth.removed) == (back.removed, back.added)


def test_an_error_that_appears_changes_the_status() -> None:
    case = ROOT / "tests/diff/error"
    old, new = str(case / "old.mars"), str(case / "new.mars")
    assert run_here(["diff", old, new, "--quiet"]) == 1
    assert run_here(["diff", new, old, "--quiet"]) == 0
    assert run_here(["diff", new, new, "--quiet"]) == 0


def test_json_names_the_lines(tmp_path: Path, capsys: Captured) -> None:
    for name in ("old.mars", "new.mars"):
        shutil.copy(ROOT / "tests/diff/divergence" / name, tmp_path)
    words = ["diff", str(tmp_path / "old.mars"), str(tmp_path / "new.mars"), "--format", "json"]
    assert run_here(words) == 0
    found = json.loads(capsys.readouterr().out)
    line = {"path": str(tmp_path / "new.mars"), "line": 3, "column": 1}
    line |= {"text": "Edges uses_data_from Camera"}
    assert found["added"] == [line]
    assert found["consequences"][0]["change"] == "appeared"
    assert found["consequences"][0]["added"] == [line]
    assert found["nodes"][0] == {
        "change": "appeared",
        "name": "DataSplitter1",
        "kind": "data_splitter",
        "resolves": ["data_divergence(Camera)"],
        "added": [line],
        "removed": [],
        "unchanged": [],
    }
    assert found["cost"]["new"] == {"nodes": 1, "conversion": 0, "relationships": 4}


def test_lines_that_do_not_differ_as_text_are_neither_added_nor_removed(tmp_path: Path) -> None:
    for seed in seeds(2, 12):
        rng, sides = random.Random(seed), []
        for name, text in zip("ab", _two_alike(rng, seed), strict=True):
            path = tmp_path / f"{name}{seed}.mars"
            path.write_text(text)
            sides.append(path)
        old, new = (Reasoner(load_project(str(path)), RULEBOOK) for path in sides)
        found = diff(old, new, lines_of)
        texts = [Counter(map(str.strip, path.read_text().split("\n"))) for path in sides]
        removed, added = (
            Counter(lines_of(path)[line - 1].strip() for path, line in places)
            for places in (
                {(s.path, s.line) for s in each} for each in (found.removed, found.added)
            )
        )
        assert not removed - (texts[0] - texts[1]), seed
        assert not added - (texts[1] - texts[0]), seed


def _two_alike(rng: random.Random, seed: int) -> tuple[str, str]:
    """Return a configuration, and the same with lines added, dropped, moved and changed."""
    text = random_ports(seed) if seed % 2 else random_faults(seed)
    lines = [line for line in text.split("\n") if line]
    head, body = lines[:2], lines[2:]
    blocks = body.index("@module_start") if "@module_start" in body else len(body)
    own = body[:blocks]
    rng.shuffle(own)
    own = own[rng.randint(0, 1) :] or ["Near"]
    rate = rng.choice(["58.8235", "58.824", "every 17 ms"])
    own.append(f"{own[0].split(maxsplit=1)[0]} uses_data_from Far NotifyAtFrequency {rate}")
    head[0] = rng.choice(["@configuration flat", "@configuration hierarchical"])
    own = [line for line in own if " " in line]
    changed = [line.replace("NotifyAtFrequency 10", f"NotifyAtFrequency {rate}") for line in own]
    return text, "\n".join([*head, *changed, *body[blocks:], ""])


def test_a_specification_beside_its_configuration_is_one_to_verify(capsys: Captured) -> None:
    robot, specification = (f"docs/tutorial/{name}.mars" for name in ("repaired", "specification"))
    for pair, name in (((robot, specification), "NEW"), ((specification, robot), "OLD")):
        run_here(["diff", *(str(ROOT / path) for path in pair)])
        shown = capsys.readouterr().out
        assert f"{name} is a specification and has its nodes already" in shown
        command = f"mars-asp verify {ROOT / specification} {ROOT / robot}"
        assert f"    {command}\n" in shown
