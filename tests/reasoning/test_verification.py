"""Rules of their own accept every synthesis and refuse every change of one."""

import json
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest

from mars_asp.asp.solve.grounding import Resolution
from mars_asp.cli import run_here
from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Function,
    Mode,
    Module,
    Mount,
    Relationship,
    Service,
    Transformation,
)
from mars_asp.model.modes import parse_mode
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import judge_specification, verify, written_cost
from tests.support.campaigns import sample, seeds
from tests.support.documents import run
from tests.support.fixtures import Captured, Patch
from tests.support.random_configurations import random_configuration

RULEBOOK = load_rulebook(stages=("resolve", "verify", "cost"))


def block(name: str, *lines: str) -> str:
    return "\n".join(["@module_start", f"@module_name {name}", *lines, "@module_end"])


def carried(seed: int) -> str:
    """Return a random robot whose carried modules are commanded in what they inherit, as text."""
    rng = random.Random(seed)
    kind = rng.choice(["flat", "hierarchical"])
    functions = ("Rotn_X", "Rotn_Y", "Trans_Z")
    movers = ["Base", "Neck", "Head"]
    tools = [f"T{index}" for index in range(rng.randint(1, 3))]
    drivers = [f"D{index}" for index in range(rng.randint(1, 3))]
    lines = ["Neck is_mounted_on Base", "Head is_mounted_on Neck"]
    lines += [f"{tool} is_mounted_on {rng.choice(movers)}" for tool in tools]
    for module in (*tools, *movers):
        for rank, driver in enumerate(rng.sample(drivers, rng.randint(0, len(drivers)))):
            hold = rng.choice(["", "", " hold 50"])
            allocation = rng.choice(["", "", " allocation root", " allocation split"])
            lines.append(f"{module} is_controlled_by {driver} {rank}{hold}{allocation}")
    blocks = [
        block(
            name,
            *(f"@{f} -90 90 45\nvoid {f.lower()}(double r);" for f in rng.sample(functions, n)),
        )
        for name in movers
        for n in [rng.randint(1, 2)]
    ]
    for tool in tools:
        if rng.random() < 0.7:
            blocks.append(block(tool, "@Grasp 0 80", "void grasp(double width);"))
        else:
            blocks.append(block(tool, "@Sense NotifyWhenReady", "P look();"))
    for driver in drivers:
        result = rng.sample(functions, rng.randint(0, 2))
        blocks.append(block(driver, f"@ControlOut {', '.join(result)}", "Command go();"))
    header = f"@configuration {kind}\n@modules {', '.join((*movers, *tools, *drivers))}"
    return "\n".join([header, *lines, *blocks])


def synthesised(text: str) -> tuple[Project, Configuration] | None:
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    found = synthesise(project, analysis, RULEBOOK)
    if found is None:
        return None
    printed = print_configuration(found.specification.configuration)
    return project, parse_text(printed, "s.mars").configuration


#: More paths than any synthesis here has.
MANY = 200


def paths(specification: Configuration, nodes: frozenset[str]) -> Counter[tuple[str, str, str]]:
    """Count the paths through nodes between each pair of modules, of data and of control."""
    found: Counter[tuple[str, str, str]] = Counter()
    data = [(r.source, r.client) for r in specification.relationships if isinstance(r, Data)]
    control = [
        (r.controller, r.controlled) for r in specification.relationships if isinstance(r, Control)
    ]
    for kind, lines in (("data", data), ("control", control)):
        open_paths = [(a, b) for a, b in lines if a not in nodes]
        # Longer than all lines together is a path that goes round in a circle.
        for _ in lines:
            if sum(found.values()) + len(open_paths) > MANY:
                break
            found.update((kind, a, b) for a, b in open_paths if b not in nodes)
            open_paths = [(a, d) for a, b in open_paths if b in nodes for c, d in lines if c == b]
        found.update(("circle", a, b) for a, b in open_paths)
    return found


