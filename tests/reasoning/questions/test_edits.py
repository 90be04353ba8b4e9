"""Edits as they are written: of each the lines that change, and the text that comes out."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

import pytest
from clingo import parse_term

from mars_asp.annotations.directives import MOST_OTHERS
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import MarsError
from mars_asp.language.text_edits import LineEdit
from mars_asp.model.declarations import Service, ends_of, verb_of
from mars_asp.model.described import described_modules
from mars_asp.reasoning.facts.identifiers import numbered_annotations
from mars_asp.reasoning.project import load_project, revised
from mars_asp.reasoning.questions.annotation_edits import read
from mars_asp.reasoning.questions.edits import (
    EditedTexts,
    ImpossibleEditError,
    UnknownEditError,
    apply_edits,
)
from tests.support.applied_repairs import applied
from tests.support.documents import ROOT
from tests.support.fixtures import Patch

CASES = sorted((ROOT / "tests/edits").glob("*/"))


@pytest.mark.parametrize("folder", CASES, ids=lambda path: path.name)
def test_cases(folder: Path, monkeypatch: Patch, update_golden: bool) -> None:
    """Lines of `edits.txt` are edits, those of one set separated by `;`, with the effects below.

    `{A verb B}` and `{A @Word}` are the identifiers of a relationship and of an annotation.
    """
    monkeypatch.chdir(folder)
    texts = EditedTexts(load_project("config.mars"))
    expected = (folder / "edits.txt").read_text()
    edits = [line for line in expected.splitlines() if not line.startswith(" ")]
    found = "".join(f"{line}\n{''.join(_changed_lines(texts, line))}" for line in edits)
    if update_golden:
        (folder / "edits.txt").write_text(found)
    assert found == expected


def _changed_lines(texts: EditedTexts, written: str) -> Iterator[str]:
    names = _identifiers(texts)
    terms = re.sub(r"\{(.*?)\}", lambda match: str(names[match[1]]), written)
    try:
        lines, changed = apply_edits(texts, [parse_term(term) for term in terms.split(";")])
    except (ImpossibleEditError, UnknownEditError) as error:
        yield f"  {type(error).__name__}\n"
        return
    for path, text in changed.items():
        edits = [asdict(line) for line in lines if line.path == path]
        assert applied(texts.text(path).encode(), edits).decode() == text
    for line in lines:
        yield from _shown(line)
    try:
        revised(texts.project, changed)
    except MarsError as error:
        yield f"  cannot be read: {error.diagnostics[0].message}\n"


def _identifiers(texts: EditedTexts) -> Mapping[str, int]:
    project, names = texts.project, {}
    for number, declared in texts.relationships.items():
        first, second = ends_of(declared)
        names[f"{first} {verb_of(declared)} {second}"] = number
    described = described_modules(project.configuration, project.modules)
    for number, module, annotation in numbered_annotations(project.configuration, described):
        word = annotation.kind if isinstance(annotation, Service) else annotation.name
        names[f"{module.name} @{word}"] = number
    return names


def _shown(line: LineEdit) -> Iterator[str]:
    where = f"{line.where} " if line.where else ""
    if line.old is not None:
        yield f"  - {line.path}:{line.line}:{line.column}: {line.old}\n"
    for text in [] if line.new is None else line.new.split("\n"):
        yield f"  + {where}{line.path}:{line.line}: {text}\n"


def test_annotations_are_read_beside_very_many_words_of_others() -> None:
    words = [f"// @other{number}" for number in range(MOST_OTHERS + 1)]
    text = "\n".join(["// @module_start", "// @module_name A", "// @module_end", *words])
    found = read(Source("a.c", "c", text))
    assert [each.word for each in found.directives] == ["module_start", "module_name", "module_end"]
    assert found.places == {(1, 4): 0, (2, 4): 1, (3, 4): 2}
