"""Rule packs that would lie, hang or end the process: each is refused at its place.

Packs are in `tests/packs`, each with its expected messages beside it.
"""

import ast
import re
from collections import Counter
from itertools import product
from pathlib import Path

import pytest

from mars_asp.asp.rules.declarations import Documented
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.cli import run_here
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.cases import run_case
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.reasoning.lint import lint
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import STAGES, load_rulebook, seal
from mars_asp.reasoning.sample import samples
from mars_asp.reasoning.verification import verify
from tests.mutate.rules import built_in
from tests.support.campaigns import examples, sample, seeds
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.mutated_texts import faults
from tests.support.random_configurations import random_configuration
from tests.support.refusals import refusal, refusals

PACKS = sorted((ROOT / "tests/packs").glob("*.lp"))
ROBOT = "tests/packs/robot.mars"


@pytest.mark.parametrize("path", PACKS, ids=lambda path: path.stem)
def test_packs(path: Path, update_golden: bool, capsys: Captured, monkeypatch: Patch) -> None:
    """`rules lint` reports the errors of an analysis, though it tries other robots."""
    monkeypatch.chdir(ROOT)
    pack = str(path.relative_to(ROOT))
    assert run_here(["analyse", ROBOT, "--rules", pack]) == 2
    printed, output = capsys.readouterr()
    assert not printed
    if update_golden:
        path.with_suffix(".txt").write_text(output, encoding="utf-8")
    assert output == path.with_suffix(".txt").read_text(encoding="utf-8")
    status = run_here(["rules", "lint", pack])
    linted = capsys.readouterr().err
    if path.stem != "constraint":
        linted = _errors(linted)
    else:
        linted = "".join(each for each in _blocks(linted) if "[rules-inconsistent]" in each)
    if path.stem == "constraint":
        # Another robot may meet the demand.
        output = " ".join(output.split()).replace("error: ", "warning: ")
        output = output.replace("this configuration", "a sample robot")
        assert (status, " ".join(linted.split())) == (0, output)
    else:
        assert (status, _plain(linted)) == (2, _plain(output))


def _blocks(printed: str) -> list[str]:
    """Return the printed text, split before each finding."""
    return re.split(r"(?m)^(?=\S+:\d+:\d+: (?:error|warning|note):)", printed)


def _errors(printed: str) -> str:
    """Return the printed text without its warnings, which lint alone finds."""
    return "".join(each for each in _blocks(printed) if not re.match(r"\S+ warning:", each))


def _plain(printed: str) -> str:
    """Return the printed text without values of `N`, which depend on the robot."""
    return re.sub(r"`N` is \d+", "", printed)


#: Packs that are refused when they are grounded.
GROUNDED = ("chosen", "constraint", "undefined", "wrapping")


def test_refusals_are_equal_for_all_stages() -> None:
    refused = [pack for pack in PACKS if pack.stem not in GROUNDED]
    for pack in refused:
        entries = []
        for stages in ((), ("resolve",), STAGES):
            entries.append(refusals(load_rulebook, [pack], stages))
        assert entries[0] == entries[1] == entries[2]
    assert {each.span.path for each in refusals(load_rulebook, refused, STAGES)} == set(
        map(str, refused)
    )


def test_no_stage_shares_a_predicate_with_packs() -> None:
    """Whatever a built-in rule derives or is given, of whichever stage, a pack may not derive."""
    whole = built_in()
    sealed = seal()
    assert {head for rule in whole.rules for head in rule.heads} == set(sealed.derived)
    assert {rule.id for rule in whole.rules} == set(sealed.ids)


