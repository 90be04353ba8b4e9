"""Attributes of modules: messages about each form and about faults, beside the files."""

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.annotations.blocks import read_blocks
from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text, print_configuration
from mars_asp.language.format import format_text, meaning
from mars_asp.language.print import print_module
from mars_asp.model.attributes import Attribute, Attributed
from mars_asp.model.declarations import Configuration, Module, Name
from mars_asp.model.names import quoted
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.refusals import refusal, refusals
from tests.support.strategies import HERE, few, names
from tests.support.strategies import NAMES as MODULES

FOLDER = ROOT / "tests" / "attributes"
PACK = "tests/attributes/pack"
ROBOTS = sorted(path.stem for path in FOLDER.glob("*.mars") if path.stem != "wheel")
GOOD = ("blocks", "includes", "languages", "lines")
NAMES = ("backup", "grade", "latency_ms", "level", "reach", "safety_critical", "vendor")


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch: Patch) -> None:
    """Let paths be as they are written beside the files."""
    monkeypatch.chdir(ROOT)


def answer(capsys: Captured, *words: str) -> tuple[int, str]:
    form = ["--format", "full"] if words[0] == "check" else []
    status = run_here([*words, *form])
    printed = "".join(capsys.readouterr())
    return status, re.sub(r"(?m)^[0-9]+ errors? in 1 file\n", "", printed)


@pytest.mark.parametrize("name", ROBOTS)
def test_cases(name: str, update_golden: bool, capsys: Captured) -> None:
    robot, text = f"tests/attributes/{name}.mars", FOLDER / f"{name}.txt"
    _, printed = answer(capsys, "facts", robot, "--rules", PACK)
    if name in GOOD:
        starts = tuple(start for each in NAMES for start in (each, f"place({each}("))
        kept = [line for line in printed.splitlines(True) if line.startswith(starts)]
        printed = "".join(kept) + answer(capsys, "check", robot, "--rules", PACK)[1]
    if update_golden:
        text.write_text(printed, encoding="utf-8")
    assert printed == text.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted({*ROBOTS} - {*GOOD}))
def test_every_command_reports_the_same_errors(name: str, tmp_path: Path, capsys: Captured) -> None:
    robot, rules = f"tests/attributes/{name}.mars", ("--rules", PACK)
    output = answer(capsys, "facts", robot, *rules)
    assert output[0] == 2
    # Where there is no terminal, only `check` leaves first lines whole.
    status, printed = answer(capsys, "check", robot, *rules)
    assert (status, printed.split()) == (2, output[1].split())
    for verb in ("analyse", "explain", "synthesise"):
        assert answer(capsys, verb, robot, *rules) == output
    picture = ("-o", str(tmp_path / "robot.svg"))
    assert answer(capsys, "draw", robot, *rules, *picture) == output
    scenario = ("--scenario", "docs/tutorial/scenario.toml")
    assert answer(capsys, "run", robot, *rules, *scenario) == output


def test_a_missing_pack_has_a_hint_to_pass_it(capsys: Captured) -> None:
    status, output = answer(capsys, "check", "tests/attributes/blocks.mars")
    assert status == 2
    assert output.count("no rule pack declares") == 5
    assert output.count("help: give the pack that declares it with `--rules`") == 5
    assert "tests/attributes/blocks.mars:18:1: error: no rule pack declares the tag" in output


@pytest.mark.parametrize("name", GOOD)
def test_a_printed_configuration_has_the_same_meaning(name: str) -> None:
    path = FOLDER / f"{name}.mars"
    text = path.read_text(encoding="utf-8")
    first = parse_text(text, str(path)).configuration
    printed = print_configuration(first)
    again = parse_text(printed, str(path)).configuration
    assert meaning(again) == meaning(first)
    assert print_configuration(again) == printed
    laid_out = format_text(text, str(path))
    assert meaning(parse_text(laid_out, str(path)).configuration) == meaning(first)


