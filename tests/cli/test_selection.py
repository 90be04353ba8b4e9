"""Which findings are reported: options, settings, comments and baselines."""

import ast
import json
from collections.abc import Set
from functools import cache
from pathlib import Path
from unittest.mock import Mock

import pytest

from mars_asp.cli import run_here
from mars_asp.cli.input_codes import ignorable_codes, is_input_error
from mars_asp.cli.settings import settings_for
from mars_asp.language import toml_text
from tests.support.applied_repairs import result_of
from tests.support.configurations import FINDINGS as ROBOT
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import mars
from tests.support.refusals import refusals

ERROR, WARNING, NOTES = "module_conflict", "ambiguous_priority", {"control_convergence"}
PACK = 'consequence(crowded, error, M, here) :- module(M), M = "Camera".\n'


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    (tmp_path / "a.mars").write_text(ROBOT)
    return tmp_path


def analysed(capsys: Captured, *words: str) -> tuple[int, set[str], list[str]]:
    """Return the status of `analyse`, the kinds that it reports, and its remarks."""
    status = run_here(["analyse", *words, "--format", "json"])
    shown = capsys.readouterr()
    kinds = {each["kind"] for each in json.loads(shown.out)["consequences"]} if shown.out else set()
    remarks = [json.loads(line) for line in shown.err.splitlines()]
    lines = [f"{r['line']}:{r['column']} {r['message']}|{r['help']}" for r in remarks]
    return status, kinds, lines


@cache
def kinds_of_robot() -> Set[str]:
    """Return all kinds of findings of `a.mars`, as it is when a test begins."""
    return {each["kind"] for each in result_of("analyse", "a.mars")[1]["consequences"]}


def test_selected_notes_are_named(capsys: Captured) -> None:
    path = ROOT / "examples/figure04-divergence/config.mars"
    assert run_here(["check", str(path), "--select", "data_divergence"]) == 0
    message = "1 finding of `data_divergence` not reported, as `check` leaves out notes"
    assert message in capsys.readouterr().err


def test_the_robot_of_these_tests(capsys: Captured) -> None:
    status, kinds, result = analysed(capsys, "a.mars")
    assert (status, result) == (1, [])
    assert {ERROR, WARNING, *NOTES} < kinds


@pytest.mark.parametrize(
    ("options", "status", "kinds"),
    [
        (["--select", WARNING], 0, {WARNING}),
        (["--select", f"{ERROR}, {WARNING}"], 1, {ERROR, WARNING}),
        (["--select", ERROR, "--select", WARNING], 1, {ERROR, WARNING}),
        (["--select", f"{WARNING},{WARNING},"], 0, {WARNING}),
        (["--select", f"{ERROR},{WARNING}", "--ignore", ERROR], 0, {WARNING}),
        (["--select", ERROR, "--ignore", ERROR], 0, set()),
        (["--select", "control/ambiguous-priority"], 0, {WARNING}),
        (["--select", f"control/ambiguous-priority,{ERROR}", "--ignore", "mounts/cycle"], 0, None),
        (["--select", ERROR, "--ignore", "mounts/repeated"], 1, {ERROR}),
        (["--select", "mounts/repeated"], 0, set()),
    ],
)
def test_kinds_are_selected_and_ignored(
    options: list[str], status: int, kinds: set[str] | None, capsys: Captured
) -> None:
    kinds = {WARNING} if kinds is None else kinds
    assert analysed(capsys, "a.mars", *options) == (status, kinds, [])
    assert run_here(["check", "a.mars", *options]) == status
    assert (f"[{WARNING}]" in capsys.readouterr().out) == (WARNING in kinds)