@pytest.mark.parametrize(
    "text",
    [
        "p(X) :- X = " + "1+\n%\n" * 80_000 + "1.\n",
        "p(X) :- X = " + "1+\n%.\n" * 80_000 + "1.\n",
        "p(X) :- X = " + "1+ %*.*%\n" * 80_000 + "1.\n",
        "p(X) :- X = " + "~" * 30_000 + "1.\n",
        "p(X) :- X = " + "f(\n%.\n" * 5_000 + "1.\n",
        'p("' + "x" * 100_000 + '").\n',
        "p(1).\n" * 1_300_000,
    ],
    ids=["lines", "dots", "blocks", "signs", "brackets", "string", "facts"],
)
def test_text_that_would_overflow_the_parser_does_not_reach_it(text: str, tmp_path: Path) -> None:
    path = tmp_path / "deep.lp"
    path.write_text(text, encoding="utf-8")
    for read in (lambda: load_rulebook([path]), lambda: run_case(path, load_rulebook())):
        found = refusal(read)
        assert (found.code, found.span.path) == ("rules-refused", str(path))


DEEP = {
    "sum": "+".join(["X"] * 198),
    "signs": "-" * 190 + "X",
    "functions": "f(" * 190 + "X" + ")" * 190,
    "both": "f(0+" * 95 + "X" + ")" * 95,
    "arguments": "1," * 30_000 + "X",
    "negatives": ",".join(["-X"] * 4_000),
}
VERBS = (["analyse"], ["explain"], ["explain", "deep(Camera)"])


@pytest.mark.parametrize(("name", "verb"), sample([*product(DEEP, VERBS)], 4, 1))
def test_deep_or_long_text_within_the_bounds_is_read(
    name: str, verb: list[str], tmp_path: Path, monkeypatch: Patch
) -> None:
    term = DEEP[name]
    monkeypatch.chdir(ROOT)
    path = tmp_path / "deep.lp"
    path.write_text(
        f"deep(M,({term})) :- module(M), X = 1.\n"
        f"consequence(deep,note,M,1) :- deep(M,_), not deep(M,({term.replace('X', '2')}),0).\n"
        "#defined deep/3.\n"
    )
    known = "X" in term and not term.startswith("f(0+")
    assert run_here([verb[0], ROBOT, *verb[1:], "--rules", str(path)]) == (0 if known else 2)


def test_a_case_passes_the_gate_and_the_mask(tmp_path: Path) -> None:
    path = tmp_path / "case.lp"
    for text, place in [
        ('% größer\np("größer"). größe(1).\n', (2, 16)),
        ('p("ü", @f(1)).\n', (1, 8)),
        ('p("ü", 1/0).\n%=\n', (1, 8)),
        ("p(3000000000).\n", (1, 3)),
        ("p(X) :- q(Y).\n", (1, 3)),
    ]:
        path.write_text(text, encoding="utf-8")
        found = refusal(run_case, path, load_rulebook())
        assert (found.span.path, found.span.line, found.span.column) == (str(path), *place)


def test_a_rule_of_a_pack_without_a_value_in_a_case_is_reported_at_its_location(
    tmp_path: Path,
) -> None:
    pack, case = tmp_path / "mine.lp", tmp_path / "case.lp"
    case.write_text('module("A").\n%=\n')
    for text, code in [
        ("\np(M+1) :- module(M).\n", "undefined"),
        ("\np(X*X) :- X = 65536.\n", "number"),
    ]:
        pack.write_text(text)
        found = refusal(run_case, case, load_rulebook([pack]))
        assert (found.code, found.span[:3]) == (f"rule-{code}", (str(pack), 2, 3))


def forged(text: str) -> Rulebook:
    """Return a rulebook with a pack that passed no gate."""
    book = load_rulebook(stages=("resolve", "verify"))
    texts, paths = (*book.texts, ("base", text)), (*book.paths, "forged.lp")
    documented = (*book.documented, Documented("base", "forged.lp", ()))
    return Rulebook(book.rules, texts, 1, 0, paths, documented)


