"""Whether an account cites the causes of its first sentence, and no other line.

Each line is removed from the text. A cited line is a cause if the same subject no longer has the
same sentence. Conversely, a line is cited if the sentence disappears with it, and as many members
are cited as the sentence counts.

    python -m tests.support.counterfactual COUNT [FIRST_SEED]

checks COUNT random configurations of each kind, and prints how often each consequence and node was
explained.
"""

import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from pathlib import Path

from mars_asp.cli.lines import remember, whole_line
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.account import Account
from mars_asp.reasoning.questions.explain import Explanation, Topic, explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis import IntroducedNode
from tests.support.random_configurations import (
    random_configuration,
    random_control,
    random_faults,
    random_mounts,
    random_twins,
)

KINDS = (random_configuration, random_control, random_mounts, random_twins, random_faults)
_NUMBERED = r"(DataSplitter|DataTransformer|ArbitrationNode|ControlSplitter|InheritanceNode)\d*"
#: What sentences count, and what shows one of those in a line that is cited.
_COUNTED = {
    r"modules|controllers": r"[A-Za-z]\w*",
    r"functions": r"(?:Rotn|Trans)_[XYZ]|Grasp",
    r"lines|relationships|commands|joints|motions|times": r"^.*$",
}
#: A value that is missing from a sentence.
_HOLE = re.compile(r"\{\w*\}|``")
#: Words of lines, other than names of modules.
_KEYWORDS = re.compile(
    r"@\w+|\b(?:(?:Notify|Request)\w+|uses_data_from|is_\w+_(?:by|on)"
    r"|hold|forever|period|allocation|root|split|of|flat|hierarchical)\b"
)
STAGES = ("resolve", "account")
#: Lines that state a relationship or annotate a function.
_STATES = re.compile(
    r"\s*(?:@(?!module_|modules|configuration|specification|sources|include)\w"
    r"|\w.* (?:uses|is)_\w+ )"
)
#: A sentence about all that carries a module, up to the root.
_CARRIED = re.compile(r"^Nothing that carries `(\w+)` .*, up to `(\w+)`\.$")
#: The modules and vertices that a mount joins.
_MOUNT = re.compile(r"(\w+)(?: (\d+))? +is_mounted_on (\w+)(?: (\d+))?")


def topics(text: str, path: str = "config.mars") -> tuple[Topic, ...]:
    """Return the topics of the explanation of a configuration."""
    return _explanation(text, path).topics


def _explanation(text: str, path: str) -> Explanation:
    reasoner = Reasoner(load_project(path, (), text), load_rulebook(stages=STAGES))
    return explain(reasoner, traced=False)


def uncaused(text: str, path: str = "config.mars") -> Iterator[str]:
    """Yield each cited line whose removal leaves the sentence that cites it unchanged."""
    lines = text.splitlines(keepends=True)
    without: dict[int, list[tuple[str, frozenset[int]]]] = {}
    for answer in _answers(text, path)[0]:
        for at in answer.cited:
            # A line that is stated twice is still stated.
            if _is_repeated(lines, at):
                continue
            if at not in without:
                numbers = [*range(at), *range(at + 1, len(lines))]
                without[at] = [
                    (each.sentence, frozenset(numbers[n] for n in each.cited))
                    for each in _answers(_without(lines, at), path)[0]
                ]
            # The same sentence may cite other lines. An equal number of other lines is a change.
            counted = _counted(lines, answer.sentence, answer.cited - {at})
            if any(
                answer.sentence == one and answer.cited & of and counted == _counted(lines, one, of)
                for one, of in without[at]
            ):
                yield f"{lines[at].strip()} for {answer.sentence}"


def _counted(lines: Sequence[str], sentence: str, cited: Set[int]) -> frozenset[int]:
    """Return the cited relationships, if the sentence counts lines or commands."""
    if not re.search(r"\b\d+ (?:lines|commands)\b", sentence):
        return frozenset()
    return frozenset(at for at in cited if re.search(r" (?:uses|is)_\w+", lines[at]))


def uncited(text: str, path: str = "config.mars") -> Iterator[str]:
    """Yield the causes to which an answer does not lead, with the answer.

    `docs/decisions/traces.md` defines causes, and when an answer leads to a line.
    """
    lines = text.splitlines(keepends=True)
    before, _ = _answers(text, path)
    for at, line in enumerate(lines):
        if not _STATES.match(line) or all(at in each.reached for each in before):
            continue
        after, judged = _answers(_without(lines, at), path)
        left: dict[tuple[str, ...], set[str]] = {}
        for each in after:
            for key in (each.key, each.arbitrates):
                left.setdefault(key, set()).update(each.members)
        for each in before:
            # A source with one output left is called by its module.
            gone = not any(
                key in left and members <= left[key]
                for key, members in ((each.key, each.members), _without_ports(each))
            )
            if gone and each.sort in judged and at not in each.reached:
                yield f"{line.strip()} is missing for {each.sentence}"