def test_ignored_kinds_are_all_but_the_others(capsys: Captured) -> None:
    everything = kinds_of_robot()
    assert analysed(capsys, "a.mars", "--ignore", ERROR) == (0, everything - {ERROR}, [])


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("ambigous_priority", "no rule finds `ambigous_priority`|did you mean"),
        ("mounts/cycel", "no rule finds `mounts/cycel`|did you mean `mounts/cycle`?"),
        ("rivals", "no rule finds `rivals`|did you mean `launch/commands/rivals`?"),
        ("control/splitter", "no rule finds `control/splitter`|"),
        (
            "syntax",
            "`syntax` is an error of the input, which cannot be ignored or selected|it is always",
        ),
        (
            "unreadable",
            "`unreadable` is an error of the input, which cannot be ignored or selected|",
        ),
        ("MARS111", "`MARS111` is an error of the input, which cannot be ignored or selected|"),
        ("zzz", "no rule finds `zzz`|`mars-asp rules list` names"),
    ],
)
def test_unknown_kinds_are_errors(option: str, message: str, capsys: Captured) -> None:
    for name in ("--select", "--ignore"):
        status, _, remarks = analysed(capsys, "a.mars", name, option)
        assert status == 2
        assert message in remarks[0]


def test_kinds_of_packs_are_known_where_the_pack_is(folder: Path, capsys: Captured) -> None:
    (folder / "own.lp").write_text(PACK)
    words = ("a.mars", "--select", "crowded")
    assert analysed(capsys, *words)[0] == 2
    assert analysed(capsys, *words, "--rules", "own.lp") == (1, {"crowded"}, [])


def test_settings_take_kinds_and_rules(folder: Path, capsys: Captured) -> None:
    everything = kinds_of_robot()
    (folder / "mars.toml").write_text('ignore = ["mounts/cycle", "ambiguous_priority"]\n')
    assert analysed(capsys, "a.mars") == (0, everything - {ERROR, WARNING}, [])
    (folder / "mars.toml").write_text('ignore = ["cycle"]\n')
    status, _, (remark,) = analysed(capsys, "a.mars")
    advice = "did you mean `control_cycle` or `data_cycle` or `suppression_cycle`?"
    assert (status, remark) == (2, f"1:11 no rule finds `cycle`|{advice}")


def test_a_hidden_error_hides_no_repair_of_a_warning(folder: Path, capsys: Captured) -> None:
    (folder / "r").write_text(
        "@configuration hierarchical\n@modules A, B, C\nA uses_data_from D\n"
        "C is_controlled_by A 3\nC is_controlled_by B 3\n"
    )
    assert run_here(["explain", "r", "--repair", "--ignore", "undeclared_module"]) == 0
    assert "ambiguous_priority: `A` and `B`" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("name", [WARNING, "control/ambiguous-priority"])
def test_kinds_and_rules_name_findings_to_explain(name: str, capsys: Captured) -> None:
    assert run_here(["explain", "a.mars", name]) == 1
    output = capsys.readouterr().out
    assert "ambiguous_priority(Base)" in output and ERROR not in output


#: Names in brackets of messages about reading, and files that cause them.
READ = [
    ("unused-ignore", "@configuration\n@modules A, B // mars: ignore\nA uses_data_from B\n"),
]


@pytest.mark.parametrize(("name", "text"), READ)
def test_names_in_brackets_are_ignored(
    name: str, text: str, folder: Path, capsys: Captured
) -> None:
    (folder / "r").write_text(text)
    run_here(["check", "r"])
    assert f"[{name}]" in "".join(capsys.readouterr())
    for each in {name, name.replace("_", "-")}:
        assert run_here(["check", "r", "--ignore", each]) == 0
        assert f"[{name}]" not in "".join(capsys.readouterr())
    run_here(["check", "r", "--select", "unused_input"])
    assert f"[{name}]" not in "".join(capsys.readouterr())


def test_every_code_of_an_error_is_known_as_one() -> None:
    """A name in brackets is either taken by `--ignore` or refused with the reason."""
    calls = (
        node
        for path in sorted((ROOT / "mars_asp").rglob("*.py"))
        if path.relative_to(ROOT / "mars_asp").parts[0] in READING_FOLDERS
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("Diagnostic", "refusal")
    )
    codes = {
        argument.value
        for node in calls
        for argument in node.args[:1]
        if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
    }
    assert len(codes) > 40
    assert not [
        code for code in codes if code not in ignorable_codes() and not is_input_error(code)
    ]


#: The packages that read the input of `check`.
READING_FOLDERS = ("annotations", "language", "exchange", "reasoning", "asp")


