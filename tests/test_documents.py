"""Every command in the documentation prints what the documentation shows."""

import re
import shlex
from pathlib import Path
from runpy import run_path

import pytest

from docs.reference.make_reference import pages
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


STUDY = ROOT / "docs" / "explanation" / "case-study.md"
BLOCK = run_path(str(ROOT / "benchmarks" / "case_study.py"))["BLOCK"]
SIGN_TEST = run_path(str(ROOT / "benchmarks" / "sign_test.py"))


def test_the_commands_of_the_case_study_work(tmp_path: Path) -> None:
    """Each with one seed, 1 s and the first of its values; the page keeps what 200 seeds show."""
    blocks = [shlex.split(command) for command in BLOCK.findall(STUDY.read_text(encoding="utf-8"))]
    tested = {(words[2], words[3]) for words in blocks if words[0] == "python"}
    assert len(tested) > 10
    for words in blocks:
        if words[0] == "python":
            file, what = (f"{tmp_path}/{each}" if "jsonl" in each else each for each in words[2:])
            counts = re.findall(r": of (\d+) worlds$", told_by(file, what), re.MULTILINE)
            assert counts and {*counts} == {"1"}, words
            continue
        file = words[words.index("-o") + 1]
        short = "duration=1"
        for word in words[1:]:
            key, equals, values = word.partition("=")
            if equals and key != "duration":
                kept = values if (file, key) in tested else values.split(",")[0]
                short += f" --vary {key}={kept}"
        scenario = words[words.index("--scenario") + 1]
        given = f"{words[2]} --scenario {scenario} --seeds 1 -o {tmp_path}/{file}"
        told = run(f"mars-asp campaign {given} --vary {short}")
        assert re.search(r"^passed +\d of \d ", told, re.MULTILINE), words


def told_by(file: str, what: str) -> str:
    return "\n".join(SIGN_TEST["lines"](SIGN_TEST["compared"](Path(file), what)))


def test_numbers_in_the_case_study_are_in_what_its_commands_print() -> None:
    """Or in the scenarios and sources that they run."""
    page = STUDY.read_text(encoding="utf-8")
    blocks = "".join(re.findall(r"^```.*?^```$", page, re.MULTILINE | re.DOTALL))
    prose = re.sub(r"^```.*?^```$|\[[^]]*\]\([^)]*\)", "", page, flags=re.MULTILINE | re.DOTALL)
    folders = [ROOT / "examples" / name for name in ("level0", "level1")]
    files = [
        path for folder in folders for path in (*folder.glob("*.toml"), *folder.glob("*/*.py"))
    ]
    known = {*NUMBER.findall(blocks), *NUMBER.findall("".join(path.read_text() for path in files))}
    assert {*NUMBER.findall(prose)} - known == {*ELSEWHERE.split()}


#: Whole or with a fraction.
NUMBER = re.compile(r"\d+(?:\.\d+)?")
#: Of the case study: the day, the bound of p, and 200 mm/s over 500 mm/s a second.
ELSEWHERE = "2026 11 23 26 0.05 0.0019 0.4"


def test_the_sign_test_is_that_of_fair_coins() -> None:
    probability = SIGN_TEST["probability"]
    assert probability(1, 8) == 20 / 512  # 2 * (1 + 9) of 2^9
    assert probability(0, 0) == probability(3, 3) == 1
    assert probability(60, 0) == 2 / 2**60


@pytest.mark.parametrize("name", pages())
def test_the_reference_is_what_parsers_and_rules_make(name: str, update_golden: bool) -> None:
    path, text = ROOT / "docs" / "reference" / name, pages()[name]()
    if update_golden:
        path.write_text(text, encoding="utf-8")
    assert path.read_text(encoding="utf-8") == text


def test_each_page_of_the_reference_is_made_or_written() -> None:
    written = {"glossary.md", "language.md"}
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


ANNOTATIONS = ROOT / "docs" / "reference" / "annotations.md"
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