def _without_ports(answer: "Answer") -> tuple[tuple[str, ...], frozenset[str]]:
    """Return the key and the members of an answer, sources named by their modules."""
    return (
        tuple(re.sub(r'"(\w+)\.\w+"\)$', r'"\1")', part) for part in answer.key),
        frozenset(member.partition(".")[0] for member in answer.members),
    )


def uncounted(account: Account) -> Iterator[str]:
    """Yield each count in the first sentence of an account that exceeds the cited lines."""
    answer = account.answer or ""
    lines = [f"{whole_line(each.span).strip()} {each.label}" for each in account.cites]
    lines = [_KEYWORDS.sub("", line) for line in lines]
    named = set(re.findall(r"`(\w+)`", re.split("[,;]", answer)[0]))
    for nouns, member in _COUNTED.items():
        numbers = [int(number) for number in re.findall(rf"\b(\d+) (?:{nouns})\b", answer)]
        shown = [each for line in lines for each in re.findall(member, line)]
        if "lines" not in nouns:
            shown = [each for each in dict.fromkeys(shown) if each not in named]
        if numbers and len(shown) < (max(numbers) if "lines" in nouns else sum(numbers)):
            yield f"{len(shown)} {nouns} are shown of {answer}"


def malformed(topic: Topic) -> Iterator[str]:
    """Yield the faults of an account: no sentence, a hole or an empty name in it, a line twice."""
    account = topic.account
    if account is None or not (account.answer or "").strip():
        yield f"no sentence for {topic.name}"
        return
    sentences = (account.answer or "", *account.notes)
    yield from (f"`{each}` for {topic.name}" for each in sentences if _HOLE.search(each))
    shown = [*sentences, *((each.span.path, each.span.line, each.label) for each in account.cites)]
    times = Counter(shown)
    yield from (f"{each} twice for {topic.name}" for each, number in times.items() if number > 1)


def _is_repeated(lines: Sequence[str], at: int) -> bool:
    """Whether another line has the same relationship of the same two modules."""
    related = lines[at].split()[:3]
    return any(line.split()[:3] == related for line in (*lines[:at], *lines[at + 1 :]) if related)


def _without(lines: Sequence[str], at: int) -> str:
    return "".join([*lines[:at], *lines[at + 1 :]])


@dataclass(frozen=True)
class Answer:
    """An answer: its first sentence without the numbers of nodes, its lines, and those it leads to.

    It is about the consequence or node of a `key`, in which `members` take part or which resolves
    them. An arbiter also has the key of one that `arbitrates` for its module and resolves nothing.
    """

    sort: str
    sentence: str
    cited: frozenset[int]
    reached: frozenset[int]
    key: tuple[str, ...]
    members: frozenset[str]
    arbitrates: tuple[str, ...]


@lru_cache(maxsize=200)
def _answers(text: str, path: str) -> tuple[Sequence[Answer], Set[str]]:
    """Return the answers about a configuration, and the sorts of which none is missing.

    Both are empty where it cannot be read. Nodes are missing where it has no specification.
    """
    try:
        explanation = _explanation(text, path)
    except MarsError:
        return (), set()
    found = explanation.topics
    cited = {topic.name: frozenset[int]() for topic in found}
    for topic in found:
        cited[topic.name] |= _led_to(topic, text, path)
    names = {topic.name: _named(topic, cited) for topic in found}
    arbitrated = {topic.name: _arbitrates(topic) for topic in found}
    about = [
        # A case that is a number is that of a line, which another line moves.
        *(
            # A function that several modules provide is inherited as where one provides it.
            (
                re.sub(r",\d+\)$", ",_)", f"{c.atom}").replace("similar_", "simple_").split(",", 2),
                c.participants,
            )
            for c in explanation.analysis.consequences
        ),
        *(
            (
                _key(node, resolves, arbitrated),
                [each.replace("similar_", "simple_") for each in resolves],
            )
            for node, resolves in _nodes(explanation)
        ),
    ]
    result = []
    for topic, (key, members) in zip(found, about, strict=True):
        assert topic.account is not None
        own = _lines_of(topic, path)
        others = _followed(topic.name, names) - {topic.name}
        reached = _led_to(topic, text, path).union(*(cited[name] for name in others))
        result.append(
            Answer(
                topic.sort,
                re.sub(_NUMBERED, r"\1", f"{topic.name}: {topic.account.answer}"),
                own,
                reached | _vertices(text, reached),
                tuple(key),
                frozenset(members),
                _arbitrates(topic),
            )
        )
    return result, {"consequence"} if explanation.synthesis is None else {"consequence", "node"}


def _nodes(explanation: Explanation) -> Iterator[tuple[IntroducedNode, Sequence[str]]]:
    """Yield the nodes of a specification, with the consequences that each resolves."""
    if explanation.synthesis is not None:
        introduced = explanation.synthesis.specification
        yield from ((node, introduced.resolves[node.name]) for node in introduced.nodes)


