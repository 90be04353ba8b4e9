"""The house: which rooms there are, that imports point one way, and that tests mirror it."""

import ast
import re
from keyword import iskeyword

import pytest

from tests.support.documents import ROOT
from tests.support.imports_drawn import HOUSE, drawing, imported, rooms

TESTS = ROOT / "tests"
#: A place imports from layers before its own alone, and files of one layer not from each other.
LAYERS = (
    ("diagnostic", "spelling", "output", "reading"),
    ("asp", "model"),
    ("annotations", "behaviour"),
    ("language",),
    ("kinematics",),
    ("reasoning",),
    ("draw", "exchange"),
    ("execution", "lsp"),
    ("cli",),
    ("robot",),
)
#: The files and folders of each package: each imports from those before it alone.
FILES = {
    "asp": (
        "contained cache signature fragments units solve rules lint messages cases trace program"
    ),
    "asp/solve": "atoms cyclic disjoint_sets observer term_ids components optimum grounding",
    "asp/cases": ("expectations outcomes run probes coverage mutants killers"),
    "asp/rules": (
        "gate trees statements dependencies rule premises computed expansions checks "
        "symbols arithmetic outline declarations metadata externals read program_files namespaces "
        "rulebook consistency"
    ),
    "asp/lint": (
        "found clauses values orders catalogue sorts variables bodies keys aggregates "
        "recursion joins predicates copies messages roles arithmetic names allow"
    ),
    "asp/trace": (
        "firings sentences tree counted counting_rules given heights "
        "literal_order patterns premise_order dominators firing_rules text document "
        "near_misses conflicts proofs explainer absence"
    ),
    "model": (
        "cycles names ranges attributes declarations remembered described modes transformation "
        "rates ports graph"
    ),
    "annotations": (
        "languages comments sources directives type_words types declarations following "
        "arguments overrides services problems pending modules alike repeated files blocks "
        "representations"
    ),
    "annotations/declarations": (
        "declaration tokens c_types c_parameters c java rust go matlab python read"
    ),
    "behaviour": "values command context imports calls testing",
    "language": (
        "toml_text layout text_edits expected relocate statements lines grammar tokens parse "
        "statement_edits print format"
    ),
    "kinematics": "frames supports sharing",
    "reasoning": (
        "budget facts findings packs includes attributes rules analysis project launch_trees "
        "sample lint synthesis verification session cases questions"
    ),
    "reasoning/cases": "configurations places run examples",
    "reasoning/facts": (
        "identifiers ends rates loose_ends topic_names ports closed_walks compile vocabulary "
        "motion descriptions launched otherwise"
    ),
    "reasoning/synthesis": (
        "carried_modes line_inputs derived draft exclusion inheritance_nodes side_lines "
        "control_lines data_lines specify preferences synthesise"
    ),
    "reasoning/questions": (
        "unrealised sharing account capability needs subject relationship_query absence_query "
        "alternatives "
        "annotation_edits changes "
        "connected blame edits explain "
        "launch_trees diff_lines diff_trees diff failed_value near_miss repair fix why_not "
        "why_no_finding absences without"
    ),
    "exchange": (
        "recognise lift yaml_document elements unread folders ports graph relays cascades locks "
        "topics unite urdf twist_mux rosgraph dora ros2 foreign"
    ),
    "exchange/dora": "document read",
    "exchange/rosgraph": "dump rosdiscover caret dot_tokens dot node_info topic_info read",
    "exchange/ros2": (
        "actions commands names interface catalogue cmake python_files python_scopes "
        "python_written python_values python_expressions python_texts setup_files workspace "
        "parameters observations cpp_code cpp_durations cpp_scopes cpp_texts cpp_handles "
        "source_cpp source_python programs glue bridges conditions python_nodes python_tests "
        "python_evaluate launch_python launch_markup launch_catalogue descriptions launch "
        "controllers muxes read"
    ),
    "exchange/twist_mux": "document read",
    "exchange/urdf": "angles document read write",
    "draw": (
        "picture marks part colours ranks order straighten layered packing graphviz shapes legend "
        "svg page dot mermaid png"
    ),
    "execution": (
        "parts executor simulator scenario observed trial promises gate_facts judgement recording "
        "campaign"
    ),
    "execution/campaign": "grid summary journal code picture",
    "execution/executor": (
        "behaviour schedule link bounds channel arbitration delivery gate modules nodes plan "
        "executor"
    ),
    "execution/simulator": "motion ramp world body fleet approach devices",
    "execution/scenario": (
        "schema contradictions vary read link_faults functions agreement devices"
    ),
    "execution/recording": "frame lanes signs picture record mcap replay",
    "lsp": (
        "places keyword_docs occurrences robot rule_text rules actions references rename symbols "
        "hover completion lenses questions protocol workers client_errors workspace server"
    ),
    "cli": (
        "deliver encode wrapping arguments suggested_commands lines account watch realtime "
        "progress output_files diagnostic_text limits settings input_codes extract excluded "
        "trace_document schemas worker inputs ignores baseline selection trials results folding "
        "github gitlab junit sarif finding_formats alternatives analyse can "
        "completion draw export facts fmt import_robot winners run_report run_json run_text run "
        "campaign_runner campaign_dask campaign_table campaign synthesise "
        "cases_report cases_measure cases_watch test pytest_plugin verify diff rules_kinds "
        "rules_example rules_document rules_new rules_diff rules repair check_output check "
        "lsp_files lsp_rules lsp_answers lsp explain_page explain ament ros2_command"
    ),
}
#: The packages whose imports `docs/explanation/architecture.md` draws, in its order.
DRAWN = (".", "asp", "reasoning", "execution")
#: Words of robots, which the engine does not know.
OURS = re.compile(
    "robot|sensor|effector|controller|consequence|splitter|configuration|relationship",
    re.IGNORECASE,
)


