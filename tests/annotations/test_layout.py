"""White space, comment style, line ends and wrapped lines never change the extracted modules."""

import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mars_asp.annotations.comments import tokens
from mars_asp.annotations.files import extract
from mars_asp.annotations.languages import LANGUAGES
from tests.support.campaigns import IS_CAMPAIGN
from tests.support.generated import GENERATORS

SUFFIXES = {
    "c": ".c",
    "cpp": ".cpp",
    "go": ".go",
    "java": ".java",
    "matlab": ".m",
    "python": ".py",
    "rust": ".rs",
}
SERVICES = [
    "@Sense NotifyWhenReady",
    "@Sense NotifyAtFrequency 12.5, RequestWhenReady",
    "@DataOut NotifyOnMin(300, of=nearest), NotifyOnChange, NotifyAtFrequency 5",
    "@ControlOut Rotn_Y, Trans_Z",
    "@ControlOut",
    "@DataIn",
    "@Converts 3",
    "@Sense NotifyAtFreqency 12",
    "@DataOut",
]
BESIDE = ["@Output Map", "@Input none", "@Output none", "@Input Scan, Imu", "@Input x: Scan"]
ALONE = ["@Rotn_Y -90 90 30", "@Trans_Z _ 5", "@Vertex 2 (_,_,_,_,0,0,100)", "@Grasp 0"]
#: What may begin each line of an annotation, and the brackets of a whole block of lines.
LINES = {"python": ("# ", "#", "##", "#\t"), "matlab": ("% ", "%", "%%")}
C_LINES = ("// ", "//", "/// ", "//! ", "//\t")
BLOCKS = {
    "python": (),
    "matlab": (("%{\n", "", "\n%}"), ("  %{\n", "   ", "\n%}\t")),
}
C_BLOCKS = (
    ("/* ", " * ", "\n */"),
    ("/**\n * ", "\t*", " */"),
    ("/*!", "   ", "*/"),
    ("/*", "", "\n*/"),
)


def plain(modules: list[tuple[list[str], list[tuple[list[str], str]]]], marks: str) -> str:
    """Write modules one line each, without anything that could be left out."""
    return "".join(
        "".join(f"{marks} {line}\n" for line in head)
        + "".join(
            "".join(f"{marks} {line}\n" for line in annotations) + declaration + "\n"
            for annotations, declaration in functions
        )
        + f"{marks} @module_end\n"
        for head, functions in modules
    )


def spaced(rng: random.Random, line: str) -> list[str]:
    """Write an annotation with other blanks, cut at some commas, with a remark here and there."""
    pieces = [""]
    for character in line:
        pieces[-1] += rng.choice([" ", "  ", "\t "]) if character == " " else character
        if character == "," and line.startswith(("@S", "@D")) and rng.random() < 0.3:
            pieces.append(rng.choice(["", "   "]))
    if rng.random() < 0.3:
        pieces[-1] += rng.choice([" -- as it is", "  --", " -- @Sense of it, too"])
    return [piece + rng.choice(["", " "]) for piece in pieces]


def commented(rng: random.Random, language: str, lines: list[str]) -> Iterator[str]:
    """Write annotations in one of the comment styles of a language."""
    at = 0
    while at < len(lines):
        blocks = BLOCKS.get(language, C_BLOCKS)
        if blocks and rng.random() < 0.5:
            opening, mark, closing = rng.choice(blocks)
            count = rng.randint(1, len(lines) - at)
            inside = [piece for line in lines[at : at + count] for piece in spaced(rng, line)]
            yield opening + f"\n{mark}".join(inside) + closing
            at += count
            continue
        mark = rng.choice(LINES.get(language, C_LINES))
        for piece in spaced(rng, lines[at]):
            yield rng.choice(["", "", "\t", "    "]) + mark + piece
        at += 1
        if rng.random() < 0.2:
            yield rng.choice(["", f"{mark} see the manual", f"{mark}", "\t"])


