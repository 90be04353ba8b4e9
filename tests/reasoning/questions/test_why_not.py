"""Reasons for absent nodes, consequences and atoms, and answers about present ones."""

import json
import re
from pathlib import Path

import pytest

from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.why_not import why_not
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import sample
from tests.support.documents import ROOT, answered, questions, run
from tests.support.processes import mars

LEVEL0 = "examples/level0/config.mars"
LEVEL1 = "examples/level1/config.mars"


@pytest.mark.parametrize(
    ("atom", "mentions"),
    [
        ("DataSpliter(FeelForce)", "did you mean `DataSplitter`"),
        ("DataSplitter(FeelFroce)", "did you mean `FeelForce`"),
        ("data_divergenc(FeelForce)", "did you mean `data_divergence`"),
        ("splitter(FeelForce)", "there is `splitter/2`"),
        ('splitter("FeelForce",origins)', "did you mean `origin`"),
        ("FeelForce", "DataSplitter(FeelForce)"),
        ("data_divergence(X)", "write `_` for any"),
        ("DataSplitter(X)", "write `_` for any"),
        ("a b", "is not an atom"),
        ('not module("Turn")', "is not an atom"),
        ("module(X) :- nothing", "is not an atom"),
        ('module("Turn"), module("Forward")', "is not an atom"),
        ("p(1..3)", "there is no predicate"),
        ("priority(1..3,1)", "is not an atom"),
        ("", "is not an atom"),
    ],
)
def test_mistakes(atom: str, mentions: str) -> None:
    done = mars("explain", LEVEL0, "--why-not", atom)
    assert done.returncode == 2
    assert mentions in done.stderr
    assert "Traceback" not in done.stderr


def test_why_not_of_a_present_node_reports_it_as_present() -> None:
    found = json.loads(
        run(f"mars-asp explain {LEVEL0} --why-not DataSplitter(Runaway) --format json")
    )
    assert found["present"]
    assert found["traces"][0]["kind"] == "derived"


def test_any_node_of_a_kind_is_one_that_is_there() -> None:
    found = json.loads(
        run(f"mars-asp explain {LEVEL0} --why-not DataSplitter(Runaway) --format json")
    )
    for subject in ("DataSplitter2", "DataSplitter(_)", "DataSplitter"):
        other = json.loads(run(f"mars-asp explain {LEVEL0} --why-not {subject} --format json"))
        assert other["present"]
        (trace,) = other["traces"]
        assert trace.pop("title") == subject
        assert [trace] == [
            {key: each[key] for key in each if key != "title"} for each in found["traces"]
        ]


@pytest.mark.parametrize(
    "subject", ["InheritanceNode(Turn)", "InheritanceNode", "ControlSplitter(_)", "DataTransformer"]
)
def test_every_kind_of_node_can_be_queried(subject: str) -> None:
    found = json.loads(run(f"mars-asp explain {LEVEL0} --why-not {subject} --format json"))
    assert not found["present"]
    assert found["traces"][0]["premises"]


UNREALISED = "tests/repair/rate/config.mars"
PREVENTING = f"`service_infeasible(Map)` ({UNREALISED}:4) prevents it"


@pytest.mark.parametrize(
    "subject",
    ["DataSplitter(Sonar)", "DataSplitter1", "splitter(X,Y)", "ArbitrationNode", "DataSplitter(_)"],
)
def test_no_node_is_there_where_nothing_realises_the_configuration(subject: str) -> None:
    done = mars("explain", UNREALISED, "--why-not", subject)
    assert done.returncode == 1
    output = " ".join(done.stdout.split())
    title = subject.removesuffix("(_)")
    assert f"No {title}: no specification realises this configuration: {PREVENTING}" in output
    assert "4 Map uses_data_from Sonar NotifyAtFrequency 50" in output
    found = json.loads(mars("explain", UNREALISED, "--why-not", subject, "--format=json").stdout)
    assert not found["present"]
    assert [trace["rule"]["id"] for trace in found["obstacles"]] == ["data/unresolvable"]


def test_atoms_about_nodes_are_absent_without_a_specification() -> None:
    done = mars("explain", UNREALISED, 'splitter("Sonar",origin)')
    assert done.returncode == 2
    assert "no specification realises this configuration" in done.stderr
    held = mars("explain", UNREALISED, "--why-not", "unresolvable(_)").stdout
    assert held.startswith("unresolvable(_) holds")


