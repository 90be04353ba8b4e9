"""Blocks that are alike are read once, and as they are read together with all others."""

import random

import pytest

from mars_asp.annotations.alike import read_alike
from mars_asp.annotations.blocks import Blocks, block_lines, block_source, read_blocks
from mars_asp.annotations.modules import read_modules
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic
from mars_asp.model.declarations import Module
from tests.support.campaigns import seeds
from tests.support.documents import ROOT
from tests.support.fixtures import Patch

BLOCK = (
    "@module_start\n@module_name {name}\n@Sense NotifyAtFrequency 25\nRaw grab();\n@module_end\n"
)
FULL = """\
  @module_start \t
\t@module_name  {name}
  @ControlOut Rotn_Y, Trans_Z -- both
  @Input x: Map
  Motion act(Raw x, /* of old */ Scan[] y);
  @Guard
  @Vertex 1 (_,_,_,_,0,0,100)
  @Tag safety_critical
  @Property latency_ms 60
  @DataOut NotifyWhenReady,
     NotifyOnMax(3)
  Mäp make(
    Raw x);
  @module_end
"""
#: What a change puts into a text, or in the place of a part of it.
PUT = (
    *("@module_start", "@module_end", "@module_name B", "@Module_Start", "@module_start : x"),
    *("@configuration", "@Sense", "@sense", "@foo", "@param", "a@b", "@Input A,", "-- no", ","),
    *("// x @Sense", "/* ", "*/", "# x", '"', "bool f();", "f(", "@Signature X g(Y y)", "@Guard"),
    *("\x0b", "\t", "\xa0", "\u2028", "\ufeff", "ä", "机", "\ud800", "\n", "\n\n", " ", "@", "@é"),
)


def blocks_together(path: str, text: str) -> Blocks:
    """Return the blocks of a text, each parsed without reuse of a similar one."""
    lines = block_lines(text)
    return Blocks(*read_modules(block_source(path, text, lines)), lines)


def mutated(seed: int) -> str:
    """Return blocks, some of them alike, with random changes."""
    rng = random.Random(seed)
    blocks = [rng.choice((BLOCK, BLOCK, FULL)).format(name=name) for name in "ABCDÖ"]
    parts = rng.sample(blocks, rng.randint(1, 5))
    parts.insert(rng.randrange(len(parts) + 1), rng.choice(("", "\n", "A uses_data_from B\n")))
    text = "".join(parts)
    for _ in range(rng.choice((0, 1, 1, 2, 3, 8))):
        at = rng.choice(
            [rng.randrange(len(text) + 1), *(n for n, c in enumerate(text) if c == "\n")]
        )
        text = text[:at] + rng.choice(PUT) + text[at + rng.choice((0, 0, 0, 1, 20)) :]
    # One block is always there: a text without any block is not searched.
    return f"{text}\n{BLOCK.format(name='E')}"


@pytest.mark.parametrize("first", [300 * each for each in seeds(2, 4)])
def test_changed_blocks_are_read_as_all_blocks_together(first: int) -> None:
    for seed in range(first, first + 300):
        text = mutated(seed)
        assert read_blocks("a.mars", text) == blocks_together("a.mars", text), seed


def test_files_are_read_as_all_blocks_together() -> None:
    for path in sorted((ROOT / "examples").rglob("*.mars")):
        text = path.read_text(encoding="utf-8")
        found = read_blocks("a.mars", text)
        if found.lines:
            assert found == blocks_together("a.mars", text), path


def test_a_block_with_another_name_is_not_read_again(monkeypatch: Patch) -> None:
    words = ("A", "B_1", "/robot/front-left", "Ä")
    names = [name for word in words for name in (word, f"{word}2")]
    blocks = zip(names, (BLOCK, FULL) * 4, strict=True)
    text = "".join(block.format(name=name) for name, block in blocks)
    read: list[Source] = []

    def counted(source: Source) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
        read.append(source)
        return read_modules(source)

    monkeypatch.setattr("mars_asp.annotations.alike.read_modules", counted)
    found = read_blocks("a.mars", text)
    assert len(read) == 2
    assert [module.name for module in found.modules] == names
    assert found == blocks_together("a.mars", text)


@pytest.mark.parametrize("line", ["@foo", "@module_name B", "x @foo", "@Sense", "@sense", "@Guard"])
def test_blocks_with_a_wrong_or_unusual_line_are_not_alike(line: str) -> None:
    text = BLOCK.format(name="A").replace("@module_end", f"{line}\n@module_end")
    assert not read_alike("a.mars", text.split("\n"), block_lines(text))
