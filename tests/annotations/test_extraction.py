"""Annotated sources: the expected modules of each, hostile ones included."""

import json
import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from mars_asp.annotations.blocks import read_blocks
from mars_asp.annotations.directives import MOST_OTHERS
from mars_asp.annotations.files import extract
from mars_asp.annotations.following import MOST_DECLARED
from mars_asp.annotations.languages import LANGUAGES
from mars_asp.annotations.modules import MOST_ERRORS
from mars_asp.annotations.types import representation
from mars_asp.cli.extract import extraction_json
from mars_asp.diagnostic import Diagnostic
from mars_asp.model.declarations import Module
from tests.support.documents import ROOT, run

FOLDER = ROOT / "tests" / "extraction"
CASES = [path for path in sorted((FOLDER / "cases").iterdir()) if path.suffix in LANGUAGES]
EXPECTED = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))


#: Keys of services, and of modules, that came later.
ADDED = ("port", "parameters")
ADDED_TO_MODULES = ("tags", "properties")


def plain(word: str) -> str:
    return re.sub(r"[-_ ]", "", word.lower())


def comparable(module: dict[str, object]) -> dict[str, object]:
    module = {key: value for key, value in module.items() if key not in ("path", *ADDED_TO_MODULES)}
    classes = module["class"]
    assert isinstance(classes, list)
    services = module["services"]
    assert isinstance(services, list)
    read = [{k: v for k, v in each.items() if k not in ADDED} for each in services]
    return {**module, "class": [plain(name) for name in classes], "services": read}


def answers(found: Diagnostic, problem: dict[str, list[list[int | None]] | list[str]]) -> bool:
    text = f"{found.message} {found.help} {found.code}"
    place = (found.span.line, found.span.column)
    at = any(
        all(want is None or want == have for want, have in zip(allowed, place, strict=True))
        for allowed in problem["at"]
    )
    return at and all(re.search(str(word), text, re.IGNORECASE) for word in problem["mentions"])


@pytest.mark.parametrize("name", EXPECTED)
def test_case(name: str) -> None:
    found = extract([FOLDER / name])
    modules = extraction_json(found)["modules"]
    assert isinstance(modules, list)
    assert list(map(comparable, modules)) == list(map(comparable, EXPECTED[name]["modules"]))
    left = list(found.diagnostics)
    for problem in EXPECTED[name]["problems"]:
        answer = next((d for d in left if answers(d, problem)), None)
        assert answer is not None or not problem["required"], problem
        if answer is not None:
            left.remove(answer)
            assert problem["severity"] != "error" or answer.severity == "error"
    assert [d for d in left if d.severity == "error"] == []


def test_ports_have_keys_of_their_own(tmp_path: Path) -> None:
    lines = ("@module_name Eye", "@DataOut NotifyWhenReady", "@Port image/raw")
    start = "".join(f"// {line}\n" for line in ("@module_start", *lines))
    (tmp_path / "eye.hpp").write_text(f"{start}Image see(Ray light, Ray);\n// @module_end\n")
    modules = extraction_json(extract([tmp_path]))["modules"]
    assert isinstance(modules, list)
    (service,) = modules[0]["services"]
    assert {key: service[key] for key in ADDED} == {
        "port": "image/raw",
        "parameters": ["light", "Ray"],
    }


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.name)
def test_a_case_prints_the_expected_output(path: Path, update_golden: bool) -> None:
    """The modules, then all messages, as on the command line."""
    golden = path.with_name(f"{path.name}.txt")
    printed = run(f"mars-asp extract {path.relative_to(ROOT)}")
    if update_golden:
        golden.write_text(printed, encoding="utf-8", newline="\n")
    assert printed == golden.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("std::optional<std::vector<Point>>", "Point[]"),
        ("std::shared_ptr<const msgs::msg::LaserScan>", "msgs::LaserScan"),
        ("sensor_msgs::msg::LaserScan::SharedPtr", "sensor_msgs::LaserScan"),
        ("const std::map<std::string, Pose> &", "map<std::string,Pose>"),
        ("long unsigned int", "unsigned long"),
        ("std::function<void(int)>", "function"),
        ("Result<Map, E>", "Map"),
        ("impl Future<Output=Scan>", "Scan"),
        ("&'a mut Scan", "Scan"),
        ("[]byte", "byte[]"),
        ("map[string]Pose", "map<string,Pose>"),
        ("(Fix, error)", "Fix"),
        ("Pose | None", "Pose"),
        ("AsyncIterator[Pose]", "Pose"),
        ("List<? extends Pose>", "Pose[]"),
        ("tuple[A, B]", "(A,B)"),
        ("Rooms$Door<a.B$C>", "Rooms::Door<a::B::C>"),
        ("$Own", "$Own"),
        ("Rooms$", None),
        ("Übersicht", "Übersicht"),
        ("void *", None),
        ("auto", None),
        ("void", ""),
        ("[", None),
        ("Vec<[", None),
        ("[]", None),
    ],
)
def test_representation(written: str, name: str | None) -> None:
    assert representation(written) == name


