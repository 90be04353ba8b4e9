"""Islands that are alike count as one, and nodes are numbered as where each counts by itself."""

import random
import re
from collections.abc import Hashable, Mapping
from itertools import product
from typing import Any

import pytest

from mars_asp.asp.slice.portions import kept_apart
from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text
from mars_asp.model.declarations import Data
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.project import Project, project_parts
from mars_asp.reasoning.questions import counted, sayings
from mars_asp.reasoning.questions.behind import for_counting, for_resolution, for_unresolvable
from mars_asp.reasoning.questions.counted import Counter
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.questions.islands import Forms, Map, Saying
from mars_asp.reasoning.questions.preceding import is_realised, preceding_evidence
from mars_asp.reasoning.questions.sayings import differences
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis.synthesise import is_unresolvable
from tests.reasoning.synthesis.test_stretches import RULEBOOK, fleet, read
from tests.support.campaigns import seeds

#: Rules that compare names or identifiers where data is counted: of lines that say the same of the
#: same modules the first one counts. With another one, islands would not count as one.
COMPARING = {"counts_for(X, S, D, F, R) :- may_count(X, S, D, F, _), R = #min {"}
#: Those that compare what alike islands have alike: rates, places of modes, numbers.
OTHERS = {"lowered_from", "most_served", "favoured", "carries", "depth", "1 <= "}
#: Those that compare inputs or turns of one client: its island counts by itself then.
INPUTS = {"unnamed_input", "free_input", "place_in_queue", "left_unlike", "eliminated", "disputed"}
#: Those that compare rates or times, or name one of several lines whichever comes first.
FIRST = {"represents", "serves_both", "opposed", "conveys_mode", "slower_on", "on_link"}


#: What lines ask for, and what sources offer.
MODES = ("", "RequestWhenReady", "NotifyAtFrequency 10", "NotifyAtFrequency 5", "NotifyOnChange")
OFFERS = ("NotifyAtFrequency 25", "NotifyWhenReady", "RequestWhenReady, NotifyAtFrequency 30")


def islands(*lines: str, blocks: str = "") -> list[object]:
    """Return the forms of the islands that data lines make."""
    names = ", ".join(sorted(set(re.findall(r"\b[A-Z]\b", " ".join(lines)))))
    text = "\n".join(("@configuration flat", f"@modules {names}", *lines, blocks))
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    wanted = {"uses_data_from", "input", "output", "offered_mode"}
    parts = project_parts(project, wanted, vocabulary(RULEBOOK), {})
    map_ = Map(project.configuration, parts.numbered)
    forms = Forms(map_, parts, wanted)
    return [forms.form(each) for each in map_.islands((Data,))]


def block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end\n"


def test_names_and_the_order_of_lines_make_no_form() -> None:
    one, other = islands(
        "B uses_data_from A",
        "C uses_data_from A NotifyOnChange",
        "Z uses_data_from Y NotifyOnChange",
        "X uses_data_from Y",
    )
    assert one == other


@pytest.mark.parametrize(
    "second",
    [
        "D uses_data_from C NotifyOnChange",
        "D uses_data_from C NotifyAtFrequency 10",
        "C uses_data_from C",
        "D uses_data_from C\nE uses_data_from C",
        "D uses_data_from C\nD uses_data_from C NotifyOnChange",
    ],
)
def test_what_lines_say_makes_a_form(second: str) -> None:
    one, other = islands("B uses_data_from A", second)
    assert one != other


@pytest.mark.parametrize(
    ("annotation", "declaration", "alike"),
    [
        ("@DataIn", "void other(Map m)", True),
        ("@DataIn", "void f(Scan m)", False),
        ("@DataOut NotifyWhenReady", "Map f(Map m)", False),
    ],
)
def test_what_rules_read_of_modules_makes_a_form(
    annotation: str, declaration: str, alike: bool
) -> None:
    blocks = block("B", "@DataIn", "void f(Map m)") + block("D", annotation, declaration)
    one, other = islands("B uses_data_from A", "D uses_data_from C", blocks=blocks)
    assert (one == other) is alike


