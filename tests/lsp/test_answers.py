"""Answers about locations in texts."""

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from mars_asp.annotations.directives import WORDS
from mars_asp.asp.rules.metadata import KEYS
from mars_asp.language.expected import _WORDS, KEYWORDS
from mars_asp.language.text_edits import LineEdit, apply_lines
from mars_asp.lsp.actions import line_edits
from mars_asp.lsp.completion import completion, rule_completion
from mars_asp.lsp.hover import hover
from mars_asp.lsp.keyword_docs import ANNOTATIONS, METADATA, MODES, STATEMENTS
from mars_asp.lsp.places import Place, Position, Range, Text, TextEdit
from mars_asp.lsp.questions import CheckedFile, Survey
from mars_asp.lsp.references import definition, references
from mars_asp.lsp.rename import RefusedError, rename
from mars_asp.lsp.robot import EditorFinding
from mars_asp.lsp.rule_text import rule_text
from mars_asp.lsp.rules import Rules
from mars_asp.lsp.symbols import module_symbols, workspace_symbols
from mars_asp.lsp.workspace import EditorWorkspace
from mars_asp.model.declarations import DELIVERY_MODES
from mars_asp.reasoning.findings import EXPANSIONS
from tests.support.editor_answers import editor_answer


def desk_of(folder: Path, texts: Mapping[str, str], robot: str = "robot.mars") -> EditorWorkspace:
    """Return a workspace with these files open and the robot analysed."""
    desk = EditorWorkspace()
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
        desk.texts[str(folder / name)] = text
    found = editor_answer("check", folder / robot)
    assert isinstance(found, CheckedFile)
    assert found.robot is not None, found.findings
    desk.store(str(folder / robot), *found)
    return desk


