"""Functions and classes of users in a run: state, context, imports and refusals."""

import re
from pathlib import Path
from typing import Any

import pytest

from mars_asp.execution.scenario.read import read_scenario
from mars_asp.execution.trial import Trial, stage_trial
from mars_asp.reasoning.project import load_project
from tests.support.documents import ROOT
from tests.support.fixtures import Patch
from tests.support.refusals import refusal, refusals
from tests.support.trials import BASE, DRIVE, trial

TWO = "@specification\n@modules P, Q, C, D\nP is_controlled_by C\nQ is_controlled_by D\n"
LANGUAGES = ("python", "toml")
SLIDE = '[devices.Q]\nkind = "joint"\nfunction = "Trans_Z"\n'
BIND = 'python = "{}"\nperiod = 100\n'


def bound(**modules: str) -> str:
    return BASE + "".join(f"[bindings.{name}]\n{BIND.format(p)}" for name, p in modules.items())


def rates(made: Trial, module: str) -> list[float]:
    return [next(iter(c.values())) for _, _, c in made.executor.effectors[module].applied if c]


COUNT = """
class Count:
    def __init__(self, step=1):
        self.step, self.count = step, 0
    def __call__(self):
        return self.next()
    def next(self):
        self.count += self.step
        return "Trans_Z", self.count
"""


