"""Imports point one way: a file imports only from layers before its own."""

import ast

import pytest

from tests.documents import ROOT

LAYERS = [
    "source",
    "diagnostic",
    "visible",
    "spelling",
    "atom",
    "model",
    "ranges",
    "modes",
    "tuples",
    "walks",
    "disjoint",
    "annotations",
    "text_edits",
    "language",
    "facts",
    "lookup",
    "frames",
    "supports",
    "physical",
    "sharing",
    "inheritance_nodes",
    "urdf",
    "kept",
    "gate",
    "statements",
    "computed",
    "joined",
    "pack",
    "symbols",
    "term",
    "arithmetic",
    "apart",
    "rulebook",
    "risks",
    "recorder",
    "ground_program",
    "optimum",
    "solve",
    "conflict",
    "stretches",
    "analysis",
    "rule_cases",
    "synthesis",
    "resolve",
    "reach",
    "trace",
    "magic",
    "slicing",
    "project",
    "sample",
    "relocate",
    "verify",
    "link_modes",
    "subject",
    "explain",
    "capability",
    "why_not",
    "diff",
    "annotation_edits",
    "edits",
    "repair",
    "alternatives",
    "sim",
    "execute",
    "forms",
    "toml_places",
    "scenario",
    "bindings",
    "devices",
    "trial",
    "judge",
    "draw",
    "plot",
    "replay",
    "record",
    "foxglove",
    "cli",
]

#: The layers of packages that are large enough to have some of their own.
INNER = {
    "annotations": [
        "languages",
        "skim",
        "comments",
        "sources",
        "directives",
        "type_words",
        "types",
        "declarations",
        "following",
        "arguments",
        "overrides",
        "services",
        "problems",
        "pending",
        "modules",
        "files",
        "blocks",
        "representations",
    ],
    "urdf": ["angles", "elements", "document", "read", "write"],
    "draw": [
        "picture",
        "colours",
        "ranks",
        "order",
        "straighten",
        "layered",
        "packing",
        "shapes",
        "legend",
        "svg",
        "dot",
        "mermaid",
        "png",
    ],
    "apart": ["shapes", "groups", "portions"],
    "annotations/declarations": [
        "declaration",
        "tokens",
        "c_types",
        "c_parameters",
        "c",
        "java",
        "rust",
        "go",
        "matlab",
        "python",
        "read",
    ],
}


@pytest.mark.parametrize("package", INNER)
def test_imports_inside_a_package_point_one_way(package: str) -> None:
    layers, wrong = INNER[package], []
    prefix = f"mars_asp.{package.replace('/', '.')}."
    for path in sorted((ROOT / "mars_asp" / package).rglob("*.py")):
        layer = path.relative_to(ROOT / "mars_asp" / package).with_suffix("").parts[0]
        if layer.startswith("__"):
            continue
        assert layer in layers, f"{layer} has no place in the list of layers of {package}"
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(prefix):
                imported = (node.module or "").removeprefix(prefix).split(".")[0]
                if layers.index(imported) > layers.index(layer):
                    wrong.append(f"{path.relative_to(ROOT)} imports {node.module}")
    assert wrong == []


def test_imports_point_one_way() -> None:
    wrong = []
    for path in sorted((ROOT / "mars_asp").rglob("*.py")):
        layer = path.relative_to(ROOT / "mars_asp").with_suffix("").parts[0]
        if layer.startswith("__"):
            continue
        assert layer in LAYERS, f"{layer} has no place in the list of layers"
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("mars_asp."):
                imported = (node.module or "").split(".")[1]
                if LAYERS.index(imported) > LAYERS.index(layer):
                    wrong.append(f"{path.relative_to(ROOT)} imports {node.module}")
    assert wrong == []


#: Who walks clingo's trees: the reader of rules, and those who write further rules from them.
WRITERS = ("groups", "near", "order", "pattern", "rewrite", "scope")
TREES = ["computed.py", "statements.py", *(f"trace/{name}.py" for name in WRITERS)]


def test_one_place_reads_rules() -> None:
    found = []
    for path in sorted((ROOT / "mars_asp").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [each.name for each in node.names] if isinstance(node, ast.ImportFrom) else []
            module = node.module if isinstance(node, ast.ImportFrom) else None
            if module == "clingo.ast" or (module == "clingo" and "ast" in names):
                found.append(path.relative_to(ROOT / "mars_asp").as_posix())
    assert found == TREES
