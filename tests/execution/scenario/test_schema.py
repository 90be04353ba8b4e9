"""The JSON Schema of scenarios: its output, its use by editors, and its documentation."""

import json
import tomllib
from datetime import date
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema_rs import Draft4Validator

from mars_asp.cli import run_here
from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.scenario.schema import SCHEMA, mistakes
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS
from tests.support.campaigns import examples
from tests.support.documents import ROOT
from tests.support.fixtures import Captured
from tests.support.refusals import refusal
from tests.support.trials import BASE

DOCUMENT = ROOT / "mars_asp" / "execution" / "scenario" / "scenario.schema.json"
SCENARIOS = sorted(ROOT.glob("examples/*/*.toml"))
GOOD: dict[str, Any] = {"duration": 3, "robot": {"module": "P"}}


def test_the_printed_schema_is_that_of_the_file_without_references(capsys: Captured) -> None:
    with pytest.raises(SystemExit) as ended:
        run_here(["run", "--schema"])
    assert not ended.value.code
    printed = capsys.readouterr().out
    assert json.loads(printed) == SCHEMA
    assert "$ref" not in printed
    assert "definitions" not in SCHEMA


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: str(path.relative_to(ROOT)))
def test_examples_conform_to_the_schema(path: Path) -> None:
    schema = json.loads(DOCUMENT.read_text(encoding="utf-8"))
    Draft4Validator(schema).validate(tomllib.loads(path.read_text(encoding="utf-8")))


def test_every_key_is_explained() -> None:
    text = (ROOT / "docs" / "reference" / "scenarios.md").read_text(encoding="utf-8")
    functions = {*MOTION_FUNCTIONS, GRASP}
    assert [key for key in keys(SCHEMA) if f"{key}" not in text and key not in functions] == []


def keys(schema: dict[str, Any]) -> list[str]:
    found: list[str] = []
    for key, value in schema.get("properties", {}).items():
        found += [key, *keys(value)]
    for inner in (
        schema.get("items"),
        schema.get("additionalProperties"),
        *schema.get("oneOf", ()),
    ):
        found += keys(inner) if isinstance(inner, dict) else []
    return found


@pytest.mark.parametrize(
    ("wrong", "message", "help_text"),
    [
        ("seed = 1.0", "`seed` must be a whole number", None),
        (
            "seed = 9223372036854775808",
            "`9223372036854775808` is out of range for `seed`",
            "from -9223372036854775808 to 9223372036854775807",
        ),
        ("duration = 1979-05-27", "`duration` must be a number", None),
        ("up = 07:32:00", "`up` must be a string", None),
        ("robot = 3", "`robot` must be a table", None),
        ("world.walls = 3", "`walls` must be a list", None),
        ("robot.module = true", "`module` must be a string", None),
        ("requirements.no_collision = 1", "`no_collision` must be true or false", None),
        ("world.circles = [[0, 0, -inf]]", "an entry of `circles` must be", None),
        (
            "robot.start = [0, nan, 0]",
            "`nan` is out of range for `start`",
            "from -1000000000 to 1000000000",
        ),
        (
            "devices.D = { kind = 'sonor' }",
            "`kind` must be sonar, lidar, ",
            "did you mean `sonar`?",
        ),
        (
            "devices.D.kind = 'joint'\ndevices.D.low = nan",
            "`nan` is out of range",
            "from -inf to inf",
        ),
        ("devices.D = {}", "`D` has no `kind`", "one of sonar, lidar"),
        ("devices.D = [1]", "`D` must be a table", None),
        ("devices = 3", "`devices` must be a table", None),
        ("faults.C = { kind = 'stuck', until = -1 }", "`-1` is out of range", "from 0 to inf"),
    ],
)
def test_each_mistake_has_its_message(wrong: str, message: str, help_text: str | None) -> None:
    key = wrong.split(" =", maxsplit=1)[0].split(".", maxsplit=1)[0]
    rest = [line for line in ("duration = 3", 'robot.module = "P"') if not line.startswith(key)]
    if wrong.startswith("robot.start"):
        rest.append('robot.module = "P"')
    found = refusal(read_scenario, "\n".join([wrong, *rest]), Path("s.toml"))
    assert found.message.startswith(message)
    assert (found.help or "").startswith(help_text or "")
    assert found.span.line in (1, 2)


def test_several_faults_of_one_form_are_reported_once() -> None:
    (found,) = mistakes({**GOOD, "world": {"walls": [[["a", "b"], ["c"]]]}})
    assert found.path == ("world", "walls", 0)


VALUES = st.recursive(
    st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from(["P", "sonar", "late", "Trans_Z", "y"])
    | st.just(date(2026, 1, 1)),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from([*dict.fromkeys(keys(SCHEMA)), "x"]), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.sampled_from([*SCHEMA["properties"], "x"]), VALUES, max_size=4))
@settings(max_examples=examples(100, 300), deadline=None)
def test_each_scenario_has_a_reported_mistake_or_fits_the_schema(
    tables: dict[str, Any],
) -> None:
    entries = list(mistakes({**GOOD, **tables}))
    assert len(set(entries)) == len(entries)
    for mistake in entries:
        assert "None" not in mistake.message
    if not entries:
        Draft4Validator(SCHEMA).validate({**GOOD, **tables})


@pytest.mark.parametrize("depth", [80, 200, 300, 400])
def test_too_deep_nesting_is_reported(depth: int) -> None:
    text = f"{BASE}[world]\nwalls = {'[' * depth}{']' * depth}\n"
    found = refusal(read_scenario, text, Path("s.toml"))
    assert "walls" in found.message or "too deep" in found.message
