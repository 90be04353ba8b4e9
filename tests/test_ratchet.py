"""The words and the size of the code: each figure of `tests/ratchet.toml` can only fall.

A count above its entry fails, and so does one below it, until the lower one is written:
`pytest tests/test_ratchet.py --update-golden` writes it. It removes an entry that has reached its
goal; from then on the goal holds. It never raises a figure of words, names or structure: reword or
rename instead, with `docs/reference/glossary.md`. `what` and `told` have goals of 1.5 and 0.5 in
1,000 words of docstrings.

Only `lines` may rise with `--update-golden`, because a correction can need lines. The difference of
`tests/ratchet.toml` then states them for review. They are rounded up to the next 100, so that few
changes meet in one entry. After a conflict in the file, take the version of `main` and update.
"""

import re
import tomllib
from collections.abc import Mapping
from functools import cache
from itertools import chain
from pathlib import Path

import pytest

from tests.support.documents import ROOT
from tests.support.figures import (
    Figure,
    Place,
    Source,
    Text,
    figure_of_lines,
    figure_of_test_names,
    figures_of_rules,
    figures_of_structure,
    figures_of_words,
    matches,
    names_speech,
    words,
)

ENTRIES = ROOT / "tests" / "ratchet.toml"
#: The files and folders of each package, the longest path first to match, and its target in lines.
PACKAGES = {
    "annotations": ("annotations", 2_900),
    "language": ("language model spelling.py", 2_700),
    "asp/rules": ("asp", 2_700),
    "asp/solve": ("asp/solve", 1_050),
    "asp/slice": ("asp/slice asp/cache.py", 170),
    "asp/trace": ("asp/trace asp/messages.py", 2_700),
    "asp/lint": ("asp/lint", 1_200),
    "asp/cases": ("asp/cases reasoning/cases", 1_300),
    "reasoning/questions": ("reasoning/questions", 3_900),
    "reasoning": ("reasoning", 4_700),
    "kinematics": (".", 1_700),  # with behaviour and the files beside the packages
    "exchange": ("exchange", 7_300),
    "execution": ("execution", 5_900),
    "draw": ("draw", 1_300),
    "lsp": ("lsp", 2_000),
    "cli": ("cli", 7_100),
}
Entries = dict[str, dict[str, int]]


def package_of(path: Path) -> str:
    """Return the package of a file of `mars_asp`, given by its path there."""
    folders = {folder: name for name, (listed, _) in PACKAGES.items() for folder in listed.split()}
    return next(
        folders[place.as_posix()] for place in (path, *path.parents) if place.as_posix() in folders
    )


@cache
def measured() -> dict[str, dict[str, Figure]]:
    """Return each figure of each package."""
    packages: dict[str, list[Source]] = {name: [] for name in PACKAGES}
    for path in sorted((ROOT / "mars_asp").rglob("*.py")):
        package = packages[package_of(path.relative_to(ROOT / "mars_asp"))]
        package.append(Source(path, path.read_text(encoding="utf-8")))
    result = {
        name: {**figures_of_words(sources), "lines": figure_of_lines(sources, PACKAGES[name][1])}
        for name, sources in packages.items()
    }
    result["mars_asp"] = figures_of_structure(chain(*packages.values()))
    tests = [
        Source(path, path.read_text(encoding="utf-8"))
        for path in sorted((ROOT / "tests").rglob("*.py"))
        if (path.parent / "__init__.py").exists()  # sources that tests read have none
    ]
    result["tests"] = {**figures_of_words(tests), "test_names": figure_of_test_names(tests)}
    rules = sorted((ROOT / "rules").rglob("*.lp"))
    result["rules"] = figures_of_rules((path, path.read_text(encoding="utf-8")) for path in rules)
    return result


def judge(
    figures: Mapping[str, Mapping[str, Figure]], entries: Mapping[str, Mapping[str, int]]
) -> tuple[list[str], list[str], Entries]:
    """Return the rises that stay forbidden, the entries to write, and all new entries."""
    rises: list[str] = []
    changes: list[str] = []
    new: Entries = {}
    for package, named in figures.items():
        for name, figure in named.items():
            entry = entries.get(package, {}).get(name)
            bound = figure.goal if entry is None else entry
            kept: int | None = figure.value
            if figure.value > bound and name != "lines":
                above = "its goal" if entry is None else "its entry"
                rises.append(
                    f"{package}, {name}: {figure.value}, above {above} {bound}\n{_shown(figure)}"
                )
                kept = entry
            elif figure.value <= figure.goal:
                kept = None
                if entry is not None:
                    changes.append(f"{package}, {name}: remove {entry}, the goal is reached")
            elif figure.value != entry:
                changes.append(f"{package}, {name}: write {figure.value} instead of {bound}")
            if kept is not None:
                new.setdefault(package, {})[name] = kept
    changes += [
        f"{package}, {name}: remove, there is no such figure"
        for package, named in entries.items()
        for name in named
        if name not in figures.get(package, {})
    ]
    return rises, changes, new


