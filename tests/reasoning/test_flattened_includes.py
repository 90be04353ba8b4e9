"""Instances and includes mean what modules with blocks of their own mean, in one file.

    python -m tests.reasoning.test_flattened_includes HOW_MANY [FIRST_SEED]

does the same for as many random robots as wanted. Both are written from one draft, neither from the
other, so nothing here knows how includes are taken in.
"""

import re
import sys
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import NamedTuple

import pytest

from mars_asp.language.print import print_relationship
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import seeds

#: What modules may be: their annotations, the ports that deliver, and those that take.
KINDS: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "Camera": ("@Sense NotifyAtFrequency 30\nImage look();\n", ("look",), ()),
    "Scanner": (
        "@Sense NotifyWhenReady\nImage scan();\n"
        "@Sense NotifyAtFrequency every 30 ms\nDepth range();\n",
        ("scan", "range"),
        (),
    ),
    "Mapper": (
        "@DataOut NotifyWhenReady\nMap draw(Depth depth, Image image);\n",
        ("draw",),
        ("depth", "image"),
    ),
    "Screen": ("@DataIn\nvoid show(Map map, Image image);\n", (), ("map", "image")),
    "Driver": ("@ControlOut\nCommand lead(Map map);\n", (), ("map",)),
    "Guard": ("@Guard\n@ControlOut\nCommand check();\n", (), ()),
    "Base": ("@Trans_Z\n@Rotn_Y\n", (), ()),
    "Gripper": ("@Grasp 0 80\n", (), ()),
}
CONVERTERS = {
    "Warp": "@Converts 2\nDepth warp(Image);\n",
    "Fold": "@Converts 3\nMap fold(Depth);\n",
}
WANTED = ("", "", " NotifyAtFrequency 10", " NotifyAtFrequency every 70 ms", " RequestWhenReady")
#: What files are included as; `None` is without a name.
PREFIXES = (None, "left", "right", "b c", "arm/2")


class End(NamedTuple):
    name: str
    port: str | None = None

    def __str__(self) -> str:
        both = (self.name,) if self.port is None else self
        return ".".join(f'"{n}"' if n and re.search(r"[^\w/-]", n) else str(n) for n in both)


class Line(NamedTuple):
    """A line, the file that it is in, and its number there."""

    file: str
    number: int
    left: End
    verb: str
    right: End
    rest: str


class Draft(NamedTuple):
    """A file: its own modules with their kinds, its lines, and its includes.

    `here` is whether blocks are in the file itself, else they are in a source that all share.
    """

    path: str
    names: dict[str, str | None]
    lines: list[Line]
    includes: "list[tuple[Draft, str | None]]"
    here: bool
    has_architecture: bool

    def kind(self, name: str) -> str:
        """Return the name of the block that describes a module of this file."""
        return f"{name}{ident(self.path)}" if self.here else f"Any{name}"


def ident(path: str) -> str:
    """Return a part of names for a file of its own."""
    return Path(path).parent.name.replace(".", "")


class Flat(NamedTuple):
    """The meaning of a draft in one file: modules with their kinds, lines, and converters.

    Converters are keyed by name and by whether a source, shared by all files, describes them.
    """

    names: dict[str, str | None]
    lines: dict[Line, None]
    converters: dict[tuple[str, bool], str]


def drawn(random: Random, folder: str = ".", deep: int = 2) -> Draft:
    """Draw a file; what it includes may be included again further up."""
    includes: list[tuple[Draft, str | None]] = []
    for number in range(random.randint(1, 2) if deep else 0):
        known = [each for inner, _ in includes for each, _ in inner.includes]
        inner = drawn(random, f"{folder}_{number}".lstrip("."), random.randint(0, deep - 1))
        if known and random.random() < 0.4:
            inner = random.choice(known)
        some = random.sample(PREFIXES, random.choice([1, 1, 2]))
        includes += [(inner, prefix) for prefix in some]
    here, declared = random.random() < 0.5, random.random() < 0.3
    draft = Draft(f"{folder}/part.mars", {}, [], includes, here, declared)
    for kind in random.sample([*KINDS, *KINDS, None, "Base", "Driver"], random.randint(2, 5)):
        called = f"{random.choice(['', '', '/'])}{kind or 'Stranger'}-{ident(draft.path)}"
        called += f"x{len(draft.names)}"
        if kind is not None and random.random() < 0.5:
            called = draft.kind(kind)
        draft.names[called] = kind
    every = flat(draft).names
    pairs = [(a, b) for a in every for b in every if a != b]
    for number in range(random.randint(1, 8)):
        line = related(random, every, random.choice(pairs)) if pairs else None
        if line is not None:
            draft.lines.append(line._replace(file=draft.path, number=number))
    return draft


def related(random: Random, every: dict[str, str | None], pair: tuple[str, str]) -> Line | None:
    left, right = pair
    client, source = every[left], every[right]
    if client in ("Base", "Gripper", "Guard") and source in ("Driver", "Guard", None):
        rest = random.choice(["", " 1", " 2", " 3 hold 50", " 1 hold forever"])
        return Line("", 0, End(left), "is_controlled_by", End(right), rest)
    if client == "Gripper" and source == "Base":
        rest = random.choice([" (_,_,_,_,_,100)", "", " (y,90,_,_,_,_,10)"])
        return Line("", 0, End(left), "is_mounted_on", End(right), rest)
    delivering = ("data",) if source is None else KINDS[source][1]
    taking = ("data",) if client is None else KINDS[client][2]
    if not delivering or not taking:
        return None
    several = len(delivering) > 1 and random.random() < 0.9
    output = random.choice(delivering) if several or random.random() < 0.3 else None
    entry = random.choice([None, random.choice(taking)])
    return Line(
        "", 0, End(left, entry), "uses_data_from", End(right, output), random.choice(WANTED)
    )


