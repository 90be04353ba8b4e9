"""Names of modules: valid ones, their quoting, and the same quoting in all outputs."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.cli import run_here
from mars_asp.language import parse_text
from mars_asp.model.names import read_name, written
from tests.support.fixtures import Captured
from tests.support.refusals import refusal, refusals

ROBOT = r"""@configuration hierarchical
@modules "bumper response", joystick, /robot1/base, dora-camera, "a // b # c", "3", "say \"go\" \\"
/robot1/base is_controlled_by "bumper response" 100 hold forever
/robot1/base is_controlled_by joystick 10 hold 500
"bumper response" uses_data_from dora-camera   // a comment with "quotes"
"a // b # c" uses_data_from dora-camera
"say \"go\" \\" uses_data_from "3"
"""
NAMES = ("bumper response", "joystick", "/robot1/base", "dora-camera", "a // b # c", "3")


@pytest.mark.parametrize(
    "name", ["A", "_a1", "dora-camera", "/robot1/base", "base", "a/b-c/d", "2d_lidar", "Äpfel"]
)
def test_these_are_written_as_they_are(name: str) -> None:
    assert written(name) == name
    assert read_name(name) == name


@pytest.mark.parametrize(
    "name", ["bumper response", "3", "1e5", "-a", "a-", "a//b", "/", "a.b", 'x"y', "\\", "a, b"]
)
def test_these_need_quotes(name: str) -> None:
    assert read_name(written(name)) == name
    assert written(name).startswith('"')


@pytest.mark.parametrize("text", ["", '""', '"a', 'a"', "a b", "3", '"a"b"', '"a\nb"', "-"])
def test_these_are_not_names(text: str) -> None:
    assert read_name(text) is None


@pytest.mark.parametrize("sign", ["\x1b", "\x7f", "\x85", "\u2028", "\u202e", "\u2066"])
def test_names_contain_no_control_or_hidden_characters(sign: str) -> None:
    assert read_name(written(f"a{sign}b")) is None
    text = f'@configuration\n@modules "a{sign}b", B\nB uses_data_from C."{sign}"\n'
    first, second = refusals(parse_text, text, "c.mars")
    assert (first.span[1:3], second.span[1:3]) == ((2, 10), (3, 19))
    assert first.help == second.help
    assert first.help == "a name contains no control characters and no marks of direction"


@given(
    st.text(
        st.characters(
            codec="utf-8",
            exclude_categories=("Cc", "Zl", "Zp"),
            exclude_characters="\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069",
        ),
        min_size=1,
    )
)
def test_any_name_of_one_line_reads_back(name: str) -> None:
    assert read_name(written(name)) == name


def test_quoted_names_are_read_as_written() -> None:
    configuration = parse_text(ROBOT, "c.mars").configuration
    assert tuple(each.text for each in configuration.modules) == (*NAMES, 'say "go" \\')
    assert configuration.modules[0].span[1:] == (2, 10, 2, 27)


def test_base_and_slash_base_are_two_names() -> None:
    text = "@configuration\n@modules base, /base\nbase uses_data_from /base\n"
    assert len(parse_text(text, "c.mars").configuration.modules) == 2


@pytest.mark.parametrize(
    ("line", "column", "found"),
    [("A uses_data_from B-", 19, "`-`"), ('"A uses_data_from B', 1, '`"A`'), ("A/ x", 2, "`/`")],
)
def test_a_wrong_name_is_reported_at_its_location(line: str, column: int, found: str) -> None:
    only = refusal(parse_text, f"@configuration\n@modules A, B\n{line}\n", "c.mars")
    assert only.span[1:3] == (3, column)
    assert only.message.startswith(f"found {found}")


def test_a_specification_with_such_names_realises_its_configuration(
    tmp_path: Path, capsys: Captured
) -> None:
    path, made = tmp_path / "c.mars", tmp_path / "s.mars"
    path.write_text(ROBOT)
    assert run_here(["synthesise", str(path), "-o", str(made), "--quiet"]) == 0
    assert 'ArbitrationNode is_controlled_by "bumper response" 100 hold forever\n' in (
        made.read_text()
    )
    assert run_here(["verify", str(made), str(path)]) == 0
    assert run_here(["fmt", "--check", str(made)]) == 0
    capsys.readouterr()
    for subject in ("bumper response", '"bumper response"', "control_convergence(/robot1/base)"):
        assert run_here(["explain", str(path), subject]) == 0
        assert "`/robot1/base`" in capsys.readouterr().out