def test_a_synthesis_is_judged_without_packs(monkeypatch: Patch, capsys: Captured) -> None:
    """A pack that calls the source a splitter made `synthesise` leave one out, and agree to it."""
    monkeypatch.chdir(ROOT)
    assert run_here(["synthesise", ROBOT]) == 0
    assert "DataSplitter1 uses_data_from Camera" in capsys.readouterr().out
    lying = forged('node("Camera",data_splitter).\n')
    monkeypatch.setattr("mars_asp.cli.inputs.load_rulebook", lambda *_, **__: lying)
    monkeypatch.setattr("mars_asp.cli.inputs.load_rulebook", lambda *_, **__: lying)
    assert run_here(["synthesise", ROBOT]) == 2
    printed, output = capsys.readouterr()
    assert not printed
    assert "internal error, please report it: " in output
    project = load_project(ROBOT)
    analysis = analyse(project_facts(project), lying, project.configuration.span)
    assert verify(project.configuration, project, lying, analysis.grounding)


def test_the_sample_robots_hold_something_of_all_that_is_given() -> None:
    facts = [fact.atom for project in samples() for fact in project_facts(project)]
    entries = {Signature(atom.name, len(atom.arguments)) for atom in facts}
    given = {signature for signature, stage in seal().given.items() if "base" in stage}
    # Findings are derived, circuits told of what `can` asks for, kinds of nodes stated by packs.
    found = {"consequence/4", "participant/5", "concerns/4", "circuit/5", "node_kind/4"}
    assert set(map(str, given - entries)) == found


def test_the_constants_of_facts_are_known() -> None:
    """Both those that Python writes down and those that facts were seen to hold."""
    written = set()
    for path in (ROOT / "mars_asp").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(ast.Name("Atom"), [ast.Constant(str(name))]):
                    written.add(name)
    assert written
    assert written <= CONSTANTS
    # Packs declare attributes of their own.
    paths = (p for p in (ROOT / "examples").rglob("*.mars") if "packs" not in p.parts)
    projects = [*samples(), *(load_project(str(path)) for path in paths)]
    projects += [load_project("random.mars", text=random_configuration(n)) for n in range(60)]
    seen = set()
    for project in projects:
        rest = [fact.atom for fact in project_facts(project)]
        for atom in rest:
            inside = [each for each in atom.arguments if not isinstance(each, int | str)]
            seen |= {each.name for each in inside if not each.arguments}
            rest += inside
    assert {"flat", "sensor", "data", "zero", "none"} <= seen <= CONSTANTS


def test_a_clean_pack_is_accepted_and_lint_reports_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "mine.lp"
    path.write_text(
        "% größer\n#const most = 1.\n#defined team/2.\n#show odd/1.\n"
        'odd(M) :- module(M), not team(M, "größer"), 1 + 1 > most.\n'
        "-odd(M) :- team(M, _).\n"
        "%! id: mine/odd\n%! because: `{M}` is odd\n"
        "consequence(K, note, M, 1..2) :- odd(M), K = (odd; even).\n"
    )
    assert lint([path]).diagnostics == ()
    path.write_text("square(X * X) :- X = 1..9.\n#show square/1.\n")
    assert [each.code for each in lint([path]).diagnostics] == ["rule-arithmetic"]


@pytest.mark.parametrize("first", [5_000 * seed + 1 for seed in seeds(1, 30)])
def test_no_change_of_a_text_ends_the_process(first: int) -> None:
    seen: Counter[str] = Counter()
    count = examples(250, 700)
    assert list(faults(first, count, seen)) == []
    assert seen["taken taken"] > count // 50


def test_a_pack_declares_only_its_own_predicates(tmp_path: Path) -> None:
    pack = tmp_path / "own.lp"
    pack.write_text("%*! module(M: city)\nM is.\npacks: extend\n*%\nmodule(a).\n")
    found = refusal(load_rulebook, [pack])
    assert (found.code, found.span[:3]) == ("rule-reserved", (str(pack), 5, 1))
    pack.write_text("%*! module(M: city)\nM is.\n*%\nmine(M) :- module(M).\n")
    (argument,) = load_rulebook([pack]).declarations[Signature("module", 1)].arguments
    assert argument.sorts == {"module"}