def flat(draft: Draft) -> Flat:
    """Expand a draft by hand."""
    found = Flat({}, {}, {})
    for inner, prefix in draft.includes:
        part = flat(inner)

        def named(name: str, prefix: str | None = prefix) -> str:
            if prefix is None:
                return name
            return f"/{prefix}{name}" if name[0] == "/" else f"{prefix}/{name}"

        found.names.update({named(name): kind for name, kind in part.names.items()})
        for line in part.lines:
            left, right = (end._replace(name=named(end.name)) for end in (line.left, line.right))
            found.lines[line._replace(left=left, right=right)] = None
        for (name, shared), text in part.converters.items():
            found.converters[name if shared else named(name), shared] = text
    found.names.update(draft.names)
    found.lines.update(dict.fromkeys(draft.lines))
    for name, text in CONVERTERS.items():
        found.converters[draft.kind(name), not draft.here] = text
    return found


def block(name: str, body: str) -> str:
    return f"@module_start\n@module_name {End(name)}\n{body}@module_end\n"


def in_one(draft: Draft, architecture: str) -> str:
    whole = flat(draft)
    lines = [f"{e.left} {e.verb} {e.right}{e.rest}" for e in whole.lines]
    blocks = {name: KINDS[kind][0] for name, kind in whole.names.items() if kind is not None}
    blocks |= {name: text for (name, _), text in whole.converters.items()}
    names = ", ".join(str(End(name)) for name in whole.names)
    written = [block(name, text) for name, text in blocks.items()]
    return "\n".join([f"@configuration {architecture}", f"@modules {names}", *lines, *written])


def in_files(draft: Draft, folder: Path, architecture: str) -> Path:
    """Write a draft as the files that it is about, and return the first."""
    path = folder / draft.path
    path.parent.mkdir(exist_ok=True)
    texts = {name: text for name, (text, _, _) in KINDS.items()} | CONVERTERS
    blocks = "".join(block(draft.kind(name), text) for name, text in texts.items())
    if not draft.here:
        (folder / "kinds.hpp").write_text(re.sub(r"(?m)^@", "// @", blocks))
    up = "" if path.parent == folder else "../"
    lines = [f"@configuration {architecture if draft.has_architecture or not up else ''}".rstrip()]
    lines += [] if draft.here else [f"@sources {up}kinds.hpp"]
    for inner, prefix in draft.includes:
        in_files(inner, folder, architecture)
        lines.append(f"@include {up}{inner.path}")
        lines[-1] += "" if prefix is None else f" as {End(prefix)}"
    names = (
        f"{End(name)}"
        if kind is None or draft.kind(kind) == name
        else f"{End(name)}: {End(draft.kind(kind))}"
        for name, kind in draft.names.items()
    )
    lines.append(f"@modules {', '.join(names)}")
    lines += [f"{e.left} {e.verb} {e.right}{e.rest}" for e in draft.lines]
    path.write_text("\n".join([*lines, blocks if draft.here else ""]))
    return path


def result_of(path: str, text: str | None = None) -> tuple[object, ...]:
    """Return the findings of a file, and the cost and the lines of its specification."""
    reasoner = Reasoner(load_project(path, text=text), RULEBOOK)
    found = sorted(
        (each.kind, each.severity, each.subject, *each.participants, each.message)
        for each in reasoner.analysis.consequences
    )
    synthesis = reasoner.synthesis
    if synthesis is None:
        return (found, None)
    specification = synthesis.specification.configuration
    assert reasoner.verify(specification) == ()
    lines = sorted(map(print_relationship, specification.relationships))
    return (found, synthesis.resolution.cost, synthesis.resolution.count, lines)


RULEBOOK = load_rulebook(stages=("resolve", "verify"))


def compare(seed: int, folder: Path) -> str | None:
    """Return the difference between a robot in several files and in one."""
    random = Random(seed)
    architecture = random.choice(["flat", "hierarchical"])
    draft = drawn(random)
    parts = result_of(str(in_files(draft, folder, architecture)))
    whole = result_of("robot.mars", in_one(draft, architecture))
    return None if parts == whole else f"{parts}\n  in one file: {whole}"


@pytest.mark.parametrize("seed", seeds(2, 16))
def test_an_include_means_the_same_as_its_text_in_place(seed: int, tmp_path: Path) -> None:
    assert compare(seed, tmp_path) is None


def main(words: list[str]) -> int:
    many, first = (int(word) for word in (*words, "0")[:2])
    wrong = 0
    for seed in range(first, first + many):
        with TemporaryDirectory() as folder:
            difference = compare(seed, Path(folder))
        if difference is not None:
            wrong += 1
            print(f"seed {seed}: {difference}", flush=True)
    print(f"{many} robots from seed {first}, {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
