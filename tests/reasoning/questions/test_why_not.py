"""Why an atom is absent: the nearest instance of each rule and the premise that fails."""

import json
from pathlib import Path

import clingo
import pytest

from mars_asp.asp.trace import Attempt, Missing
from mars_asp.asp.trace.absence import why_not
from mars_asp.asp.trace.patterns import hole
from tests.support.documents import run
from tests.support.programs import explainer_of
from tests.test_command_line import mars

LEVEL0 = "examples/level0/config.mars"


def attempts(program: str, atom: str) -> list[Attempt]:
    found = explainer_of(program)
    assert found is not None
    trace = why_not(found[0], clingo.parse_term(atom), 9)
    assert isinstance(trace, Missing)
    return list(trace.attempts)


@pytest.mark.parametrize(
    ("program", "fails", "cause", "value"),
    [
        ("q(1..3). p(X) :- q(X), r(X).", "q(X)", "q(5)", None),
        ("q(5). r(5). p(X) :- q(X), not r(X).", "not r(X)", "r(5)", None),
        ("q(5). r(7). p(X) :- q(X), not not r(X).", "not not r(X)", "r(5)", None),
        ("q(5). p(X) :- q(X), X > 7.", "X > 7", None, None),
        ("q(4). p(X + 1) :- q(X), r(X, Y).", "r(X,Y)", "r(4,Y)", None),
        ("q(5). s(1..2). p(X) :- q(X), 3 <= #count { Y : s(Y) }.", None, None, "2"),
        ("q(5). s(1..2). p(X) :- q(X), 3 { s(Y) }.", None, None, "2"),
        ("q(5). s(1..2). p(X) :- q(X), #sum { Y : s(Y) } < 3.", None, None, "3"),
        ("q(5). s(1..2). t(1). p(X) :- q(X), t(Y) : s(Y).", "t(Y): s(Y)", "t(2)", None),
        ("q(5). p(X) :- q(X), r(1..2).", "r((1..2))", "r(1)", None),
        ("q(5). p(X) :- q(X), r(f(X, Y), _).", "r(f(X,Y),_)", "r(f(5,Y),_)", None),
        ("q(5). { p(X) } :- q(X), r(X).", "r(X)", "r(5)", None),
        ("q(5). { p(X) : r(X) } :- q(X).", "r(X)", "r(5)", None),
        ("q(5). { p(X) } :- q(X). :- p(X).", None, None, None),
        # Of several it is the least, in whatever order they are given.
        ("q(5). s(3). s(1..2). p(X) :- q(X), t(Y) : s(Y).", "t(Y): s(Y)", "t(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), not s(Y) : s(Y).", "not s(Y): s(Y)", "s(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), not s(_).", "not s(_)", "s(1)", None),
        ("q(5). s(3). s(1..2). p(X) :- q(X), t(Y,_) : s(Y).", "t(Y,_): s(Y)", "t(1,_)", None),
        ("q(5). s(1). p(X) :- q(X), t((1;2)) : s(Y).", "t(1): s(Y)", "t(1)", None),
        ("q(5). s(1). { u }. :- u. p(X) :- q(X), u : s(Y).", "u: s(Y)", "u", None),
        ("q(5). s(1). { u }. :- not u. p(X) :- q(X), not u : s(Y).", "not u: s(Y)", "u", None),
        ("q(5). s(1). p(X) :- q(X), t(Y,Z) : s(Y).", "t(Y,Z): s(Y)", None, None),
        # What computes with a constant has no value, so that nothing satisfies it.
        ("q(5,a). p(X) :- q(X,Y), r(Y + 1).", "r((Y+1))", None, None),
        ("q(5,a). p(X) :- q(X,Y), not r(Y + 1).", "not r((Y+1))", None, None),
        ("q(5,a). p(X) :- q(X,Y), s(Z) : r(Z); r(Y + 1).", "r((Y+1))", None, None),
        ("q(5). s(1). p(X) :- q(X), t(2 * Y + 1), s(Y).", "t(((2*Y)+1))", "t(3)", None),
        ("q(5). s(1). t(3). p(X) :- q(X), t(2 * Y + 1), r(Y).", "r(Y)", "r(1)", None),
        ("q(5). s(1). p(X) :- q(X), s(Z), t(1 - Y * 2).", "t((1-(Y*2)))", "t((1-(Y*2)))", None),
    ],
)
def test_what_fails(program: str, fails: str | None, cause: str | None, value: str | None) -> None:
    (attempt,) = attempts(program, "p(5)")
    if fails is not None:
        assert attempt.fails == fails
    assert (None if attempt.cause is None else attempt.cause.atom) == cause
    assert (None if attempt.value is None else str(attempt.value)) == value


