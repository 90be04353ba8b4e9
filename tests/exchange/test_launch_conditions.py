"""Conditions of launch files against an enumeration of all that their arguments can be."""

from itertools import combinations, product
from pathlib import Path
from random import Random
from typing import NamedTuple

import pytest

from mars_asp.diagnostic import point
from mars_asp.exchange.foreign import ForeignFile, read_foreign
from mars_asp.exchange.ros2 import import_ros2
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.facts.launched import launch_facts
from mars_asp.reasoning.launch_trees import launch_rules
from mars_asp.reasoning.rules import load_rulebook
from tests.support.campaigns import seeds

RULES = launch_rules(load_rulebook(stages=("launch",)))
#: The values that each argument takes; the last of three is any other.
VALUES = {
    **{f"a{n}": ("true", "false") for n in range(8)},
    "m": ("x", "y", "?"),
    "k": ("x", "z", "?"),
}
DEFAULTS = {name: values[0] for name, values in VALUES.items()}
NAMES = ("left", "right", "front")


class Held(NamedTuple):
    """A condition as the file writes it, and its meaning."""

    written: str
    argument: str
    value: str
    wanted: bool


class Started(NamedTuple):
    """A node of a random tree, and the conditions above it."""

    name: str
    under: tuple[Held, ...]


def random_condition(random: Random) -> Held:
    name = random.choice(list(VALUES))
    wanted = random.random() < 0.5
    if name.startswith("a"):
        form = random.choice(("{} = '$(var {})'", "{} = '$(eval \"$(var {})\")'"))
        word = "if" if wanted else "unless"
        return Held(
            form.replace("'", '"', 2).format(word, name)
            if "eval" not in form
            else f"{word}='$(eval \"$(var {name})\")'",
            name,
            "true",
            wanted,
        )
    value = random.choice(VALUES[name][:2])
    sign = "==" if wanted else "!="
    return Held(f"if=\"$(eval &quot;'$(var {name})' {sign} '{value}'&quot;)\"", name, value, wanted)


def random_tree(random: Random) -> tuple[str, list[Started]]:
    """Return a launch file in XML, and the nodes that it may start."""
    lines = [f'<arg name="{name}" default="{values[0]}"/>' for name, values in VALUES.items()]
    nodes: list[Started] = []

    def fill(under: tuple[Held, ...], depth: int) -> None:
        for _ in range(random.randint(1, 3)):
            if depth < 3 and random.random() < 0.5:
                held = random_condition(random)
                lines.append(f"<group {held.written}>")
                fill((*under, held), depth + 1)
                lines.append("</group>")
            else:
                name = random.choice(NAMES)
                own = random_condition(random) if random.random() < 0.4 else None
                written = "" if own is None else f" {own.written}"
                lines.append(f'<node pkg="some" exec="thing" name="{name}"{written}/>')
                nodes.append(Started(name, (*under, *([own] if own else []))))

    fill((), 0)
    return "<launch>\n" + "\n".join(lines) + "\n</launch>\n", nodes


def runs(node: Started, assigned: dict[str, str]) -> bool:
    return all((assigned[each.argument] == each.value) == each.wanted for each in node.under)


def needed(held: list[Held]) -> set[Held]:
    """Return the tests of several conditions: equality with one value excludes others."""
    plain = {each._replace(written="") for each in held}
    known = {each.argument for each in plain if each.wanted}
    return {each for each in plain if each.wanted or each.argument not in known}


def assignments(nodes: list[Started]) -> list[dict[str, str]]:
    named = sorted({each.argument for node in nodes for each in node.under})
    return [
        dict(zip(named, values, strict=True)) for values in product(*(VALUES[n] for n in named))
    ]


def judged(text: str, folder: Path) -> Analysis:
    file = folder / "tree.launch.xml"
    file.write_text(text)
    parsed = read_foreign([ForeignFile(str(file), text, "ros2")])
    return analyse(launch_facts(parsed.trees), RULES, point("tree", 1, 1))


