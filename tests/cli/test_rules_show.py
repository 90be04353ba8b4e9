"""A rule or kind by its name, with `rules show` and with `explain`."""

import json
import re

import pytest

from mars_asp.cli import run_here
from tests.support.fixtures import Captured


@pytest.mark.parametrize("name", ["guards/bypass", "unused_module", "checks/unused"])
def test_explain_alone_prints_a_rule_or_kind(name: str, capsys: Captured) -> None:
    assert run_here(["explain", name]) == 0
    explained = capsys.readouterr().out
    assert run_here(["rules", "show", name]) == 0
    assert capsys.readouterr().out == explained
    # No hole of a message is left.
    assert not re.search(r"\{[A-Z]", explained)


def test_explain_prints_json_of_a_rule(capsys: Captured) -> None:
    assert run_here(["explain", "guards/bypass", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["id"] == "guards/bypass"


def test_a_rule_is_shown_with_the_values_of_its_example(
    capsys: Captured,
) -> None:
    run_here(["rules", "show", "guards/bypass"])
    shown = capsys.readouterr().out
    assert "`Joy` commands `Base` past the guard `Monitor`" in shown.split("\n\n")[1]
    assert (
        "Help: let `Joy` control `Monitor`" in shown and "consequence(guard_bypass, w" not in shown
    )
    run_here(["rules", "show", "guards/bypass", "--source"])
    shown = capsys.readouterr().out
    assert shown.split("\n\n")[1].startswith("`Joy` commands `Base`")
    assert "%! who:     C@0; G@1\n" in shown
    assert "consequence(guard_bypass, warning, M, past(C, G)) :-" in shown
    run_here(["rules", "show", "unused_module", "--source"])
    shown = capsys.readouterr().out
    assert shown.count("```clingo") == 4 and "\n\n`B` takes part in no relationship" in shown


def test_sentences_of_explanations_show_no_holes(capsys: Captured) -> None:
    run_here(["rules", "show", "account/data/feeds-several"])
    assert "`S` feeds … modules, and a source" in capsys.readouterr().out
    run_here(["explain", "DataSplitter"])
    assert "account/" not in capsys.readouterr().out


def test_a_list_takes_no_name(capsys: Captured) -> None:
    assert run_here(["rules", "list", "guard"]) == 2
    assert "`rules show guard`" in capsys.readouterr().err


def test_a_name_that_is_neither_file_nor_rule_is_a_missing_file(
    capsys: Captured,
) -> None:
    assert run_here(["explain", "guard_bypas"]) == 2
    assert "did you mean `guard_bypass`?" in capsys.readouterr().err
