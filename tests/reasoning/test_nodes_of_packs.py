"""Nodes that rule packs bring: specifications written by hand, and what is wrong with others.

Each case of `tests/node_kinds` is a configuration with the specification that it should give,
beside it, written from the meaning of `docs/how-to/writing-rules.md`. Its first line names its
packs.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import Configuration, Control, Data, Relationship
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import STAGES, by_name, load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis.synthesise import Synthesis
from mars_asp.reasoning.verification import Violation, judge_specification, written_cost
from tests.support.campaigns import IS_CAMPAIGN, sample
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured, Patch

HERE = ROOT / "tests" / "node_kinds"
CASES = sorted(path for path in HERE.glob("*.mars") if ".expected" not in path.suffixes)
PLACES = {path.name: path.parent for path in (HERE / "packs").iterdir()}

every_case = pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
some_cases = pytest.mark.parametrize("path", sample(CASES, 6), ids=lambda path: path.stem)


def packs_of(path: Path) -> tuple[Path, ...]:
    first = path.read_text(encoding="utf-8").partition("\n")[0]
    names = first.removeprefix("// packs: ").split(", ")
    return tuple(PLACES.get(name, ROOT / "examples" / "packs") / name for name in names)


@cache
def rulebook(packs: tuple[Path, ...]) -> Rulebook:
    return load_rulebook(packs, stages=("resolve", "verify", "cost"))


@cache
def resolved(path: Path) -> tuple[Reasoner, Synthesis]:
    reasoner = Reasoner(load_project(str(path)), rulebook(packs_of(path)))
    found = reasoner.synthesis
    assert found is not None
    return reasoner, found


def read(text: str, reasoner: Reasoner) -> Configuration:
    """Return a specification, whose nodes of packs are known."""
    parsed = parse_text(text, "s.mars").configuration
    return replace(parsed, kinds=reasoner.project.configuration.kinds)


def lines_of(text: str) -> list[str]:
    """Return the modules and lines of a specification, sorted, so that order has no effect."""
    body = text.partition("\n@module_start")[0]
    head, _, rest = body.partition("@modules ")
    named, lines = [], rest.splitlines()
    while lines:
        line = lines.pop(0)
        named += [name.strip() for name in line.split(",") if name.strip()]
        if not line.rstrip().endswith(","):
            break
    return sorted([*head.split(), *named, *(line.strip() for line in lines if line.strip())])


@every_case
def test_a_synthesis_equals_the_specification_by_hand(path: Path) -> None:
    _, found = resolved(path)
    expected = path.with_suffix(".expected.mars").read_text(encoding="utf-8")
    assert lines_of(print_configuration(found.specification.configuration)) == lines_of(expected)
    assert found.resolution.proven


def judged(specification: Configuration, reasoner: Reasoner) -> tuple[Violation, ...]:
    return judge_specification(specification, reasoner.project, reasoner.rulebook).violations


@every_case
def test_the_specification_by_hand_is_accepted_at_the_same_cost(path: Path) -> None:
    reasoner, found = resolved(path)
    expected = read(path.with_suffix(".expected.mars").read_text(encoding="utf-8"), reasoner)
    verification = judge_specification(expected, reasoner.project, reasoner.rulebook)
    assert [violation.message for violation in verification.violations] == []
    written = written_cost(verification, reasoner.project, reasoner.rulebook)
    assert by_name(written.cost) == by_name(found.resolution.cost)


def brought(specification: Configuration) -> list[str]:
    return [each.text for each in specification.modules if specification.pack_kind(each.text)]


def ends(line: Relationship) -> tuple[str, str]:
    """Return who takes and who gives."""
    if isinstance(line, Data):
        return line.client, line.source
    assert isinstance(line, Control)
    return line.controlled, line.controller


def joined(line: Relationship, taker: str, giver: str) -> Relationship:
    if isinstance(line, Data):
        return replace(line, client=taker, source=giver)
    assert isinstance(line, Control)
    return replace(line, controlled=taker, controller=giver)


def changes(specification: Configuration, node: str) -> Iterator[tuple[str, Configuration]]:
    """Yield specifications in which a node of a pack is missing, passed by, or wrongly used."""
    lines = [each for each in specification.relationships if isinstance(each, Data | Control)]
    others = [each for each in specification.relationships if each not in lines]
    taken = [each for each in lines if ends(each)[0] == node]
    given = [each for each in lines if ends(each)[1] == node]
    rest = [each for each in lines if node not in ends(each)]
    past = [joined(out, ends(out)[0], ends(into)[1]) for out in given for into in taken]

    def made(relationships: list[Relationship], keep: bool = True) -> Configuration:
        modules = tuple(m for m in specification.modules if keep or m.text != node)
        return replace(specification, modules=modules, relationships=(*others, *relationships))

    yield "removed", made([*rest, *past], keep=False)
    yield "unfed", made([*rest, *given])
    kind = specification.pack_kind(node)
    if given or kind is None or kind.inputs == "one":
        yield "second input", made([*lines, joined(taken[0], node, "Stranger")])
    if given:
        yield "bypassed", made([*rest, *taken, *past])
        yield "bypassed as well", made([*rest, *taken, *given, *past[:1]])
        yield "not heard", made([*rest, *taken])
    else:
        beside = next(each for each in rest if ends(each)[1] == ends(taken[0])[1])
        led = joined(beside, ends(beside)[0], node)
        yield "hands on", made([led if each is beside else each for each in lines])


@every_case
def test_a_specification_without_its_node_or_past_it_is_refused(path: Path) -> None:
    reasoner, found = resolved(path)
    specification = read(print_configuration(found.specification.configuration), reasoner)
    nodes = brought(specification)
    assert nodes
    if not IS_CAMPAIGN:
        nodes = [*{specification.pack_kind(node): node for node in nodes}.values()]
    made = [(node, *change) for node in nodes for change in changes(specification, node)]
    # Each case begins with another change, so that all are tried on some.
    some = sample(made, 12, CASES.index(path) % 3)
    accepted = [(node, how) for node, how, changed in some if not judged(changed, reasoner)]
    assert accepted == []


@some_cases
def test_a_specification_that_is_resolved_again_stays_as_it_is(path: Path) -> None:
    reasoner, found = resolved(path)
    printed = print_configuration(found.specification.configuration)
    text = "\n".join([printed, *reasoner.project.blocks])
    again = Reasoner(load_project(str(path), text=text), reasoner.rulebook)
    assert again.synthesis is not None
    found_again = again.synthesis.specification.configuration
    assert lines_of(print_configuration(found_again)) == lines_of(printed)
    assert [each.message for each in judged(found_again, again)] == []


@some_cases
def test_drawings_and_json_name_the_node(path: Path, tmp_path: Path) -> None:
    options = " ".join(f"--rules {each}" for each in packs_of(path))
    reasoner, found = resolved(path)
    printed = print_configuration(found.specification.configuration)
    nodes = brought(read(printed, reasoner))
    specification, drawing = tmp_path / "s.mars", tmp_path / "s.dot"
    specification.write_text(printed, encoding="utf-8")
    run(f"mars-asp draw {specification} {options} -o {drawing}")
    drawn = drawing.read_text(encoding="utf-8")
    listed = run(f"mars-asp synthesise {path} {options} --format json --quiet")
    assert nodes
    assert [node for node in nodes if node not in drawn or f'"{node}"' not in listed] == []


@every_case
def test_the_explanation_of_nodes_is_as_expected(
    path: Path, capsys: Captured, monkeypatch: Patch, update_golden: bool
) -> None:
    monkeypatch.chdir(path.parent)
    options = [word for pack in packs_of(path) for word in ("--rules", str(pack))]
    monkeypatch.setattr("mars_asp.cli.explain._covered_by_nodes", lambda topics: ())
    run_here(["explain", path.name, *options, "--quiet"])
    output, expected = capsys.readouterr().out, path.with_suffix(".txt")
    if update_golden:
        expected.write_text(output, encoding="utf-8")
    assert output == expected.read_text(encoding="utf-8")


#: Invalid facts that a pack derives, by the rule that refuses them in a specification.
WRONG = {
    "undeclared": 'inserted(n, cat). placed_before(n, "Base").',
    "two-kinds": 'inserted(n, (dog; bird)). placed_before(n, "Base").',
    "named-as-a-module": 'inserted("Drive", dog). placed_before("Drive", "Base").',
    "nowhere-before": 'inserted(n, dog). placed_before(n, "Drive").',
    "nowhere-after": 'inserted(n, dog). placed_after(n, "Base").',
    "unplaced": "inserted(n, dog).",
    "twice": 'inserted(n, dog). placed_before(n, "Base"). placed_after(n, "Drive").',
    "two-controllers": 'inserted(n, dog). placed_after(n, ("Drive"; "Reach")).',
    "two-modules": 'inserted(n, dog). placed_before(n, ("Base"; "Arm")).',
}
DATA = {
    "two-inputs": "inserted(n, sieve). placed_before(n, R) :- link(R, _, _).",
    "two-clients": "inserted(n, vote). placed_before(n, R) :- link(R, _, _).",
    "parted": (
        'inserted(a, vote). placed_before(a, R) :- link(R, "Map", ("Left"; "Right")). '
        'inserted(b, sieve). placed_before(b, R) :- link(R, "Map", "Left").'
    ),
    "parted-though-several-are-given": (
        'inserted(a, weave). placed_before(a, R) :- link(R, "Map", ("Left"; "Right")). '
        'inserted(b, sieve). placed_before(b, R) :- link(R, "Map", "Left").'
    ),
}


def pack(folder: Path, name: str, stage: str, text: str) -> Path:
    """Write a pack of one file, with kinds of nodes of both sorts."""
    (folder / name / stage).mkdir(parents=True)
    kinds = {
        "dog": ("Dog", "control", "one", "one"),
        "bird": ("Bird", "control", "one", "one"),
        "sieve": ("Sieve", "data", "one", "one"),
        "vote": ("Vote", "data", "several", "one"),
        "weave": ("Weave", "data", "several", "several"),
    }
    nodes = "".join(
        f'[[node]]\nkind = "{kind}"\nname = "{called}"\ncarries = "{carries}"\n'
        f'inputs = "{inputs}"\noutputs = "{outputs}"\n'
        for kind, (called, carries, inputs, outputs) in kinds.items()
    )
    result = nodes if stage == "resolve" else ""
    (folder / name / "pack.toml").write_text(f'name = "{name}"\nversion = "1.0"\n{result}')
    (folder / name / stage / f"{name}.lp").write_text(f"{text}\n", encoding="utf-8")
    return folder / name


@pytest.mark.parametrize(("rule", "text"), [*WRONG.items(), *DATA.items()])
def test_a_node_that_cannot_be_is_named(rule: str, text: str, tmp_path: Path) -> None:
    named = {"two-clients": "after_source", "two-inputs": "other_sources"}
    case = named.get(rule, "other_sources" if rule in DATA else "two_effectors")
    book = load_rulebook([pack(tmp_path, "mine", "resolve", text)], stages=("resolve",))
    with pytest.raises(MarsError) as caught:
        _ = Reasoner(load_project(str(HERE / f"{case}.mars")), book).synthesis
    expected = f"resolve/inserted/{rule.partition('-though')[0]}"
    assert [each.code for each in caught.value.diagnostics] == [expected]


ONE_OF_TWO = (
    '1 { chosen("Base"; "Arm") } 1. inserted(n, dog). placed_before(n, M) :- chosen(M). '
    "#minimize { 1@LEVEL, M : chosen(M), M = MODULE }."
)


def before(reasoner: Reasoner) -> list[str]:
    found = reasoner.synthesis
    assert found is not None
    lines = found.specification.configuration.relationships
    return [ends(line)[0] for line in lines if ends(line)[1] == "Dog1"]


#: How the author's rule introduces a node, and the first sentence of its explanation.
REASONS = {
    '%! because: `{M}` needs a dog\ninserted(n(M), dog) :- M = "Base", module(M).': (
        "`Base` needs a dog"
    ),
    '%! because: `{M}` may have a dog\n1 { inserted(n(M), dog) } :- M = "Arm", module(M).': (
        "`Arm` may have a dog"
    ),
    'inserted(n("Base"), dog).': "all commands to `Base` go through it",
}


@pytest.mark.parametrize(("rule", "sentence"), REASONS.items())
def test_a_node_is_explained_first_by_the_message_of_its_rule(
    rule: str, sentence: str, tmp_path: Path
) -> None:
    text = f"{rule.replace('%! b', '%! id: resolve/mine/dog' + chr(10) + '%! b')}\n"
    text += "placed_before(n(M), M) :- inserted(n(M), dog).\n"
    text += '#minimize { 1@3, M : inserted(n(M), dog), M = "Base" }.'
    book = load_rulebook([pack(tmp_path, "mine", "resolve", text)], STAGES)
    reasoner = Reasoner(load_project(str(HERE / "two_effectors.mars")), book)
    for subject in (None, "Dog1"):
        (topic,) = (t for t in explain(reasoner, subject, traced=False).topics if t.name == "Dog1")
        assert topic.account is not None
        assert topic.account.answer == sentence
        if rule.startswith("%!"):
            place = sentence.split("`")[1]
            assert topic.account.notes[0] == f"All commands to `{place}` go through it."
            assert topic.rule == "mine/resolve/mine/dog"


@pytest.mark.parametrize(("avoided", "taken"), [("Base", "Arm"), ("Arm", "Base")])
def test_a_preference_of_a_pack_chooses_among_optima(
    avoided: str, taken: str, tmp_path: Path
) -> None:
    project = load_project(str(HERE / "two_effectors.mars"))
    text = ONE_OF_TWO.replace("MODULE", f'"{avoided}"')
    mine = pack(tmp_path, "mine", "resolve", text.replace("LEVEL", "3"))
    assert before(Reasoner(project, load_rulebook([mine]))) == [taken]
    high = pack(tmp_path, "high", "resolve", text.replace("LEVEL", "40"))
    with pytest.raises(MarsError, match="40"):
        load_rulebook([high])
    assert before(Reasoner(project, load_rulebook([high], trusted=True))) == [taken]


def test_a_constraint_of_a_pack_is_named_where_nothing_is_left(tmp_path: Path) -> None:
    text = (
        "%! id: resolve/mine/quiet\n%! because: `{M}` may not be commanded\n:- commanded(_, M, _)."
    )
    book = load_rulebook([pack(tmp_path, "mine", "resolve", text)])
    with pytest.raises(MarsError, match="may not be commanded"):
        _ = Reasoner(load_project(str(HERE / "arbiter.mars")), book).synthesis


def test_packs_use_one_name_independently_and_read_public_predicates_of_required_packs(
    tmp_path: Path,
) -> None:
    shared = "%*! odd(M)\nM is odd.\npackage\n*%\nodd(M) :- module(M).".replace(
        "package", "packs: read"
    )
    one = pack(tmp_path, "one", "consequences", shared)
    two = pack(tmp_path, "two", "consequences", "odd(M, 1) :- class(M, effector).\nodd(1).")
    load_rulebook([one, two])
    reads = pack(tmp_path, "reads", "consequences", "even(M) :- module(M), not odd(M).")
    with pytest.raises(MarsError, match="odd/1"):
        load_rulebook([one, reads])
    (reads / "pack.toml").write_text('name = "reads"\nversion = "1.0"\nneeds = ["one"]\n')
    load_rulebook([one, reads])
    private = pack(tmp_path, "private", "consequences", "a(M) :- borrowed(M, _).")
    with pytest.raises(MarsError, match="borrowed/2"):
        load_rulebook([private])