def mutations(
    specification: Configuration, nodes: frozenset[str], rng: random.Random
) -> Iterator[Configuration]:
    """Yield specifications with a line dropped, doubled, added or redirected, with two priorities
    swapped, with another mode for a client, or with a module mounted at another place.

    A redirected line that leaves every path as it was is left out: that may realise as well.
    """
    lines = specification.relationships
    names = [name.text for name in specification.modules]
    before = paths(specification, nodes)

    def put(index: int, *new: Relationship) -> Configuration:
        return replace(specification, relationships=(*lines[:index], *new, *lines[index + 1 :]))

    for index, line in enumerate(lines):
        yield put(index)
        yield put(index, line, line)
        if isinstance(line, Mount):
            moved = Transformation(translation=(Decimal(0), Decimal(7), Decimal("0.25")))
            yield put(index, replace(line, transformation=moved))
            yield put(index, replace(line, mounted_vertex=77))
            continue
        redirected: list[Relationship] = []
        for other in rng.sample(names, 1):
            if isinstance(line, Data):
                redirected += [replace(line, source=other), replace(line, client=other)]
            elif isinstance(line, Control):
                redirected += [replace(line, controller=other), replace(line, controlled=other)]
        for new in redirected:
            if paths(put(index, new), nodes) != before:
                yield put(index, new)
        if isinstance(line, Data) and line.client not in nodes and line.mode is not None:
            modes = ("NotifyWhenReady", "RequestWhenReady", "NotifyOnMin(7)", "NotifyAtFrequency")
            name = rng.choice([mode for mode in modes if not mode.startswith(line.mode.name)])
            mode = parse_mode(name)
            assert isinstance(mode, Mode)
            yield put(index, replace(line, mode=mode, hz=None))
        for place, second in enumerate(lines[index + 1 :], index + 1):
            if isinstance(line, Control) and isinstance(second, Control):
                declared = {line.priority, second.priority} - {None}
                if line.controlled == second.controlled and len(declared) == 2:
                    swapped = list(lines)
                    swapped[index] = replace(line, priority=second.priority)
                    swapped[place] = replace(second, priority=line.priority)
                    yield replace(specification, relationships=tuple(swapped))
    first, second_name = rng.sample(names, 2)
    added: tuple[Relationship, ...] = (
        Data(first, second_name, specification.span),
        Control(first, second_name, specification.span, 1),
    )
    for relationship in added:
        yield replace(specification, relationships=(*lines, relationship))


def redescribed(specification: Configuration, blocks: Sequence[Module]) -> Iterator[Configuration]:
    """Yield specifications with one block changed: a guard, a motion or a service."""
    for at, block in enumerate(blocks):
        other = [replace(block, guard=block.span if block.guard is None else None)]
        other.append(replace(block, functions=(*block.functions, Function("Trans_Y", block.span))))
        for place, service in enumerate(block.services):
            rest = (block.services[:place], block.services[place + 1 :])
            services: list[tuple[Service, ...]] = [()]
            if service.kind in ("Sense", "DataOut"):
                services += [(replace(service, hz=Fraction(7)),), (replace(service, port="new"),)]
                services += [(replace(service, output="New"),), (replace(service, modes=()),)]
            other += [replace(block, services=(*rest[0], *new, *rest[1])) for new in services]
        for changed in other:
            yield replace(specification, declared=(*blocks[:at], changed, *blocks[at + 1 :]))


def refuses_every_mutation(text: str, seed: int) -> None:
    found = synthesised(text)
    if found is None:
        return
    project, specification = found
    assert verify(specification, project, RULEBOOK) == ()
    declared = {name.text for name in project.configuration.modules}
    nodes = frozenset(name.text for name in specification.modules) - declared
    changes = list(mutations(specification, nodes, random.Random(seed)))
    blocks = project.configuration.declared
    assert verify(replace(specification, declared=blocks), project, RULEBOOK) == ()
    differing = list(redescribed(specification, blocks))
    rng = random.Random(seed)
    some = rng.sample(changes, min(5, len(changes)))
    for changed in (*some, *rng.sample(differing, min(2, len(differing)))):
        assert verify(changed, project, RULEBOOK), print_configuration(changed)