def test_a_premise_alone_is_nearer_than_two() -> None:
    (attempt,) = attempts("q(5,1..2). r(2). p(X) :- q(X,Y), r(Y), s(Y).", "p(5)")
    assert attempt.fails == "s(Y)"
    assert attempt.cause is not None
    assert attempt.cause.atom == "s(2)"


def test_absence_is_followed_through_rules_and_ends_where_it_turns_in_a_circle() -> None:
    (attempt,) = attempts("p(X) :- q(X). q(X) :- r(X). r(X) :- p(X).", "p(1)")
    names = []
    cause = attempt.cause
    while isinstance(cause, Missing):
        names.append(cause.atom)
        cause = cause.attempts[0].cause
    assert names == ["q(1)", "r(1)"]
    assert cause is not None
    assert cause.atom == "p(1)"


def test_holes_of_one_name_are_one_value() -> None:
    found = explainer_of("q(1,2). p(X,Y) :- q(X,Y).")
    assert found is not None
    trace = why_not(found[0], clingo.Function("p", [hole("X"), hole("X")]), 3)
    assert isinstance(trace, Missing)
    assert trace.attempts[0].fails == "X = Y"


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
        ("DataSplitter9", "there is DataSplitter1, DataSplitter2"),
        ("InheritanceNode7", "`InheritanceNode(_)` for any"),
        ("a b", "is no atom"),
        ('not module("Turn")', "is no atom"),
        ("module(X) :- nothing", "is no atom"),
        ('module("Turn"), module("Forward")', "is no atom"),
        ("p(1..3)", "there is no predicate"),
        ("priority(1..3,1)", "is no atom"),
        ("", "is no atom"),
    ],
)
def test_mistakes(atom: str, mentions: str) -> None:
    done = mars("explain", LEVEL0, "--why-not", atom)
    assert done.returncode == 2
    assert mentions in done.stderr
    assert "Traceback" not in done.stderr


def test_what_is_there_is_said_to_be_there() -> None:
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
        assert other["traces"] == found["traces"]


@pytest.mark.parametrize(
    "subject", ["InheritanceNode(Turn)", "InheritanceNode", "ControlSplitter(_)", "DataTransformer"]
)
def test_every_kind_of_node_can_be_asked_for(subject: str) -> None:
    found = json.loads(run(f"mars-asp explain {LEVEL0} --why-not {subject} --format json"))
    assert not found["present"]
    assert found["traces"][0]["premises"]


UNREALISED = "tests/repair/rate/config.mars"


@pytest.mark.parametrize(
    "subject",
    ["DataSplitter(Sonar)", "DataSplitter1", "splitter(X,Y)", "ArbitrationNode", "DataSplitter(_)"],
)
def test_no_node_is_there_where_nothing_realises_the_configuration(subject: str) -> None:
    done = mars("explain", UNREALISED, "--why-not", subject)
    assert done.returncode == 1
    assert f"no {subject}: no specification realises this configuration" in done.stdout
    assert "no splitter makes what `Map` requires" in done.stdout
    found = json.loads(mars("explain", UNREALISED, "--why-not", subject, "--format=json").stdout)
    assert not found["present"]
    assert [trace["rule"]["id"] for trace in found["obstacles"]] == ["data/unresolvable"]


