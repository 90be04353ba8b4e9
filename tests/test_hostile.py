"""Odd numbers, depths and names are refused where they are, and hostile commands harm nothing."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.exchange.ros2.launch_python import read_python
from tests.support import hostile
from tests.support.campaigns import seeds
from tests.support.fixtures import Captured, Patch

DIGITS = "9" * 5000
HEX = "0x" + "f" * 4000
MANIFEST = 'name = "p"\nversion = "1.0"\n'
#: What a file holds, the command that reads it, and where and how it is refused.
REFUSED = {
    "digits": ("s.toml", f"seed = 1\nduration = {DIGITS}\n", "s.toml:2:12: error: a number with"),
    "hexadecimal": ("s.toml", f"seed = 1\nduration = {HEX}\n", "s.toml:2:1: error: a whole number"),
    "in a list": ("s.toml", f"[world]\nwalls = [0, {HEX}]\n", "s.toml:2:13: error: a whole number"),
    "depth": ("s.toml", "seed = 1\nx = " + "[" * 2000, "s.toml:2:5: error: its lists and tables"),
    "some depth": ("s.toml", "x = " + "[" * 150 + "]" * 150, "s.toml:1:104: error: its lists"),
    "version": ("p/pack.toml", f'name = "p"\nversion = "{DIGITS}"\n', "p/pack.toml:2:1: error: "),
    "needed version": (
        "p/pack.toml",
        f'{MANIFEST}needs = ["mars-asp >= 1.{DIGITS}"]\n',
        "p/pack.toml:3:10: error: ",
    ),
    "settings": ("mars.toml", f"\nselect = [{HEX}]\n", "mars.toml:2:11: error: a whole number"),
    "baseline": (
        "b.json",
        f'{{"version":\n {DIGITS}}}',
        "b.json:2:2: error: a number with more than",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_an_odd_number_or_depth_is_refused_where_it_is(
    case: str, tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    name, text, expected = REFUSED[case]
    words = {
        "s.toml": ["run", "a.mars", "--scenario", "s.toml"],
        "p/pack.toml": ["check", "a.mars", "--rules", "p"],
        "b.json": ["check", "a.mars", "--baseline", "b.json"],
    }.get(name, ["check", "a.mars"])
    monkeypatch.chdir(tmp_path)
    Path("p").mkdir()
    Path("a.mars").write_text(hostile.FLAT)
    Path(name).write_text(text)
    assert run_here(words) == 2
    assert expected in "".join(capsys.readouterr())


@pytest.mark.parametrize(
    "vary",
    [
        "robot.radius=" + "[" * 5000,
        "robot.radius=" + "[" * 150 + "]" * 150,
        "robot.radius=" + "{a=" * 120 + "1" + "}" * 120,
        f"robot.radius={DIGITS}",
        f"robot.radius={HEX}",
        "robot.radius='\udcff'",
        "a." * 5000 + "b=1",
    ],
)
def test_an_odd_value_of_vary_is_refused(
    vary: str, tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    Path("a.mars").write_text(hostile.FLAT)
    Path("s.toml").write_text(hostile.SCENARIO.format(200))
    assert run_here(["run", "a.mars", "--scenario", "s.toml", "--vary", vary]) == 2
    assert "mars-asp: error: --vary: " in capsys.readouterr().err


@pytest.mark.parametrize("body", hostile.DOUBLING)
def test_doubling_lists_of_launch_files_are_bounded(body: str) -> None:
    text = hostile.LAUNCH.format("\n    ".join([body] * 50))
    try:
        read_python(text, "x.launch.py")
    except MarsError as error:
        assert "nested too deeply" in str(error)


@pytest.mark.parametrize("verb", ["check", "analyse", "synthesise", "explain", "facts", "draw"])
def test_paths_of_any_bytes_are_read(verb: str, tmp_path: Path, monkeypatch: Patch) -> None:
    folder = tmp_path / 'd\udcff"\\n\n%*'
    folder.mkdir()
    monkeypatch.chdir(folder)
    name = 'r\udcff").\x01\n.mars'
    Path(name).write_text(hostile.FLAT)
    output = ["-o", f"{name}.svg"] if verb == "draw" else []
    assert run_here([verb, name, *output]) in (0, 1)
    assert run_here([verb, str(folder / name), *output]) in (0, 1)


@pytest.mark.parametrize("seed", seeds(8, 26))
def test_a_hostile_command_ends_with_a_status_of_the_contract(seed: int) -> None:
    assert hostile.hostile(seed) == []
