"""Each lint reports its own bad example and not the good one."""

import pytest

from mars_asp.asp.lint import Host, lint
from mars_asp.asp.lint.catalogue import PAGES, Page
from mars_asp.asp.lint.values import Form
from mars_asp.asp.rules.metadata import wrong_holes
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic

FORMS: dict[str, Form] = {"city": "string", "road": "number"}


def codes(text: str, code: str) -> set[str]:
    problems: list[Diagnostic] = []
    file = read_rules(text, "a.lp", "base", problems)
    assert file is not None
    assert not problems
    assert not [each for rule in file.rules for each in wrong_holes(rule)]
    rulebook = Rulebook(
        file.rules, (("base", file.text),), paths=("a.lp",), documented=(file.documented,)
    )
    finding = next((s for r in file.rules for s in r.heads if s.name == "finding"), None)
    things = frozenset({"city", "road"})
    durations = {Signature("lasts", 2): (1,)}
    host = Host(
        finding,
        FORMS,
        things,
        durations,
        exists=lambda _: False,
        # In half of the examples constraints are the point.
        demanding=frozenset({"verify"}) if code == "rule-demand" else frozenset(),
        placing={Signature("inserted", 2): frozenset({Signature("placed_after", 2)})},
    )
    found = {each.diagnostic.code for each in lint(rulebook, host)}
    # What tells a finding is shown by the host.
    return found if finding is None else found - {"rule-unused"}


#: Described anew is a predicate of other rules, which this example has not.
ALONE = [page for page in PAGES if page.code != "rule-described"]


@pytest.mark.parametrize("page", ALONE, ids=lambda page: page.code)
def test_the_bad_example_has_one_fault_and_the_good_one_has_none(page: Page) -> None:
    assert codes(page.bad, page.code) == {page.code}
    assert codes(page.good, page.code) == set()
