"""Words of the command line: help, examples, suggestions, and completion by bash."""

import re
import shlex
import subprocess
from pathlib import Path

import pytest

from mars_asp.cli import run_command, run_here
from mars_asp.cli.arguments import VERBS, help_texts, parser_of
from mars_asp.cli.check_output import FORMATS
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import mars

FIGURE = str(ROOT / "examples" / "figure04-divergence" / "config.mars")


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"]])
def test_the_help_names_each_verb_with_an_example_and_the_common_options_once(
    words: list[str], capsys: Captured
) -> None:
    assert run_command(words) == 0
    shown = capsys.readouterr().out
    for name in VERBS:
        example = help_texts()[name]["example"]
        assert f"\n  {name}" in shown
        assert f"$ mars-asp {example}\n" in shown
        assert example.split()[0] == name
    assert shown.count("--memory-limit MB") == shown.count("--rules DIR") == 1
    assert "half of" in shown
    first = " ".join(" ".join(shown.splitlines()[:24]).split())
    assert "ROS workspaces, twist_mux files, dora dataflows, URDF and `.mars` files" in first
    assert first.partition("$ mars-asp ")[2].startswith("check my_ws/ ")
    assert not re.search(r"\bverbs?\b", shown)
    assert all(len(line) <= 80 for line in shown.splitlines())


@pytest.mark.parametrize("name", VERBS)
def test_each_argument_has_a_sentence_of_help(name: str) -> None:
    _, parser = parser_of(name)
    parser.format_help()
    assert [action for action in parser.positionals() + parser.options() if not action.help] == []


def test_the_help_of_draw_names_the_kind_of_side_lines(capsys: Captured) -> None:
    run_command(["draw", "--help"])
    assert "suppress and inhibit lines are data or control" in " ".join(
        capsys.readouterr().out.split()
    )


