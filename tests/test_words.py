"""Messages, the reasons of rules and the documents are written in plain English."""

import ast
import re
from collections.abc import Iterator

import pytest

from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.support.documents import ROOT
from tests.support.figures import CODE, PATTERNS
from tests.test_documents import DOCUMENTS


def texts(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield each text of a module but docstrings, with its line; holes as `{}`."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue
        if isinstance(node, ast.JoinedStr):
            pieces = (v.value if isinstance(v, ast.Constant) else "{}" for v in node.values)
            yield node.lineno, "".join(str(piece) for piece in pieces)
            # The value of a hole may be a text: a plural, or a word for zero.
            for value in node.values:
                yield from texts(value)
        elif isinstance(node, ast.Constant):
            if isinstance(node.value, str):
                yield node.lineno, node.value
        else:
            yield from texts(node)


def faults(text: str) -> Iterator[str]:
    """Yield the bad wording of a text, each with its correction."""
    prose = CODE.sub("`x`", text)
    # A single word is a key, and a text without words a pattern.
    for pattern, better in PATTERNS.items() if " " in prose.strip() else ():
        if found := re.search(pattern, prose):
            yield f"{found[0]!r} in {text!r}: {better}"


def test_messages_of_the_package() -> None:
    package = ROOT / "mars_asp"
    found = []
    for path in sorted(package.rglob("*.py")):
        for line, text in texts(ast.parse(path.read_text(encoding="utf-8"))):
            found += [f"{path.relative_to(ROOT)}:{line}: {fault}" for fault in faults(text)]
    assert not found, "\n".join(found)


def test_messages_of_the_rules() -> None:
    rules = load_rulebook(stages=STAGES).built_in.rules
    found = [
        f"{rule.span.path}:{rule.span.line}: {fault}"
        for rule in rules
        for text in (rule.because, rule.help, rule.why)
        if text is not None
        for fault in faults(text)
    ]
    assert not found, "\n".join(found)


BLOCK = re.compile(r"(?ms)^```.*?^```|<!--.*?-->")


def test_documents() -> None:
    found = [
        f"{document.relative_to(ROOT)}: {fault}"
        for document in DOCUMENTS
        for paragraph in BLOCK.sub("", document.read_text(encoding="utf-8")).split("\n\n")
        for fault in faults(paragraph)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("text", "bad"),
    [
        ("`x` is no vertex", True),
        ("there is no vertex", False),
        ("it is no longer needed", False),
        ("left out, for it is empty", True),
        ("a file, for example", False),
        ("the `behind x` of a line", False),
        ("{} collision(s)", True),
        ("behind", False),
    ],
)
def test_faults_of_wording(text: str, bad: bool) -> None:
    assert any(faults(text)) == bad


def test_texts_are_found_in_holes_and_docstrings_left_out() -> None:
    source = '"""Says so."""\nx = f"a {y} b {\'no c\' if y else z}"\n'
    assert list(texts(ast.parse(source))) == [(2, "a {} b {}"), (2, "no c")]