@pytest.mark.parametrize("name", GOOD)
def test_a_saved_specification_states_the_same_facts(
    name: str, tmp_path: Path, capsys: Captured
) -> None:
    saved, rules = tmp_path / "specification.mars", ("--rules", PACK)
    robot = f"tests/attributes/{name}.mars"
    assert answer(capsys, "synthesise", robot, *rules, "--quiet", "-o", str(saved))[0] == 0

    def attribute_facts(path: str) -> set[str]:
        _, output = answer(capsys, "facts", path, *rules)
        return {line for line in output.splitlines() if line.startswith(NAMES)}

    assert attribute_facts(str(saved)) == attribute_facts(robot)
    assert attribute_facts(robot)


def test_a_printed_block_reads_back() -> None:
    text = (FOLDER / "blocks.mars").read_text(encoding="utf-8")
    for module in read_blocks("blocks.mars", text).modules:
        (again,) = read_blocks("blocks.mars", print_module(module)).modules
        assert meaning(again) == meaning(module)


NUMBERS = st.decimals(allow_nan=False, allow_infinity=False, places=3).map(lambda n: f"{n:f}")
UNITS = st.sampled_from(["", " ms", "s", " %", " Hz"])
VALUES = (
    st.builds("{}{}".format, NUMBERS, UNITS)
    | st.sampled_from(["fast", "/robot1/base", "dora-camera", "3rd"])
    | st.text(st.characters(exclude_categories=("Cc", "Cs", "Zl", "Zp")), min_size=1).map(quoted)
)
ATTRIBUTES = st.builds(
    lambda name, value: Attribute(name, HERE, value),
    st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,8}", fullmatch=True),
    st.none() | VALUES,
)


@few
@given(st.lists(st.tuples(names, ATTRIBUTES), max_size=5))
def test_lines_of_attributes_read_back(attributes: list[tuple[str, Attribute]]) -> None:
    lines = tuple(Attributed(module, attribute) for module, attribute in attributes)
    modules = tuple(Name(name, HERE) for name in MODULES)
    configuration = Configuration("config.mars", HERE, modules=modules, attributed=lines)
    text = print_configuration(configuration)
    assert meaning(parse_text(text, "config.mars").configuration) == meaning(configuration)
    assert meaning(parse_text(format_text(text, "a"), "a").configuration.attributed) == meaning(
        lines
    )


@few
@given(st.lists(ATTRIBUTES, max_size=5, unique_by=lambda each: (each.name, each.word)))
def test_blocks_with_attributes_read_back(attributes: list[Attribute]) -> None:
    module = Module("A", HERE, named=HERE, attributes=tuple(attributes))
    read = read_blocks("config.mars", print_module(module))
    assert read.diagnostics == ()
    assert meaning(read.modules) == meaning((module,))


def test_traces_cite_the_annotation(capsys: Captured) -> None:
    words = ("explain", "tests/attributes/blocks.mars", "late(right)", "--rules", PACK)
    assert answer(capsys, *words, "--depth", "all") == (
        0,
        "\nlate(right)\n"
        "    `right` is safety critical and takes 0.07 s  [latency/late]\n"
        "        tests/attributes/blocks.mars:5  right @Tag safety_critical\n"
        "        tests/attributes/blocks.mars:9  @Property latency_ms 70\n"
        "          `right` takes 0.07 s\n\n",
    )
    whole = ("explain", "tests/attributes/blocks.mars", "--rules", PACK)
    assert answer(capsys, *whole, "--why-not", "late(left)")[1] == (
        "No late(left): `left` is not safety critical.\n"
    )


def test_a_project_without_rules_makes_no_facts_of_attributes() -> None:
    project = load_project("tests/attributes/blocks.mars")
    with pytest.raises(MarsError, match="no rule pack declares"):
        project_facts(project)


def declared(text: str) -> str:
    return f"%# Mine: a pack\n%\n% Purpose: declare.\n\n{text}\n"


