"""`fmt`: layout changes, and nothing else does."""

import json
import os
import random
import re
import stat
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text, print_configuration
from mars_asp.language.format import format_text, meaning
from mars_asp.model.declarations import Configuration
from mars_asp.model.names import QUOTED
from tests.support.documents import ROOT
from tests.support.strategies import configurations, few

FILES = sorted(
    [*ROOT.glob("examples/*/*.mars"), *ROOT.glob("tests/specifications/*.mars")],
    key=str,
)
BLOCK = (
    "@module_start",
    "@module_name\tCamera",
    "  @Sense   NotifyAtFrequency  25  -- as  it  comes",
    "",
    "    RawImage grab();  // a frame",
    "@module_end  ",
)
REMARKS = ("// plain", "# hash", "//", "// DataTransformer1: Hough (A -> B)", "//  (x), @modules")
LONG = "Platform is_controlled_by Collide, Runaway, TurnAround, ForwardAgain, WanderAbout, Stop"
STATEMENTS = (
    "@sources a/b, c d, e",
    "A is_mounted_on B 1 (_,_,_,_,_,100)",
    "A 0 is_mounted_on B (x,90,_,_,1,2.50,-3)",
    "A uses_data_from B NotifyOnMin(300, of=nearest)",
    "A uses_data_from C NotifyOnValue(30, 0.5)",
    "A uses_data_from D 12.50",
    "B is_controlled_by C 0 hold 300",
    LONG,
)


def comments(text: str) -> list[str]:
    found = re.finditer(rf"{QUOTED}|(?://|#)[^\n]*", text)
    return [match[0].rstrip() for match in found if not match[0].startswith('"')]


def noisy(rng: random.Random, text: str, remarks: bool) -> str:
    """Return a text with white space, and comments if wanted, wherever they change nothing."""

    def blank(least: int) -> str:
        return "".join(rng.choices(" \t", k=rng.choice((least, least, least + 1, 3))))

    def line_end() -> str:
        remark = rng.choice(REMARKS) if remarks and rng.random() < 0.4 else ""
        return f"{blank(0)}{remark}\n"

    def gap(before: str, after: str) -> str:
        least = int(before[-1] not in "(,)=" and after[0] not in "(,)=")
        if rng.random() < 0.3 and (before == "," or after in (",", "(")):
            return "".join(line_end() for _ in range(rng.choice((1, 1, 2, 3)))) + blank(0)
        return blank(least)

    lines = []
    for statement in text.splitlines():
        pieces = rf"[(),=:]|(?:{QUOTED}|[^\s(),=:])+"
        if statement.startswith("@sources"):
            pieces = r"@sources|,|[^,\n]*[^,\s]"
        words = [match[0].strip() for match in re.finditer(pieces, statement)]
        line = blank(0) + words[0]
        for before, after in pairwise(words):
            line += (blank(1) if before == "@sources" else gap(before, after)) + after
        lines += [line_end() for _ in range(rng.choice((0, 0, 1, 3)))] + [line + line_end()]
    return "".join(lines)


def text_of(configuration: Configuration, statements: list[str]) -> str:
    return print_configuration(configuration) + "".join(f"{line}\n" for line in statements)


chosen = st.lists(st.sampled_from(STATEMENTS), max_size=4, unique=True)
randoms = st.randoms(use_true_random=False)


@few
@given(configurations)
def test_printed_text_is_in_canonical_layout(configuration: Configuration) -> None:
    text = print_configuration(configuration)
    assert format_text(text, "config.mars") == text


@few
@given(configurations, chosen, randoms)
def test_layout_has_one_form(
    configuration: Configuration, statements: list[str], rng: random.Random
) -> None:
    plain = text_of(configuration, statements)
    formatted = format_text(noisy(rng, plain, False), "config.mars")
    assert re.sub("\n+", "\n", formatted) == format_text(plain, "config.mars")
    assert "\n\n\n" not in formatted


@few
@given(configurations, chosen, randoms)
def test_comments_stay_and_meaning_does_not_change(
    configuration: Configuration, statements: list[str], rng: random.Random
) -> None:
    text = noisy(rng, text_of(configuration, statements), True)
    lines = text.splitlines()
    at = rng.choice([0, len(lines)])
    text = "\n".join([*lines[:at], *BLOCK, *lines[at:]])
    formatted = format_text(text, "config.mars")
    read, again = (parse_text(each, "config.mars").configuration for each in (text, formatted))
    assert meaning(read) == meaning(again)
    assert read.declared
    assert comments(formatted) == comments(text)
    assert format_text(formatted, "config.mars") == formatted
    assert not re.search(r"[ \t]\n|\n\n\n|^\n|\n\n$", formatted)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_of_the_project_keep_their_meaning(path: Path) -> None:
    text = path.read_text()
    formatted = format_text(text, "config.mars")
    read, again = (parse_text(each, "config.mars").configuration for each in (text, formatted))
    assert meaning(read) == meaning(again)
    assert comments(formatted) == comments(text)
    assert format_text(formatted, "config.mars") == formatted


