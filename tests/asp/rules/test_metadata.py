"""Ids of rules: those that are written, and those that places give."""

from pathlib import Path

from mars_asp.asp import Program
from tests.support.refusals import refusal


def ids(program: Program) -> list[str]:
    return [rule.id for rule in program.rulebook.rules]


def test_rules_without_ids_have_their_line_and_further_ones_of_it_their_column() -> None:
    program = Program.from_text("p(1). p(2). q(X) :-\n  p(X). r.\ns.\n", "reach.lp")
    assert ids(program) == ["reach:1", "reach:1:7", "reach:1:13", "reach:2", "reach:3"]


def test_columns_count_characters() -> None:
    assert ids(Program.from_text('p("öö机"). q.\n', "a.lp")) == ["a:1", "a:1:11"]


def test_a_rule_with_an_id_leaves_its_line_to_others() -> None:
    text = "%! id: reach/start\np(1). p(2). p(3).\n"
    assert ids(Program.from_text(text, "reach.lp")) == ["reach/start", "reach:2", "reach:2:13"]


def test_rules_of_files_that_share_a_name_have_ids_of_their_own(tmp_path: Path) -> None:
    paths = [tmp_path / folder / "graph.lp" for folder in ("a", "b")]
    for path in paths:
        path.parent.mkdir()
        path.write_text("edge(1,2). edge(2,3).\n")
    program = Program.from_files(*paths)
    assert ids(program) == ["graph:1", "graph:1:12", f"{paths[1]}:1", f"{paths[1]}:1:12"]


def test_a_repeated_id_is_reported_with_both_locations(tmp_path: Path) -> None:
    paths = [tmp_path / folder / "graph.lp" for folder in ("a", "b")]
    for path in paths:
        path.parent.mkdir()
        path.write_text("%! id: graph/edge\nedge(1,2).\n")
    found = refusal(Program.from_files, *paths)
    assert found.message == "rule id `graph/edge` is used twice"
    assert (found.span.path, found.labels[0][0].path) == (str(paths[1]), str(paths[0]))


def test_a_text_goes_on_in_lines_that_are_indented() -> None:
    text = "%! why: this is told,\n%!      because: it matters,\n%!      and so on\n%! help: none\n"
    (rule,) = Program.from_text(f"{text}p(1).\n", "a.lp").rulebook.rules
    assert (rule.why, rule.because, rule.help) == ("this is told,", "it matters, and so on", "none")
    text = "%! why: this is told,\n%!    over lines\n%!     \n%! example: a/b.lp\n"
    (rule,) = Program.from_text(f"{text}p(1).\n", "a.lp").rulebook.rules
    assert (rule.why, rule.example) == ("this is told, over lines", "a/b.lp")


def test_a_line_that_is_not_below_metadata_goes_on_with_none() -> None:
    text = "%!     not this\n%! why: this\n\n%!     nor this\np(1).\n"
    found = refusal(Program.from_text, text, "a.lp")
    assert found.message == "`why` is not directly above a rule"
    (rule,) = Program.from_text("%!     not this\n%! why: this\np(1).\n", "a.lp").rulebook.rules
    assert rule.why == "this"
