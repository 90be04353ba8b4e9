"""Documents: commands print the output that pages show, links resolve, and lines are short."""

import re
import shlex
import subprocess
from functools import cache
from pathlib import Path
from runpy import run_path

import pytest

from docs.reference.make_reference import EXAMPLES, pages
from mars_asp.annotations.languages import LANGUAGES
from tests.support.documents import JSON, ROOT, commands, json_block, refresh, refresh_json, run
from tests.support.fixtures import Patch

#: Its commands are run in an empty folder, step by step.
TUTORIAL = ROOT / "docs/tutorial/packs.md"
MADE = {name: cache(text) for name, text in pages().items()}
DOCUMENTS = [
    ROOT / "README.md",
    *(
        page
        for page in sorted(ROOT.glob("docs/**/*.md"))
        if page != TUTORIAL and page.relative_to(ROOT).as_posix() not in MADE
    ),
    ROOT / "examples" / "README.md",
    *sorted(ROOT.glob("examples/*/README.md")),
    *sorted(ROOT.glob("examples/packs/*/README.md")),
    ROOT / "mars_asp" / "asp" / "README.md",
    ROOT / "rules" / "README.md",
]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_commands_print_the_shown_outputs(document: Path, update_golden: bool) -> None:
    if update_golden:
        refresh(document)
    for command, shown in commands(document):
        assert run(command) == shown, command


def test_shown_json_is_the_output_of_commands(update_golden: bool) -> None:
    page = ROOT / "docs/reference/json.md"
    if update_golden:
        refresh_json(page)
    blocks = JSON.findall(page.read_text(encoding="utf-8"))
    assert len(blocks) > 20
    for command, language, shown in blocks:
        assert json_block(command, language) == shown, command


STUDY = ROOT / "docs" / "explanation" / "case-study.md"
BLOCK = run_path(str(ROOT / "benchmarks" / "case_study.py"))["BLOCK"]
SIGN_TEST = run_path(str(ROOT / "benchmarks" / "sign_test.py"))