@pytest.mark.parametrize("name", VERBS)
def test_the_help_of_a_verb_shows_its_example(name: str, capsys: Captured) -> None:
    assert run_command([name, "--help"]) == 0
    words = capsys.readouterr().out.split()
    assert {"verb", "verbs"}.isdisjoint(words)
    assert " ".join(help_texts()[name]["example"].split()) in " ".join(words)
    assert words.count("--memory-limit") == 2
    _, parser = parser_of(name)
    _, *example = shlex.split(help_texts()[name]["example"])
    parser.parse_intermixed_args(example)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["chek"], "there is no command `chek`: did you mean `check`?"),
        (["anlyze"], "did you mean `analyze`?"),
        (["Check"], "did you mean `check`?"),
        (["xyzzy"], "one of check, analyse,"),
        (["check", "--fail-on", "errors"], "did you mean `error`?"),
        (["format", "a.mars"], "did you mean `fmt`?"),
        (
            ["check", "a.mars", "--quite"],
            "arguments: --quite: did you mean `--quiet`?",
        ),
        # An option is never abbreviated, and one that writes files never proposed.
        (["check", "a.mars", "--fxi"], "unrecognized arguments: --fxi"),
        (["check", "a.mars", "--fi"], "unrecognized arguments: --fi; see"),
        (["check", "a.mars", "--write-base", "b"], "unrecognized arguments: --write-base b; see"),
        (["check", "a.mars", "--quie"], "did you mean `--quiet`?"),
        (["check", "a.mars", "--fromat=json"], "did you mean `--format`?"),
        (["check", "a.mars", "--xyzzy"], "unrecognized arguments: --xyzzy; see `mars-asp check -"),
        (["--fromat", "json", "check"], "unknown option `--fromat`: did you mean `--format`?"),
        (["--vresion"], "did you mean `--version`?"),
        (["check", "--message-format", "json"], "did you mean `--format`?"),
        (["check", "--output-format=json"], "did you mean `--format`?"),
        (["--json", "check"], "unknown option `--json`: did you mean `--format json`?"),
        (["check", "--sarif"], "did you mean `--format sarif`?"),
        # An option or a value that the command does not have is not proposed.
        (["test", "--sarif"], "unrecognized arguments: --sarif; see"),
        (["check", "-k", "guard"], "did you mean `--select`?"),
        # Other options have no words of this tool, but there is another way.
        (["test", "-k", "guard"], "arguments: -k: name the files of the cases to run; see"),
        (["facts", "a.mars", "-o", "a.lp"], "arguments: -o a.lp: redirect standard output, as in"),
        (["explain", "a.mars", "--format", "html"], "`-o explained.html`; see"),
        (["explain", "a.mars", "--only", "node"], "did you mean `--only nodes`?"),
        (["facts", "a.mars", "--format", "json"], "invalid choice: 'json' (choose from 'text'): f"),
        (["diff", "a.mars", "b.mars", "--exit-code"], "the status is 1 where an error appeared;"),
        (["rules", "test", "pack"], "did you mean `mars-asp test`?"),
        (
            ["synthesise", "a.mars", "--alternatives"],
            "`mars-asp explain FILE --alternatives` lists",
        ),
        (["fmt", "-w", "a.mars"], "arguments: -w: `fmt` changes the files without it; see"),
        (["check", "--watch"], "arguments: --watch: `mars-asp lsp`, the server for editors,"),
        (["draw", "a.mars", "-Tpng"], "arguments: -Tpng: did you mean `--as`?"),
        (["check", "--max-warnings", "0"], "did you mean `--fail-on warning`?"),
        (["solve", "a.mars"], "no command `solve`: did you mean `synthesise`?"),
        (["test", "-j", "2"], "did you mean `--jobs`?"),
        (["check", "--no-color"], "did you mean `--color never`?"),
        (["check", "-Werror"], "did you mean `--fail-on warning`?"),
        (["check", "--show-files"], "did you mean `--verbose`?"),
        (["check", "--fix-only"], "did you mean `--diff`?"),
        (["check", "--explain", "guard_bypass"], "did you mean `explain`?"),
        (["export", "dot", "a.mars"], "did you mean `draw --as dot`?"),
        (["draw", "a.mars", "--format", "svg"], "did you mean `--as svg`?"),
        (["draw", "a.mars", "--format", "mmd"], "did you mean `--as mmd`?"),
        (["rules", "explain", "guard_bypass"], "did you mean `rules show`?"),
        (["rule", "guard_bypass"], "no command `rule`: did you mean `rules show`?"),
        (["fix"], "no command `fix`: did you mean `check --fix`?"),
        (["clean"], "no command `clean`: one of "),
        (["version"], "there is no command `version`: did you mean `--version`?"),
        (["-x"], "unknown option `-x`; see `mars-asp --help`"),
        (["", "check"], "there is no command ``"),
        (["analyse"], "the following arguments are required: FILE"),
        (["check", "x", "--memory-limit", "0"], "`0` must be a positive number"),
        (["import", "twistmux", "x"], "did you mean `twist_mux`?"),
        (["run", "a.mars", "--scenari", "x"], "--scenari: did you mean `--scenario`?"),
        (["campaign", "a.mars", "-s", "x"], "-s: did you mean `--scenario`?"),
        (["run", "a.mars", "--set", "x=3"], "--set: did you mean `--vary`?"),
        (["test", "--cov"], "--cov: did you mean `--coverage`?"),
        (["synthesise", "a.mars", "--release"], "unrecognized arguments: --release; see"),
        (["topic", "list"], "did you mean `import ros2 WORKSPACE` or `explain WORKSPACE TOPIC`?"),
    ],
)
def test_suggestions_for_misspelt_words(words: list[str], message: str, capsys: Captured) -> None:
    assert run_command(words) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert message in " ".join(shown.err.split())
    assert "?;" not in shown.err
    assert "`--fix`" not in shown.err and "`--write" not in shown.err


def test_a_file_with_a_dash_in_front_is_named_with_its_folder(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("-x.mars").touch()
    assert run_command(["check", "-x.mars"]) == 2
    assert "write `./-x.mars` for the file;" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["import", FIGURE, "ros2"], "FORMAT comes before the files"),
        (["import", "-"], "name the format of standard input"),
        (["import", FIGURE], "is not known by its content: mars-asp import FORMAT FILE"),
        (["rules", "list", "tests"], "`rules list --rules tests` adds a pack"),
        (["can", "Rotn_Y of A", FIGURE], "the query comes after the file: mars-asp can "),
        (["can", FIGURE, "Rotn_Y", "of", "A"], "put it in quotes, as in 'Trans_Z of Base'"),
        (["rules", "new", "3d-lidar"], "begin with a small letter; then write small letters"),
        (["explain", "guard_bypas"], "did you mean `guard_bypass`? A module of a robot"),
    ],
)
def test_words_in_the_wrong_place(words: list[str], message: str, capsys: Captured) -> None:
    assert run_here(words) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_each_meaning_of_a_word_of_other_tools_is_a_word_of_this_one() -> None:
    meant = help_texts()["meant"]
    assert {"--fix", "--write-baseline", "--output", "--update"}.isdisjoint(meant.values())
    options = {
        name
        for verb in VERBS
        for option in parser_of(verb)[1].options()
        for name in option.option_strings
    }
    for word, words in meant.items():
        first, *further = words.split()
        assert first in (options if first.startswith("-") else VERBS), word
        if further and first in VERBS:
            parser_of(first)[1].parse_known_intermixed_args([*further, "x", "y"])