TYPE_PIECES = (
    "< > [ ] ( ) * & :: . | , ; ? -> ... A vector std Option impl Future Output = func chan map struct"
    " const unsigned int 3 'a mut dyn Fn Vec list extends super interface { } $ None Callable"
).split()


def test_any_type_is_read_or_unknown() -> None:
    rng = random.Random(0)
    for _ in range(5000):
        written = rng.choice([" ", ""]).join(rng.choices(TYPE_PIECES, k=rng.randint(1, 9)))
        assert isinstance(representation(written), str | None), written


LAYOUTS = {
    "line": "// @module_start\n// @module_name A\n// @Sense RequestWhenReady\n{f}\n// @module_end\n",
    "doc": "/// @module_start\n//! @module_name A\n///   @Sense   RequestWhenReady\n{f}\n//@module_end\n",
    "block": "/* @module_start\n * @module_name A\n   @Sense RequestWhenReady -- all of it\n */\n{f}\n"
    "/* @module_end */\n",
    "behind": "int x; // @module_start\nint y; // @module_name A\n// @Sense RequestWhenReady\n{f}"
    " // @module_end\n",
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    "declaration",
    [
        "Map build(Scan s, const Imu & i);",
        "Map\nbuild(\n    Scan s,\n    const Imu &\n      i\n);",
        "template <class T> [[nodiscard]] inline auto build(Scan s, Imu* i) -> Map { return {}; }",
    ],
)
def test_layout_changes_nothing(tmp_path: Path, layout: str, end: str, declaration: str) -> None:
    path = tmp_path / "a.cpp"
    path.write_bytes(LAYOUTS[layout].format(f=declaration).replace("\n", end).encode())
    found = extract([path])
    assert found.diagnostics == ()
    (module,) = found.modules
    (service,) = module.services
    assert (service.function, service.output, service.inputs) == ("build", "Map", ("Scan", "Imu"))


def test_one_name_in_two_files(tmp_path: Path) -> None:
    text = LAYOUTS["line"].format(f="X f();")
    for name in ("a.cpp", "b.cpp"):
        (tmp_path / name).write_text(text)
    (problem,) = extract([tmp_path]).diagnostics
    assert problem.severity == "error"
    assert problem.span.path.endswith("b.cpp")
    assert "a.cpp:1" in problem.message


def test_links_that_lead_in_circles_end(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path)
    (tmp_path / "a.cpp").write_text(LAYOUTS["line"].format(f="X f();"))
    assert [module.name for module in extract([tmp_path]).modules] == ["A"]


TEXTS = [
    path.read_bytes().decode("latin-1").replace("\r", "\n")
    for path in (*sorted(FOLDER.glob("*.*")), *CASES)
    if path.suffix in LANGUAGES
]
PIECES = [
    *(
        "",
        '"',
        "'",
        "/*",
        "*/",
        "//",
        "(",
        ")",
        "<",
        ">",
        "{",
        "}",
        "[[",
        "`",
        "\n",
        ",",
        "\\",
        "%",
        "#",
    ),
    *(
        'R"x(',
        ')x"',
        'R"(',
        '8R"',
        'r#"',
        '"#',
        "'''",
        '"""',
        "1'0",
        "'a",
        "...",
        "\\\n",
        "%{\n",
        "\n%}\n",
    ),
    *(
        "#if 0\n",
        "\n#else\n",
        "\n#endif\n",
        "@",
        "@Sense",
        "\u00e9",
        "\u2014",
        "\n// @Input A,\n// B\n",
    ),
    *("// @module_end\n", "# @Sense RequestWhenReady\n", "% @module_start\n", "@Output X\n"),
]


