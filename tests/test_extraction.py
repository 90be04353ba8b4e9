"""Annotated sources: what must be found in each, hostile ones included."""

import json
import random
import re
from pathlib import Path

import pytest

from mars_asp.annotations.comments import LANGUAGES, lex
from mars_asp.annotations.files import extract
from mars_asp.annotations.modules import read_modules
from mars_asp.annotations.types import representation
from mars_asp.cli.extract import extraction_json
from mars_asp.diagnostic import Diagnostic

FOLDER = Path(__file__).parent / "extraction"
EXPECTED = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))


def plain(word: str) -> str:
    return re.sub(r"[-_ ]", "", word.lower())


def comparable(module: dict[str, object]) -> dict[str, object]:
    module = {key: value for key, value in module.items() if key != "path"}
    classes = module["class"]
    assert isinstance(classes, list)
    return {**module, "class": [plain(name) for name in classes]}


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
        ("void *", None),
        ("auto", None),
        ("void", ""),
    ],
)
def test_representation(written: str, name: str | None) -> None:
    assert representation(written) == name


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


@pytest.mark.parametrize("language", sorted(set(LANGUAGES.values())))
def test_any_text_is_read_or_refused(language: str) -> None:
    """10,000 mutations of the cases, over all languages, raise nothing."""
    rng = random.Random(language)
    texts = [
        path.read_bytes().decode("latin-1").replace("\r", "\n")
        for path in sorted(FOLDER.glob("*.*"))
        if LANGUAGES.get(path.suffix) is not None
    ]
    pieces = [
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
        'R"x(',
        "`",
        "\n",
        ",",
    ]
    for _ in range(1700):
        text = rng.choice(texts)
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(text) + 1)
            length = rng.choice([0, 0, 1, 5])
            text = text[:at] + rng.choice([*pieces, ""]) + text[at + length :]
        modules, problems = read_modules(lex("a", language, text))
        assert all(module.name for module in modules)
        assert all(problem.span.line > 0 for problem in problems)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("module_start", "module_strat"),
        ("module_name", "module_nmae"),
        ("module_end", "module_ned"),
    ],
)
def test_a_misspelt_boundary_is_told_once(tmp_path: Path, right: str, wrong: str) -> None:
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