@pytest.mark.parametrize(
    ("words", "same"),
    [
        (["-V"], ["--version"]),
        (["--quiet", "--version"], ["--version"]),
        (["help"], ["--help"]),
        (["help", "check"], ["check", "--help"]),
        (["--help", "check"], ["check", "--help"]),
        (["--format", "json", "-q", "check", FIGURE], ["check", FIGURE, "-q", "--format=json"]),
        (["--format=json", "check", FIGURE], ["check", FIGURE, "--format", "json"]),
        (["rules"], ["rules", "list"]),
        (["draw", FIGURE], ["draw", FIGURE, "-o", "-"]),
    ],
)
def test_two_ways_to_write_a_command(words: list[str], same: list[str], capfd: Captured) -> None:
    outcomes = []
    for each in (words, same):
        outcomes.append((run_command(each), *capfd.readouterr()))
    assert outcomes[0] == outcomes[1]
    assert outcomes[0][0] == 0 and outcomes[0][1]


def test_a_format_alone_has_no_file_to_read(capsys: Captured) -> None:
    assert run_here(["import", "urdf"]) == 2
    assert capsys.readouterr().err == "mars-asp import: name the files: mars-asp import urdf FILE\n"


@pytest.mark.parametrize(("command", "first"), [("import", "urdf"), ("completion", "bash")])
def test_a_command_alone_lists_its_choices(command: str, first: str, capfd: Captured) -> None:
    assert run_command([command]) == 0
    assert capfd.readouterr().out.splitlines()[0] == first


@pytest.fixture(scope="module")
def completion() -> str:
    return mars("completion", "bash").stdout


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["ch"], ["check"]),
        (["s"], ["synthesise"]),
        (["--v"], ["--verbose", "--version"]),
        (["-q", "--format", "json", "ch"], ["check"]),
        (["--format", "=", "json", "ch"], ["check"]),
        (["--color", "al"], ["always"]),
        (["-q", "check", "--fail"], ["--fail-on"]),
        (["help", "ca"], ["can", "campaign"]),
        (["help", "help", ""], list(VERBS)),
        (
            ["check", "--select", "unused_"],
            ["unused_argument", "unused_module", "unused_output", "unused_parameters"],
        ),
        (["check", "--ignore", "loose_end,catal"], ["loose_end,catalogue"]),
        (["check", "--ignore", "=", "no_c"], ["no_conversion"]),
        (["check", "--f"], ["--fail-on", "--fix", "--force-exclude", "--format", "--from"]),
        (["explain", "x.mars", "--why"], ["--why-not"]),
        (["check", "x", "--format", ""], list(FORMATS)),
        (["analyse", "x", "--format", ""], ["text", "json", "sarif", "github"]),
        (["check", "x", "--format", "j"], ["json", "junit"]),
        (["check", "--format", "=", "js"], ["json"]),
        (["diff", "--format", "="], ["text", "json"]),
        (["analyze", "--color", "al"], ["always"]),
        (["check", "--rules", ""], []),
        (["check", ""], []),
        (["rules", "s"], ["show"]),
        (["completion", ""], ["bash", "zsh", "fish"]),
        (["nothing", "--"], []),
    ],
)
def test_bash_completes(completion: str, words: list[str], expected: list[str]) -> None:
    typed = " ".join(shlex.quote(word) for word in ["mars-asp", *words])
    script = f"""{completion}
        complete -p mars-asp > /dev/null || exit 1
        COMP_WORDS=({typed}); COMP_CWORD={len(words)}; _mars_asp
        ((${{#COMPREPLY[@]}})) && printf '%s\\n' "${{COMPREPLY[@]}}"; true"""
    done = subprocess.run(
        ["bash", "--norc", "-c", script], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(done.stdout.split()) == sorted(expected)


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_have_each_command_and_option(shell: str, capsys: Captured) -> None:
    assert run_here(["completion", shell]) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in (*VERBS, "analyze", "why-not", "memory-limit"))
    # Quotes are closed in each command.
    commands = shown.replace("\\\n", "").splitlines()
    assert all(shlex.split(line, comments=True) is not None for line in commands)