def mutated(language: str, count: int) -> Iterator[str]:
    """Yield cases and parts of cases, with a few pieces put in and cut out."""
    rng = random.Random(language)
    marks = {"python": "#", "matlab": "%"}.get(language, "//")
    for _ in range(count):
        text = "".join(rng.choices(TEXTS, k=rng.randint(1, 2))).replace("//", marks)
        if rng.random() < 0.8:
            # A part of it, which is read in a fifth of the time.
            begin = rng.randrange(len(text))
            text = text[begin : begin + rng.randint(20, 400)]
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(text) + 1)
            length = rng.choice([0, 0, 1, 5])
            text = text[:at] + rng.choice(PIECES) + text[at + length :]
        yield text


def codes(text: str) -> set[str]:
    """Return the codes of problems in a text; `MARS104 to MARS107` are four."""
    found = set(re.findall(r"MARS[0-9]+", text))
    for first, last in re.findall(r"MARS([0-9]+) to MARS([0-9]+)", text):
        found |= {f"MARS{number}" for number in range(int(first), int(last) + 1)}
    return found


DOCUMENTED = codes((ROOT / "docs" / "reference" / "annotations.md").read_text(encoding="utf-8"))


def test_every_problem_is_documented() -> None:
    sources = (ROOT / "mars_asp" / "annotations").rglob("*.py")
    assert codes("".join(path.read_text(encoding="utf-8") for path in sources)) == DOCUMENTED


def stored(rng: random.Random, text: str) -> bytes:
    """Return a text as some editor may have saved it, or some program may have torn it."""
    text = text.replace("\n", rng.choice(["\n", "\n", "\r\n", "\r"]))
    encoding = rng.choice(["utf-8", "utf-8", "utf-8", "utf-8-sig", "latin-1", "utf-16"])
    data = text.encode(encoding, "replace")
    if rng.random() < 0.2:
        at = rng.randrange(len(data) + 1)
        data = data[:at] + rng.randbytes(rng.randint(1, 3)) + data[at + rng.choice([0, 1]) :]
    return data


