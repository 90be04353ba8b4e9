"""What is resolved part by part is resolved as the whole is."""

import random
import re
from collections.abc import Sequence

import pytest

from mars_asp.asp.signature import Signature
from mars_asp.asp.slice.portions import kept_apart
from mars_asp.asp.trace.document import trace_json
from mars_asp.language import parse_text
from mars_asp.reasoning.facts.identifiers import numbered
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.questions.islands import Map
from mars_asp.reasoning.questions.preceding import preceding_evidence
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import seeds
from tests.support.random_configurations import random_configuration

RULEBOOK = load_rulebook()
SPLITTER, ARBITER = Signature("splitter", 2), Signature("arbiter", 1)


def test_the_rules_keep_parts_apart() -> None:
    resolution = f"{RULEBOOK.text('resolve')}\n{RULEBOOK.text('specify')}"
    apart = kept_apart(RULEBOOK.text("base"), resolution, vocabulary(RULEBOOK).connected)
    assert apart is not None
    portions = [portion.derived for portion in apart.deciding]
    assert [SPLITTER in derived for derived in portions].count(True) == 1
    assert [ARBITER in derived for derived in portions].count(True) == 1
    assert not any({SPLITTER, ARBITER} <= derived for derived in portions)
    # What decides nothing is left out where nodes are only counted.
    assert not any(Signature("resolves", 3) in derived for derived in portions)


# ---- Random configurations -----------------------------------------------------------------------


def fleet(seeds: Sequence[int]) -> str:
    """Return a configuration of several robots, with converters that serve all of them."""
    modules, lines, blocks = [], [], []
    for number, seed in enumerate(seeds):
        text = random_configuration(seed)
        named = re.search(r"@modules (.*)", text)
        assert named is not None
        names = {*named[1].split(", "), *re.findall(r"@module_name (\w+)", text)}
        text = re.sub(rf"\b({'|'.join(sorted(names))})\b", rf"X{number}\1", text)
        _, told, rest = text.split("\n", 2)
        relations, *described = rest.split("@module_start")
        modules.append(told.removeprefix("@modules "))
        lines.append(relations.strip())
        blocks += [f"@module_start{block.rstrip()}" for block in described]
    heading = ["@configuration hierarchical", f"@modules {', '.join(modules)}"]
    return "\n".join((*heading, *filter(None, lines), *blocks))


def read(text: str) -> Project:
    return Project(parse_text(text, "c.mars").configuration, {}, ())


@pytest.mark.parametrize("first", [4 * seed for seed in seeds(2, 30)])
def test_a_node_is_explained_as_among_all_others(first: int) -> None:
    project = read(fleet(range(first, first + 4)))
    whole = explain(Reasoner(project, RULEBOOK))
    if whole.synthesis is None:
        return
    nodes = whole.synthesis.specification.nodes
    told = whole.topics[-len(nodes) :]
    traces = [trace_json(topic.trace) for topic in told]
    titles = [topic.title for topic in told]
    for number in random.Random(first).sample(range(len(nodes)), min(3, len(nodes))):
        part = explain(Reasoner(project, RULEBOOK), nodes[number].name)
        assert part.synthesis is None, "the whole was resolved"
        assert [topic.title for topic in part.topics] == [titles[number]]
        assert trace_json(part.topics[0].trace) == traces[number]
        assert part.topics[0].account == told[number].account


def test_each_of_many_nodes_is_found_whatever_is_passed_over_together() -> None:
    rng = random.Random(1)
    fed = [rng.choice((1, 2, 3)) for _ in range(40)]
    names = [f"{word}{at}" for at, most in enumerate(fed) for word in ("S", *"ABC"[:most])]
    lines = [
        f"{word}{at} uses_data_from S{at}" for at, most in enumerate(fed) for word in "ABC"[:most]
    ]
    project = read("\n".join(("@configuration flat", f"@modules {', '.join(names)}", *lines)))
    several = [at for at, most in enumerate(fed) if most > 1]
    for number in (1, 2, 3, 8, 13, 16, 23, 24):
        part = preceding_evidence(Reasoner(project, RULEBOOK), f"DataSplitter{number}")
        assert part is not None
        assert part.introduced is not None
        told = part.introduced.resolves[f"DataSplitter{number}"]
        assert [*told] == [f"data_divergence(S{several[number - 1]})"]
    assert preceding_evidence(Reasoner(project, RULEBOOK), "DataSplitter25") is None


def test_nodes_before_are_counted_with_the_names_that_modules_have() -> None:
    robots = [
        f"{clients[0]} uses_data_from {source}\n{clients[1]} uses_data_from {source}"
        for source, *clients in (("A", "B", "C"), ("D", "E", "F"), ("G", "H", "DataSplitter2"))
    ]
    names = "A, B, C, D, E, F, G, H, DataSplitter2"
    project = read("\n".join(("@configuration flat", f"@modules {names}", *robots)))
    titles = [
        explain(Reasoner(project, RULEBOOK), name).topics[0].title
        for name in ("DataSplitter1", "DataSplitter3")
    ]
    assert titles == [
        "DataSplitter1 resolves data_divergence(A)",
        "DataSplitter3 resolves data_divergence(D)",
    ]


def test_stretches_hold_whole_parts() -> None:
    lines = ["B uses_data_from A", "E uses_data_from D", "C uses_data_from A", "H uses_data_from G"]
    text = "\n".join(("@configuration flat", "@modules A, B, C, D, E, G, H", *lines))
    project = read(text)
    told = numbered(project.configuration.relationships)
    stretches = Map(project.configuration, told).stretches()
    assert [len(each.lines) for each in stretches] == [3, 1]


def test_nothing_is_found_apart_where_nothing_realises_the_whole() -> None:
    lines = [
        "B uses_data_from A NotifyAtFrequency 90",
        "D uses_data_from C",
        "E uses_data_from C",
    ]
    block = ["@module_start", "@module_name A", "@Sense NotifyAtFrequency 10"]
    block += ["@Signature void f(P &p)", "@module_end"]
    text = "\n".join(("@configuration flat", "@modules A, B, C, D, E", *lines, *block))
    project = read(text)
    whole = explain(Reasoner(project, RULEBOOK))
    assert whole.synthesis is None
    assert preceding_evidence(Reasoner(project, RULEBOOK), "DataSplitter1") is None