@pytest.mark.parametrize("seed", seeds(1, 20))
def test_a_changed_synthesis_is_refused(seed: int) -> None:
    refuses_every_mutation(random_configuration(seed), seed)


@pytest.mark.parametrize("seed", seeds(1, 12))
def test_commands_for_inherited_functions_are_forwarded(seed: int) -> None:
    refuses_every_mutation(carried(seed), seed)


def test_a_broken_priority_names_its_clause() -> None:
    done = json.loads(
        run("mars-asp verify --format json tests/swapped.mars examples/level0/config.mars")
    )
    assert not done["realises"]
    assert {violation["clause"] for violation in done["violations"]} == {4}
    places = {Path(at["path"]).name for each in done["violations"] for at in each["locations"]}
    assert places == {"swapped.mars", "config.mars"}


def written(specification: Configuration, project: Project) -> dict[int, int]:
    verification = judge_specification(specification, project, RULEBOOK)
    assert verification.violations == ()
    cost = written_cost(verification, project, RULEBOOK)
    assert cost.proven
    return cost.cost


@pytest.mark.parametrize("seed", seeds(4, 28))
def test_the_cost_of_a_synthesis_equals_the_cost_of_its_text(seed: int) -> None:
    """Without comments the cheapest converters are meant, and a synthesis has those."""
    project = Project(parse_text(random_configuration(seed), "c.mars").configuration, {}, ())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    found = synthesise(project, analysis, RULEBOOK)
    if found is None:
        return
    specification = found.specification.configuration
    cost = {level: value for level, value in found.resolution.cost.items() if level >= 10}
    levels = {10: 0, 20: 0, 30: 0}
    assert {**levels, **written(specification, project)} == {**levels, **cost}
    silent = replace(specification, conversions=())
    assert {**levels, **written(silent, project)} == {**levels, **cost}


CHOICE = """
@configuration
@modules Eye, C, D
C uses_data_from Eye
D uses_data_from Eye
@module_start
@module_name Eye
@Sense NotifyWhenReady
sensor_msgs::Image look();
@module_end
@module_start
@module_name C
@DataIn
void take(Lines x);
@module_end
@module_start
@module_name D
@DataIn
void take(Image x);
@module_end
@module_start
@module_name Cheap
@Converts 2
geo::Lines turn(Image x);
@module_end
@module_start
@module_name Dear
@Converts 3
geo::Lines turn(Image x);
@module_end
"""
CHOSEN = """
@specification
@modules Eye, C, D, DataSplitter1, DataTransformer1
DataSplitter1 uses_data_from Eye
{comment}
DataTransformer1 uses_data_from DataSplitter1
C uses_data_from DataTransformer1
D uses_data_from DataSplitter1
"""


@pytest.mark.parametrize(
    ("comment", "minimal", "conversion"),
    [
        ("", True, 2),
        ("// DataTransformer1: Cheap (Image -> Lines)", True, 2),
        ("// DataTransformer1: Dear (sensor_msgs::Image -> geo::Lines)", False, 3),
        ("// DataTransformer1: no converter declared (Image -> geo::Lines)", True, 2),
    ],
)
def test_conversion_cost_decides_minimality(
    comment: str, minimal: bool, conversion: int, tmp_path: Path
) -> None:
    (tmp_path / "c.mars").write_text(CHOICE)
    (tmp_path / "s.mars").write_text(CHOSEN.format(comment=comment))
    done = json.loads(run(f"mars-asp verify --format json {tmp_path}/s.mars {tmp_path}/c.mars"))
    assert done["realises"]
    assert done["minimal"] is minimal
    assert done["cost"] == {"nodes": 2, "conversion": conversion, "relationships": 4}
    assert done["least"] == {"nodes": 2, "conversion": 2, "relationships": 4}