@pytest.mark.parametrize("subject", ["data_divergence(FeelForce)", "data_divergence(_)"])
def test_only_rules_that_speak_of_a_kind_are_named(subject: str) -> None:
    found = json.loads(run(f"mars-asp explain {LEVEL0} --why-not {subject} --format json"))
    (trace,) = found["traces"]
    if found["present"]:
        assert trace["rule"]["id"] == "data/divergence"
    else:
        assert [near["rule"]["id"] for near in trace["premises"]] == ["data/divergence"]


def test_json_of_an_absence() -> None:
    found = json.loads(
        run(f"mars-asp explain {LEVEL0} --why-not data_divergence(FeelForce) --format json")
    )
    assert not found["present"]
    (trace,) = found["traces"]
    assert trace["kind"] == "absent"
    assert trace["premises"][0]["rule"]["id"] == "data/divergence"
    last = trace["premises"][0]["premises"][0]["premises"][0]
    assert last["fails"] == "N > 1"
    assert last["bindings"]["N"] == "1"


def test_a_rule_of_any_kind_speaks_of_those_that_no_rule_names(tmp_path: Path) -> None:
    pack = tmp_path / "mine.lp"
    pack.write_text(
        "%! id: mine/any\n%! because: `{M}` is `{K}`\n"
        "consequence(K, note, M, 1) :- module(M), oddity(K, M).\n"
        'oddity(strange, "Turn"). oddity(weird, "Forward").\n'
        "%! id: mine/spaced\n%! because: `{M}` is spaced\n"
        "consequence( spaced , note, M, 1) :- module(M), oddity(weird, M).\n",
        encoding="utf-8",
    )
    for subject, item in (
        ("data_divergence(Turn)", "data/divergence"),
        ("weird(Turn)", "mine/any"),
        ("spaced(Turn)", "mine/spaced"),
    ):
        words = ("explain", LEVEL0, "--rules", str(pack), "--why-not", subject)
        found = json.loads(mars(*words, "--format", "json").stdout)
        assert not found["present"]
        attempts = found["traces"][0]["premises"]
        assert [attempt["rule"]["id"] for attempt in attempts] == [item]
    assert "strange(Turn) holds: `Turn` is `strange`" in mars(*words[:-1], "strange(Turn)").stdout


CASES = ROOT / "tests" / "why-not" / "questions.txt"
QUESTIONS = questions(CASES)


@pytest.mark.parametrize(("command", "expected"), QUESTIONS, ids=[each for each, _ in QUESTIONS])
def test_the_answer(command: str, expected: str, update_golden: bool) -> None:
    found = answered(CASES, command, expected, update_golden)
    assert len(found.splitlines()) <= 12
    # Lines of users and commands are not broken.
    whole = re.compile(r"    (\S+:\d+  |Why: mars-asp )")
    assert all(len(line) <= 80 or whole.match(line) for line in found.splitlines())


#: Changes that are nothing but lines to be written.
ADDED = re.compile(
    r"To get one: (a line|one more line|a second line|two lines) `([^`]*)`(?:\.|, where)"
)
WRITTEN = [
    (command, found[1], found[2])
    for command, expected in QUESTIONS
    if (found := ADDED.search(" ".join(expected.split()))) and "of the same" not in expected
]


def test_lines_that_would_give_it_do(tmp_path: Path) -> None:
    """Whatever is lacking in a line is a new module; this reads and solves the changed text."""
    assert len(WRITTEN) > 10
    for command, number, line in sample(WRITTEN, 3):
        words = command.split()
        text = (ROOT / words[2]).read_text(encoding="utf-8")
        lines = [line.replace("...", f"New{n}") for n in range(2 if number == "two lines" else 1)]
        at = text.find("\n@module_start")
        at = len(text) if at < 0 else at + 1
        text = "".join((text[:at], *(f"{each}\n" for each in lines), text[at:]))
        changed = tmp_path / "config.mars"
        changed.write_text(text.replace("@modules ", "@modules New0, New1, "), encoding="utf-8")
        again = run(command.replace(words[2], str(changed)))
        assert not again.startswith("No "), (command, lines, again)


def test_json_has_the_change_that_would_give_the_node() -> None:
    found = json.loads(
        run(f"mars-asp explain {LEVEL1} --why-not DataSplitter(Sonar) --format json")
    )
    assert found["answer"].startswith("No DataSplitter(Sonar): only `SonarMap` uses data from")
    assert found["to_get"] == "one more line `... uses_data_from Sonar`."
    assert found["evidence"] == [
        {
            "path": "examples/level1/config.mars",
            "line": 5,
            "column": 1,
            "text": "SonarMap uses_data_from Sonar",
        }
    ]
    assert found["extra_cost"] is None