@pytest.mark.parametrize("language", sorted(set(LANGUAGES.values())))
def test_any_file_is_read_or_refused(language: str, tmp_path: Path, fuzz: int) -> None:
    """Mutations of the cases, 3,000 over all languages, give modules or documented errors only."""
    suffix = next(suffix for suffix, known in LANGUAGES.items() if known == language)
    rng = random.Random(f"stored {language}")
    path = tmp_path / f"a{suffix}"
    for text in mutated(language, fuzz // len(set(LANGUAGES.values())) + 1):
        path.write_bytes(stored(rng, text))
        found = extract([path])
        assert all(module.name for module in found.modules)
        assert all(problem.span.line > 0 for problem in found.diagnostics)
        assert {problem.code for problem in found.diagnostics} <= DOCUMENTED


def only(tmp_path: Path, text: str) -> tuple[list[Module], list[Diagnostic]]:
    path = tmp_path / "a.cpp"
    path.write_text(text, encoding="utf-8")
    found = extract([path])
    return list(found.modules), list(found.diagnostics)


@pytest.mark.parametrize("count", [1000, MOST_DECLARED // 10])
def test_a_long_declaration_is_read_or_reported(tmp_path: Path, count: int) -> None:
    parameters = ", ".join(f"Map m{number:04}" for number in range(count))
    modules, problems = only(tmp_path, LAYOUTS["line"].format(f=f"X f({parameters});\nX g();"))
    if len(parameters) < MOST_DECLARED:
        assert problems == []
        assert len(modules[0].services[0].inputs) == count
    else:
        (problem,) = problems
        assert (problem.code, problem.span.line, problem.severity) == ("MARS212", 4, "error")


def test_code_far_after_an_annotation_is_not_its_declaration(tmp_path: Path) -> None:
    gap = "\n" * (MOST_DECLARED + 1)
    _, (problem,) = only(tmp_path, LAYOUTS["line"].format(f=f"{gap}X f();"))
    assert (problem.code, problem.span.line) == ("MARS201", 3)


def test_a_file_full_of_errors_is_given_up(tmp_path: Path) -> None:
    _, problems = only(tmp_path, "// @module_end\n" * 2 * MOST_ERRORS)
    assert [problem.code for problem in problems] == ["MARS103"] * MOST_ERRORS + ["MARS119"]
    assert problems[-1].span.line == MOST_ERRORS + 1


def test_words_that_are_not_ours_are_compared_with_ours_up_to_a_limit(tmp_path: Path) -> None:
    others = "".join(f"// @zq{number}\n" for number in range(MOST_OTHERS))
    text = (
        LAYOUTS["line"].format(f="X f();").replace("// @module_end", "// @Outptu X\n// @module_end")
    )
    _, (problem,) = only(tmp_path, others + text)
    assert (problem.code, problem.span.line, problem.severity) == (
        "MARS122",
        MOST_OTHERS + 5,
        "note",
    )
    _, problems = only(tmp_path, others.removeprefix("// @zq0\n") + text)
    assert "MARS109" in {problem.code for problem in problems}


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("#if 0\n#endif\n{m}", 3),
        ("#if 0\n{m}#else\n{m}#endif\n", 8),
        ("  # if 0 // old\n#ifdef A\n#else\n#endif\n{m}#elif B\n{m}#endif\n", 11),
        ("#if 0\n#if 0\n#endif\n{m}#endif\n{m}", 10),
        ("int a; #if 0\n{m}", 2),
        ("#if 0\n int a; #endif\n{m}#endif\n{m}", 9),
        ("#if 01\n{m}#endif\n", 2),
        ("#if 0\n#endif\n#if false\n{m}", 0),
    ],
)
def test_code_in_if_0_has_no_annotations(tmp_path: Path, text: str, line: int) -> None:
    module = LAYOUTS["line"].format(f="X f();")
    assert module.count("\n") == 5
    modules, problems = only(tmp_path, text.replace("{m}", module))
    assert [module.span.line for module in modules] == ([line] if line else [])
    assert problems == []


@pytest.mark.parametrize(
    ("written", "column", "message", "help_text"),
    [
        ("600 -600", 13, "MIN is `600`, MAX is `-600`", "`-600 600`"),
        ("1 2 0", 17, "a rate must be positive, found `0`", "speed"),
        ("1  2 -3", 18, "a rate must be positive, found `-3`", "speed"),
        ("1 2 3 4", 13, "`1 2 3 4`", "MIN MAX RATE"),
    ],
)
def test_a_message_names_the_wrong_bound(
    tmp_path: Path, written: str, column: int, message: str, help_text: str
) -> None:
    text = LAYOUTS["line"].format(f="").replace("Sense RequestWhenReady", f"Trans_Z {written}")
    _, (problem,) = only(tmp_path, text)
    assert (problem.code, problem.span.line, problem.span.column) == ("MARS116", 3, column)
    assert message in problem.message
    assert help_text in str(problem.help)


def test_locations_are_right_after_wide_characters_and_wrapped_lines(tmp_path: Path) -> None:
    text = (
        "// \u2014 \U0001f916\n/* \u00e9 */ int x; // @module_start\n// @module_name A\n"
        "// @Sense NotifyWhenReady,\n//   \u00e9 \nX f(); /* \u2014 */ // @module_end\n"
    )
    _, (problem,) = only(tmp_path, text)
    assert (problem.code, problem.span.line, problem.span.column) == ("MARS111", 5, 6)
    (module,), _ = only(tmp_path, text.replace("//   \u00e9", "//   RequestWhenReady"))
    assert (module.span.line, module.span.column) == (2, 19)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("module_start", "module_strat"),
        ("module_name", "module_nmae"),
        ("module_end", "module_ned"),
    ],
)
def test_a_misspelt_boundary_is_reported_once(tmp_path: Path, right: str, wrong: str) -> None:
    path = tmp_path / "a.cpp"
    path.write_text(LAYOUTS["line"].format(f="X f();").replace(right, wrong))
    found = extract([path])
    assert [problem.code for problem in found.diagnostics] == ["MARS109"]
    assert [module.name for module in found.modules] == ["A"]