def test_each_module_has_its_own_object_of_a_class(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(COUNT)
    text = bound(C="b.py:Count", D="b.py:Count.next") + f"parameters = {{ step = 10 }}\n{SLIDE}"
    for _ in range(2):  # nothing is left of the first run
        made = trial(text, TWO, tmp_path)
        assert rates(made, "P") == list(range(1, 32))
        assert rates(made, "Q") == list(range(10, 320, 10))


def test_files_of_one_name_in_two_folders_serve_one_run(tmp_path: Path) -> None:
    for name, rate in (("a", 1), ("b", 2)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "shape.py").write_text(f"RATE = {rate}\n")
        (tmp_path / name / "do.py").write_text(
            "import shape\ndef go():\n    from shape import RATE\n"
            "    return 'Trans_Z', RATE + 10 * shape.RATE\n"
        )
    made = trial(bound(C="a/do.py:go", D="b/do.py:go") + SLIDE, TWO, tmp_path)
    assert (set(rates(made, "P")), set(rates(made, "Q"))) == ({11}, {22})


def test_chance_is_of_the_module_and_the_seed(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go(ctx):\n    return 'Trans_Z', ctx.random.random()\n")
    text = bound(C="b.py:go", D="b.py:go") + SLIDE
    made = trial(text, TWO, tmp_path)
    alone = trial(bound(C="b.py:go"), DRIVE, tmp_path)
    other = trial(f"seed = 2\n{text}", TWO, tmp_path)
    assert rates(made, "P") == rates(alone, "P")
    assert rates(made, "P")[0] not in (rates(made, "Q")[0], rates(other, "P")[0])


def test_time_passes_for_a_module_that_a_fault_silences(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text("def go(ctx):\n    return 'Trans_Z', 100 * ctx.now + ctx.dt\n")
    text = bound(C="b.py:go") + "[faults.C]\nfrom = 1\nuntil = 2\n"
    made = trial(text, folder=tmp_path)
    entries = [rate for rate in rates(made, "P") if rate >= 90]
    assert entries[:2] == pytest.approx([90.1, 201.1])


def annotated(tmp_path: Path, source: str, modules: str, lines: str, scenario: str) -> Trial:
    (tmp_path / "b.py").write_text(source)
    config = tmp_path / "c.mars"
    config.write_text(f"@specification\n@sources b.py\n@modules {modules}\n{lines}")
    project = load_project(str(config))
    read = read_scenario(f"{BASE}{scenario}", tmp_path / "s.toml")
    made = stage_trial(project.configuration, project.modules, read)
    made.run_until(read.duration)
    return made


STEPS = """
class First:
    # @module_start
    # @module_name C
    # @ControlOut Trans_Z
    def step(self, ctx) -> tuple[str, float]:
        return "Trans_Z", 1
    # @module_end

class Second:
    def __init__(self, rate=2):
        self.rate = rate
    # @module_start
    # @module_name D
    # @ControlOut Trans_Z
    def step(self, ctx) -> tuple[str, float]:
        return "Trans_Z", self.rate
    # @module_end
"""


def test_annotated_methods_run_without_a_binding_that_names_them(tmp_path: Path) -> None:
    lines = "P is_controlled_by C\nQ is_controlled_by D\n"
    scenario = f"{SLIDE}[bindings.C]\nperiod = 100\n[bindings.D]\nperiod = 100\n"
    made = annotated(tmp_path, STEPS, "P, Q, C, D", lines, scenario)
    assert (set(rates(made, "P")), set(rates(made, "Q"))) == ({1}, {2})
    scenario += 'parameters.rate = 5\npython = "b.py:Second"\n'
    made = annotated(tmp_path, STEPS, "P, Q, C, D", lines, scenario)
    assert set(rates(made, "Q")) == {5}
    assert not made.executor.plan.modules["D"].services[0].inputs  # `ctx` is not one


CAMERA = """
from __future__ import annotations
# @module_start
# @module_name Camera
class Camera:
    def __init__(self):
        self.taken = 0
    # @Sense NotifyAtFrequency 10
    def image(self) -> Image:
        self.taken += 1
        return self.taken
    # @Sense NotifyAtFrequency 5
    def depth(self) -> Depth:
        return -self.taken
# @module_end
"""


def test_parts_of_a_module_share_its_object(tmp_path: Path) -> None:
    (tmp_path / "log.py").write_text(
        "import builtins\nseen = []\ndef image(x): seen.append(x)\ndef depth(x): seen.append(x)\n"
        "def go():\n    return 'Trans_Z', min(seen, default=0)\n"
    )
    lines = "A uses_data_from Camera.image\nB uses_data_from Camera.depth\nP is_controlled_by C\n"
    scenario = "".join(
        f'[bindings.{n}]\npython = "log.py:{f}"\n'
        for n, f in (("A", "image"), ("B", "depth"), ("C", "go"))
    )
    made = annotated(tmp_path, CAMERA, "P, C, Camera, A, B", lines, f"{scenario}period = 100\n")
    assert rates(made, "P")[-1] == -30


COUNTED = """
@module_start
@module_name Count
@Sense NotifyWhenReady
Num count();
@Done
Full full();
@module_end
"""


def test_parts_with_a_completion_are_bound_by_the_name_of_the_module(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(
        "class Count:\n    total = 0\n"
        "    def count(self):\n        self.total += 1\n        return self.total\n"
        "    def full(self):\n        return self.total if self.total % 2 == 0 else None\n"
        "def go(count, full):\n    return 'Trans_Z', 10 * count + full\n"
    )
    lines = "C.count uses_data_from Count.count\nC.full uses_data_from Count.full\n"
    robot = f"@specification\n@modules P, C, Count\n{lines}P is_controlled_by C\n{COUNTED}"
    text = f"{bound(Count='b.py:Count')}[bindings.C]\npython = 'b.py:go'\n"
    # Readings at 0, 100 and 200 ms; the first completion is at 100 ms.
    made = trial(f"duration = 0.25\n{text.partition(chr(10))[2]}", robot, tmp_path)
    assert rates(made, "P") == [22, 32]


def test_the_template_of_the_page_runs(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "how-to" / "behaviours.md").read_text(encoding="utf-8")
    source, bindings = (re.findall(rf"(?ms)^```{kind}\n(.*?)^```$", page)[0] for kind in LANGUAGES)
    (tmp_path / "behaviours.py").write_text(source)
    robot = (
        "@specification hierarchical\n@modules Base, Sonar, Cruise, Retreat\n"
        "DataSplitter1 uses_data_from Sonar\nCruise uses_data_from DataSplitter1\n"
        "Retreat uses_data_from DataSplitter1\nBase is_controlled_by ArbitrationNode\n"
        "ArbitrationNode is_controlled_by Cruise 1\nArbitrationNode is_controlled_by Retreat 2\n"
    )
    world = "[world]\nwalls = [[[1200, -900], [1200, 900]]]\n[devices.Sonar]\nkind = 'sonar'\n"
    text = 'duration = 12\n[robot]\nmodule = "Base"\n'
    made = trial(f"{text}{world}{bindings}", robot, tmp_path)
    assert not made.executor.failures
    assert made.control_time.keys() == {"Cruise", "Retreat"}
    assert len(made.bodies[0].contacts) == 0


REFUSED = {
    "b.py:nothing": "`b.py` defines no function `nothing`",
    "b.py:goo": "`b.py` defines no function `goo`",
    "b.py:N": "`N` is not a function",
    "b.py:Bad": "`b.py:Bad` cannot be used: b.py:6: ValueError: not today",
    "b.py:Mute": "the class `Mute` has no `__call__`",
    "b.py:Mute.stp": "the class `Mute` has no method `stp`",
    "b.py:Call.stp": "the class `Call` has no method `stp`",
    "b.py:late": "`late` is asynchronous (`async def`)",
    "b.py:two": "`two(a, b)` takes 2 inputs, and the module gets none",
    "c.py:go": "`c.py` is not a file",
    "wrong.py:go": "`wrong.py:go` cannot be used: wrong.py:2: SyntaxError: ",
    "needs.py:go": "`needs.py:go` cannot be used: needs.py:1: ModuleNotFoundError: ",
    "ends.py:go": "`ends.py:go` cannot be used: ends.py:1: GeneratorExit: ",
}


def test_unusable_functions_are_all_refused_at_their_bindings(
    tmp_path: Path, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "b.py").write_text(
        "N = 3\ndef go(): ...\nasync def late(): ...\ndef two(a, b): ...\n"
        "class Bad:\n    def __init__(self): raise ValueError('not today')\n"
        "    def __call__(self): ...\nclass Mute:\n    def step(self): ...\n"
        "class Call:\n    def __call__(self): ...\n"
    )
    (tmp_path / "wrong.py").write_text("x = 1\ndef go(:\n")
    (tmp_path / "needs.py").write_text("import nothing_of_this_name\n")
    (tmp_path / "ends.py").write_text("raise GeneratorExit\n")
    names = [f"C{k}" for k in range(len(REFUSED))]
    robot = "@specification\n@modules P, " + ", ".join(names) + "\n"
    robot += "".join(f"P is_controlled_by {name}\n" for name in names)
    text = bound(**dict(zip(names, REFUSED, strict=True)))
    found = refusals(trial, text, robot)
    assert [d.span.line for d in found] == [4 + 3 * k for k in range(len(names))]
    for name, item, diagnostic in zip(names, REFUSED.values(), found, strict=True):
        assert diagnostic.message.startswith(f"`{name}`: {item}")
    assert found[1].help == "did you mean `go`?"
    assert found[6].help == "leave out `.stp`: an object of the class is called"


def test_an_unusable_annotated_function_is_refused_at_its_annotation(tmp_path: Path) -> None:
    source = "\n# @module_start\n# @module_name C\n# @ControlOut Trans_Z\ndef go(x: int): ...\n"
    found = refusal(
        annotated, tmp_path, f"{source}# @module_end\n", "P, C", "P is_controlled_by C\n", ""
    )
    assert found.message.endswith("takes 1 input, and the module gets none")
    assert (Path(found.span.path).name, found.span.line) == ("b.py", 4)


@pytest.mark.parametrize(
    ("body", "first", "line"),
    [
        ("    return 'Trans_z', 3", "ValueError: 'Trans_z' is not a function of an", 2),
        ("    return Command('Trans_Z', 'x')", "TypeError: the rate of `Trans_Z` must", 3),
        ("    raise GeneratorExit", "RuntimeError: it raised GeneratorExit", 3),
        ("    import shape; shape.go()", "ZeroDivisionError: division by zero", 1),
    ],
)
def test_a_failure_has_a_file_and_line(body: str, first: str, line: int, tmp_path: Path) -> None:
    (tmp_path / "shape.py").write_text("def go(): return 1 / 0\n")
    (tmp_path / "b.py").write_text(f"from mars_asp.behaviour import Command\ndef go():\n{body}\n")
    made: Any = trial(bound(C="b.py:go"), folder=tmp_path)
    failures = made.executor.failures["C"]
    assert failures.first.startswith(first)
    name = "shape.py" if "shape" in body else "b.py"
    assert failures.raised == (str(tmp_path / name), line)