def test_the_commands_of_the_case_study_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each with one seed, 0.2 s and the first of its values; the page has results of 200 seeds."""
    blocks = [
        shlex.split(command.removeprefix("$ "))
        for commands in BLOCK.findall(STUDY.read_text(encoding="utf-8"))
        for command in commands.splitlines()
    ]
    tested = {(words[2], words[3]) for words in blocks if words[0] == "python"}
    assert len(tested) > 10
    for words in blocks:
        if words[0] == "python":
            files = (f"{tmp_path}/{each}" if "jsonl" in each else each for each in words[2:])
            SIGN_TEST["main"](*files)
            counts = re.findall(r": of (\d+) worlds$", capsys.readouterr().out, re.MULTILINE)
            assert counts and {*counts} == {"1"}, words
            continue
        file = words[words.index("-o") + 1]
        short = "duration=0.2"
        for word in words[1:]:
            key, equals, values = word.partition("=")
            if equals and key != "duration":
                kept = values if (file, key) in tested else values.split(",")[0]
                short += f" --vary {key}={kept}"
        scenario = words[words.index("--scenario") + 1]
        given = f"{words[2]} --scenario {scenario} --seeds 1 -o {tmp_path}/{file}"
        output = run(f"mars-asp campaign {given} --vary {short}")
        assert re.search(r"^passed +\d of \d ", output, re.MULTILINE), words


def test_numbers_in_the_case_study_are_in_the_output_of_its_commands() -> None:
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
#: Of the case study: the day, and the bound of p.
ELSEWHERE = "2026 11 23 37 0.05 0.0013"


def test_the_sign_test_is_that_of_fair_coins() -> None:
    probability = SIGN_TEST["probability"]
    assert probability(1, 8) == 20 / 512  # 2 * (1 + 9) of 2^9
    assert probability(0, 0) == probability(3, 3) == 1
    assert probability(60, 0) == 2 / 2**60


# ---- Pages, links and lines ----------------------------------------------------------------------

LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
FENCE = re.compile(r"^ *```.*?^ *```$", re.MULTILINE | re.DOTALL)


def links(page: str, text: str) -> set[Path]:
    """Return the files that a page links to, without those of the web."""
    folder = (ROOT / page).parent
    targets = LINK.findall(FENCE.sub("", text))
    return {(folder / target).resolve() for target in targets if "://" not in target}


def committed() -> list[Path]:
    """Return the pages of the repository."""
    words = ["git", "-C", str(ROOT), "ls-files", "-z", "*.md"]
    found = subprocess.run(words, check=False, capture_output=True, text=True)
    if found.returncode == 0 and found.stdout:
        return [ROOT / name for name in found.stdout.split("\0")[:-1] if (ROOT / name).exists()]
    folders = ("benchmarks", "docs", "editors", "examples", "mars_asp", "rules", "tests")
    found_in = (page for folder in folders for page in ROOT.glob(f"{folder}/**/*.md"))
    return [
        page
        for page in (*ROOT.glob("*.md"), *found_in)
        if page.relative_to(ROOT).as_posix() not in MADE
    ]


def test_no_made_page_is_committed() -> None:
    assert not {page.relative_to(ROOT).as_posix() for page in committed()} & MADE.keys()


def test_docs_hold_their_index_and_the_folders_of_the_site() -> None:
    names = {path.name for path in (ROOT / "docs").iterdir() if path.name != "__pycache__"}
    folders = {"tutorial", "how-to", "reference", "explanation", "decisions", "pictures"}
    assert names == {"README.md", *folders}


def test_committed_pages_link_to_committed_files() -> None:
    absent = {ROOT / name for name in MADE}
    for page in committed():
        linked = links(page.relative_to(ROOT).as_posix(), page.read_text(encoding="utf-8"))
        assert not {path for path in linked if path in absent or not path.exists()}, page


def test_made_pages_link_to_pages_and_files() -> None:
    known = {ROOT / name for name in MADE}
    for name, text in MADE.items():
        assert not {path for path in links(name, text()) if path not in known and not path.exists()}


def test_each_page_is_two_clicks_from_the_readme() -> None:
    """Decisions are in their list, which is made."""
    reached = {ROOT / "README.md"}
    for _ in range(2):
        for page in [path for path in reached if path.suffix == ".md"]:
            reached |= links(page.relative_to(ROOT).as_posix(), page.read_text(encoding="utf-8"))
    listed = "docs/decisions/README.md"
    reached |= links(listed, MADE[listed]())
    assert not [page for page in (*DOCUMENTS, TUTORIAL) if page.resolve() not in reached]


def test_each_page_has_a_place_in_the_site() -> None:
    """Else `make site` ends with a warning, and few run it."""
    listed = set(re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE))
    named = {page.relative_to(ROOT).as_posix() for page in (*DOCUMENTS, TUTORIAL)} | MADE.keys()
    decisions = "docs/decisions/"
    assert {name for name in named - listed if not name.startswith(decisions)} == set()
    assert not [name for name in listed if name not in MADE and not (ROOT / name).is_file()]


def test_each_kind_of_finding_has_a_file_that_a_user_writes() -> None:
    """Those of runs are the exception: a scenario of `judge-a-run.md` shows them."""
    page = MADE["docs/reference/findings.md"]()
    for kind, text in re.findall(r"(?ms)^## (\w+)$(.*?)(?=^## |\Z)", page):
        if kind in EXAMPLES:
            assert f": {kind}: " in " ".join(text.split()), kind
        else:
            assert set(re.findall(r"^### (\w+)/", text, re.MULTILINE)) == {"run"}, kind


def test_the_repository_has_at_most_10000_lines_of_markdown() -> None:
    assert sum(len(page.read_text(encoding="utf-8").splitlines()) for page in committed()) <= 10_000


def test_lines_end_at_120_columns() -> None:
    """But for output in a fence, and a link or code that cannot be broken."""
    long = []
    for page in committed():
        for line in FENCE.sub("", page.read_text(encoding="utf-8")).splitlines():
            if len(line) > 120 and len(UNBROKEN.sub("x", line).split()) > 2:
                long.append(f"{page.relative_to(ROOT)}: {line}")
    assert long == []


#: A link or code in a line.
UNBROKEN = re.compile(r"!?\[[^\]]*\]\([^)]*\)|`[^`]*`")
#: The end of a sentence within a line.
SENTENCE_END = re.compile(r"[a-z`)]\. +[A-Z`][a-z]")


def test_a_line_has_one_sentence() -> None:
    several = []
    for page in committed():
        for line in FENCE.sub("", page.read_text(encoding="utf-8")).splitlines():
            if not line.startswith(("|", "#", "    ")) and SENTENCE_END.search(
                UNBROKEN.sub("x", line)
            ):
                several.append(f"{page.relative_to(ROOT)}: {line}")
    assert several == []


ANNOTATIONS = ROOT / "docs" / "reference" / "annotations.md"
SUFFIXES = {
    "c": "c", "cpp": "cpp", "python": "py", "java": "java", "rust": "rs", "go": "go", "matlab": "m"
}  # fmt: skip
#: A source, and the output of `extract` after it.
SOURCE = re.compile(rf"(?ms)^```({'|'.join(SUFFIXES)})\n(.*?)^```\n\n```text\n(.*?)^```$")


def test_every_language_has_an_example() -> None:
    shown = [match[1] for match in SOURCE.finditer(ANNOTATIONS.read_text(encoding="utf-8"))]
    assert sorted(shown) == sorted(SUFFIXES)
    assert {LANGUAGES[f".{suffix}"] for suffix in SUFFIXES.values()} == set(LANGUAGES.values())


def test_examples_of_annotated_sources(
    tmp_path: Path, monkeypatch: Patch, update_golden: bool
) -> None:
    """The output of each source is the one shown below it."""
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
    # Those of the engine are on its own page.
    place = ROOT / "mars_asp" / "asp" if folder.name == "engine" else folder
    assert list(commands(place / "README.md"))