def _arbitrates(topic: Topic) -> tuple[str, ...]:
    """Return the key of an arbiter for a module, or of a splitter for the parts of one, or ()."""
    if topic.name.startswith("ControlSplitter") and topic.account is not None:
        notes = " ".join(topic.account.notes)
        parted = re.findall(r"takes what `(\w+)` inherits", notes)
        return ("control_splitter", *parted) if parted else ()
    found = re.findall(r"controls? `(\w+)`", topic.account.answer or "" if topic.account else "")
    return ("arbitration_node", *found) if found and topic.name.startswith("Arbitr") else ()


def _key(
    node: IntroducedNode, resolves: Sequence[str], arbitrated: Mapping[str, tuple[str, ...]]
) -> tuple[str, ...]:
    """Return the kind of a node and, if it resolves nothing, the module it arbitrates or its term.

    A node that resolves the same as another of its kind does is there in its stead.
    """
    if resolves:
        return (node.kind, "")
    return arbitrated[node.name] or (node.kind, node.term)


def _lines_of(topic: Topic, path: str) -> frozenset[int]:
    assert topic.account is not None
    return frozenset(each.span.line - 1 for each in topic.account.cites if each.span.path == path)


def _noted(topic: Topic, path: str) -> frozenset[int]:
    """Return the lines of which the sentences below an answer name the place."""
    assert topic.account is not None
    place = rf"{re.escape(Path(path).name)}:(\d+)"
    return frozenset(int(n) - 1 for note in topic.account.notes for n in re.findall(place, note))


def _led_to(topic: Topic, text: str, path: str) -> frozenset[int]:
    """Return the lines to which an answer leads by itself."""
    assert topic.account is not None
    named = {each for line in topic.account.cites for each in re.findall(r"`(\w+)`", line.label)}
    paths = [re.search(_CARRIED, note) for note in topic.account.notes]
    mounts = [_mounts_between(text, path[1], {path[2]}) for path in paths if path]
    if topic.name.startswith("emergent_functionality"):
        mounts.append(_mounts_between(text, topic.name.partition("(")[2].rstrip(")"), named))
    return (_lines_of(topic, path) | _noted(topic, path)).union(*mounts)


def _named(topic: Topic, names: Iterable[str]) -> set[str]:
    """Return the consequences that a node resolves, and the nodes that its sentences name."""
    assert topic.account is not None
    words = set(re.findall(r"\w+", " ".join([topic.account.answer or "", *topic.account.notes])))
    return {name for name in names if name in words or name in topic.resolves}


def _followed(name: str, named: Mapping[str, set[str]]) -> set[str]:
    """Return a name and all that it leads to."""
    found, ahead = {name}, [name]
    while ahead:
        more = named[ahead.pop()] - found
        found |= more
        ahead += more
    return found


def _mounts_between(text: str, module: str, carriers: Set[str]) -> frozenset[int]:
    """Return the mounts from a module to some of those that carry it."""
    mounts = {
        mount[1]: (at, mount[3])
        for at, line in enumerate(text.splitlines())
        if (mount := re.match(_MOUNT, line))
    }
    found, ahead = set[int](), set[int]()
    while module in mounts and mounts[module][0] not in ahead:
        at, module = mounts[module]
        ahead.add(at)
        if module in carriers:
            found |= ahead
    return frozenset(found)


def _vertices(text: str, reached: Set[int]) -> frozenset[int]:
    """Return the vertices that the mounts among some lines join; an unwritten one is 0."""
    lines = text.splitlines()
    joined = {
        (module, number or "0")
        for at in reached
        for mount in re.finditer(_MOUNT, lines[at])
        for module, number in (mount.group(1, 2), mount.group(3, 4))
    }
    found, module = set(), ""
    for at, line in enumerate(lines):
        word, _, rest = line.strip().partition(" ")
        if word == "@module_name":
            module = rest.strip()
        elif word == "@Vertex" and (module, rest.split()[0]) in joined:
            found.add(at)
    return frozenset(found)


def main(words: Sequence[str]) -> int:
    """Check random configurations; return whether a citation or a count is wrong.

    Interrupted, it prints its results so far.
    """
    count, first = int(words[0]), int((*words, "0")[1])
    answers: Counter[str] = Counter()
    tried = cited = wrong = 0
    with suppress(KeyboardInterrupt):
        for seed, kind in product(range(first, first + count), KINDS):
            text = kind(seed)
            result: tuple[Topic, ...] = ()
            with suppress(MarsError):
                result = topics(text)
            remember("config.mars", text)
            accounts = [topic.account for topic in result if topic.account is not None]
            missing = (each for account in accounts for each in uncounted(account))
            faults = (each for topic in result for each in malformed(topic))
            for line in (*uncaused(text), *uncited(text), *missing, *faults):
                wrong += 1
                print(f"{kind.__name__} {seed}: {line}", flush=True)
            tried += 1
            answers.update(re.sub(r"\d*$|\(.*", "", topic.name) for topic in result)
            cited += sum(len(account.cites) for account in accounts)
    print(", ".join(f"{name} {number}" for name, number in answers.most_common()))
    print(
        f"{tried} configurations of {len(KINDS)} kinds, {answers.total()} answers, "
        f"{cited} cited lines: {wrong} are wrong"
    )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
