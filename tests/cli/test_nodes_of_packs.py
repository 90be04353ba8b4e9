"""Specifications with nodes of rule packs as files: read with and without the packs, and run."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from tests.support.documents import ROOT
from tests.support.fixtures import Captured

KINDS = ROOT / "tests" / "node_kinds"
WATCHDOG = ROOT / "examples" / "packs" / "watchdog"
EARS, SHAPES, WITNESS = (KINDS / "packs" / name for name in ("ears", "shapes", "witness"))

SPECIFICATION = """@specification
@modules Drive, Base, Watchdog1
Base is_controlled_by Watchdog1
// Watchdog1: node of the pack watchdog
Watchdog1 is_controlled_by Drive
"""


def written(folder: Path, text: str = SPECIFICATION) -> Path:
    path = folder / "s.mars"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("verb", ["analyse", "synthesise", "explain", "facts", "check"])
def test_a_node_of_a_pack_that_is_not_given_is_an_error_everywhere(
    verb: str, tmp_path: Path, capsys: Captured
) -> None:
    assert run_here([verb, str(written(tmp_path))]) == 2
    output = capsys.readouterr()
    assert "`Watchdog1` is a node of the pack `watchdog`, which is not given" in " ".join(
        (output.out if verb == "check" else output.err).split()
    )


def test_the_specification_that_is_judged_names_its_packs_too(
    tmp_path: Path, capsys: Captured
) -> None:
    configuration = tmp_path / "c.mars"
    configuration.write_text("@configuration\n@modules Drive, Base\nBase is_controlled_by Drive\n")
    judged = ["verify", str(written(tmp_path)), str(configuration)]
    assert run_here(judged) == 2
    assert "give the folder of the pack" in " ".join(capsys.readouterr().err.split())
    written(tmp_path, SPECIFICATION.replace("// Watchdog1: node of the pack watchdog\n", ""))
    assert run_here(judged) == 1
    output = " ".join(capsys.readouterr().out.split())
    assert "if it is a node of a rule pack, give the pack with `--rules`" in output


@pytest.mark.parametrize(
    ("comment", "status"),
    [
        ("// Watchdog1: node of the pack watchdog", 0),
        ("# Watchdog1: node of the pack watchdog -- as the team asked", 0),
        ("// Watchdog1: node of the pack witness", 2),
        ("// Watchdog1: node of the pack of dogs", 0),
        ("// Cat1: node of the pack cats", 0),
        ("// Base: node of the pack witness", 2),
    ],
)
def test_comments_name_the_pack_of_a_node(
    comment: str, status: int, tmp_path: Path, capsys: Captured
) -> None:
    text = SPECIFICATION.replace("// Watchdog1: node of the pack watchdog", comment)
    packs = [word for each in (WATCHDOG, WITNESS) for word in ("--rules", str(each))]
    assert run_here(["analyse", str(written(tmp_path, text)), *packs, "--quiet"]) == status
    assert ("has no nodes named as" in " ".join(capsys.readouterr().err.split())) == (status == 2)


def test_packs_of_the_settings_bring_their_nodes(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "mars.toml").write_text(f'rules = ["{WATCHDOG}"]\n', encoding="utf-8")
    assert run_here(["facts", str(written(tmp_path))]) == 0
    assert 'node("Watchdog1",watchdog).' in capsys.readouterr().out


def test_nodes_that_need_no_behaviour_forward_their_inputs(
    tmp_path: Path, capsys: Captured
) -> None:
    specification = written(
        tmp_path,
        """@specification hierarchical
@modules Sonar, Lidar, Map, Screen, Drive, Base, Fan1, Merger1, Mixer1
Fan1 uses_data_from Sonar
Screen uses_data_from Fan1
Merger1 uses_data_from Fan1
Merger1 uses_data_from Lidar
Map uses_data_from Merger1
Mixer1 is_controlled_by Drive
Base is_controlled_by Mixer1

