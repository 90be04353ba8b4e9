import json
import re
import shutil
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.language.text_edits import LineEdit, apply_lines
from tests.support.fixtures import Captured, Patch

PACK = """\
%*! ours(M: module)
M is one of ours.
*%
#defined ours/1.
slow(R) :- module(R), required_rate(R, F), F < 3000.
odd(M) :- class(M, sensr).
both(P) :- ours(P), output(_, _, P).
#show slow/1. #show odd/1. #show both/1.
"""


@pytest.fixture(autouse=True)
def wide(monkeypatch: Patch) -> None:
    """Print each message in one line."""
    monkeypatch.setenv("COLUMNS", "1000")


def test_lint_hands_sorts_on(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(PACK)
    assert run_here(["rules", "lint", str(pack)]) == 0
    output = [line for line in capsys.readouterr().err.splitlines() if "warning" in line]
    assert output == [
        f"{pack}:5:23: warning: `R` is a module in `module/1` and a relationship in "
        "`required_rate/2` [rule-sort]",
        f"{pack}:6:20: warning: `K` of `class/2` is never `sensr` [rule-value]",
        f"{pack}:7:21: warning: `P` is a module in `ours/1` and a representation in `output/3` "
        "[rule-sort]",
    ]


def test_lint_has_nothing_against_our_own_rules(capsys: Captured) -> None:
    assert run_here(["rules", "lint"]) == 0
    assert capsys.readouterr().out == "no problems found in the built-in rules\n"


def test_lint_without_a_path_takes_the_pack_of_the_folder(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_here(["rules", "new", "ours"]) == 0
    monkeypatch.chdir(tmp_path / "ours")
    with (tmp_path / "ours/consequences/ours.lp").open("a", encoding="utf-8") as rules:
        rules.write("bad(X :- y.\n")
    assert run_here(["rules", "lint"]) == 2
    assert "syntax error" in capsys.readouterr().err


def test_a_wrong_declaration_is_reported(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(PACK.replace("ours.\n", "ours.\nfron: stated\n"))
    assert run_here(["rules", "lint", str(pack)]) == 0
    assert f"{pack}:1:1: warning: `fron: stated` is not a key" in capsys.readouterr().err
    # What one writes for readers keeps no rule from being used.
    assert run_here(["analyse", "examples/level0/config.mars", "--rules", str(pack)]) == 0


def test_packs_may_read_the_old_names_of_predicates(capsys: Captured) -> None:
    assert run_here(["rules", "list", "--predicates", "--format", "json"]) == 0
    names = {each["predicate"] for each in json.loads(capsys.readouterr().out)}
    old = {
        *("speaks/2", "hears/3", "takes/2", "at/3", "stems/2"),
        *("spec_comes_by/2", "spec_leaves_by/2", "spec_heard_by/2"),
    }
    assert old <= names


def test_predicates_are_shown(capsys: Captured) -> None:
    assert run_here(["rules", "show", "architecture/1"]) == 0
    assert "architecture(K: {flat, hierarchical})" in capsys.readouterr().out


def test_fixes_are_written(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text("% größer\nodd(M) :- class(M, sensr), guard(M), guard(M). #show odd/1.\n")
    assert run_here(["rules", "lint", "--fix", str(pack)]) == 0
    changed = capsys.readouterr().out
    assert "\n+odd(M) :- class(M, sensor), guard(M). #show odd/1.\n" in changed
    assert changed.endswith("\ncorrected: 2\nno problems found\n")
    assert pack.read_text() == "% größer\nodd(M) :- class(M, sensor), guard(M). #show odd/1.\n"
    assert run_here(["rules", "lint", "--fix"]) == 2
    assert "`--fix` has an effect only on `lint` with a pack" in capsys.readouterr().err


def test_refusals_of_an_analysis_come_with_the_lints(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(
        "odd(M) :- missing_here(M, sensr).\nsees(M) :- class(M, sensr). #show sees/1.\n"
    )
    assert run_here(["rules", "lint", str(pack)]) == 2
    output = capsys.readouterr().err
    assert "[rule-unknown]" in output
    assert "[rule-value]" in output


def test_json_has_the_fix_of_each_lint(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "pack.lp"
    text = "odd(M) :- class(M, sensr),\n  guard(M), guard(M). #show odd/1.\nx(M) :- module(M).\n"
    pack.write_text(text)
    assert run_here(["rules", "lint", str(pack), "--format", "json"]) == 0
    found = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    fixes = {each["code"]: each["fix"] for each in found}
    assert fixes["rule-value"]["message"] == "write `sensor`"
    assert fixes["rule-redundant"]["message"] == "leave it out"
    assert fixes["rule-unused"] is None
    edits = [
        LineEdit(**{**line, "path": str(pack)})
        for fix in fixes.values()
        if fix is not None
        for line in fix["lines"]
    ]
    run_here(["rules", "lint", str(pack), "--fix"])
    assert apply_lines(text, edits) == pack.read_text()


def test_lint_takes_several_files_and_judges_those_of_a_pack_with_it(
    tmp_path: Path, capsys: Captured
) -> None:
    bus, loose = tmp_path / "bus", tmp_path / "loose.lp"
    shutil.copytree("examples/packs/bus", bus)
    files = [bus / "consequences" / name for name in ("bus.lp", "vocabulary.lp")]
    with files[1].open("a", encoding="utf-8") as rules:
        rules.write("odd(M) :- on_bus(M, B), size(B).\n")
    loose.write_text("odd(M) :- class(M, sensr). #show odd/1.\n")
    for first, status, places in ((0, 0, []), (1, 2, [f"{files[1]}:"])):
        assert run_here(["rules", "lint", str(files[first]), str(loose)]) == status
        output = re.findall(r"(?m)^(\S+:)[0-9]+:[0-9]+: ", capsys.readouterr().err)
        assert sorted(set(output)) == sorted([*places, f"{loose}:"])
    with files[1].open("a", encoding="utf-8") as rules:
        rules.write("bad(X :- y.\n")
    assert run_here(["rules", "lint", str(files[0])]) == 2
    assert "syntax error" in capsys.readouterr().err


def pack_in(folder: Path, name: str, needs: str, rule: str) -> Path:
    (folder / name / "consequences").mkdir(parents=True)
    manifest = f'name = "{name}"\nversion = "1.0"\nneeds = [{needs}]\n'
    (folder / name / "pack.toml").write_text(manifest)
    (folder / name / "consequences" / f"{name}.lp").write_text(rule)
    return folder / name


def test_a_required_pack_is_found_beside_its_user(tmp_path: Path, capsys: Captured) -> None:
    shared = "%*! far(M: module)\nM is far.\npacks: read\n*%\nfar(M) :- class(M, sensr).\n"
    pack_in(tmp_path, "base", "", shared)
    top = pack_in(tmp_path, "top", '"base"', "near(M) :- module(M), not far(M).\n#show near/1.\n")
    # Findings in a required pack are not reported.
    assert run_here(["rules", "lint", str(top)]) == 0
    assert capsys.readouterr().out == "no problems found\n"
    assert run_here(["rules", "doc", str(top)]) == 0
    assert run_here(["rules", "lint", str(tmp_path / "base")]) == 0
    assert "never `sensr`" in capsys.readouterr().err
    assert run_here(["rules", "lint", str(top), "--rules", str(tmp_path / "base")]) == 0
    assert "never `sensr`" in capsys.readouterr().err
    (tmp_path / "base").rename(tmp_path / "elsewhere")
    assert run_here(["rules", "lint", str(top)]) == 2
    assert "find `../base` themselves" in capsys.readouterr().err
