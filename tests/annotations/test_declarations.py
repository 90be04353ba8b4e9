"""Our declaration scanners against tree-sitter: written declarations, then generated ones.

tree-sitter reads whole files and knows no macros; where it reports an error, or deviates from the
language, the right reading is stated here.
"""

import random
import re

import pytest

from mars_asp.annotations.comments import blanked
from mars_asp.annotations.declarations import NoFunction, SourceDeclaration, read_declaration
from tests.support.documents import ROOT
from tests.support.generated import GENERATORS
from tests.support.oracle import Reading, ask, normalised

FOLDER = ROOT / "tests" / "declarations"
LANGUAGES = ["c", "cpp", "go", "java", "matlab", "python", "rust"]
#: Forms that span lines are parted by what begins the next one.
BEGINNING = {
    "matlab": r"(?m)^(?=function)",
    "python": r"(?m)(?<=\.\.\.)\n|(?<=return s)\n",
    "c": r"(?<=[;}])\n",
    "cpp": r"(?<=[;}])\n",
}
#: The right readings where tree-sitter is wrong: it ignores types after the brackets (K&R), takes a
#: returned pointer for the function, and `= 0` for the type.
RIGHT = {
    "int build(s, n) struct Scan *s; int n; { return 0; }": Reading(
        "build", (("s", "Scan*"), ("n", "int")), "int"
    ),
    "Map build(a, b, c) int a, *b; Scan c[3]; { }": Reading(
        "build", (("a", "int"), ("b", "int*"), ("c", "Scan[]")), "Map"
    ),
    "int old(s, i) const struct Scan *s; Imu i; { return 0; }": Reading(
        "old", (("s", "Scan*"), ("i", "Imu")), "int"
    ),
    "void (*handler(int signal, void (*old)(int)))(int);": Reading(
        "handler", (("signal", "int"), ("old", "function")), "function"
    ),
    # Both are right; an array's reference is the array, and `decltype(auto)` is `auto`, to us.
    "Map build(Scan s, int (&raw)[8]);": Reading("build", (("s", "Scan"), ("raw", "int[]")), "Map"),
    "decltype(auto) forward(T &&x);": Reading("forward", (("x", "T&&"),), "auto"),
}
#: How many of the generated declarations tree-sitter may fail to read.
MOST_UNREAD = 5
MEMBER = re.compile(r"virtual|friend|operator|= 0;|= delete;|\) (?:const|&|noexcept)")


def written(language: str) -> list[str]:
    text = (FOLDER / f"{language}.txt").read_text(encoding="utf-8")
    return [
        part.strip("\n") for part in re.split(BEGINNING.get(language, r"\n"), text) if part.strip()
    ]


def ours(language: str, text: str) -> Reading | NoFunction | None:
    key = {"cpp": "c"}.get(language, language)
    found = read_declaration(key, text, blanked(key, text))
    if not isinstance(found, SourceDeclaration):
        return found
    parameters = tuple((p.name, simple(p.type)) for p in found.parameters)
    return Reading(re.sub(r"\s+", "", found.name), parameters, simple(found.output))


def simple(kind: str | None) -> str | None:
    return "function" if kind == "std::function<void()>" else normalised(kind)


def wrapped(language: str, text: str) -> str:
    """Put a method where its language wants it."""
    if language == "cpp" and MEMBER.search(text) and "ns::Rig" not in text:
        return f"struct A {{ {text} }};"
    if language == "java":
        return f"abstract class A {{ {text} }}"
    if language == "rust":
        return f"trait A {{ {text} }}" if text.endswith(";") else f"impl A {{ {text} }}"
    return text


@pytest.mark.parametrize("language", LANGUAGES)
def test_written_declarations(language: str) -> None:
    for text in written(language):
        expected = RIGHT.get(text) or ask(language, wrapped(language, text))
        assert expected is not None, f"tree-sitter cannot read: {text}"
        assert ours(language, text) == expected, text


@pytest.mark.parametrize("language", LANGUAGES)
def test_generated_declarations(language: str) -> None:
    rng = random.Random(language)
    unread = 0
    for _ in range(150):
        text = GENERATORS[language](rng)
        expected = ask(language, wrapped(language, text))
        unread += expected is None
        assert expected is None or ours(language, text) == expected, text
    assert unread <= MOST_UNREAD
