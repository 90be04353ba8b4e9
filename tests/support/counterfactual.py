"""Whether what an account cites are causes: without a cited line something else is said.

A line that is cited for a consequence or node is taken out of the text. If the same is still said
of the same, in its first sentence, the line was no cause of it.

    python -m tests.support.counterfactual HOW_MANY [FIRST_SEED]

asks this of every line that is cited of as many random configurations of each kind.
"""

import re
import sys
from collections.abc import Iterator, Sequence

from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.explain import Topic, explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.random_configurations import (
    random_configuration,
    random_control,
    random_mounts,
    random_twins,
)

KINDS = (random_configuration, random_control, random_mounts, random_twins)
_NUMBERED = r"(DataSplitter|DataTransformer|ArbitrationNode|ControlSplitter|InheritanceNode)\d*"
STAGES = ("resolve", "account")


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
            if at not in without:
                rest = [*lines[:at], *lines[at + 1 :]]
                numbers = [*range(at), *range(at + 1, len(lines))]
                without[at] = [
                    (said, frozenset(numbers[n] for n in others))
                    for said, others in _said("".join(rest), path)
                ]
            # A line that is stated twice is still stated, and elsewhere the same may be said.
            if not _is_stated_again(lines, at) and any(
                said == sentence and cited & others for said, others in without[at]
            ):
                yield f"{lines[at].strip()} for {sentence}"


def _is_stated_again(lines: Sequence[str], at: int) -> bool:
    """Whether another line relates the same two modules, whatever else it says."""
    related = lines[at].split()[:3]
    return any(line.split()[:3] == related for line in (*lines[:at], *lines[at + 1 :]) if related)


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
    """Ask it of random configurations; return how many lines are no causes."""
    count, first = int(words[0]), int((*words, "0")[1])
    wrong = 0
    for seed in range(first, first + count):
        for kind in KINDS:
            text = kind(seed)
            for line in uncaused(text):
                wrong += 1
                print(f"{kind.__name__} {seed}: {line}", flush=True)
    print(f"{count} configurations of each of {len(KINDS)} kinds: {wrong} lines are no causes")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