def test_an_abstract_transformer_costs_nothing_and_is_minimal(tmp_path: Path) -> None:
    """Where nothing is minimised the first answer is as good as any."""
    (tmp_path / "c.mars").write_text(
        "@configuration\n@modules Eye, C\nC uses_data_from Eye\n"
        "@module_start\n@module_name Eye\n@Sense NotifyWhenReady\nImage look();\n@module_end\n"
        "@module_start\n@module_name C\n@DataIn\nvoid take(Lines x);\n@module_end\n"
    )
    words = ["verify", str(tmp_path / "s.mars"), str(tmp_path / "c.mars"), "--format", "json"]
    assert run_here(["synthesise", str(tmp_path / "c.mars"), "-o", words[1]]) == 0
    assert run_here(words) == 0
    done = json.loads(run(f"mars-asp {' '.join(words)}").splitlines()[0])
    assert done["minimal"]
    assert done["cost"] == done["least"] == {"nodes": 1, "conversion": 0, "relationships": 2}


RANKED = """
@specification hierarchical
@modules M, A, B, ArbitrationNode
M is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by A {a}
ArbitrationNode is_controlled_by B {b}
"""
MOST = 2**31 - 1


@pytest.mark.parametrize(
    ("low", "high"),
    sample([(0, 1), (0, 46_341), (0, MOST), (0, 50_000), (MOST - 1, MOST), (1, 65_537)], 2),
)
def test_priorities_of_any_size_are_compared(low: int, high: int) -> None:
    configuration = f"""
    @configuration hierarchical
    @modules M, A, B
    M is_controlled_by A {low}
    M is_controlled_by B {high}
    """
    found = synthesised(configuration)
    assert found is not None
    project, specification = found
    assert verify(specification, project, RULEBOOK) == ()
    for a, b in ((low, high), (0, MOST)):
        assert verify(parsed(RANKED.format(a=a, b=b)), project, RULEBOOK) == ()
        assert verify(parsed(RANKED.format(a=b, b=a)), project, RULEBOOK), (b, a)
    assert verify(parsed(RANKED.format(a=high, b=high)), project, RULEBOOK)


def parsed(text: str) -> Configuration:
    return parse_text(text, "s.mars").configuration


ABSTRACT = """
@configuration
@modules Source1, Client1, Client2
Client2 uses_data_from Source1 NotifyOnMax
Client1 uses_data_from Source1 NotifyWhenReady
@module_start
@module_name Source1
@Sense NotifyWhenReady
RepA deliver(void);
@module_end
@module_start
@module_name Client1
@DataIn
void consume(RepD, RepA);
@module_end
@module_start
@module_name Client2
@DataIn
void consume(RepD, RepX);
@module_end
"""
BRIDGED = """
@specification
@modules Source1, Client1, Client2, DataTransformer1, DataSplitter1
{comment}
DataTransformer1 uses_data_from Source1
DataSplitter1 uses_data_from DataTransformer1
Client2 uses_data_from DataSplitter1 NotifyOnMax
Client1 uses_data_from DataSplitter1 NotifyWhenReady
"""


@pytest.mark.parametrize(
    "comment", ["", "// DataTransformer1: no converter declared (RepA -> RepD)"]
)
def test_a_client_that_its_source_reaches_is_not_fed_through_an_abstract_transformer(
    comment: str,
) -> None:
    found = synthesised(ABSTRACT)
    assert found is not None
    project, specification = found
    assert len(specification.modules) == 6  # three nodes besides the modules
    assert verify(specification, project, RULEBOOK) == ()
    (violation,) = verify(parsed(BRIDGED.format(comment=comment)), project, RULEBOOK)
    assert violation.clause == 3
    # The line means the input for `RepA`, so `RepD` is none that it takes.
    assert violation.rule.id == "verify/delivery/representation"