# ---- Settings ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("files", "kinds"),
    [
        ({"mars.toml": f'select = ["{WARNING}"]\n'}, {WARNING}),
        ({"../mars.toml": f'select = ["{WARNING}"]\r\n'}, {WARNING}),
        ({"pyproject.toml": f'[tool.mars-asp]\nselect = ["{WARNING}"]\n'}, {WARNING}),
        (
            {
                "mars.toml": f'select = ["{WARNING}"]\n',
                "pyproject.toml": f'[tool.mars-asp]\nselect = ["{ERROR}"]\n',
            },
            {WARNING},
        ),
        (
            {
                "pyproject.toml": "[project]\nname = 'mars-asp-robot'\n",
                "../mars.toml": f'select = ["{WARNING}"]\nignore = []\n',
            },
            {WARNING},
        ),
        ({"mars.toml": "", "../mars.toml": 'select = ["no"]\n'}, None),
    ],
)
def test_the_nearest_settings_count(
    files: dict[str, str],
    kinds: set[str] | None,
    folder: Path,
    capsys: Captured,
    monkeypatch: Patch,
) -> None:
    (folder / "robots").mkdir()
    (folder / "robots/a.mars").write_text(ROBOT)
    for name, text in files.items():
        (folder / "robots" / name).write_bytes(text.encode())
    _, everything, _ = analysed(capsys, "robots/a.mars")
    assert everything == kinds or (kinds is None and ERROR in everything)
    # Options replace settings of the same name.
    assert analysed(capsys, "robots/a.mars", "--select", ERROR)[1] == {ERROR}
    monkeypatch.chdir(folder / "robots")
    assert analysed(capsys, "a.mars")[1] == everything


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('\nselct = ["a"]', "2:1 `selct` is not a key of the settings|did you mean `select`?"),
        (
            'ignore = ["module_conflict", "moduleconflict"]',
            "1:30 no rule finds `moduleconflict`|did you mean",
        ),
        ("select = 'module_conflict'", "1:1 `select` must be a list"),
        ("select = [\n 1]", "2:2 `select` lists kinds"),
        ("baseline = 1", "1:1 `baseline` must be the path"),
        ("select = [", "1:1 Invalid value"),
        ("baseline = 'none.json'", "1:1 the file cannot be read"),
    ],
)
@pytest.mark.parametrize("verb", ["analyse", "check"])
def test_errors_of_settings_have_a_location(
    verb: str, text: str, message: str, folder: Path, capsys: Captured
) -> None:
    (folder / "mars.toml").write_text(text)
    assert run_here([verb, "a.mars", "--format", "json"]) == 2
    output = capsys.readouterr()
    if verb == "check":
        found = json.loads(output.out)["findings"][0]
    else:
        found = json.loads(output.err.splitlines()[0])
    if "none.json" in text:
        assert found["path"] == "none.json"
        assert found["severity"] == "error"
        return
    assert f"{found['line']}:{found['column']} {found['message']}|{found['help']}".startswith(
        message
    )
    assert found["path"] == "mars.toml"


# ---- Comments ------------------------------------------------------------------------------------