WRITTEN = """\
\ufeff

   // A camera on its head.
@configuration    hierarchical   period 50 # milliseconds\r
@sources a/b , c d,e//here



@modules   Camera ,Head,   // physical
     Joystick,

  // not built yet
  Screen
Camera  is_mounted_on   Head 1 ( _ , _,_,_,
  _,  100 )
Screen uses_data_from Camera   NotifyOnMax (  30 , of = near )
Head is_controlled_by
// before a block
@module_start

  @module_name    Camera\t// c
    @Sense   NotifyAtFrequency  25 --  free   text


    RawImage  grab ( ) ;   // code

@module_end
# behind it""".replace("Head is_controlled_by\n", "Head is_controlled_by Joystick\n  , Joystick\n")
FORMATTED = """\
// A camera on its head.
@configuration hierarchical period 50  # milliseconds
@sources a/b, c d, e  //here

@modules Camera, Head,  // physical
Joystick,
// not built yet
Screen
Camera is_mounted_on Head 1 (_,_,_,_,_,100)
Screen uses_data_from Camera NotifyOnMax(30, of=near)
Head is_controlled_by Joystick, Joystick
// before a block
@module_start
@module_name Camera  // c
@Sense NotifyAtFrequency 25 --  free   text

    RawImage  grab ( ) ;   // code
@module_end

# behind it
"""


def test_a_whole_file() -> None:
    assert format_text(WRITTEN, "config.mars") == FORMATTED
    assert format_text(FORMATTED, "config.mars") == FORMATTED


def test_a_block_inside_a_statement_and_a_comment_inside_a_path_stay_there() -> None:
    block = "\n".join(line.rstrip() for line in BLOCK)
    text = f"@configuration\n@modules A,\n{block}\nB\n@sources one // why\n(1)\n"
    formatted = format_text(text, "config.mars")
    assert format_text(formatted, "config.mars") == formatted
    assert comments(formatted) == comments(text)
    read, again = (parse_text(each, "config.mars").configuration for each in (text, formatted))
    assert meaning(read) == meaning(again)


def test_any_white_space_parts_words() -> None:
    text = "@configuration\xa0flat\n\u3000\n@modules A,\u3000\n\xa0B\x0c\n"
    text += "A\x0cuses_data_from\xa0B\xa0\n"
    text += "A is_mounted_on B\xa0\n(\xa0_,_,_,\u30001,2,3)\xa0// x\xa0y\xa0\n"
    assert format_text(text, "config.mars") == (
        "@configuration flat\n\n@modules A, B\nA uses_data_from B\n"
        "A is_mounted_on B (_,_,_,1,2,3)  // x\xa0y\n"
    )


def test_syntax_errors_are_raised() -> None:
    with pytest.raises(MarsError):
        format_text("@configuration\n@modules A\nA uses_data_form B\n", "config.mars")


def fmt(*words: str, text: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "mars_asp", "fmt", *words],
        cwd=ROOT,
        input=text,
        capture_output=True,
        check=False,
    )


GOOD = b"@configuration\n@modules A, B\nA uses_data_from B\n"
LOOSE = b"\xef\xbb\xbf@configuration\r\n@modules A,B\r\nA  uses_data_from B // caf\xc3\xa9\r\n"
TIGHT = b"@configuration\n@modules A, B\nA uses_data_from B  // caf\xc3\xa9\n"


def test_files_are_rewritten_and_wrong_ones_left_alone(tmp_path: Path) -> None:
    good, loose, wrong = (tmp_path / name for name in ("good.mars", "loose.mars", "wrong.mars"))
    link = tmp_path / "link.mars"
    good.write_bytes(GOOD)
    loose.write_bytes(LOOSE)
    loose.chmod(0o640)
    link.symlink_to(loose)
    wrong.write_bytes(b"@configuration\n@modules A\nA  uses_data_form B\n")
    files = [str(tmp_path / "missing.mars"), *map(str, (wrong, good, link))]
    os.utime(good, (1, 1))

    checked = fmt("--check", *files[2:])
    assert (checked.returncode, checked.stdout.decode()) == (1, f"{link}\n")
    assert loose.read_bytes() == LOOSE

    done = fmt(*files)
    assert done.returncode == 2
    assert done.stdout.decode() == f"formatted {link}\n"
    assert b"wrong.mars:3:4: error" in done.stderr
    assert b"missing.mars" in done.stderr
    assert wrong.read_bytes() == b"@configuration\n@modules A\nA  uses_data_form B\n"
    assert loose.read_bytes() == TIGHT
    assert stat.S_IMODE(loose.stat().st_mode) == 0o640
    assert link.is_symlink()
    assert good.stat().st_mtime == 1
    assert sorted(tmp_path.iterdir()) == sorted([good, loose, link, wrong])

    assert fmt("--check", *files[2:]).returncode == 0


def test_standard_input_goes_to_standard_output() -> None:
    done = fmt("-", text=LOOSE)
    assert (done.returncode, done.stdout) == (0, TIGHT)
    assert fmt("-", "--check", text=LOOSE).returncode == 1
    assert fmt("-", "--check", text=TIGHT).returncode == 0
    found = json.loads(fmt("-", "--format", "json", text=LOOSE).stdout)
    assert found == {"files": [{"path": "-", "changed": True, "text": TIGHT.decode()}]}
    assert fmt("-", "examples/level0/config.mars", text=LOOSE).returncode == 2
