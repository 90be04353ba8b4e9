"""Every command in the documentation prints what the documentation shows."""

import re
from pathlib import Path

import pytest

from docs.make_reference import pages
from mars_asp.annotations.languages import LANGUAGES
from tests.support.documents import ROOT, commands, refresh, run

#: Its commands are run in an empty folder, step by step.
TUTORIAL = ROOT / "docs/tutorial/packs.md"
DOCUMENTS = [
    ROOT / "README.md",
    *(page for page in sorted(ROOT.glob("docs/**/*.md")) if page != TUTORIAL),
    ROOT / "examples" / "README.md",
    *sorted(ROOT.glob("examples/*/README.md")),
    *sorted(ROOT.glob("examples/packs/*/README.md")),
    ROOT / "mars_asp" / "asp" / "README.md",
    ROOT / "rules" / "README.md",
]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_commands_print_what_is_shown(document: Path, update_golden: bool) -> None:
    if update_golden:
        refresh(document)
    for command, shown in commands(document):
        assert run(command) == shown, command


def test_the_campaigns_of_the_case_study_work() -> None:
    """Each with one seed, 1 s and the first of its values; the page keeps what 200 seeds show."""
    page = (ROOT / "docs" / "case-study.md").read_text(encoding="utf-8")
    campaigns = re.findall(r"^mars-asp campaign .*", page, re.MULTILINE)
    assert campaigns
    for command in campaigns:
        short = re.sub(r"--vary duration=\S+| -o \S+| --plot \S+", "", command)
        short = re.sub(r"(=[^,\s]+),\S+", r"\1", re.sub(r"1-\d+00", "1", short))
        told = run(f"{short} --vary duration=1")
        assert re.search(r"^passed +[01] of 1 ", told, re.MULTILINE), command


@pytest.mark.parametrize("name", pages())
def test_the_reference_is_what_parsers_and_rules_make(name: str, update_golden: bool) -> None:
    path, text = ROOT / "docs" / "reference" / name, pages()[name]()
    if update_golden:
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text


def test_each_page_of_the_reference_is_made_or_written() -> None:
    written = {"language.md"}
    found = (ROOT / "docs/reference").rglob("*.md")
    assert {path.relative_to(ROOT / "docs/reference").as_posix() for path in found} == {
        *pages(),
        *written,
    }


LINK = re.compile(r"\]\(([^)#]+)[^)]*\)")


def linked(page: Path) -> set[Path]:
    """Return the files that a page links to; none of those of the web."""
    links = LINK.findall(page.read_text(encoding="utf-8"))
    return {(page.parent / link).resolve() for link in links if "://" not in link}


def test_each_page_is_two_clicks_from_the_readme_and_no_link_is_dead() -> None:
    first = linked(ROOT / "README.md")
    pages_of_them = [page for page in first if page.suffix == ".md"]
    reached = {ROOT / "README.md"}.union(first, *map(linked, pages_of_them))
    assert not [page for page in reached if not page.exists()]
    assert not [page for page in (*DOCUMENTS, TUTORIAL) if page.resolve() not in reached]


def test_each_page_has_a_place_in_the_site() -> None:
    """Else `make site` ends with a warning, and few run it."""
    listed = set(re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE))
    pages_of_site = (path.relative_to(ROOT).as_posix() for path in (*DOCUMENTS, TUTORIAL))
    assert not set(pages_of_site) - listed
    assert not [path for path in listed if not (ROOT / path).is_file()]


ANNOTATIONS = ROOT / "docs" / "annotations.md"
SUFFIXES = {
    "c": "c", "cpp": "cpp", "python": "py", "java": "java", "rust": "rs", "go": "go", "matlab": "m"
}  # fmt: skip
#: A source, and behind it what is extracted from it.
SOURCE = re.compile(rf"(?ms)^```({'|'.join(SUFFIXES)})\n(.*?)^```\n\n```text\n(.*?)^```$")


def test_every_language_has_an_example() -> None:
    shown = [match[1] for match in SOURCE.finditer(ANNOTATIONS.read_text(encoding="utf-8"))]
    assert sorted(shown) == sorted(SUFFIXES)
    assert {LANGUAGES[f".{suffix}"] for suffix in SUFFIXES.values()} == set(LANGUAGES.values())


def test_examples_of_annotated_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, update_golden: bool
) -> None:
    """Each source gives what is shown below it."""
    monkeypatch.chdir(tmp_path)

    def extracted(match: re.Match[str]) -> str:
        name = f"example.{SUFFIXES[match[1]]}"
        Path(name).write_text(match[2], encoding="utf-8")
        printed = run(f"mars-asp extract {name}", tmp_path)
        return f"```{match[1]}\n{match[2]}```\n\n```text\n{printed}```"

    text = ANNOTATIONS.read_text(encoding="utf-8")
    if update_golden:
        ANNOTATIONS.write_text(SOURCE.sub(extracted, text), encoding="utf-8")
    for match in SOURCE.finditer(ANNOTATIONS.read_text(encoding="utf-8")):
        assert extracted(match) == match[0]


@pytest.mark.parametrize("folder", sorted(ROOT.glob("examples/*/")), ids=lambda path: path.name)
def test_every_example_shows_a_command(folder: Path) -> None:
    # Those of the engine are told beside it.
    place = ROOT / "mars_asp" / "asp" if folder.name == "engine" else folder
    assert list(commands(place / "README.md"))