FLAT = """
@configuration flat
@modules M, A, B
M is_controlled_by A 1
M is_controlled_by B 2
"""


@pytest.mark.parametrize(("a", "b", "warned"), [(7, 3, 1), (3, 3, 1), (3, 7, 0), ("", "", 0)])
def test_contrary_priorities_under_flat_control_are_a_warning(
    a: int | str, b: int | str, warned: int, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "c.mars").write_text(FLAT)
    (tmp_path / "s.mars").write_text(RANKED.format(a=a, b=b).replace("hierarchical", "flat"))
    words = ["verify", str(tmp_path / "s.mars"), str(tmp_path / "c.mars")]
    assert run_here([*words, "--format", "json"]) == 0
    done = json.loads(capsys.readouterr().out)
    assert done["realises"] and done["minimal"] and not done["violations"]
    assert len(done["warnings"]) == warned
    assert run_here(words) == 0
    assert capsys.readouterr().out.count("warning: ") == warned


def test_a_cost_below_the_least_is_a_fault_of_ours(
    tmp_path: Path, capsys: Captured, monkeypatch: Patch
) -> None:
    (tmp_path / "c.mars").write_text(FLAT)
    (tmp_path / "s.mars").write_text(RANKED.format(a=1, b=2).replace("hierarchical", "flat"))
    cheap = Resolution(None, {30: 0, 20: 0, 10: 1}, {}, True, 1)  # type: ignore[arg-type]
    monkeypatch.setattr("mars_asp.cli.verify.written_cost", lambda *_: cheap)
    words = ["verify", str(tmp_path / "s.mars"), str(tmp_path / "c.mars"), "--format", "json"]
    assert run_here(words) == 1
    output = capsys.readouterr()
    done = json.loads(output.out)
    assert done["realises"] and done["minimal"] is None
    assert "nodes 0" in done["fault"] and "nodes 1" in done["fault"]
    assert "internal error" in output.err


def test_many_ranked_inputs_are_judged_in_proportion_to_their_number() -> None:
    """The ground atoms about their order grow linearly: none is about a pair of inputs."""

    def compared(count: int) -> int:
        names = [f"D{index}" for index in range(count)]
        body = [f"M is_controlled_by {name} {7 * rank}" for rank, name in enumerate(names)]
        header = f"@configuration hierarchical\n@modules M, {', '.join(names)}"
        found = synthesised("\n".join([header, *body]))
        assert found is not None
        project, specification = found
        grounding = judge_specification(specification, project, RULEBOOK).grounding
        signatures = [("ranked", 6), ("place_in", 4), ("least_at", 5), ("greatest_at", 5)]
        return sum(1 for signature in signatures for _ in grounding.symbols(*signature))

    assert compared(80) < 2.5 * compared(40)


def judged(text: str, configuration: str) -> tuple[list[str], list[str]]:
    """Return violations and cautions of a specification, whichever grounding is used."""
    project = Project(parse_text(configuration, "c.mars").configuration, {}, ())
    alone = judge_specification(parsed(text), project, RULEBOOK)
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    together = judge_specification(parsed(text), project, RULEBOOK, analysis.grounding)
    assert (together.violations, together.cautions) == (alone.violations, alone.cautions)
    violations = [f"{found.rule.id} {found.clause}: {found.message}" for found in alone.violations]
    return violations, [f"{found.rule.id}: {found.message}" for found in alone.cautions]


def test_a_caution_is_not_a_violation_and_has_a_reason() -> None:
    flat = RANKED.replace("hierarchical", "flat")
    assert judged(flat.format(a=3, b=7), FLAT) == ([], [])
    violations, (caution,) = judged(flat.format(a=7, b=3), FLAT)
    assert violations == []
    assert "`A`" in caution
    assert "`B`" in caution