PACKS = {
    "value": (
        "%*! a(M: module)\nfrom: property\n*%",
        "`a` cannot be a property: it has 1 arguments, not 2",
    ),
    "tag": (
        "%*! a(M: module, N: text)\nfrom: tag\n*%",
        "`a` cannot be a tag: it has 2 arguments, not 1",
    ),
    "module": (
        "%*! a(M: text)\nfrom: tag\n*%",
        "`a` cannot be a tag: its first argument is not of the sort `module`",
    ),
    "sort": (
        "%*! a(M: module, N)\nfrom: property\n*%",
        "`a` cannot be a property: its value has no sort",
    ),
    "numbered": (
        "%*! a(M: module, R: relationship)\nfrom: property\n*%",
        "`a` cannot be a property: no annotation states a value of the sort `relationship`",
    ),
    "ours": (
        "%*! class(M: module, K: text)\nfrom: property\n*%",
        "`class` means something else already, so it cannot be the property `class`",
    ),
    "derived": (
        "%*! a(M: module)\nfrom: tag\n*%\na(M) :- module(M).",
        "`a` is stated by annotations, and nothing derives it",
    ),
}


@pytest.mark.parametrize("case", PACKS)
def test_an_invalid_attribute_is_an_error(case: str, tmp_path: Path) -> None:
    text, message = PACKS[case]
    (tmp_path / "mine.lp").write_text(declared(text), encoding="utf-8")
    assert [each.message for each in refusals(load_rulebook, [tmp_path])] == [message]


def packs(folder: Path, first: str, second: str) -> list[Path]:
    for name, text in (("first", first), ("second", second)):
        (folder / name).mkdir()
        (folder / name / f"{name}.lp").write_text(declared(text), encoding="utf-8")
    return [folder / "first", folder / "second"]


def test_two_packs_may_declare_one_attribute_alike(tmp_path: Path) -> None:
    rule = (
        "%%*! limit(M: module, %s: milliseconds)\nfrom: property\n*%%\n#defined limit/2.\n"
        "%s(M) :- limit(M, _)."
    )
    robot = "@configuration\n@modules A\nA @Property limit 5\n"
    both = packs(tmp_path, rule % ("T", "one"), rule % ("X", "two"))
    found = Reasoner(load_project("a.mars", text=robot), load_rulebook(both)).analysis
    assert found.grounding.symbols("one", 1) and found.grounding.symbols("two", 1)


def test_two_packs_that_do_not_agree_are_both_named(tmp_path: Path) -> None:
    first = "%*! limit(M: module, T: milliseconds)\nfrom: property\n*%"
    result = refusal(load_rulebook, packs(tmp_path, first, "%*! limit(M: module)\nfrom: tag\n*%"))
    assert result.message == "the packs `first` and `second` declare `limit` in two ways"
    assert result.span.path.endswith("second.lp")
    assert [span.path.rpartition("/")[2] for span, _ in result.labels] == ["first.lp"]


def test_a_pack_that_calls_something_else_the_same_is_not_fed(tmp_path: Path) -> None:
    own = "limit(M, 9) :- module(M).\nmy_own(T) :- limit(_, T)."
    written = (
        "%*! limit(M: module, T: number)\nfrom: property\n*%\n#defined limit/2.\n"
        "my_seen(T) :- limit(_, T)."
    )
    robot = "@configuration\n@modules A\nA @Property limit 5\n"
    for place, order in enumerate(((own, written), (written, own))):
        (tmp_path / str(place)).mkdir()
        rules = load_rulebook(packs(tmp_path / str(place), *order))
        grounding = Reasoner(load_project("a.mars", text=robot), rules).analysis.grounding
        assert [str(each) for each in grounding.symbols("my_own", 1)] == ["my_own(9)"]
        assert [str(each) for each in grounding.symbols("my_seen", 1)] == ["my_seen(5)"]