@pytest.mark.parametrize("cost", ["\u00b2", "1" * 5000, "0", "x"])
def test_a_wrong_cost_is_an_error_and_no_traceback(tmp_path: Path, cost: str) -> None:
    path = tmp_path / "a.cpp"
    text = (
        LAYOUTS["line"].format(f="X f(Y y);").replace("Sense RequestWhenReady", f"Converts {cost}")
    )
    path.write_text(text, encoding="utf-8")
    assert [problem.code for problem in extract([path]).diagnostics] == ["MARS115"]


def test_a_sign_beyond_ascii_ends_a_word(tmp_path: Path) -> None:
    text = LAYOUTS["line"].format(f="X f();").replace("Sense Request", "Sense\u2014Request")
    _, (problem,) = only(tmp_path, text)
    assert (problem.code, problem.span.line, problem.span.column) == ("MARS109", 3, 4)


BLOCK = """@module_start
@module_name A
@Sense NotifyWhenReady, // as it comes
  NotifyAtFrequency 25  # and evenly
X f();
@module_end
"""


def test_a_block_of_a_configuration_may_begin_it_and_wrap() -> None:
    found = read_blocks("a.mars", BLOCK)
    assert found.diagnostics == ()
    (service,) = found.modules[0].services
    assert [mode.name for mode in service.modes] == ["NotifyWhenReady", "NotifyAtFrequency"]
    assert (service.function, service.output) == ("f", "X")
    wrong = read_blocks("a.mars", BLOCK.replace("  NotifyAtFrequency 25  # and evenly\n", ""))
    assert [(p.code, p.span.line) for p in wrong.diagnostics] == [("MARS111", 3)]


@pytest.mark.parametrize(
    ("layout", "problem"),
    [
        ("// @Signature X f(A,\nint i;", ("MARS212", 4, 15)),
        ('R"(\n\n)"', ("MARS202", 4, 1)),
        (f"// @Output {'X' * 9000}\nbool f();", ("MARS214", 4, 4)),
        ("// @DataIn\n" * 600, ("MARS213", 503, 4)),
    ],
)
def test_blocks_that_are_too_long_or_unterminated(
    tmp_path: Path, layout: str, problem: tuple[str, int, int]
) -> None:
    _, problems = only(tmp_path, LAYOUTS["line"].format(f=layout))
    assert problem in [(found.code, found.span.line, found.span.column) for found in problems]
    assert not any("\n" in found.message for found in problems)


@pytest.mark.parametrize(
    ("suffix", "declaration"),
    [
        (".py", f"def f(x: {'a.' * 5000}a): pass"),
        (".py", f"def f(x: '{'list[' * 2000}A{']' * 2000}') -> {'A | ' * 3000}A: pass"),
        (".cpp", f"auto f() -> {'A<' * 5000}B{'>' * 5000};"),
        (".cpp", f"// @Output {'(' * 2000}B{')' * 2000}\nvoid f();"),
        (".java", f"public {'List<' * 5000}A{'>' * 5000} f();"),
        (".rs", f"fn f(x: {'(' * 5000}A{')' * 5000}) -> A;"),
        (".go", f"func f(x {'func(' * 5000}A{')' * 5000}) A"),
        (".m", f"function [{'[' * 5000}a{']' * 5000}] = f(a)"),
    ],
)
def test_deep_nesting_is_read_or_refused(tmp_path: Path, suffix: str, declaration: str) -> None:
    marks = {".py": "#", ".m": "%"}.get(suffix, "//")
    path = tmp_path / f"a{suffix}"
    path.write_text(LAYOUTS["line"].format(f=declaration).replace("//", marks))
    found = extract([path])
    assert [module.name for module in found.modules] == ["A"]
    assert {problem.code for problem in found.diagnostics} <= DOCUMENTED


def test_python_prints_no_warning_of_its_own(
    tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    path = tmp_path / "a.py"
    text = LAYOUTS["line"].format(f='def f(x: A = "\\d") -> B: ...').replace("//", "#")
    path.write_text(text)
    assert extract([path]).diagnostics == ()
    # Objects of other tests may be collected meanwhile.
    assert [each for each in recwarn if each.category is not ResourceWarning] == []