@module_start
@module_name Sonar
@Sense NotifyAtFrequency 10
Range read();
@module_end
@module_start
@module_name Lidar
@Sense NotifyAtFrequency 5
Range read();
@module_end
@module_start
@module_name Drive
@ControlOut
Twist say();
@module_end
@module_start
@module_name Base
@Trans_Z
void go(Twist t);
@module_end
""",
    )
    (tmp_path / "s.py").write_text(
        "from mars_asp.behaviour import Command\n"
        "def drive():\n    return Command('Trans_Z', 100)\n"
        "def sense():\n    return 1\n"
        "def take(*inputs):\n    return None\n"
    )
    scenario = tmp_path / "s.toml"
    scenario.write_text(
        'duration = 1\n[robot]\nmodule = "Base"\nradius = 200\n[bindings]\n'
        'Drive = { python = "s.py:drive", period = 100 }\n'
        'Sonar = { python = "s.py:sense" }\nLidar = { python = "s.py:sense" }\n'
        'Map = { python = "s.py:take" }\nScreen = { python = "s.py:take" }\n'
    )
    options = ["--rules", str(SHAPES), "--format", "json", "--quiet"]
    assert run_here(["run", str(specification), "--scenario", str(scenario), *options]) == 0
    links = json.loads(capsys.readouterr().out)["links"]
    rates = {f"{each['source']} {each['client']}": each["got_hz"] for each in links}
    assert rates["Fan1 Screen"] == rates["Fan1 Merger1"] == 10
    assert rates["Merger1 Map"] == 15
    assert rates["Mixer1 Base"] == 10


@pytest.mark.parametrize("behaviour", ["needed", "none"])
def test_an_inheritance_node_leads_through_nodes_of_packs(
    behaviour: str, tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "watchdog"
    pack.mkdir()
    manifest = (WATCHDOG / "pack.toml").read_text(encoding="utf-8")
    (pack / "pack.toml").write_text(f'{manifest}behaviour = "{behaviour}"\n', encoding="utf-8")
    blocks = (KINDS / "inheritance.mars").read_text(encoding="utf-8").partition("\n\n")[2]
    expected = (KINDS / "inheritance.expected.mars").read_text(encoding="utf-8")
    specification = written(tmp_path, f"{expected}\n{blocks}")
    (tmp_path / "s.py").write_text(
        "from mars_asp.behaviour import Command\n"
        "def find():\n    return Command('Trans_X', 100)\n"
        "def sense(*inputs):\n    return None\n"
        "def hand_on(command):\n    return command\n"
    )
    bound = 'Watchdog1 = { python = "s.py:hand_on" }\n' if behaviour == "needed" else ""
    scenario = tmp_path / "s.toml"
    scenario.write_text(
        'duration = 2\nup = "z"\n[robot]\nmodule = "Platform"\nradius = 200\n'
        "[requirements]\nreach = { at = [150, 0], radius = 60, within = 2 }\n[bindings]\n"
        'Finder = { python = "s.py:find", period = 100 }\n'
        'Joystick = { python = "s.py:sense", period = 100 }\n'
        f'Camera = {{ python = "s.py:sense", period = 100 }}\n{bound}'
    )
    options = ["--rules", str(pack), "--quiet"]
    assert run_here(["run", str(specification), "--scenario", str(scenario), *options]) == 0
    if bound:
        scenario.write_text(scenario.read_text().replace(bound, ""))
        assert run_here(["run", str(specification), "--scenario", str(scenario), *options]) == 2
        assert "`Watchdog1` is not bound" in " ".join(capsys.readouterr().err.split())


REPAIRED = """@specification
@modules Sonar, Map, Screen, Fan1, Merger1
Fan1 uses_data_from Sonar
Merger1 uses_data_from Fan1
Map uses_data_from Merger1
Merger1 uses_data_from Map
Screen uses_data_from Fan1
Screen uses_data_from Merger2
"""


@pytest.mark.parametrize(
    ("finding", "edits"),
    [
        # To drop the other line would leave Merger1 without a receiver.
        ("data_cycle", ["drop the line that relates `Merger1` to `Map`"]),
        # Merger1 is another node, not one that is spelt nearly so.
        (
            "undeclared_module",
            ["add `Merger2` to `@modules`", "drop every line that names `Merger2`"],
        ),
    ],
)
def test_repairs_keep_inputs_and_outputs_of_nodes_of_packs(
    finding: str, edits: list[str], tmp_path: Path, capsys: Captured
) -> None:
    specification = str(written(tmp_path, REPAIRED))
    options = ["--repair", "--rules", str(SHAPES), "--format", "json"]
    run_here(["explain", specification, finding, *options])
    found = json.loads(capsys.readouterr().out)
    mends = [each for one in found["repairs"] for each in one["repairs"]]
    assert [edit["message"] for each in mends for edit in each["edits"]] == edits


def test_nodes_that_no_rule_of_verify_asks_for_are_a_fault_of_packs(
    tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "filters"
    (pack / "resolve").mkdir(parents=True)
    for each in ("pack.toml", "resolve/filters.lp"):
        text = (KINDS / "packs" / "filters" / each).read_text(encoding="utf-8")
        (pack / each).write_text(text, encoding="utf-8")
    robot = "@configuration\n@modules Fast, Base\nBase is_controlled_by Fast\n"
    (tmp_path / "c.mars").write_text(robot, encoding="utf-8")
    specification = written(tmp_path, robot.replace("configuration", "specification"))
    words = ["verify", str(specification), str(tmp_path / "c.mars"), "--rules", str(pack)]
    assert run_here(words) == 1
    output = " ".join(capsys.readouterr().err.split())
    assert "a fault of rule packs" in output
    assert "no rule in `verify` asks for nodes that packs introduce, such as Limiter1" in output


def test_packs_that_refuse_their_own_nodes_are_named(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "pack.toml").write_text('name = "mine"\nversion = "1"\n', encoding="utf-8")
    (tmp_path / "verify").mkdir()
    rules = tmp_path / "verify" / "mine.lp"
    rules.write_text(
        "%! id: verify/mine/never\n%! because: `{N}` is there\n"
        "violation(100, N) :- glue(N, watchdog).\n",
        encoding="utf-8",
    )
    options = ["--rules", str(WATCHDOG), "--rules", str(tmp_path), "--quiet"]
    assert run_here(["synthesise", str(KINDS / "arbiter.mars"), *options]) == 2
    output = " ".join(capsys.readouterr().err.split())
    assert f"{rules}:3:1: error:" in output.replace("mine.lp: 3", "mine.lp:3")
    assert "the rule refuses the specification that was found: `Watchdog1` is there" in output


@pytest.mark.parametrize("behaviour", ["needed", "none"])
def test_a_node_that_only_listens_hears_each_message_and_changes_nothing(
    behaviour: str, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "ears").mkdir()
    manifest = (EARS / "pack.toml").read_text(encoding="utf-8")
    declared = manifest.replace('behaviour = "none"', f'behaviour = "{behaviour}"')
    (tmp_path / "ears" / "pack.toml").write_text(declared, encoding="utf-8")
    blocks = """