def test_the_house_has_these_rooms() -> None:
    listed = {place for layer in LAYERS for place in layer}
    assert rooms(HOUSE) == listed
    folders = [path for path in HOUSE.iterdir() if path.is_dir() and not path.name.startswith("__")]
    assert len(folders) <= 12
    assert len(list(HOUSE.glob("*.py"))) <= 7
    packages = {path.parent.relative_to(HOUSE).as_posix() for path in HOUSE.rglob("__init__.py")}
    assert packages - {"."} == FILES.keys()


def test_imports_point_one_way() -> None:
    layer_of = {place: number for number, layer in enumerate(LAYERS) for place in layer}
    wrong = []
    for path in sorted(HOUSE.rglob("*.py")):
        room = path.relative_to(HOUSE).with_suffix("").parts[0]
        for name in imported(path) if not room.startswith("__") else ():
            other = name.split(".")[1]
            if other in layer_of and other != room and layer_of[other] >= layer_of[room]:
                wrong.append(f"{path.relative_to(ROOT)} imports {name}")
    assert wrong == []


@pytest.mark.parametrize("package", FILES)
def test_imports_inside_a_package_point_one_way(package: str) -> None:
    files = FILES[package].split()
    assert rooms(HOUSE / package) == set(files)
    prefix = f"mars_asp.{package.replace('/', '.')}."
    wrong = []
    for path in sorted((HOUSE / package).rglob("*.py")):
        room = path.relative_to(HOUSE / package).with_suffix("").parts[0]
        for name in imported(path) if not room.startswith("__") else ():
            other = name.removeprefix(prefix).split(".")[0] if name.startswith(prefix) else room
            if other in files and files.index(other) > files.index(room):
                wrong.append(f"{path.relative_to(ROOT)} imports {name}")
    assert wrong == []


def test_each_module_has_a_name_that_can_be_imported() -> None:
    names = {name for path in HOUSE.rglob("*.py") for name in path.relative_to(HOUSE.parent).parts}
    plain = {name.removesuffix(".py") for name in names}
    assert [name for name in sorted(plain) if not name.isidentifier() or iskeyword(name)] == []


def test_the_drawing_shows_the_real_imports(update_golden: bool) -> None:
    place = ROOT / "docs" / "explanation" / "architecture.md"
    text = place.read_text(encoding="utf-8")
    blocks = iter([drawing(HOUSE / name) for name in DRAWN])
    drawn = re.sub(r"(?ms)^```mermaid\n.*?^```$", lambda _: f"```mermaid\n{next(blocks)}```", text)
    if update_golden:
        place.write_text(drawn, encoding="utf-8")
    assert drawn == text


def test_the_engine_knows_no_robots() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in sorted((HOUSE / "asp").rglob("*"))
        if path.suffix in (".py", ".md", ".lp")
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if OURS.search(line)
    ]
    assert found == []


def test_folders_of_tests_mirror_the_packages() -> None:
    folders = {path.parent for path in TESTS.rglob("__init__.py")}
    mirrored = folders - {TESTS, TESTS / "mutate", TESTS / "support"}
    assert {folder.relative_to(TESTS).as_posix() for folder in mirrored} <= FILES.keys()
    assert {path.parent for path in TESTS.rglob("test_*.py")} <= {TESTS, *mirrored}
    files = {path.name for folder in (TESTS, *mirrored) for path in folder.glob("*.py")}
    others = {name for name in files if not name.startswith("test_")}
    assert others == {"__init__.py", "conftest.py"}


def test_tests_of_the_engine_use_no_robot() -> None:
    of_mars = re.compile(r"mars_asp\.(?!asp\b|diagnostic\b|MarsError$)")
    wrong = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in sorted((TESTS / "asp").rglob("*.py"))
        for name in imported(path)
        if of_mars.match(name)
    ]
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in sorted((TESTS / "asp").rglob("*.py"))
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if OURS.search(line)
    ]
    assert wrong + found == []


#: The files that touch clingo's trees: their values, and the reader of rules.
TREES = ["asp/rules/statements.py", "asp/rules/trees.py"]


def test_one_place_reads_rules() -> None:
    found = []
    for path in sorted(HOUSE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "clingo" in text else ():
            names = [each.name for each in node.names] if isinstance(node, ast.ImportFrom) else []
            module = node.module if isinstance(node, ast.ImportFrom) else None
            if module == "clingo.ast" or (module == "clingo" and "ast" in names):
                found.append(path.relative_to(HOUSE).as_posix())
    assert found == TREES
