"""Declarations are read from short stretches; where these end decides nothing."""

import random

import pytest

from mars_asp.annotations.comments import blanked
from mars_asp.annotations.declarations import SourceDeclaration, read_declaration
from mars_asp.annotations.following import following
from mars_asp.annotations.sources import Source
from tests.annotations.test_declarations import LANGUAGES, written
from tests.support.generated import GENERATORS

#: Longer than the longest of the stretches that are tried first.
TAIL = "\n" * 5000
#: Forms whose tail could be taken for the declaration's end, where reading pauses within.
TAILS = {
    "cpp": [
        "auto build(Scan s) noexcept(noexcept(Map{})) -> Map { return {}; }",
        "auto build(Scan s) noexcept(f([] { return 1; })) -> std::vector<Map>;",
        "int build(s, n)\nstruct Scan *s;\nint n;\n{ return 0; }",
        "Map build(Scan, Imu);",
    ],
    "rust": ["fn build(s: Scan) -> [Map; 4] { x }", "fn build(s: [u8; 4]) -> ([A; 2], B);"],
    "go": [
        "func build(s Scan) map[string]struct{} {\n}",
        "func build(s Scan) (interface{ Close() error }, error) {\n}",
    ],
}


def reading(found: object) -> object:
    if isinstance(found, SourceDeclaration):
        return found.name, found.output, found.parameters
    return found


@pytest.mark.parametrize("language", LANGUAGES)
def test_where_reading_pauses_changes_nothing(language: str) -> None:
    key = {"cpp": "c"}.get(language, language)
    rng = random.Random(language)
    some = [GENERATORS[language](rng) for _ in range(12)] + written(language)[:12]
    for declaration in some + TAILS.get(language, []):
        whole = read_declaration(key, declaration + "\n", blanked(key, declaration + "\n"))
        if not isinstance(whole, SourceDeclaration):
            continue
        step = 1 if declaration in TAILS.get(language, []) else 17
        for before in range(max(0, 256 - len(declaration)), 256, step):
            text = "\n" * before + declaration + TAIL
            found = following(Source("a", key, text), 0, len(text)).found
            assert reading(found) == reading(whole), (before, declaration)
