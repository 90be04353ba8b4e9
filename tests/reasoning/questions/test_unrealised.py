"""The sentence that no specification realises a configuration names the errors that prevent it."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured

CONFIG = "tests/repair/rate/config.mars"
NAMED = f"`service_infeasible(Map)` ({CONFIG}:4) prevents it"
FINE = "@configuration\n@modules A, B\nA uses_data_from B\n"


@pytest.mark.parametrize(
    "words",
    [
        ["synthesise", CONFIG],
        ["synthesise", CONFIG, "--format=json"],
        ["explain", CONFIG],
        ["explain", CONFIG, "--only=nodes"],
        ["explain", CONFIG, "Map", "--only=nodes"],
        ["explain", CONFIG, "DataSplitter1"],
        ["explain", CONFIG, "--why-not=DataSplitter1"],
        ["explain", CONFIG, "--alternatives"],
        ["verify", "--without=DataSplitter1", CONFIG],
        ["run", CONFIG, "--scenario=examples/level0/scenario.toml"],
        ["diff", "FINE", CONFIG],
        ["diff", CONFIG, "FINE"],
    ],
    ids=" ".join,
)
def test_the_error_that_prevents_a_specification_is_named(
    words: list[str], tmp_path: Path, capsys: Captured
) -> None:
    fine = tmp_path / "fine.mars"
    fine.write_text(FINE)
    run_here([str(fine) if word == "FINE" else word for word in words])
    output = capsys.readouterr()
    assert NAMED in " ".join(f"{output.out} {output.err}".split())


def test_of_many_errors_the_first_are_named(tmp_path: Path, capsys: Captured) -> None:
    text = "@configuration\n@modules S, A, B, C, D\n"
    text += "".join(f"{name} uses_data_from S NotifyAtFrequency 50\n" for name in "ABCD")
    text += "@module_start\n@module_name S\n@Sense NotifyAtFrequency 10\nImage image();\n"
    text += "@module_end\n"
    config = tmp_path / "c.mars"
    config.write_text(text)
    run_here(["synthesise", str(config)])
    output = " ".join(capsys.readouterr().err.split())
    names = [f"`service_infeasible({name})` ({config}:{at})" for name, at in (("A", 3), ("B", 4))]
    assert f"{', '.join(names)} and 2 more errors prevent it" in output