def gaps(language: str, declaration: str) -> Iterator[tuple[int, int, bool]]:
    """Yield the gaps where a formatter may put something: begin, end, whether lines may end."""
    held = [0] * len(declaration)
    for begin, end, _ in tokens(language, declaration):
        held[begin:end] = [1] * (end - begin)
    depth, at = 0, 0
    last = declaration.find("\n") if language == "matlab" else len(declaration)
    while at < (last if last >= 0 else len(declaration)):
        character = declaration[at]
        depth += (character in "([{") - (character in ")]}")
        end = at
        while end < len(declaration) and declaration[end] in " \t\n" and not held[end]:
            end += 1
        opens = not held[at] and character in "(,"
        if end > at or opens:
            begin, after = (at, end) if end > at else (at + 1, at + 1)
            free = language in ("c", "java", "rust", "matlab") or depth > 0
            if language == "go":
                free = free and declaration[begin - 1 : begin] in ("(", ",")
            yield begin, after, free
        at = max(end, at + 1)


def wrapped(rng: random.Random, language: str, declaration: str) -> str:
    """Write a declaration with other blanks, line ends and comments in its gaps."""
    ends = {"python": "\n        ", "matlab": " ...\n  "}.get(language, "\n    ")
    remark = {"python": "  # or so\n  ", "matlab": " ... or so\n"}.get(language, " // or so\n\t")
    pieces, last = [], 0
    for begin, end, free in gaps(language, declaration):
        if "\n" in declaration[begin:end] and not free:
            continue
        choices = [declaration[begin:end], "  ", "\t", *([ends, ends, remark] if free else [])]
        pieces += [declaration[last:begin], rng.choice(choices)]
        last = end
    return "".join(pieces) + declaration[last:]


def extracted(path: Path, data: bytes) -> list[object]:
    path.write_bytes(data)
    found = extract([path])
    return [
        *(
            (
                module.name,
                [(s.kind, s.function, s.output, s.inputs, s.modes, s.hz, s.commands, s.cost)
                 for s in module.services],
                [(f.name, f.min, f.max, f.rate) for f in module.functions],
                [(v.number, v.transformation) for v in module.vertices],
            )
            for module in found.modules
        ),
        sorted(problem.code for problem in found.diagnostics),
    ]  # fmt: skip


@pytest.mark.parametrize("name", sorted(SUFFIXES))
@settings(
    max_examples=60 if IS_CAMPAIGN else 8,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(rng=st.randoms(use_true_random=False))
def test_layout_is_nothing(tmp_path: Path, name: str, rng: random.Random) -> None:
    language = LANGUAGES[SUFFIXES[name]]
    modules = []
    for number in range(rng.randint(1, 2)):
        head = ["@module_start", f"@module_name M{number}", *rng.sample(ALONE, rng.randint(0, 2))]
        functions = [
            (
                [*rng.sample(SERVICES, rng.randint(1, 2)), *rng.sample(BESIDE, rng.randint(0, 1))],
                GENERATORS[name](rng),
            )
            for _ in range(rng.randint(0, 2))
        ]
        modules.append((head, functions))
    marks = {"python": "#", "matlab": "%"}.get(language, "//")
    path = tmp_path / f"a{SUFFIXES[name]}"
    expected = extracted(path, plain(modules, marks).encode())
    lines: list[str] = []
    for head, functions in modules:
        lines += commented(rng, language, head)
        for annotations, declaration in functions:
            lines += commented(rng, language, annotations)
            lines.append(wrapped(rng, language, declaration))
        lines += commented(rng, language, ["@module_end"])
    text = "\n".join(lines) + rng.choice(["", "\n"])
    end = rng.choice(["\n", "\r\n", "\r"])
    mark = rng.choice(["", "\ufeff"])
    found = extracted(path, (mark + text.replace("\n", end)).encode())
    assert found == expected, f"{plain(modules, marks)}\n----\n{text}"