def test_a_comment_is_judged_by_the_types_of_its_converter() -> None:
    """Both names of a comment are read as those that the configuration knows."""
    right = "// DataTransformer1: Cheap ({} -> {})"
    for names in (
        ("Image", "Lines"),
        ("sensor_msgs::Image", "geo::Lines"),
        ("Image", "geo::Lines"),
    ):
        assert judged(CHOSEN.format(comment=right.format(*names)), CHOICE) == ([], [])
    for names in (("Lines", "Image"), ("Image", "Depth"), ("other::Image", "Lines")):
        violations, _ = judged(CHOSEN.format(comment=right.format(*names)), CHOICE)
        assert any(
            item.startswith(
                "verify/conversion/misnamed 3: `DataTransformer1` applies `Cheap`, which"
            )
            for item in violations
        ), names


ARM = """
@modules Base, Arm, Lamp, Pilot
Arm is_mounted_on Base
Lamp is_mounted_on Base
Arm is_controlled_by Pilot
@module_start
@module_name Base
@Rotn_Y -90 90 45
void turn(double r);
@module_end
@module_start
@module_name Arm
@Grasp 0 80
void grasp(double width);
@module_end
@module_start
@module_name Pilot
@ControlOut Rotn_Y
Command go();
@module_end
"""


def test_a_comment_that_names_another_module_than_that_of_the_node_is_refused() -> None:
    """The arm inherits from its base; the lamp beside it has no controller."""
    through = "// InheritanceNode1: {}\nInheritanceNode1 is_controlled_by Pilot\n"
    through += "Base is_controlled_by InheritanceNode1"
    specification = "@specification" + ARM.split("@module_start", maxsplit=1)[0].replace(
        "Arm is_controlled_by Pilot", through
    ).replace("Lamp, Pilot", "Lamp, Pilot, InheritanceNode1")
    configuration = "@configuration" + ARM
    assert judged(specification.format("Arm"), configuration) == ([], [])
    violations, _ = judged(specification.format("Lamp"), configuration)
    assert (
        "verify/inheritance/misnamed 5: the comment of `InheritanceNode1` names `Lamp`, which has "
        "other controllers or providers than `InheritanceNode1`"
    ) in violations


def test_a_module_named_like_a_node_is_none() -> None:
    """Two modules read one source, and one is called as a splitter might be."""
    lines = "@modules Eye, DataSplitter1, C{}\nDataSplitter1 uses_data_from {}\nC uses_data_from {}"
    configuration = "@configuration\n" + lines.format("", "Eye", "Eye")
    straight = "@specification\n" + lines.format("", "Eye", "Eye")
    split = "@specification\n" + lines.format(", DataSplitter2", "DataSplitter2", "DataSplitter2")
    split += "\nDataSplitter2 uses_data_from Eye"
    assert judged(split, configuration) == ([], [])
    assert judged(straight, configuration)[0] != []
    chained = "@specification\n" + lines.format("", "Eye", "DataSplitter1")
    assert judged(chained, configuration)[0] != []


def test_a_mount_by_another_tuple_is_refused_and_the_same_pose_is_not() -> None:
    text = "@{} hierarchical\n@modules A, B\nA 1 is_mounted_on B 2 {}\n"
    configuration = parse_text(text.format("configuration", "(x,90,_,_,0,10,0)"), "c.mars")
    project = Project(configuration.configuration, {}, ())
    for tuple_, item in (
        ("(x,90,_,_,0,10,0)", []),
        ("(x,-270,_,_,_,10.0,_)", []),
        ("(x,90,y,360,_,10,_)", []),
        (
            "(x,91,_,_,0,10,0)",
            ["`A` is mounted on `B` by (x,91,_,_,_,10,_), which is not declared"],
        ),
        ("", ["`A` is mounted on `B` by (_,_,_,_,_,_,_), which is not declared"]),
    ):
        changed = parse_text(text.format("specification", tuple_), "s.mars").configuration
        assert [each.message for each in verify(changed, project, RULEBOOK)] == item