def marked(text: str) -> tuple[str, Position]:
    """Return a text without its mark `¦`, and where that was, in UTF-16 units."""
    before, _, after = text.partition("¦")
    line = before.count("\n")
    last = before.rpartition("\n")[2]
    return before + after, Position(line, len(last.encode("utf-16-le")) // 2)


def edited(texts: Mapping[str, str], edits: tuple[TextEdit, ...]) -> dict[str, str]:
    """Return texts by the names of files, as edits of them make them."""
    found = dict(texts)
    for edit in sorted(edits, key=lambda each: each.place, reverse=True):
        name = Path(edit.place.path).name
        lines = found[name].split("\n")
        (first, begin), (last, end) = edit.place.range
        units = [line.encode("utf-16-le") for line in lines]
        whole = units[first][: 2 * begin] + edit.text.encode("utf-16-le") + units[last][2 * end :]
        found[name] = "\n".join([*lines[:first], whole.decode("utf-16-le"), *lines[last + 1 :]])
    return found


# ---- Rename --------------------------------------------------------------------------------------

ROBOT = """\
@configuration hierarchical
@sources code.py
@include arm.mars as left
@include arm.mars as right
@modules Camera, "odd 😀 name", eye: Camera, Base
left/Hand uses_data_from Camera.grab
"odd 😀 name" uses_data_from eye.grab  // Camera is not named here
left/Arm is_mounted_on Base
right/Arm is_mounted_on Base
"""
ARM = "@configuration\n@modules Arm, Hand\nHand is_mounted_on Arm\n"
CODE = """\
# @module_start
# @module_name Camera
# @Sense NotifyWhenReady
def grab() -> Image: ...
# @module_end
"""
TEXTS = {"robot.mars": ROBOT, "arm.mars": ARM, "code.py": CODE}


@pytest.mark.parametrize(
    ("file", "at", "new", "changes"),
    [
        (
            "robot.mars",
            "@modules Ca¦mera",
            "Front",
            {
                "robot.mars": [
                    '@modules Front, "odd 😀 name", eye: Front, Base',
                    "left/Hand uses_data_from Front.grab",
                ],
                "code.py": ["# @module_name Front"],
            },
        ),
        (
            "code.py",
            "@module_name Camera¦",
            "a b",
            {
                "robot.mars": [
                    '@modules "a b", "odd 😀 name", eye: "a b", Base',
                    'left/Hand uses_data_from "a b".grab',
                ],
                "code.py": ['# @module_name "a b"'],
            },
        ),
        (
            "robot.mars",
            "uses_data_from ¦eye",
            "Eye",
            {
                "robot.mars": [
                    '@modules Camera, "odd 😀 name", Eye: Camera, Base',
                    '"odd 😀 name" uses_data_from Eye.grab  // Camera is not named here',
                ]
            },
        ),
        (
            "robot.mars",
            '"odd ¦😀 name" uses',
            "plain",
            {
                "robot.mars": [
                    "@modules Camera, plain, eye: Camera, Base",
                    "plain uses_data_from eye.grab  // Camera is not named here",
                ]
            },
        ),
        (
            "arm.mars",
            "Hand is_mounted_on A¦rm",
            "Elbow",
            {
                "arm.mars": ["@modules Elbow, Hand", "Hand is_mounted_on Elbow"],
                "robot.mars": [
                    "left/Elbow is_mounted_on Base",
                    "right/Elbow is_mounted_on Base",
                ],
            },
        ),
        (
            "robot.mars",
            "left/A¦rm is",
            "left/Elbow",
            {
                "arm.mars": ["@modules Elbow, Hand", "Hand is_mounted_on Elbow"],
                "robot.mars": [
                    "left/Elbow is_mounted_on Base",
                    "right/Elbow is_mounted_on Base",
                ],
            },
        ),
    ],
)
def test_a_module_is_renamed_wherever_it_is_named(
    file: str, at: str, new: str, changes: Mapping[str, list[str]], tmp_path: Path
) -> None:
    desk = desk_of(tmp_path, TEXTS)
    assert at.replace("¦", "") in TEXTS[file]
    _, position = marked(TEXTS[file].replace(at.replace("¦", ""), at, 1))
    scene = desk.context(str(tmp_path / file))
    assert scene is not None
    after = edited(TEXTS, rename(scene, position, new))
    changed = {
        name: [line for line in after[name].splitlines() if line not in TEXTS[name].splitlines()]
        for name in TEXTS
        if after[name] != TEXTS[name]
    }
    assert changed == changes
    # The robot is what it was, but for the name.
    again = desk_of(tmp_path, after)
    assert len(again.findings(str(tmp_path / "robot.mars"))) == len(
        desk.findings(str(tmp_path / "robot.mars"))
    )


@pytest.mark.parametrize(
    ("at", "new", "why"),
    [
        ("@modules Ca¦mera", "Base", "`Base` is a module already"),
        ("left/A¦rm is", "Elbow", "begin with `left/`"),
        ("left/A¦rm is", "left/Hand", "`left/Hand` is a module already"),
        ("@modules Ca¦mera", "two\nlines", "one line"),
        ("@modules Ca¦mera", " ", "one line"),
        ("uses_data_fr¦om eye", "x", "no module here"),
    ],
)
def test_an_impossible_rename_is_refused(at: str, new: str, why: str, tmp_path: Path) -> None:
    desk = desk_of(tmp_path, TEXTS)
    _, position = marked(ROBOT.replace(at.replace("¦", ""), at, 1))
    scene = desk.context(str(tmp_path / "robot.mars"))
    assert scene is not None
    with pytest.raises(RefusedError, match=re.escape(why)):
        rename(scene, position, new)


def test_the_comments_of_nodes_name_modules(tmp_path: Path) -> None:
    text = (
        "@specification hierarchical\n@modules A, B, C, InheritanceNode1\n"
        "// InheritanceNode1: A\nInheritanceNode1 is_controlled_by B 0\n"
    )
    desk = EditorWorkspace()
    path = str(tmp_path / "spec.mars")
    desk.texts[path] = text
    scene = desk.context(path)
    assert scene is not None
    places = [place.range.start for place, _ in references(scene, Position(1, 9))]
    assert places == [Position(1, 9), Position(2, 21)]


def test_side_lines_name_modules(tmp_path: Path) -> None:
    text = (
        "@configuration\n@modules A, latest\nA.o is_suppressed_by latest.p 20\n"
        "latest is_locked_by A hold 5\nlatest is_arbitrated_by latest\nA is_reset_by latest\n"
    )
    desk = EditorWorkspace()
    path = str(tmp_path / "robot.mars")
    desk.texts[path] = text
    scene = desk.context(path)
    assert scene is not None
    after = edited({"robot.mars": text}, rename(scene, Position(1, 14), "B"))["robot.mars"]
    assert after.splitlines()[1:] == [
        "@modules A, B",
        "A.o is_suppressed_by B.p 20",
        "B is_locked_by A hold 5",
        "B is_arbitrated_by latest",
        "A is_reset_by B",
    ]


def test_a_path_leads_to_its_file(tmp_path: Path) -> None:
    desk = desk_of(tmp_path, TEXTS)
    scene = desk.context(str(tmp_path / "robot.mars"))
    assert scene is not None
    for line, name in ((1, "code.py"), (2, "arm.mars")):
        (found,) = definition(scene, Position(line, 11))
        assert Path(found.path) == tmp_path / name
    assert definition(scene, Position(0, 3)) == ()


# ---- Completion ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "has", "lacks"),
    [
        ("¦", {"@modules", "@include", "@module_start", "Camera"}, {"hold", "NotifyOnMax"}),
        ("Camera ¦", {"uses_data_from", "is_mounted_on", "is_controlled_by"}, {"Camera"}),
        ("Camera uses_data_from ¦", {"Camera", "eye", "odd 😀 name"}, {"hold", "grab"}),
        ("Base uses_data_from Camera.¦", {"grab"}, {"Camera", "Base"}),
        ("Base uses_data_from Camera.grab Not¦", {"NotifyWhenReady", "every"}, {"Camera"}),
        ("Base is_controlled_by Camera 1, ¦", {"Camera", "left/Arm"}, {"hold"}),
        ("Base is_controlled_by Camera ¦", {"hold", "allocation"}, {"Camera"}),
        ("Base is_controlled_by Camera hold ¦", {"forever"}, {"hold"}),
        ("Camera.¦", {"grab"}, {"Camera"}),
        ("Camera.grab is_suppressed_by ¦", {"Camera", "eye"}, {"hold"}),
        ("Base is_locked_by Camera.grab 5 ¦", {"hold"}, {"allocation"}),
        ("Base is_arbitrated_by ¦", {"latest", "weighted", "flat"}, {"Camera"}),
        ("Base is_arbitrated_by flat ¦", {"period"}, {"flat"}),
        ("@configuration ¦", {"flat", "hierarchical", "period"}, {"Camera"}),
        ("@modules Cam¦", {"Camera"}, {"@modules"}),
        ("Camera uses_data_from eye // Ca¦", set(), {"Camera", "hold"}),
    ],
)
def test_a_line_is_completed(line: str, has: set[str], lacks: set[str], tmp_path: Path) -> None:
    desk = desk_of(tmp_path, TEXTS)
    path = str(tmp_path / "robot.mars")
    desk.texts[path], position = marked(f"{ROBOT}{line}\n")
    scene = desk.context(path)
    assert scene is not None
    found = {each.label for each in completion(scene, position).items}
    assert has <= found
    assert not lacks & found