def commented(line: int, comment: str) -> str:
    lines = ROBOT.splitlines()
    lines[line - 1] += f" {comment}"
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("line", "comment", "hidden", "messages"),
    [
        (5, f"// mars: ignore[{ERROR}] it turns", {ERROR}, []),
        (5, f"# mars:ignore[ {ERROR} ]", {ERROR}, []),
        (5, "// mars: ignore[mounts/cycle] it turns", {ERROR}, []),
        (5, "// mars: ignore[mounts/repeated]", set(), ["5:39 this comment hides nothing"]),
        (5, "// mars: ignore[syntax]", set(), ["5:39 `syntax` is an error of the input"]),
        (3, f"// why // mars: ignore[{WARNING}, control_convergence]", {WARNING, *NOTES}, []),
        (3, f"// mars: ignore[{WARNING},{WARNING}]", {WARNING}, []),
        (4, f"// mars: ignore[{WARNING}]", set(), ["4:43 this comment hides nothing"]),
        (6, f"// mars: ignore[{ERROR}]", set(), ["6:41 this comment hides nothing"]),
        (5, "// mars: ignore[module_conflit]", set(), ["5:39 no rule finds `module_conflit`"]),
        (5, "// mars: ignore it turns", set(), ["5:26 this comment names no kind"]),
        (5, "// mars: ignore[] it turns", set(), ["5:26 this comment names no kind"]),
        (5, "// on mars: ignore it", set(), []),
    ],
)
def test_comments_hide_findings_of_their_line(
    line: int, comment: str, hidden: set[str], messages: list[str], folder: Path, capsys: Captured
) -> None:
    everything = kinds_of_robot()
    (folder / "a.mars").write_bytes(commented(line, comment).replace("\n", "\r\n").encode())
    status, kinds, remarks = analysed(capsys, "a.mars")
    assert (status, kinds) == (int(ERROR not in hidden), everything - hidden)
    assert [each[: len(start)] for each, start in zip(remarks, messages, strict=True)] == messages
    assert run_here(["check", "a.mars"]) == status
    assert ("hides nothing" in capsys.readouterr().out) == any(
        " hides nothing" in each for each in remarks
    )


def test_a_comment_belongs_to_the_first_place(folder: Path, capsys: Captured) -> None:
    (folder / "a.mars").write_text(commented(4, f"// mars: ignore[{WARNING}]"))
    _, _, (result,) = analysed(capsys, "a.mars")
    assert result.endswith("|move it to the end of line 3 of a.mars, its first place")


def test_a_finding_without_a_line_is_at_the_first(folder: Path, capsys: Captured) -> None:
    (folder / "own.lp").write_text(PACK)
    (folder / "a.mars").write_text(commented(1, "// mars: ignore[crowded] so it is"))
    words = ("a.mars", "--select", "crowded", "--rules", "own.lp")
    assert analysed(capsys, *words) == (0, set(), [])


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.yaml", "a: 'x # mars: ignore[n]' # mars: ignore[y] so\n", [(1, "y", "so")]),
        ("a.yaml", "a: it's # mars: ignore[y]\nb: x#mars:ignore[n]\n", [(1, "y", "")]),
        ("a.yml", "a: | # mars: ignore[y]\n  b # mars: ignore[n]\n", [(1, "y", "")]),
        ("a.yaml", 'a: "b\n  # mars: ignore[n]"\n', []),
        ("a.yaml", "a: [ # mars: ignore[n]\n", [(1, "n", "")]),
        ("a.launch.py", "x = '# mars: ignore[n]'  # mars: ignore[y] so\n", [(1, "y", "so")]),
        ("a.launch", "<a b='# mars: ignore[n]'/> <!-- mars: ignore[y] so -->\n", [(1, "y", "so")]),
        ("a.xml", "<a><![CDATA[<!-- mars: ignore[n] -->]]></a>", []),
        ("a.m", "x = '% mars: ignore[n]'; % mars: ignore[y]\n", [(1, "y", "")]),
        ("a.cpp", 's("// mars: ignore[n]"); /* mars: ignore[y] so */\n', [(1, "y", "so")]),
        ("a.rs", '/* a\n mars: ignore[y] /* b */ */ "// mars: ignore[n]"\n', [(2, "y", "/* b */")]),
        ("a.dot", 'graph { "// mars: ignore[n]"; } // mars: ignore[y]\n', [(1, "y", "")]),
        ("robot", "<a/> <!-- mars: ignore[y] -->", [(1, "y", "")]),
        ("a.mars", '"// mars: ignore[n]" uses_data_from B # mars: ignore[y]\n', [(1, "y", "")]),
        ("a.mars", "@sources a/*.cpp, b // mars: ignore[y]\n", [(1, "y", "")]),
        ("a.mars", "// mars: ignored[n] mars: ignores mars: ignore-not\n", []),
    ],
)
def test_comments_are_those_of_the_language(
    name: str, text: str, expected: list[tuple[int, str, str]]
) -> None:
    from mars_asp.cli.ignores import ignores_in

    found = [(span.line, kind, i.reason) for i in ignores_in(name, text) for kind, span in i.kinds]
    assert found == expected


