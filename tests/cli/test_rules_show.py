"""A rule or kind by its name, with `rules show` and with `explain`."""

import json
import re
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.rules import STAGES, load_rulebook
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


def test_the_list_of_rules_has_the_kind_of_each_finding(capsys: Captured) -> None:
    assert run_here(["rules", "list"]) == 0
    listed = capsys.readouterr().out
    shown = {line.rpartition(" [")[2] for line in listed.splitlines() if line.endswith("]")}
    assert {f"{kind}]" for kind in consequence_kinds(load_rulebook(stages=STAGES))} <= shown


def test_a_kind_of_node_is_shown_with_the_rules_of_its_pack_alone(
    tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "slow"
    pack.mkdir()
    # A built-in rule has this word for a module that limits another one.
    node = '[[node]]\nkind = "limiter"\nname = "Limiter"\ncarries = "control"\n'
    head = 'name = "slow"\nversion = "1.0"\n\n'
    (pack / "pack.toml").write_text(f'{head}{node}inputs = "one"\noutputs = "one"\n')
    assert run_here(["rules", "show", "limiter", "--rules", str(pack)]) == 0
    assert "bounds/limiter-class" not in capsys.readouterr().out


def test_a_list_takes_no_name(capsys: Captured) -> None:
    assert run_here(["rules", "list", "guard"]) == 2
    assert "`rules show guard`" in capsys.readouterr().err


def test_a_name_that_is_neither_file_nor_rule_is_a_missing_file(
    capsys: Captured,
) -> None:
    assert run_here(["explain", "guard_bypas"]) == 2
    assert "did you mean `guard_bypass`?" in capsys.readouterr().err