@pytest.mark.parametrize(
    ("line", "has"),
    [
        ("// @¦", {"@Sense", "@module_start"}),
        ("// @Sense ¦", {"NotifyAtFrequency"}),
        ("// @ControlOut Ro¦", {"Rotn_X", "Grasp"}),
        ("int code = ¦", set()),
    ],
)
def test_annotations_are_completed(line: str, has: set[str]) -> None:
    desk = EditorWorkspace()
    desk.texts["/a.cpp"], position = marked(line)
    scene = desk.context("/a.cpp")
    assert scene is not None
    found = {each.label for each in completion(scene, position).items}
    assert has <= found
    assert bool(found) == bool(has)


def test_a_completion_replaces_typed_text() -> None:
    desk = EditorWorkspace()
    desk.texts["/a.mars"], position = marked('@modules "😀 eye", Base\n"😀 e¦')
    scene = desk.context("/a.mars")
    assert scene is not None
    found = completion(scene, position)
    assert found.typed.start == Position(1, 0)
    assert '"😀 eye"' in {each.text for each in found.items}


def test_rules_are_completed() -> None:
    text, position = marked("mine(X) :- own(X), ¦")
    found = rule_completion(rule_text("/a.lp", text), Rules(), position)
    assert {each.text for each in found.items} == {"mine(", "own("}
    text, position = marked("%! be¦")
    found = rule_completion(rule_text("/a.lp", text), Rules(), position)
    assert "because: " in {each.text for each in found.items}
    text, position = marked('mine("¦')
    assert rule_completion(rule_text("/a.lp", text), Rules(), position).items == ()


# ---- Hover ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "at", "parts"),
    [
        (4, 10, ["```text\nCamera (", "- data_divergence(Camera)"]),
        (6, 32, ["```text\nCamera (", "**warning**: tied", "- data_divergence(Camera)"]),
        (6, 36, ["output `grab` of", "**warning**: tied", "- data_divergence(Camera)"]),
        (6, 3, ["`odd 😀 name`: no annotation describes", "**warning**: tied"]),
        (5, 27, ["```text\nCamera (", "- data_divergence(Camera)"]),
        (7, 24, ["`Base`: no annotation describes this module"]),
        (6, 22, ["**warning**: tied", "```text\nNAME[.INPUT] uses_data_from"]),
    ],
)
def test_a_hover_begins_with_the_module(
    line: int, at: int, parts: list[str], tmp_path: Path
) -> None:
    text = ROBOT.replace("from eye", "from Camera")
    desk = desk_of(tmp_path, {**TEXTS, "robot.mars": text})
    path = str(tmp_path / "robot.mars")
    whole = Range(Position(6, 0), Position(6, 40))
    finding = EditorFinding(Place(path, whole), "warning", "tied", "tied", title="tie(Camera)")
    desk.found[path] = (finding,)
    desk.update(path, Survey({"Camera": ("data_divergence(Camera): two modules use it",)}, {}))
    scene = desk.context(path)
    assert scene is not None
    found = hover(scene, Position(line, at), {"tie(Camera)": "the trace"})
    assert found is not None
    shown = found.markdown.split("\n\n---\n\n")
    assert [
        text.replace("\\", "")[: len(part)] for text, part in zip(shown, parts, strict=True)
    ] == parts
    assert all(("the trace" in each) == each.startswith("**warning**") for each in shown)


