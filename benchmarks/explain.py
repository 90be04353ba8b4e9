"""What an explanation costs: whole processes, beside others in the same run, and xclingo 2.

`python benchmarks/explain.py [MODULES [MODULES_FOR_XCLINGO]]`: robots of ten modules each. Whole
explanations are ratios to the verb that they contain, single questions seconds beyond reading the
file, also for clients of half as many modules that share 300 converters. xclingo
2 is asked for one consequence over the rules and facts that it needs alone; what mars-asp takes for
the same consequence, from the file on and with all facts, stands beside it. It asks for another
clingo than ours, so it is installed by `pip install --no-deps xclingo`.
"""

import json
import random
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from clingo import ast
from growth import robot_lines, used
from library import library_lines

from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.project import load_project, project_facts, project_lookup
from mars_asp.reasoning.questions.evidence import slice_for
from mars_asp.reasoning.rules import load_rulebook

ASKED = "data_divergence(M7_0)"
#: How often each command is measured, beside what it is compared with each time.
TURNS = 5
#: So many clients share 300 converters in `library.py`.
CLIENTS = 3600
#: Reads a file as a command does: of what is imported and read hardly anything is ever garbage.
_READING = """
import gc, sys
gc.disable()
from mars_asp.reasoning.project import load_project
gc.freeze()
gc.set_threshold(500_000, 20, 20)
gc.enable()
load_project(sys.argv[1])
"""


def measure(*words: str) -> tuple[float, float]:
    """Return the seconds of CPU and the MB of memory that a command takes."""
    # 1 is an error-level finding, 30 that clingo has found all answers.
    seconds, memory, _ = used(words, (0, 1, 30))
    return seconds, memory


def mars(*words: str) -> tuple[float, float]:
    return measure(sys.executable, "-m", "mars_asp", *words)


def written(modules: int, folder: Path) -> str:
    path = folder / f"robots{modules}.mars"
    path.write_text("\n".join(robot_lines(modules, random.Random(1))) + "\n")
    return str(path)


class _Named(ast.Transformer):
    """Names anonymous variables, which xclingo 2 cannot trace beside an aggregate."""

    count = 0

    def visit_Literal(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return node.update(**self.visit_children(node)) if node.sign == ast.Sign.NoSign else node

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        self.count += 1
        return node.update(name=f"Any{self.count}") if node.name == "_" else node


def for_xclingo(path: str, folder: Path) -> str:
    """Write the rules and facts behind the asked consequence, its rules with traces."""
    project = load_project(path)
    rulebook = load_rulebook()
    part = slice_for(
        ASKED,
        rulebook,
        lambda names: project_facts(project, wanted=names),
        lambda names: project_lookup(project, names, vocabulary(rulebook)),
    )
    assert part is not None
    # Which facts of a predicate are needed is our own answer already.
    facts = project_facts(project, wanted={fact.atom.name for fact in part.facts})
    traced = [
        f'%!trace_rule {{"{rule.id}"}}.\n{_Named()(rule.ast)}' for rule in part.rulebook.rules
    ]
    kind, name = ASKED.rstrip(")").split("(")
    asked = (
        f'%!show_trace {{consequence({kind},V,"{name}",C)}} :- consequence({kind},V,"{name}",C).'
    )
    target = folder / "asked.lp"
    target.write_text("\n".join([*traced, asked, facts_text(facts)]))
    return str(target)


def first_middle_last(path: str) -> list[str]:
    """Return nodes of a configuration: what precedes a node in the file is what it costs."""
    words = (sys.executable, "-m", "mars_asp", "synthesise", path, "--format", "json", "--quiet")
    written = subprocess.run(words, capture_output=True, check=False).stdout
    names = [module["name"] for module in json.loads(written)["modules"]]
    splitters = [name for name in names if name.startswith("DataSplitter")]
    return [splitters[0], splitters[len(splitters) // 2], splitters[-1]]


def ratios(path: str) -> None:
    """Print what whole explanations take and keep, as ratios to the verb that they contain."""
    for title, words, contained in (
        ("everything", ("explain", path), "synthesise"),
        ("everything, lines of JSON", ("explain", path, "--format", "jsonl"), "synthesise"),
        ("all consequences", ("explain", path, "--only", "consequences"), "analyse"),
        ("synthesise", ("synthesise", path), "analyse"),
    ):
        turns = [(mars(contained, path), mars(*words)) for _ in range(TURNS)]
        time = statistics.median(taken / base for (base, _), (taken, _) in turns)
        memory = statistics.median(kept / base for (_, base), (_, kept) in turns)
        print(f"{title:<26} {time:5.2f} x {contained:<10}  memory {memory:5.2f}", flush=True)


def questions(path: str, asked: Sequence[Sequence[str]]) -> None:
    """Print the seconds that questions take beyond reading the file."""
    turns = [measure(sys.executable, "-c", _READING, path)[0] for _ in range(TURNS)]
    reading = statistics.median(turns)
    print(f"{'reading':<44} {reading:5.2f} s", flush=True)
    for words in asked:
        taken = [
            mars("explain", path, *words)[0] - measure(sys.executable, "-c", _READING, path)[0]
            for _ in range(TURNS)
        ]
        print(f"{' '.join(words):<44} {statistics.median(taken):5.2f} s more", flush=True)


def main() -> None:
    small = int((*sys.argv[2:], "1000")[0])
    modules = int((*sys.argv[1:], "10000")[0])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = written(modules, folder)
        print(f"{modules} modules, medians of {TURNS} turns", flush=True)
        ratios(path)
        nodes = [(node,) for node in first_middle_last(path)]
        questions(path, [(ASKED,), *nodes, ("--why-not", "ArbitrationNode(M7_1)")])
        shared = folder / "library.mars"
        lines = library_lines(CLIENTS, 1, True, random.Random(1))
        shared.write_text("\n".join(lines) + "\n")
        print(f"{CLIENTS} sources and clients that share 300 converters")
        nodes = [(node,) for node in ("DataTransformer1", "DataTransformer1000")]
        asked = [("representation_dependency(C200)",), *nodes, ("--why-not", "DataSplitter(C20)")]
        questions(str(shared), asked)
        path = written(small, folder)
        ours, _ = mars("explain", path, ASKED)
        xclingo = str(Path(sys.executable).with_name("xclingo"))
        theirs, _ = measure(xclingo, "-n", "1", "1", for_xclingo(path, folder))
        print(f"{small} modules, one consequence: mars-asp {ours:.2f} s, xclingo 2 {theirs:.2f} s")
        print(f"xclingo 2 takes {theirs / ours:.1f} times as long")


if __name__ == "__main__":
    main()