def _shown(figure: Figure) -> str:
    """Return ten places of a figure, those in the files edited last first."""
    changed = {place.path: place.path.stat().st_mtime for place in figure.places}
    places = sorted(figure.places, key=lambda place: -changed[place.path])
    rows = [f"  {place.path.relative_to(ROOT)}:{place.line}: {place.text}" for place in places[:10]]
    more = [f"  and {len(places) - 10} more"] if len(places) > 10 else []
    return "\n".join(rows + more)


def written(entries: Entries) -> str:
    """Return entries as TOML."""
    return "\n".join(
        f'["{package}"]\n' + "".join(f"{name} = {count}\n" for name, count in named.items())
        for package, named in entries.items()
    )


def test_figures_only_fall(update_golden: bool) -> None:
    rises, changes, new = judge(measured(), tomllib.loads(ENTRIES.read_text(encoding="utf-8")))
    if update_golden:
        ENTRIES.write_text(written(new), encoding="utf-8")
        changes = []
    advice = {
        "Reword or rename these, see docs/reference/glossary.md (places edited last first):": rises,
        "Write these with `pytest tests/test_ratchet.py --update-golden`:": changes,
    }
    failures = [line for title, lines in advice.items() if lines for line in (title, *lines)]
    assert not failures, "\n".join(failures)


@pytest.mark.parametrize(
    ("name", "count", "goal", "entry", "rises", "changes", "kept"),
    [
        ("told", 5, 0, 5, 0, 0, 5),
        ("told", 6, 0, 5, 1, 0, 5),
        ("told", 4, 0, 5, 0, 1, 4),
        ("told", 2, 2, 5, 0, 1, None),
        ("told", 2, 2, 2, 0, 1, None),
        ("told", 1, 2, None, 0, 0, None),
        ("told", 3, 2, None, 1, 0, None),
        ("lines", 600, 100, 500, 0, 1, 600),
        ("lines", 200, 100, None, 0, 1, 200),
    ],
)
def test_a_figure_is_compared_with_its_entry(
    name: str, count: int, goal: int, entry: int | None, rises: int, changes: int, kept: int | None
) -> None:
    entries = {} if entry is None else {"p": {name: entry}}
    result = judge({"p": {name: Figure(count, goal)}}, entries)
    assert (len(result[0]), len(result[1])) == (rises, changes)
    assert result[2] == ({} if kept is None else {"p": {name: kept}})


def test_an_entry_without_a_figure_is_removed() -> None:
    assert judge({}, {"p": {"told": 3}}) == ([], ["p, told: remove, there is no such figure"], {})


def test_a_rise_shows_its_places() -> None:
    figure = Figure(1, 0, (Place(Path(__file__), 7, "told"),))
    assert judge({"p": {"told": figure}}, {})[0] == [
        "p, told: 1, above its goal 0\n  tests/test_ratchet.py:7: told"
    ]


def test_entries_are_written_as_they_are_read() -> None:
    entries = {"asp/rules": {"told": 3, "lines": 500}, "tests": {"what": 7}}
    assert tomllib.loads(written(entries)) == entries


@pytest.mark.parametrize(
    ("path", "package"),
    [
        ("asp/program.py", "asp/rules"),
        ("asp/rules/gate.py", "asp/rules"),
        ("asp/cache.py", "asp/slice"),
        ("asp/trace/text.py", "asp/trace"),
        ("reasoning/session.py", "reasoning"),
        ("reasoning/cases/run.py", "asp/cases"),
        ("spelling.py", "language"),
        ("output.py", "kinematics"),
        ("behaviour/calls.py", "kinematics"),
    ],
)
def test_a_file_counts_in_one_package(path: str, package: str) -> None:
    assert package_of(Path(path)) == package


def counts(text: str) -> dict[str, int]:
    """Return the figures of words of a text of Python that are not zero."""
    figures = figures_of_words([Source(Path("example.py"), text)])
    return {name: figure.value for name, figure in figures.items() if figure.value}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('"""Return the items, or None if the file is empty."""', {}),
        ('"""Return what an editor proposes."""', {"return_what": 1, "what": 1}),
        ('"""Yield what\nis left."""', {"return_what": 1, "what": 1}),
        ('"""Return the file and what is in it."""', {"what": 1}),
        ('"""It is\nno file."""', {"docstrings": 1}),
        ('"""There is no file."""', {}),
        ('"""A file, for it is empty."""', {"docstrings": 1}),
        ('"""A file, for each robot, for all robots."""', {}),
        ('"""It stands here."""', {"docstrings": 1, "told": 1}),
        ('"""It starts to stand still, behind the robot."""', {}),
        ('"""It is behind the robots."""', {"docstrings": 1, "told": 1}),
        ('"""A key.\n\n    says: a text\n    what: a text\n"""', {}),
        ('"""A key, which says: a text."""', {"docstrings": 1, "told": 1}),
        ('"""The value of `what is told`."""', {}),
        ('"""The page(s) of a file."""', {"docstrings": 1}),
        ('"""Whoever asked is told."""', {"docstrings": 2, "told": 2}),
        (
            'def f():\n    """Nobody."""\n\n\nclass C:\n    """Just that."""\n',
            {"docstrings": 2, "told": 1},
        ),
        ('x = "nobody says what"\n', {}),
        ("x = 1  # just one\n", {"comments": 1}),
        ("# It is\n# no file.\nx = 1\n", {"comments": 1}),
        ("x = 1  # It is\ny = 2  # no file\n", {}),
        ("#: says: a text\nx = '# just text'\n", {}),
        ("told = asked.append(told)\n", {"identifiers": 2}),
        ("is_behind, _Told, askedFor, STATED = 1, 2, 3, 4\n", {"identifiers": 4}),
        ("restated = understated = behindhand = 'told'  # asked\n", {}),
    ],
)
def test_figures_of_words(text: str, expected: dict[str, int]) -> None:
    assert counts(text) == expected