@module_start
@module_name Sonar
@Sense NotifyAtFrequency 10
Range read();
@module_end
@module_start
@module_name Base
@Trans_Z
void go(Twist t);
@module_end
"""
    expected = (KINDS / "listeners_alone.expected.mars").read_text(encoding="utf-8")
    lines = [line for line in expected.splitlines() if "@Tag" not in line]
    specification = written(tmp_path, "\n".join([*lines, blocks]))
    (tmp_path / "s.py").write_text(
        "from mars_asp.behaviour import Command\n"
        "def drive():\n    return Command('Trans_Z', 100)\n"
        "def sense(*inputs):\n    return 1\n"
        "def halt(command):\n    return Command('Trans_Z', -100)\n"
    )
    bound = "".join(
        f'{name} = {{ python = "s.py:{what}" }}\n'
        for name, what in (("Monitor1", "halt"), ("Journal1", "halt"), ("Probe1", "sense"))
    )
    scenario = tmp_path / "s.toml"
    scenario.write_text(
        'duration = 1\n[robot]\nmodule = "Base"\nradius = 200\n[requirements]\n'
        "reach = { at = [90, 0], radius = 30, within = 1 }\n[bindings]\n"
        'Joystick = { python = "s.py:drive", period = 100 }\nMap = { python = "s.py:sense" }\n'
        f'Sonar = {{ python = "s.py:sense" }}\n{bound if behaviour == "needed" else ""}'
    )
    options = ["--rules", str(tmp_path / "ears"), "--format", "json", "--quiet"]
    run = ["run", str(specification), "--scenario", str(scenario), *options]
    assert run_here(run) == 0
    links = json.loads(capsys.readouterr().out)["links"]
    rates = {f"{each['source']} {each['client']}": each["got_hz"] for each in links}
    assert rates["ControlSplitter1 Monitor1"] == rates["ControlSplitter1 Journal1"] == 10
    assert rates["DataSplitter1 Probe1"] == rates["DataSplitter1 Map"] == 10
    if behaviour == "needed":
        scenario.write_text(scenario.read_text().replace(bound, ""))
        assert run_here(run) == 2
