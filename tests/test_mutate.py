"""Mutants: how they are made, and that the tests notice those that change an answer."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import clingo
import pytest

from mars_asp.asp.cases.mutants import Mutant, MutantVerdict, drawn, rule_mutants
from tests.mutate.exchange import exchanges
from tests.mutate.mutant import known_survivors
from tests.mutate.python_mutants import compiled_mutants, python_mutants
from tests.mutate.rules import judge_rules, rule_files
from tests.support.campaigns import IS_CAMPAIGN, sample
from tests.support.documents import ROOT
from tests.support.fixtures import Patch

#: How many mutants are known to be equivalent: lower it when there are fewer.
MOST_SURVIVORS = 86

RULES = """%# A file of rules
p(X) :- q(X, N), not r(X), N < 2.
%! id: x/most
most(N) :- N = #max { M : q(X, M) }, 1 { r(X) } 2.
#minimize { 1@30, X : p(X) }.
#minimize { N@20 : most(N) }.
"""


def texts(folder: Path, text: str) -> list[tuple[str, str]]:
    (folder / "x.lp").write_text(text)
    (file,) = rule_files(folder)
    return [(mutant.change, mutant.after) for mutant in rule_mutants(file)]


def test_a_level_can_be_negative_or_a_variable(tmp_path: Path) -> None:
    found = texts(tmp_path, "#minimize { 1@L, X : p(X, L) }. #minimize { 1@-3 : q }. :~ r. [1@2]")
    assert [change for change, _ in found if change.startswith("level")] == [
        "level -3 -> 2",
        "level 2 -> -3",
    ]


def test_mutants_of_rules(tmp_path: Path) -> None:
    """Unsafe rules, such as one with an unbound variable in its head, are not mutants."""
    most, rest = "most(N) :- N = #max { M: q(X,M) }", "1 <= { r(X) } <= 2"
    assert texts(tmp_path, RULES) == [
        ("delete", ""),
        ("drop `not r(X)`", "p(X) :- q(X,N); N < 2."),
        ("`not r(X)` -> `r(X)`", "p(X) :- q(X,N); r(X); N < 2."),
        ("drop `N < 2`", "p(X) :- q(X,N); not r(X)."),
        ("flip `< 2` -> `> 2`", "p(X) :- q(X,N); not r(X); N > 2."),
        ("constant 2 -> 3", "p(X) :- q(X,N); not r(X); N < 3."),
        ("constant 2 -> 1", "p(X) :- q(X,N); not r(X); N < 1."),
        ("delete", ""),
        ("swap #min and #max", f"{most.replace('max', 'min')}; {rest}."),
        (f"drop `{rest}`", f"{most}."),
        (f"`{rest}` -> `not {rest}`", f"{most}; not {rest}."),
        ("flip `<= 1` -> `>= 1`", f"{most}; 1 >= {{ r(X) }} <= 2."),
        ("constant 1 -> 2", f"{most}; 2 <= {{ r(X) }} <= 2."),
        ("constant 1 -> 0", f"{most}; 0 <= {{ r(X) }} <= 2."),
        ("flip `<= 2` -> `>= 2`", f"{most}; 1 <= {{ r(X) }} >= 2."),
        ("constant 2 -> 3", f"{most}; 1 <= {{ r(X) }} <= 3."),
        ("constant 2 -> 1", f"{most}; 1 <= {{ r(X) }} <= 1."),
        ("delete", ""),
        ("constant 1 -> 2", "#minimize { 2@30,X: p(X) }."),
        ("constant 1 -> 0", "#minimize { 0@30,X: p(X) }."),
        ("drop `X` of the tuple", "#minimize { 1@30: p(X) }."),
        ("level 30 -> 20", "#minimize { 1@20,X: p(X) }."),
        ("#minimize -> #maximize", "#minimize { -1@30,X: p(X) }."),
        ("delete", ""),
        ("level 20 -> 30", "#minimize { N@30: most(N) }."),
        ("#minimize -> #maximize", "#minimize { -N@20: most(N) }."),
        ("weight N -> 1", "#minimize { 1@20: most(N) }."),
    ]


def test_a_level_that_a_variable_gives_is_not_changed(tmp_path: Path) -> None:
    assert texts(tmp_path, "#minimize { W@L, X : p(X, L, W) }.\n") == [
        ("delete", ""),
        ("drop `X` of the tuple", "#minimize { W@L: p(X,L,W) }."),
        ("#minimize -> #maximize", "#minimize { -W@L,X: p(X,L,W) }."),
        ("weight W -> 1", "#minimize { 1@L,X: p(X,L,W) }."),
    ]


def test_a_mutated_file_keeps_its_lines(tmp_path: Path) -> None:
    (tmp_path / "x.lp").write_text(RULES.replace("not r(X),", "not r(X),\n      "))
    (file,) = rule_files(tmp_path)
    for mutant in rule_mutants(file):
        text = file.mutated(mutant)
        clingo.Control().add("base", [], text)
        lines = text.split("\n")
        assert len(lines) == RULES.count("\n") + 2
        assert lines[3] == "%! id: x/most"


def test_mutants_of_python(tmp_path: Path, monkeypatch: Patch) -> None:
    monkeypatch.setattr("tests.mutate.python_mutants.ROOT", tmp_path)
    (tmp_path / "m.py").write_text(
        "def f(a, b):\n"
        "    for x in a:\n"
        "        if not x and b:\n"
        "            print(x)\n"
        "    return min(y for y in a if y < 3)\n"
    )
    mutants = list(python_mutants("m.py"))
    assert [(mutant.line, mutant.change, mutant.after) for mutant in mutants] == [
        (3, "drop the statement", ""),
        (3, "drop `not x`", "f: if b:"),
        (3, "drop `b`", "f: if not x:"),
        (3, "drop `not`", "f: if x and b:"),
        (4, "drop the statement", ""),
        (5, "swap min and max", "f: return max((y for y in a if y < 3))"),
        (5, "drop `if y < 3`", "f: return min((y for y in a))"),
        (5, "flip a comparison", "f: return min((y for y in a if y <= 3))"),
        (5, "flip a comparison", "f: return min((y for y in a if y > 3))"),
        (5, "constant 3 -> 4", "f: return min((y for y in a if y < 4))"),
    ]
    drops_b = next(code for mutant, code, _ in compiled_mutants("m.py") if mutant == mutants[2])
    namespace: dict[str, Any] = {"print": lambda x: None}
    exec(drops_b, namespace)
    printed: list[int] = []
    namespace["print"] = printed.append
    assert namespace["f"]([0, 1, 2], False) == 0
    assert printed == [0]


def test_cases_notice_a_mutant_that_changes_an_answer_and_no_other() -> None:
    """The last mutant is equivalent to the rule, so that no case can notice it."""
    files = rule_files()
    (file,) = (file for file in files if file.path == "rules/data.lp")
    place = next(n for n, s in enumerate(file.statements) if s.text.startswith("repeats("))
    statement = file.statements[place]
    bodies = ["R' > R", "R' <= R", "R = R'", "R != R'; R' != R", "R' != R; not 1 > 2"]
    mutants = [
        Mutant(file.path, statement.line, "", statement.text, after, place)
        for body in bodies
        if (after := statement.text.replace("R' != R", body)) != statement.text
    ]
    cases = ROOT / "tests" / "rules" / "data"
    judged = judge_rules(files, mutants, jobs=1, cases=cases, stronger=False)
    verdicts = {verdict.mutant: verdict.killer for verdict in judged}
    assert [verdicts[mutant] is not None for mutant in mutants] == [True, True, True, False, False]


def test_known_survivors_are_still_mutants_and_have_a_reason() -> None:
    """The list may only shrink: remove entries that are killed or cease to be mutants."""
    known = known_survivors()
    assert len({survivor.key for survivor in known}) == len(known) <= MOST_SURVIVORS
    paths = sample(sorted({survivor.path for survivor in known}), 4)
    known = tuple(survivor for survivor in known if survivor.path in paths)
    mutants = {m.key for f in rule_files() if f.path in paths for m in rule_mutants(f)}
    mutants |= {m.key for path in paths if path.endswith(".py") for m in python_mutants(path)}
    assert [survivor for survivor in known if survivor.key not in mutants] == []
    assert [survivor for survivor in known if not survivor.reason.strip()] == []


#: Files whose mutants their own cases kill, and that are quick to judge.
RULES_HELD = ("data", "services", "pace", "mounts", "repair/conversions", "repair/names")
SEED = 1


def alive(verdicts: Iterable[MutantVerdict]) -> list[str]:
    return [str(verdict.mutant) for verdict in verdicts if verdict.killer is None]


@pytest.mark.parametrize(
    "folder", sample([*dict.fromkeys(name.partition("/")[0] for name in RULES_HELD)], 3)
)
def test_mutants_of_rules_are_killed(folder: str) -> None:
    """Some of each file, drawn by chance, are tried on its own cases."""
    known = {survivor.key for survivor in known_survivors()}
    files = {file.path: file for file in rule_files()}
    mutants: list[Mutant] = []
    for name in RULES_HELD:
        if name.partition("/")[0] == folder:
            result = (m for m in rule_mutants(files[f"rules/{name}.lp"]) if m.key not in known)
            mutants += drawn(result, 2 if IS_CAMPAIGN else 1, SEED)
    cases = ROOT / "tests" / "rules" / folder
    verdicts = judge_rules(tuple(files.values()), mutants, 1, cases, stronger=False)
    assert alive(verdicts) == []


def test_functions_are_found_though_the_suite_has_frozen_them() -> None:
    (found,) = exchanges(["mars_asp/spelling.py"]).values()
    assert found.functions