def test_what_rules_derive_of_a_node_is_not_there_without_a_specification() -> None:
    done = mars("explain", UNREALISED, 'splitter("Sonar",origin)')
    assert done.returncode == 2
    assert "no specification realises this configuration" in done.stderr
    assert "yes, it holds" in mars("explain", UNREALISED, "--why-not", "unresolvable(_)").stdout


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
    for subject, said in (
        ("data_divergence(Turn)", "data/divergence"),
        ("weird(Turn)", "mine/any"),
        ("spaced(Turn)", "mine/spaced"),
    ):
        words = ("explain", LEVEL0, "--rules", str(pack), "--why-not", subject)
        found = json.loads(mars(*words, "--format", "json").stdout)
        assert not found["present"]
        attempts = found["traces"][0]["premises"]
        assert [attempt["rule"]["id"] for attempt in attempts] == [said]
    assert "yes, it holds" in mars(*words[:-1], "strange(Turn)").stdout


def test_what_no_message_tells_is_gone_on_to() -> None:
    found = run(f"mars-asp explain {LEVEL0} --why-not data_divergence(FeelForce)")
    assert "`N > 1` fails for N = 1" in found
    assert "goes on to why" not in found
    assert "8: Runaway uses_data_from FeelForce" in found
    found = run(f"mars-asp explain {LEVEL0} --why-not emergent_functionality(Sonar)")
    assert "`--depth 2` goes on to why" in found
    deeper = run(f"mars-asp explain {LEVEL0} --why-not emergent_functionality(Sonar) --depth 2")
    assert "goes on to why" not in deeper
    assert len(deeper) > len(found)


@pytest.mark.parametrize(
    ("subject", "message", "advice"),
    [
        (
            "data_divergence(FeelForce)",
            "there is no `data_divergence(FeelForce)` in this configuration",
            "`--why-not 'data_divergence(FeelForce)'` says why",
        ),
        (
            "service_dependency",
            "there is no `service_dependency` in this configuration",
            "`--why-not 'service_dependency(NAME)'` says why",
        ),
        (
            "data_divergence(Felforce)",
            "there is no module `Felforce`",
            "did you mean `data_divergence(FeelForce)`?",
        ),
        (
            "DataSplitter(Runaway)",
            "`DataSplitter(Runaway)` is not the name of a node",
            "`--why-not 'DataSplitter(Runaway)'` says why there is one or none",
        ),
        ("Trun", "`Trun` is no module, node", "did you mean `Turn`?"),
    ],
)
def test_a_subject_that_is_not_there(subject: str, message: str, advice: str) -> None:
    done = mars("explain", LEVEL0, subject)
    assert done.returncode == 2
    assert message in done.stderr
    assert advice in done.stderr


def test_nodes_of_a_specification_are_explained_by_its_configuration(tmp_path: Path) -> None:
    made = tmp_path / "made.mars"
    made.write_text(run(f"mars-asp synthesise {LEVEL0}"))
    done = mars("explain", str(made), "DataSplitter1")
    assert done.returncode == 2
    assert "ask the configuration that it realises" in done.stderr


def test_names_of_modules_need_no_quotes_in_an_atom() -> None:
    plain = run(f"mars-asp explain {LEVEL0} diverges(Runaway,2)").split("\n", 2)
    quoted = run(f'mars-asp explain {LEVEL0} diverges("Runaway",2)').split("\n", 2)
    assert plain[1] == "diverges(Runaway,2)"
    assert plain[2] == quoted[2]


def test_a_configuration_that_nothing_realises_says_so() -> None:
    done = mars("explain", UNREALISED)
    assert done.returncode == 1
    assert done.stdout.rstrip().endswith("`mars-asp check` says why not")
