"""Why a configuration has no such node, consequence or atom, and what is said where it has."""

import json
from pathlib import Path

import pytest

from tests.support.documents import run
from tests.support.processes import mars

LEVEL0 = "examples/level0/config.mars"


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
    assert "no splitter makes the service that `Map` requires" in done.stdout
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
    assert "8  Runaway uses_data_from FeelForce" in found
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
