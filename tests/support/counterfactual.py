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
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import product

from mars_asp.cli.lines import remember, whole_line
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.account import Account
from mars_asp.reasoning.questions.explain import Topic, explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
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
#: Words of lines that are no names of modules.
_KEYWORDS = re.compile(
    r"@\w+|\b(?:(?:Notify|Request)\w+|uses_data_from|is_\w+_(?:by|on)"
    r"|hold|forever|period|allocation|root|split|of|flat|hierarchical)\b"
)
STAGES = ("resolve", "account")
#: Lines that state a relationship or annotate a function.
_STATES = re.compile(
    r"\s*(?:@(?!module_|modules|configuration|specification|Vertex)\w|\w.* (?:uses|is)_\w+ )"
)


def topics(text: str, path: str = "config.mars") -> tuple[Topic, ...]:
    """Return what is told of a configuration."""
    reasoner = Reasoner(load_project(path, (), text), load_rulebook(stages=STAGES))
    return explain(reasoner, traced=False).topics


def uncaused(text: str, path: str = "config.mars") -> Iterator[str]:
    """Yield the lines of a text that are cited and no causes, with what they are cited for."""
    lines = text.splitlines(keepends=True)
    without: dict[int, list[tuple[str, frozenset[int]]]] = {}
    for sentence, cited in _said(text, path):
        for at in cited:
            # A line that is stated twice is still stated.
            if _is_stated_again(lines, at):
                continue
            if at not in without:
                rest = [*lines[:at], *lines[at + 1 :]]
                numbers = [*range(at), *range(at + 1, len(lines))]
                without[at] = [
                    (said, frozenset(numbers[n] for n in others))
                    for said, others in _said("".join(rest), path)
                ]
            # Elsewhere the same may be said.
            if any(said == sentence and cited & others for said, others in without[at]):
                yield f"{lines[at].strip()} for {sentence}"


def uncited(text: str, path: str = "config.mars") -> Iterator[str]:
    """Yield the lines without which a finding changes, and that are not cited for it.

    Headings, blocks and vertices are left out: only a computation shows the effect of a vertex. So
    are nodes, whose mounts and motions are cited with the InheritanceNode.
    """
    lines = text.splitlines(keepends=True)
    before = [each for each in _said(text, path) if not re.match(_NUMBERED, each[0])]
    for at, line in enumerate(lines):
        if not _STATES.match(line) or all(at in cited for _, cited in before):
            continue
        rest = "".join([*lines[:at], *lines[at + 1 :]])
        after = {sentence for sentence, _ in _said(rest, path)}
        for sentence, cited in before:
            if after and sentence not in after and at not in cited:
                yield f"{line.strip()} is missing for {sentence}"


def uncounted(account: Account) -> Iterator[str]:
    """Yield what the first sentence of an account counts and its lines do not show."""
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


def _is_stated_again(lines: Sequence[str], at: int) -> bool:
    """Whether another line relates the same two modules, whatever else it says."""
    related = lines[at].split()[:3]
    return any(line.split()[:3] == related for line in (*lines[:at], *lines[at + 1 :]) if related)


@lru_cache(maxsize=200)
def _said(text: str, path: str) -> list[tuple[str, frozenset[int]]]:
    """Return what is told of a configuration, without the numbers of nodes, and the lines cited.

    Nothing is told where it cannot be read.
    """
    try:
        told = topics(text, path)
    except MarsError:
        return []
    found = []
    for topic in told:
        assert topic.account is not None
        sentence = re.sub(_NUMBERED, r"\1", f"{topic.name}: {topic.account.answer}")
        cited = {each.span.line - 1 for each in topic.account.cites if each.span.path == path}
        found.append((sentence, frozenset(cited)))
    return found


def main(words: Sequence[str]) -> int:
    """Ask it of random configurations; return whether something cited or counted is wrong.

    Interrupted it prints what it has found.
    """
    count, first = int(words[0]), int((*words, "0")[1])
    asked: Counter[str] = Counter()
    tried = cited = wrong = 0
    with suppress(KeyboardInterrupt):
        for seed, kind in product(range(first, first + count), KINDS):
            text = kind(seed)
            told: tuple[Topic, ...] = ()
            with suppress(MarsError):
                told = topics(text)
            remember("config.mars", text)
            accounts = [topic.account for topic in told if topic.account is not None]
            missing = (each for account in accounts for each in uncounted(account))
            faults = (each for topic in told for each in malformed(topic))
            for line in (*uncaused(text), *uncited(text), *missing, *faults):
                wrong += 1
                print(f"{kind.__name__} {seed}: {line}", flush=True)
            tried += 1
            asked.update(re.sub(r"\d*$|\(.*", "", topic.name) for topic in told)
            cited += sum(len(account.cites) for account in accounts)
    print(", ".join(f"{name} {number}" for name, number in asked.most_common()))
    print(
        f"{tried} configurations of {len(KINDS)} kinds, {asked.total()} answers, "
        f"{cited} cited lines: {wrong} are wrong"
    )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