def test_comments_of_sources_count_too(folder: Path, capsys: Captured) -> None:
    source = """\
# @module_start
# @module_name Camera
# @Sense NotifyWhenReady
# @Output Image{}
def grab() -> Image: ...
# @Sense NotifyWhenReady
# @Output Pose
def look() -> Pose: ...
# @module_end
"""
    robot = ROBOT.replace("@modules", "@sources camera.py\n@modules")
    (folder / "a.mars").write_text(robot.replace("_from Camera", "_from Camera.grab"))
    (folder / "camera.py").write_text(source.format(""))
    run_here(["analyse", "a.mars", "--format", "json"])
    listed = json.loads(capsys.readouterr().out)["consequences"]
    placed = [c for c in listed if c["locations"][0]["path"] == "camera.py"]
    assert placed
    line, kind = placed[0]["locations"][0]["line"], placed[0]["kind"]
    lines = source.format("").splitlines()
    lines[line - 1] += f"  mars: ignore[{kind}]"
    (folder / "camera.py").write_bytes("\r\n".join(lines).encode("latin-1") + b" # \xe9")
    _, kinds, result = analysed(capsys, "a.mars")
    assert kind not in kinds
    assert not any("hides nothing" in each for each in result)


# ---- Baselines -----------------------------------------------------------------------------------


def test_a_baseline_hides_listed_findings_wherever_they_move(
    folder: Path, capsys: Captured
) -> None:
    assert run_here(["check", "a.mars", "--write-baseline", "known.json"]) == 0
    assert capsys.readouterr().err.startswith(
        "mars-asp: note: known.json: the baseline lists 2 findings"
    )
    done = mars("check", str(folder / "a.mars"), "--write-baseline", "gone/known.json")
    message = "mars-asp: error: gone/known.json: there is no folder `gone` to write to\n"
    message += "    help: make it first\n"
    assert (done.returncode, done.stdout, done.stderr) == (2, "", message)
    assert (folder / "known.json").read_text() == (
        '{"format": "mars-baseline", "version": 1, "findings": [\n'
        '  {"file": "a.mars", "kind": "ambiguous_priority", "subject": "Base", "participants": '
        '["A", "B"]},\n'
        '  {"file": "a.mars", "kind": "module_conflict", "subject": "Arm", "participants": '
        '["Arm"]}\n'
        "]}\n"
    )
    moved = ROBOT.replace("Base is", "// moved\n\n\nBase is", 1)
    (folder / "a.mars").write_text(moved)
    assert run_here(["check", "a.mars", "--baseline", "known.json"]) == 0
    assert capsys.readouterr().err == "not reported: 2 in the baseline\n"
    (folder / "mars.toml").write_text('baseline = "known.json"')
    assert analysed(capsys, "a.mars", "--select", f"{ERROR},{WARNING}") == (0, set(), [])
    # What is new is reported, also where something alike is known.
    (folder / "a.mars").write_text(f"{moved}Camera is_mounted_on Camera\n")
    assert run_here(["check", "a.mars"]) == 1
    assert "`Camera -> Camera`" in capsys.readouterr().out
    # A baseline written anew also lists the entries of the old one.
    assert run_here(["check", "a.mars", "--write-baseline", "known.json"]) == 0
    assert len((folder / "known.json").read_text().splitlines()) == 5


def test_a_note_counts_entries_of_a_baseline_that_match_nothing(
    folder: Path, capsys: Captured
) -> None:
    (folder / "b.mars").write_text(ROBOT)
    assert run_here(["analyse", "a.mars", "--write-baseline", "known.json"]) == 0
    (folder / "sub").mkdir()
    assert run_here(["check", "a.mars", "b.mars", "--write-baseline", "sub/known.json"]) == 0
    capsys.readouterr()
    assert '"../a.mars"' in (folder / "sub/known.json").read_text()
    # Notes that are listed were found, though `check` reports none, and so were ignored kinds.
    assert run_here(["check", "a.mars", "--baseline", "known.json", "--ignore", ERROR]) == 0
    assert "nothing any more" not in capsys.readouterr().err
    # `b.mars` was not checked.
    (folder / "a.mars").write_text(ROBOT.replace("Arm is_mounted_on Arm\n", ""))
    assert run_here(["check", "a.mars", "--baseline", "sub/known.json"]) == 0
    assert (
        "mars-asp: note: sub/known.json: 1 finding of the baseline matches nothing any more: "
        "`module_conflict(Arm)` of `../a.mars` [baseline]\n"
    ) in capsys.readouterr().err
    # A file that is gone is not found again.
    (folder / "b.mars").unlink()
    assert run_here(["check", "a.mars", "--baseline", "sub/known.json"]) == 0
    assert "3 findings of the baseline match nothing" in capsys.readouterr().err


