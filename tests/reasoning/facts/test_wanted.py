"""Facts of some predicates are those of these predicates among all facts."""

from pathlib import Path

from mars_asp.exchange.dora import import_dora
from mars_asp.reasoning.facts.compile import ANNOTATIONS, WIRING
from mars_asp.reasoning.project import described, load_project, project_facts
from tests.support.documents import ROOT

CONFIGURATIONS = sorted((ROOT / "examples").glob("*/config.mars"))
#: What the configurations of the project leave out.
RARE = """\
@configuration flat period 50
@modules Eye, Lens, Reader, Wheel, Turn, Part
Reader uses_data_from Eye
Wheel is_controlled_by Turn 2 hold 300
Part is_controlled_by Turn allocation root
@module_start
@module_name Eye
@Sense RequestWhenReady
a::Image grab();
@module_end
@module_start
@module_name Lens
@Sense RequestWhenReady
b::Image grab();
@module_end
@module_start
@module_name Reader
@DataIn
void read(Image image, auto other);
@module_end
@module_start
@module_name Turn
@Guard
@ControlOut
Command turn();
@module_end
"""


IMPORTED = """\
@configuration hierarchical
@modules A, B
// imported from ros2
// A: not all topics read
// B: commands pass a twist_mux
B is_controlled_by A 1
"""


def test_facts_of_some_predicates_are_those_of_all(tmp_path: Path) -> None:
    rare = tmp_path / "rare.mars"
    rare.write_text(RARE)
    seen = set()
    saved = tmp_path / "saved.mars"
    saved.write_text(IMPORTED)
    paths = [*CONFIGURATIONS, *(ROOT / "tests" / "specifications").rglob("*.mars"), rare, saved]
    paths += [ROOT / "tests" / "mixed.mars", ROOT / "tests" / "swapped.mars"]
    dataflow = tmp_path / "dataflow.yml"
    (tmp_path / "c").touch()
    nodes = (
        "nodes:\n- id: a\n  path: ./a\n- id: b\n  path: ./b\n  build: make\n- id: c\n  path: ./c\n"
    )
    dataflow.write_text(nodes)
    foreign = described(import_dora([(dataflow.read_text(), str(dataflow))]), "")
    for project in (*(load_project(str(path)) for path in paths), foreign):
        facts = project_facts(project)
        for name in {fact.atom.name for fact in facts}:
            seen.add(name)
            wanted = tuple(fact for fact in facts if fact.atom.name == name)
            assert project_facts(project, wanted={name}) == wanted
    assert seen >= WIRING | ANNOTATIONS | {"closed_walk", "entangled", "spelt"}