def test_alike_robots_are_counted_once(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = [f"{word}{at} uses_data_from S{at}" for at in range(30) for word in "AB"]
    names = ", ".join(f"{word}{at}" for at in range(30) for word in "SAB")
    project = read("\n".join(("@configuration flat", f"@modules {names}", *lines)))
    counted: list[int] = []
    count = Counter._count

    def noted(self: Counter, islands: list[object]) -> bool:
        counted.append(len(islands))
        return count(self, islands)  # type: ignore[arg-type]

    monkeypatch.setattr(Counter, "_count", noted)
    part = preceding_evidence(Reasoner(project, RULEBOOK), "DataSplitter29")
    assert part is not None
    assert part.introduced is not None
    assert part.introduced.resolves["DataSplitter29"] == ("data_divergence(S28)",)
    assert counted == [1]


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_nodes_of_alike_robots_are_explained_as_among_all(seed: int) -> None:
    rng = random.Random(seed)
    seeds = [1000 * (seed % 9) + rng.randrange(400) for _ in range(2)]
    seeds += rng.choices(seeds, k=3)
    project = read(fleet(seeds))
    try:
        whole = explain(Reasoner(project, RULEBOOK), traced=False)
    except MarsError:
        return
    told = {topic.name: topic for topic in whole.topics if topic.sort == "node"}
    for name in rng.sample(sorted(told), min(3, len(told))):
        part = explain(Reasoner(project, RULEBOOK), name, traced=False)
        assert part.synthesis is None, "the whole was resolved"
        (topic,) = part.topics
        assert topic.title == told[name].title
        one, other = topic.account, told[name].account
        assert one is not None
        assert other is not None
        assert (one.answer, one.cites) == (other.answer, other.cites)


@pytest.fixture
def merging(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Let sayings be compared in files of any size; note how many made no difference each time."""
    merged: list[int] = []

    def noted(*arguments: Any) -> Mapping[Saying, Hashable]:
        found = differences(*arguments)
        merged.append(len(found) - len(set(found.values())))
        return found

    monkeypatch.setattr(counted, "_TOGETHER", 1)
    monkeypatch.setattr(sayings, "_WORTH", 0)
    monkeypatch.setattr(counted, "differences", noted)
    return merged


def stars(rng: random.Random) -> str:
    """Return sources with a few clients each; some clients have several sources or lines."""
    modes, offer = rng.sample(MODES, 3), rng.choice(OFFERS)
    # Where a client has several inputs, nothing is left out of what is compared.
    inputs = rng.sample(("P x", "Q x", "R x"), 2)
    lines = []
    blocks = [block("K", "@Converts", "Q turn(P x)"), block("L", "@Converts 2", "Q turn(R x)")]
    for number in range(30):
        blocks.append(block(f"S{number}", f"@Sense {offer}", f"{rng.choice('PPR')} look()"))
        for name in (f"C{number}_{at}" for at in range(rng.choice((1, 1, 2, 3)))):
            sources = [number]
            if rng.random() < 0.1:
                sources.append(rng.choice((number, max(number - 1, 0))))
            lines += [f"{name} uses_data_from S{each} {rng.choice(modes)}" for each in sources]
            blocks.append(block(name, "@DataIn", f"void take({rng.choice(inputs)})"))
    taken = rng.sample(("DataSplitter3", "DataTransformer2"), rng.randint(0, 2))
    names = sorted({word for line in lines for word in line.split()[:3:2]})
    heading = ["@configuration flat", f"@modules {', '.join((*names, *taken))}"]
    return "\n".join((*heading, *dict.fromkeys(map(str.strip, lines)), *blocks))


def counts(project: Project, monkeypatch: pytest.MonkeyPatch) -> list[Mapping[str, int] | None]:
    """Return how many nodes of each kind are counted for each island of data."""
    found: list[Counter] = []
    begin = Counter.__init__

    def noted(self: Counter, *arguments: Any) -> None:
        begin(self, *arguments)
        found.append(self)

    with monkeypatch.context() as patched:
        patched.setattr(Counter, "__init__", noted)
        assert preceding_evidence(Reasoner(project, RULEBOOK), "DataSplitter999") is None
    (counter,) = found
    return [counter.of(number) for number in range(len(counter.islands))]


@pytest.mark.parametrize("seed", seeds(1, 3))
def test_islands_have_as_many_nodes_where_what_makes_no_difference_is_not_compared(
    seed: int, merging: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    project = read(stars(random.Random(seed)))
    merged = counts(project, monkeypatch)
    monkeypatch.setattr(counted, "differences", lambda *_: {})
    assert counts(project, monkeypatch) == merged
    assert sum(merging) > 0


def test_nodes_have_their_names_where_what_makes_no_difference_is_not_compared(
    merging: list[int],
) -> None:
    project = read(stars(random.Random(4)))
    whole = Reasoner(project, RULEBOOK).synthesis
    assert whole is not None
    told = {node.name: node for node in whole.specification.nodes}
    for name in {node.kind: node.name for node in whole.specification.nodes}.values():
        part = preceding_evidence(Reasoner(project, RULEBOOK), name)
        assert part is not None
        assert part.introduced is not None
        for node in part.introduced.nodes:
            assert (node.term, node.kind) == (told[node.name].term, told[node.name].kind)
    assert sum(merging) > 0


def test_ways_to_ask_that_need_the_same_nodes_count_as_one(
    monkeypatch: pytest.MonkeyPatch, merging: list[int]
) -> None:
    asked = ["RequestWhenReady", "NotifyAtFrequency 10", "NotifyAtFrequency 5", "NotifyOnMax"]
    lines, blocks = [], []
    for number, (one, other) in enumerate(product(asked, repeat=2)):
        lines.append(f"A{number} uses_data_from S{number} {one}")
        lines.append(f"B{number} uses_data_from S{number} {other}")
        blocks.append(block(f"S{number}", "@Sense NotifyAtFrequency 25", "float look()"))
    names = ", ".join(f"{word}{number}" for number in range(len(blocks)) for word in "SAB")
    project = read("\n".join(("@configuration flat", f"@modules {names}", *lines, *blocks)))
    numbers: list[int] = []
    count = Counter._count

    def noted(self: Counter, islands: list[object]) -> bool:
        numbers.append(len(islands))
        return count(self, islands)  # type: ignore[arg-type]

    monkeypatch.setattr(Counter, "_count", noted)
    assert preceding_evidence(Reasoner(project, RULEBOOK), "DataSplitter16") is not None
    # A condition needs a filter at the line that states it; which line is which does not matter.
    # The only island where both lines state one is that of the node itself.
    assert sum(numbers) == 2
    assert merging == [2]


def test_where_data_is_counted_rules_compare_no_names_but_of_lines_that_say_the_same() -> None:
    whole = for_resolution(load_rulebook(stages=("resolve", "account")))
    specifying = f"{whole.text('resolve')}\n{whole.text('specify')}"
    apart = kept_apart(whole.text("base"), specifying, vocabulary(whole).connected)
    assert apart is not None
    (counting,) = (p for p in apart.deciding if any(d.name == "splitter" for d in p.derived))
    base = {*for_counting(whole, counting).rules, *for_unresolvable(whole).rules}
    texts = [rule.text for rule in base] + f"{counting.settled}\n{counting.choosing}".split("\n")
    comparing = [text for text in texts if re.search(r"#min|#max|[^:<>=!] [<>]=? ", text)]
    others = [text for text in comparing if not text.startswith(tuple(OTHERS | INPUTS | FIRST))]
    # A bound on how many there are compares no names.
    kept = [text for text in others if re.search(r"#min|#max|[A-Z]'* [<>]=? [A-Z]", text)]
    assert [next(c for c in COMPARING if text.startswith(c)) for text in kept] == [*COMPARING]


def test_what_stands_against_every_specification_is_found_in_parts() -> None:
    told = []
    for seed in seeds(15, 40):
        rng = random.Random(seed)
        lines, blocks = [], []
        for number in range(rng.randint(1, 4)):
            source, clients = f"S{number}", [f"C{number}{letter}" for letter in "ab"]
            wanted = (*MODES, "NotifyWhenReady")
            lines += [
                f"{client} uses_data_from {source} {rng.choice(wanted)}" for client in clients
            ]
            offered = rng.choice((*OFFERS, "RequestWhenReady"))
            blocks.append(block(source, f"@Sense {offered}", "Scan look()"))
        names = sorted({word for line in lines for word in re.findall(r"\b[SC]\d\w?\b", line)})
        head = f"@configuration\n@modules {', '.join(names)}"
        reasoner = Reasoner(read("\n".join((head, *lines, *blocks))), RULEBOOK)
        told.append(is_realised(reasoner))
        assert told[-1] == (not is_unresolvable(reasoner.analysis)), seed
    assert {*told} == {True, False}