def test_a_baseline_lists_each_of_two_that_are_alike(folder: Path, capsys: Captured) -> None:
    twice = ROBOT + "A uses_data_from Camera\n"
    (folder / "a.mars").write_text(twice)
    run_here(["check", "a.mars", "--select", "duplicate_relationship", "--write-baseline", "k"])
    (folder / "a.mars").write_text(twice + "Base is_controlled_by B 1\n")
    assert (
        run_here(["check", "a.mars", "--baseline", "k", "--select", "duplicate_relationship"]) == 0
    )
    assert "1 warning" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"", "1:1: error: the baseline is not JSON"),
        (
            b'{"format": "mars-baseline",\n "version": 1,\n "findings": [}',
            "3:15: error: the baseline is not JSON",
        ),
        (b"[]", "1:1: error: a baseline begins"),
        (b'{"format": "mars-trace"}', "1:1: error: a baseline begins"),
        (b'{"format": "mars-baseline", "version": 2}', "1:1: error: this baseline has version 2"),
        (b'{"format": "mars-baseline"}', "1:1: error: this baseline has version null"),
        (b'{"format": "mars-baseline", "version": 1}', "1:1: error: `findings` must be a list"),
        (
            b'{"format": "mars-baseline", "version": 1, "findings": [{"file": 1}]}',
            "1:1: error: entry 1 of `findings`",
        ),
        (b"[" * 100_000, "1:1: error: the JSON is nested"),
        (b"\xff\xfe\x00", "1:1: error: "),
        (b"\x00\xff", "1:1: error: the file is not UTF-8"),
        (b" " * (33 * 1024 * 1024), "mars-asp: error: k.json: is larger"),
        (None, "mars-asp: error: k.json: no such file"),
    ],
)
def test_an_invalid_baseline_is_refused(
    raw: bytes | None, message: str, folder: Path, capsys: Captured
) -> None:
    if raw is not None:
        (folder / "k.json").write_bytes(raw)
    assert run_here(["check", "a.mars", "--baseline", "k.json"]) == 2
    # Errors in the file are findings, and a wrong value of an option is not.
    output = capsys.readouterr()[message.startswith("mars-asp")]
    assert output.startswith((f"k.json:{message}", message))


@pytest.mark.parametrize("verb", ["check", "analyse"])
def test_a_baseline_is_read_or_written_or_renewed(
    verb: str, folder: Path, capsys: Captured
) -> None:
    words = [verb, "a.mars", "--write-baseline", "new.json", "--baseline"]
    assert run_here([*words, "old.json"]) == 2
    assert "--write-baseline lists all findings" in capsys.readouterr().err
    assert not (folder / "new.json").exists()
    for _ in range(2):
        assert run_here([*words, "new.json"]) == 0
    assert (folder / "new.json").exists()


def test_no_baseline_is_written_if_a_file_cannot_be_read(folder: Path, capsys: Captured) -> None:
    (folder / "bad.mars").write_text("@configuration\n@modules A,,\n")
    assert run_here(["check", "a.mars", "bad.mars", "--write-baseline", "k.json"]) == 2
    assert "no baseline was written" in capsys.readouterr().err
    assert not (folder / "k.json").exists()


TIED = (
    "@configuration hierarchical\n@modules A, B, Base\n"
    "Base is_controlled_by A\nBase is_controlled_by B\n"
)