@pytest.mark.parametrize("seed", seeds(30, 300))
def test_nodes_of_one_name_are_found_where_some_arguments_start_both(
    seed: int, tmp_path: Path
) -> None:
    random = Random(seed)
    text, nodes = random_tree(random)
    every = assignments(nodes)
    twice = {
        name: [
            assigned
            for assigned in every
            if sum(node.name == name and runs(node, assigned) for node in nodes) > 1
        ]
        for name in NAMES
    }
    found = {each.subject: each for each in judged(text, tmp_path).consequences}
    assert found.keys() == {f"/{name}" for name, both in twice.items() if both}
    for name, both in twice.items():
        if not both:
            continue
        tests = found[f"/{name}"].conditions
        meant = [
            assigned
            for assigned in every
            if all((assigned[t.variable] == t.value) == (t.how == "if") for t in tests)
        ]
        # The conditions are possible, sufficient and minimal: no pair has fewer.
        assert meant and all(assigned in both for assigned in meant)
        # Of two pairs one may always run.
        if not tests:
            assert both == every
            continue
        pairs = [
            pair
            for pair in combinations([node for node in nodes if node.name == name], 2)
            if any(all(runs(node, assigned) for node in pair) for assigned in every)
        ]
        # Those that run with the defaults come first.
        usual = [pair for pair in pairs if all(runs(node, DEFAULTS) for node in pair)]
        least = min(
            len(needed([held for node in pair for held in node.under])) for pair in usual or pairs
        )
        assert found[f"/{name}"].severity == ("warning" if usual else "note")
        assert len(tests) == least


@pytest.mark.parametrize("seed", seeds(15, 60))
def test_publishers_of_one_topic_are_found_where_some_arguments_start_both(
    seed: int, tmp_path: Path
) -> None:
    text, nodes = random_tree(Random(seed))
    keyboard = 'pkg="teleop_twist_keyboard" exec="teleop_twist_keyboard"'
    found = judged(text.replace('pkg="some" exec="thing"', keyboard), tmp_path).consequences
    every = assignments(nodes)
    together = {
        f"/{node.name}"
        for pair in combinations(nodes, 2)
        for node in pair
        if pair[0].name != pair[1].name
        if any(all(runs(each, assigned) for each in pair) for assigned in every)
    }
    rivals = [set(each.participants) for each in found if each.kind == "ambiguous_priority"]
    assert rivals == ([together] if together else [])


@pytest.mark.parametrize("line", ["", "if='$(var a)'"])
@pytest.mark.parametrize("same", [False, True])
def test_pairs_grow_no_faster_than_nodes(line: str, same: bool, tmp_path: Path) -> None:
    pairs = []
    for number in (20, 40):
        nodes = (
            f'<node pkg="teleop_twist_keyboard" exec="teleop_twist_keyboard" {line}'
            f' name="n{0 if same else each}"/>'
            for each in range(number)
        )
        text = (
            "<launch>\n" + "\n".join(('<arg name="a" default="true"/>', *nodes)) + "\n</launch>\n"
        )
        analysis = judged(text, tmp_path)
        atoms = analysis.grounding.control.symbolic_atoms
        pairs.append(sum(1 for _ in atoms.by_signature("weighed_pair", 2)))
    assert pairs[1] < 2.2 * pairs[0]


def test_a_launch_file_of_ros_1_keeps_its_arguments(tmp_path: Path) -> None:
    # Only its name shows that the outer file is of ROS 1.
    (tmp_path / "outer.launch").write_text(
        '<launch><arg name="shown" default="true"/>'
        '<include file="$(dirname)/inner.launch"/></launch>'
    )
    (tmp_path / "inner.launch").write_text(
        '<launch><arg name="shown" default="false"/>'
        '<node pkg="some" type="thing" name="eye" if="$(arg shown)"/></launch>'
    )
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert not tree.nodes


@pytest.mark.parametrize(
    ("name", "is_named"), [("$(anon a)", False), ("$(arg a)", False), ("a", True)]
)
def test_an_anonymous_node_has_a_name_of_its_own(name: str, is_named: bool, tmp_path: Path) -> None:
    text = (
        '<launch><arg name="a" default="$(anon a)"/><node pkg="joy" type="joy_node" name="{}"/>'
        '<node pkg="other" type="x" name="b"/></launch>'
    )
    (tmp_path / "a.launch").write_text(text.format(name))
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [(node.name, node.is_named) for node in tree.nodes] == [("/a", is_named), ("/b", True)]