# ---- Rules as text -------------------------------------------------------------------------------


def test_predicates_are_found_with_their_arguments() -> None:
    text = (
        'a(X,f(Y,Z)) :- not b, -c("x,(", X+1), X = #sum { W,V : d(W,V), not e }, Y != g.\n'
        "{ h(X) : i(X); j } :- k((1,2)). % l(X)\n"
        "#show m/3.\n%*! n(A: {o, p}, B)\nwords q(X)\n*%\n:- r, not"
    )
    found = [(str(each.signature), each.is_head) for each in rule_text("/a.lp", text).mentions]
    assert found == [
        *[("a/2", True), ("b/0", False), ("-c/2", False), ("d/2", False), ("e/0", False)],
        *[("h/1", True), ("i/1", False), ("j/0", True), ("k/1", False), ("m/3", False)],
        *[("n/2", True), ("r/0", False)],
    ]


# ---- Edits of lines ------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["a\nb\nc\n", "a\nb\nc", "a\n😀 b\n\n"])
@pytest.mark.parametrize(
    "edits",
    [
        [(1, "x", None)],
        [(1, None, None), (2, "x😀", None)],
        [(3, None, None)],
        [(1, "new", "before"), (1, "x", None), (1, "more\nlines", "behind")],
        [(3, "last", "behind")],
        [(2, "a", "before"), (2, None, None), (3, None, None)],
    ],
)
def test_edits_of_lines_are_edits_of_stretches(
    text: str, edits: list[tuple[int, str | None, str | None]]
) -> None:
    lines = text.split("\n")
    wanted = [
        LineEdit("/t", number, 1, None if where else lines[number - 1], new, where)  # type: ignore[arg-type]
        for number, new, where in edits
    ]
    whole = tuple(line_edits({"/t": Text("/t", text)}, wanted))
    after = edited({"t": text}, whole)["t"]
    assert after.rstrip("\n") == apply_lines(text, wanted).rstrip("\n")


# ---- Words and symbols ---------------------------------------------------------------------------


def test_each_word_has_its_meaning() -> None:
    assert ANNOTATIONS.keys() == set(WORDS)
    assert MODES.keys() == set(DELIVERY_MODES)
    assert STATEMENTS.keys() == {*KEYWORDS, *_WORDS}
    assert METADATA.keys() == {*KEYS, *EXPANSIONS}


def test_words_of_several_sentences_are_explained_for_each() -> None:
    assert "source of this lock or limit may be silent" in STATEMENTS["hold"].meaning
    assert "flat or weighted" in STATEMENTS["period"].meaning


def test_symbols_span_their_blocks() -> None:
    desk = EditorWorkspace()
    desk.texts["/a.mars"] = "@modules A\n@module_start\n@module_name B\n@Grasp 0 1\n@module_end\n"
    scene = desk.context("/a.mars")
    assert scene is not None
    found = [(each.name, each.whole) for each in module_symbols(scene.here)]
    assert found == [
        ("A", (Position(0, 9), Position(0, 10))),
        ("B", (Position(1, 0), Position(4, 11))),
    ]


@pytest.mark.parametrize(
    ("query", "names"),
    [
        ("CAM", ["Camera robot.mars:4", "Camera code.py:1"]),
        ("left/", ["left/Arm arm.mars:1", "left/Hand arm.mars:1"]),
        ("amera2", []),
        ("new", ["New unread.mars:0", "new/1 own.lp:0"]),
    ],
)
def test_symbols_of_all_open_files_are_found_by_part_of_their_name(
    query: str, names: list[str], tmp_path: Path
) -> None:
    desk = desk_of(tmp_path, TEXTS)
    # The module of a closed file is found as well; a text that was never read has its own.
    del desk.texts[str(tmp_path / "code.py")]
    desk.texts[str(tmp_path / "unread.mars")] = "@modules New\n@modules"
    desk.texts[str(tmp_path / "own.lp")] = "new(M) :- module(M).\nold(M) :- new(M).\n"
    scenes = filter(None, map(desk.context, desk.texts))
    rules = filter(None, map(desk.rule_text, desk.texts))
    assert [
        f"{name} {Path(place.path).name}:{place.range.start.line}"
        for name, _, place in workspace_symbols(scenes, rules, query)
    ] == names
