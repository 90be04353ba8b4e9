"""Each changed line of a specification with side lines is refused, with the lines that show it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.verification import judge_specification
from tests.support.campaigns import sample

RULEBOOK = load_rulebook(stages=("resolve", "verify"))
CASES = Path(__file__).parents[1] / "execution" / "subsumption"
SIGNS = ("is_suppressed_by", "is_inhibited_by")


def changes(body: list[str]) -> Iterator[list[str]]:
    """Yield bodies with a line dropped, doubled, of the other sign or with another number."""
    for index, line in enumerate(body):
        words = line.split()
        yield [*body[:index], *body[index + 1 :]]
        # A strategy that is stated again means the same.
        if words[1] != "is_arbitrated_by":
            yield [*body[:index], line, *body[index:]]
        new = []
        if words[1] in SIGNS:
            new.append([words[0], SIGNS[words[1] == SIGNS[0]], *words[2:]])
        # Priorities of controllers count by their order alone.
        first = 4 if words[1] == "is_controlled_by" else 3
        for at in range(first, len(words)):
            if words[at].isdigit():
                new.append([*words[:at], str(int(words[at]) + 1), *words[at + 1 :]])
        for each in new:
            yield [*body[:index], " ".join(each), *body[index + 1 :]]


@pytest.mark.parametrize("path", sorted(CASES.glob("*.spec.mars")), ids=lambda path: path.name)
def test_every_change_of_a_line_is_refused(path: Path) -> None:
    configuration = path.with_name(path.name.replace(".spec.", "."))
    if not configuration.exists():
        pytest.skip("no configuration beside it")
    parsed = parse_text(configuration.read_text(), "c.mars").configuration
    project = Project(parsed, {}, ())
    first, names, *body = path.read_text().split("@module_start")[0].split("\n")
    body = [line for line in body if line.strip() and not line.startswith("//")]
    for lines in ([body], sample([*changes(body)], 3)):
        for changed in lines:
            text = "\n".join([first, names, *changed, ""])
            try:
                specification = parse_text(text, "s.mars").configuration
            except MarsError:
                continue
            found = judge_specification(specification, project, RULEBOOK, cited=True).violations
            assert bool(found) == (changed != body), text
            assert all(each.locations for each in found), text