@pytest.mark.parametrize(
    ("subject", "message", "advice"),
    [
        (
            "data_divergence(FeelForce)",
            "there is no `data_divergence(FeelForce)` in this configuration",
            "`--why-not 'data_divergence(FeelForce)'` shows why",
        ),
        (
            "service_dependency",
            "there is no `service_dependency` in this configuration",
            "`--why-not 'service_dependency(NAME)'` shows why",
        ),
        (
            "data_divergence(Felforce)",
            "unknown module `Felforce`",
            "did you mean `data_divergence(FeelForce)`?",
        ),
        (
            "DataSplitter(Runaway)",
            "`DataSplitter(Runaway)` is not the name of a node",
            "`--why-not 'DataSplitter(Runaway)'` shows why there is one or none",
        ),
        ("Trun", "this configuration has no module, node", "did you mean `Turn`?"),
    ],
)
def test_a_subject_that_is_not_there(subject: str, message: str, advice: str) -> None:
    done = mars("explain", LEVEL0, subject)
    # A kind that is not there is an answer, and no mistake.
    is_answer = message.endswith("in this configuration")
    assert done.returncode == (0 if is_answer else 2)
    output = " ".join((done.stdout if is_answer else done.stderr).split())
    assert message in output
    assert advice in output


def test_nodes_of_a_specification_are_explained_by_its_configuration(tmp_path: Path) -> None:
    made = tmp_path / "made.mars"
    made.write_text(run(f"mars-asp synthesise {LEVEL0}"))
    done = mars("explain", str(made), "DataSplitter1")
    assert done.returncode == 0
    assert "ask about the configuration" in " ".join(done.stdout.split())


def test_names_of_modules_need_no_quotes_in_an_atom() -> None:
    plain = run(f"mars-asp explain {LEVEL0} diverges(Runaway,2)").split("\n", 2)
    quoted = run(f'mars-asp explain {LEVEL0} diverges("Runaway",2)').split("\n", 2)
    assert plain[1] == "diverges(Runaway,2)"
    assert plain[2] == quoted[2]


def test_a_configuration_without_a_realisation_is_reported() -> None:
    done = mars("explain", UNREALISED)
    assert done.returncode == 1
    assert done.stdout.rstrip().endswith("prevents it")


#: A value that a rule compares with another, and how the answer words it.
VALUES = {
    "over(A)": "No over(A): `power` is 1.5 W; the rule needs more than 2 W, its `budget`.",
    "late(A)": "No late(A): `delay` is 40 ms; the rule needs more than 50 ms.",
    "late": "No late: `delay` of `A` is 40 ms; the rule needs more than 50 ms.",
    "early(A)": "No early(A): `delay` is 40 ms; the rule needs less than 30 ms.",
    "whole(A)": "No whole(A): the sum is 2 W; the rule needs more than 5 W.",
    "exact(A)": "No exact(A): `power` of `A` is 1.5 W, not 1 W.",
    "delay(A,60)": "No delay(A,60): `delay` of `A` is 40 ms, not 60 ms.",
    "delay(B,60)": "No delay(B,60): `B` states no delay.",
}


@pytest.mark.parametrize(("question", "answer"), VALUES.items())
def test_the_value_that_fails_a_comparison_is_named(
    question: str, answer: str, tmp_path: Path
) -> None:
    sorts = {"power": "milliwatts", "budget": "milliwatts", "delay": "milliseconds"}
    declared = "".join(
        f"%*! {name}(M: module, V: {sort})\n`{name}` of M.\nunless: `{{M}}` states no {name}\n"
        f"from: property\n*%\n#defined {name}/2.\n"
        for name, sort in sorts.items()
    )
    bodies = {
        "over": "power(M, P), budget(M, B), P > B",
        "late": "delay(M, T), T > 50",
        "early": "delay(M, T), 30 > T",
        "whole": "module(M), 5000 < #sum { P, N : power(N, P) }",
        "exact": "power(M, 1000)",
    }
    rules = "".join(
        f"%! id: values/{kind}\n%! because: `{{M}}` is {kind}\n%! at: M\n"
        f"consequence({kind}, note, M, x) :- {body}.\n"
        for kind, body in bodies.items()
    )
    pack, robot = tmp_path / "values.lp", tmp_path / "robot.mars"
    pack.write_text(declared + rules)
    robot.write_text(
        "@configuration\n@modules A, B\nA uses_data_from B\nA @Property power 1500 mW\n"
        "A @Property budget 2 W\nB @Property power 500 mW\nA @Property delay 40\n"
    )
    reasoner = Reasoner(load_project(str(robot)), load_rulebook([pack]))
    assert why_not(reasoner, question).answer == answer