def test_a_baseline_keeps_the_findings_of_files_that_were_not_read(
    folder: Path, capsys: Captured
) -> None:
    names = ("c.mars", "d.mars", "e.mars")
    for name in names:
        (folder / name).write_text(TIED)
    assert run_here(["check", *names, "--write-baseline", "k.json"]) == 0
    (folder / "c.mars").write_text(TIED.replace("by B", "by B 1"))
    (folder / "e.mars").unlink()
    capsys.readouterr()
    assert run_here(["check", "c.mars", "--write-baseline", "k.json"]) == 0
    assert "lists 1 finding, 1 of them as before, of what was not read" in capsys.readouterr().err
    listed = json.loads((folder / "k.json").read_text())["findings"]
    assert [each["file"] for each in listed] == ["d.mars"]
    assert run_here(["check", "c.mars", "d.mars", "--baseline", "k.json", *FAIL]) == 0


FAIL = ("--fail-on", "warning")
MISSPELT = (
    TIED.replace("Base\n", "Base, Camera\n", 1)
    + "A uses_data_from Camera.imge\n@module_start\n@module_name Camera\n"
    + "@Sense NotifyWhenReady\nImage image();\n@module_end\n"
)


@pytest.mark.parametrize("named", ["option", "settings", "input"])
def test_a_baseline_still_counts_after_repairs(named: str, folder: Path) -> None:
    (folder / "c.mars").write_text(MISSPELT)
    kinds = ["--select", "ambiguous_priority", "--write-baseline", "k.json"]
    assert run_here(["check", "c.mars", *kinds]) == 0
    words = ["check", "c.mars", "--fix", *FAIL]
    if named == "settings":
        (folder / "mars.toml").write_text('baseline = "k.json"\n')
    else:
        words += ["--baseline", "k.json"]
    if named == "input":
        words = [*words, "--stdin-filename", "c.mars"]
        words[1] = "-"
        assert mars(*words, text=MISSPELT, folder=folder).returncode == 0
    else:
        assert run_here(words) == 0
        assert "imge" not in (folder / "c.mars").read_text()


@pytest.mark.parametrize("format", ["text", "github", "gitlab", "sarif", "json"])
def test_findings_in_a_shared_file_are_reported_once(
    format: str, folder: Path, capsys: Captured
) -> None:
    (folder / "shared.mars").write_text(MISSPELT)
    for name in ("c.mars", "d.mars"):
        (folder / name).write_text("@configuration hierarchical\n@include shared.mars\n")
    capsys.readouterr()
    words = ["check", "c.mars", "d.mars", "--format", format]
    assert run_here(words) == 1
    output = "".join(capsys.readouterr())
    assert output.count("no output `Camera.imge`") == 1
    if format == "text":
        assert "1 error, 1 warning in 2 files" in output
        assert "\n1 of them has exactly one repair" in output
    if format == "json":
        document = json.loads(output.rpartition("}")[0] + "}")
        assert [each["errors"] for each in document["files"]] == [1, 1]
        assert document["errors"] == 1
    # Both have to fail in a report with a suite for each robot.
    assert run_here([*words[:-1], "junit"]) == 1
    assert capsys.readouterr().out.count("<failure") == 4
    assert run_here([*words[:3], "--fix"]) == 0
    assert capsys.readouterr().err.endswith("1 warning in 2 files; 1 fixed\n")


def test_findings_hidden_by_comments_are_in_no_baseline(folder: Path, capsys: Captured) -> None:
    (folder / "a.mars").write_text(commented(5, f"// mars: ignore[{ERROR}]"))
    assert run_here(["check", "a.mars", "--write-baseline", "-"]) == 0
    (listed,) = json.loads(capsys.readouterr().out)["findings"]
    assert listed["kind"] == WARNING


def test_a_baseline_comes_from_standard_input(folder: Path) -> None:
    listed = mars("check", str(folder / "a.mars"), "--write-baseline", "-").stdout
    done = mars("check", str(folder / "a.mars"), "--baseline", "-", text=listed)
    assert (done.returncode, done.stderr) == (0, "not reported: 2 in the baseline\n")
    twice = mars("check", "-", "--baseline", "-", text=listed)
    assert (twice.returncode, twice.stderr[:14]) == (2, "mars-asp: erro")


