"""Imports point one way: a file imports only from layers before its own."""

import ast

from tests.documents import ROOT

LAYERS = [
    "source",
    "diagnostic",
    "visible",
    "atom",
    "model",
    "modes",
    "tuples",
    "walks",
    "annotations",
    "language",
    "facts",
    "frames",
    "physical",
    "urdf",
    "gate",
    "rulebook",
    "rule_cases",
    "ground_program",
    "optimum",
    "solve",
    "analysis",
    "synthesis",
    "resolve",
    "trace",
    "project",
    "verify",
    "explain",
    "sim",
    "execute",
    "scenario",
    "bindings",
    "trial",
    "judge",
    "plot",
    "cli",
]


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
