"""Ids of the built-in rules and of packs: each is the path of a file, and is there once."""

from collections import Counter
from pathlib import Path

import pytest

from mars_asp.asp.rules.metadata import file_name
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.rules import STAGES, load_rulebook


def test_ids_are_paths_and_unique_over_all_stages() -> None:
    rules = load_rulebook(stages=STAGES, strict=True).rules
    counted = Counter(rule.id for rule in rules)
    assert {each: count for each, count in counted.items() if count > 1} == {}
    for rule in rules:
        *folders, name = Path(rule.span.path).relative_to("rules").with_suffix("").parts
        # A file with the name of its folder adds nothing.
        path = "/".join([*folders, name] if name not in folders else folders)
        assert file_name(rule.span.path, rule.stage) == path
        assert rule.id.startswith((f"{path}/", f"{path}:"))


def test_a_rule_of_a_pack_has_no_id_of_a_built_in_rule(tmp_path: Path) -> None:
    built_in = {rule.id for rule in load_rulebook(stages=STAGES).rules}
    pack = tmp_path / "control.lp"
    # More lines than any built-in file has: an id is a path and a line.
    pack.write_text("mine(1).\n" * 500)
    book = load_rulebook([pack], STAGES)
    mine = [rule.id for rule in book.rules if rule.span.path == str(pack)]
    assert mine[:2] == [f"{pack}:1", f"{pack}:2"]
    assert len(mine) == 500
    assert built_in.isdisjoint(mine)


def test_a_pack_may_not_take_the_id_of_a_rule_of_any_stage(tmp_path: Path) -> None:
    pack = tmp_path / "resolve.lp"
    pack.write_text("%! id: resolve/data/edge\nmine(1).\n")
    with pytest.raises(MarsError, match="rule id `resolve/data/edge` is used twice"):
        load_rulebook([pack], STAGES)


def test_a_pack_given_twice_is_read_once(tmp_path: Path) -> None:
    pack = tmp_path / "mine.lp"
    pack.write_text("%! id: mine/one\nmine(1).\n")
    assert load_rulebook([pack, tmp_path], STAGES).packs == 1