def test_fix_ignores_hidden_findings(folder: Path) -> None:
    text = ROBOT + "B uses_data_from Camera\n"
    (folder / "a.mars").write_text(text)
    assert (
        run_here(["check", "a.mars", "--fix", "--ignore", f"duplicate_relationship,{ERROR}"]) == 0
    )
    assert (folder / "a.mars").read_text() == text
    run_here(["check", "a.mars", "--fix", "--ignore", ERROR])
    assert (folder / "a.mars").read_text() == ROBOT


# ---- Other verbs ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("verb", "more", "hidden_by"),
    [
        ("synthesise", [], "option"),
        ("synthesise", [], "settings"),
        ("explain", [], "comment"),
        ("explain", [], "baseline"),
        ("explain", ["--repair"], "option"),
        ("explain", ["--alternatives"], "comment"),
    ],
)
def test_verbs_that_find_something_on_their_way_hide_it_too(
    verb: str, more: list[str], hidden_by: str, folder: Path, capsys: Captured
) -> None:
    assert run_here([verb, "a.mars", *more]) == 1
    shown = capsys.readouterr()
    text = "mounts form a cycle" in shown.out + shown.err
    # `--alternatives` does not report the cycle.
    assert text == (more != ["--alternatives"])
    options = []
    if hidden_by == "option":
        options = ["--ignore", ERROR]
    elif hidden_by == "settings":
        (folder / "mars.toml").write_text(f'ignore = ["{ERROR}"]')
    elif hidden_by == "comment":
        (folder / "a.mars").write_text(commented(5, f"// mars: ignore[{ERROR}]"))
    else:
        run_here(["check", "a.mars", "--write-baseline", "k.json"])
        options = ["--baseline", "k.json"]
    capsys.readouterr()
    assert run_here([verb, "a.mars", *more, *options]) == 0
    shown = capsys.readouterr()
    assert "mounts form a cycle" not in shown.out + shown.err


def test_a_hidden_finding_can_be_explained(capsys: Captured) -> None:
    assert run_here(["explain", "a.mars", f"{ERROR}(Arm)", "--ignore", ERROR]) == 0
    assert "mounts form a cycle" in capsys.readouterr().out


def test_verbs_agree_on_the_first_place_of_a_finding(folder: Path, capsys: Captured) -> None:
    """All commands match a finding of a baseline by the file of its first location."""
    robot = str(ROOT / "tests/repair/left-over/config.mars")
    run_here(["check", robot, "--write-baseline", "k"])
    for words in (["--only", "consequences"], ["--repair"]):
        capsys.readouterr()
        assert run_here(["explain", robot, *words, "--baseline", "k", "--quiet"]) == 0
        assert "loose_end(" not in capsys.readouterr().out
    run_here(["check", str(ROOT / "examples/ros2_workspace"), "--write-baseline", "k"])
    capsys.readouterr()
    words = ["explain", str(ROOT / "examples/ros2_workspace"), "--baseline", "k", "--quiet"]
    assert run_here(words) == 0
    assert capsys.readouterr().out == ""


def test_comments_at_the_first_place_hide_from_explanations_too(
    folder: Path, capsys: Captured
) -> None:
    text = (ROOT / "tests/repair/left-over/config.mars").read_text(encoding="utf-8")
    hidden = text.replace("@ControlOut\n", "@ControlOut // mars: ignore[loose_end] later\n")
    (folder / "r.mars").write_text(hidden)
    for words in (
        ["explain", "r.mars", "--only", "consequences"],
        ["explain", "r.mars", "--repair"],
    ):
        assert run_here([*words, "--quiet"]) == 0
        shown = capsys.readouterr().out
        assert "unused_module" in shown
        assert "Track.picture`, and nothing takes" not in shown


def test_each_of_many_wrong_settings_has_its_place_and_the_file_is_read_once_for_all(
    folder: Path, monkeypatch: Patch
) -> None:
    places = Mock(wraps=toml_text.Places)
    monkeypatch.setattr(toml_text, "Places", places)
    (folder / "mars.toml").write_text("ignore = [\n" + "1,\n" * 3000 + "]\n")
    assert [each.span.line for each in refusals(settings_for, folder)] == [*range(2, 3002)]
    assert places.call_count == 1