def test_a_place_is_the_line_of_the_match() -> None:
    pattern = re.compile("is no")
    assert list(matches(pattern, Text(10, "One.\n\nTwo `a\nb` three\nis no four"))) == [
        (14, "is no")
    ]


def test_goals_of_rates_follow_the_words() -> None:
    docstring = " ".join(["word"] * 2_000)
    figures = figures_of_words([Source(Path("example.py"), f'"""{docstring}"""')])
    assert (figures["what"].goal, figures["told"].goal) == (3, 1)
    assert words([Text(1, "Two `not these` words-with-dashes: 3")]) == 3


def test_figures_of_names_of_tests() -> None:
    names = "test_what_is_told test_it_stands_still test_a_file_is_no_file test_a_file_is_empty"
    text = "".join(f"def {name}(): ...\n" for name in [*names.split(), "what_is_told"])
    figure = figure_of_test_names([Source(Path("test_example.py"), text)])
    assert [(place.line, place.text) for place in figure.places] == [
        *((1, "what"), (1, "is told"), (3, "is no"))
    ]


def test_figures_of_rules() -> None:
    text = """\
%# Control: who is told
%*! behind(X, Y)
X stands behind Y.
says: `{X}` is at `{Y}`
*%
%! id:  a/b
%! who: X
behind(X, Y) :- untold(X), told(Y), not asked.  % just so
a("behind(X, Y) % just").
"""
    figures = figures_of_rules([(Path("example.lp"), text)])
    assert {
        name: [(place.line, place.text) for place in figure.places]
        for name, figure in figures.items()
    } == {
        "blocks": [(3, "stands"), (3, "behind")],
        "comments": [(1, "is told"), (8, "just")],
        "identifiers": [(8, "behind"), (8, "told")],
    }


def structure(*texts: str) -> dict[str, int]:
    sources = [Source(Path(f"file{index}.py"), text) for index, text in enumerate(texts)]
    return {name: figure.value for name, figure in figures_of_structure(sources).items()}


def test_figures_of_structure() -> None:
    common = "def f(): ...\ndef __len__(): ...\n"
    file = "class C:\n    def _g(self):\n        '''Doc.'''\n        return 1\n\nC()._g()\n"
    result = structure(common, common, common, common + common, file, file)
    assert (result["class_names"], result["common_functions"]) == (1, 5)
    assert result["short_functions"] == 2
    assert structure(common, common, common)["common_functions"] == 0
    long = "def _g():\n    a\n    b\n    c\n    d\n\n_g()\n"
    twice = "def _g():\n    a\n\n_g()\n_g()\n"
    decorated = "@property\ndef _g():\n    a\n\n_g()\n"
    assert structure(long, twice, decorated)["short_functions"] == 0


@pytest.mark.parametrize(
    ("text", "figure"),
    [
        ("import clingo.ast", "clingo_ast_files"),
        ("from clingo import Symbol, ast", "clingo_ast_files"),
        ("from clingo.ast import AST", "clingo_ast_files"),
        ("from clingo._internal import _lib", "clingo_internal_files"),
        ('x = import_module("clingo._internal")', "clingo_internal_files"),
        ("process = subprocess.Popen(words)", "process_files"),
        ("child = os.fork()", "process_files"),
        ("import ast\nx = 'clingo.ast'  # os.fork()", None),
        ("idle: list[subprocess.Popen[bytes]] = []", None),
    ],
)
def test_files_that_use_clingo_and_processes(text: str, figure: str | None) -> None:
    result = structure(text)
    assert [name for name, count in result.items() if count] == ([figure] if figure else [])


def test_lines_are_rounded_up_until_their_target() -> None:
    sources = [Source(Path("example.py"), "x = 1\n" * 150)]
    assert figure_of_lines(sources, 149) == Figure(200, 149)
    assert figure_of_lines(sources, 150) == Figure(150, 150)


def test_identifiers_are_split_at_underscores_and_capitals() -> None:
    assert names_speech("told_by") and names_speech("LinesToldBy")
    assert not names_speech("restated")
