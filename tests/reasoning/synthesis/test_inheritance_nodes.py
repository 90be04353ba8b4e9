"""The module of an InheritanceNode: from its comment, else from mounts and controllers."""

import json
import re
from dataclasses import replace

import pytest

from mars_asp.cli.synthesise import synthesis_json
from mars_asp.diagnostic import MarsError
from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.language import parse_text, print_configuration
from mars_asp.language.format import format_text
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.verification import verify
from tests.support.execute_builders import ms
from tests.support.refusals import refusal, refusals
from tests.support.subjects import RULEBOOK, read, synthesised

TURNED = """@configuration
@modules Base, Pan, Cam, A
Pan is_mounted_on Base
Cam is_mounted_on Pan (y,90,_,_,_,_,_)
{led} is_controlled_by A
@module_start
@module_name Base
@Trans_X
@Trans_Z
@module_end
@module_start
@module_name Pan
@Rotn_Y
@module_end
@module_start
@module_name Cam
@Sense NotifyWhenReady
Image look();
@module_end
@module_start
@module_name A
@ControlOut Trans_X
Command lead();
@module_end
"""
COMMENT = re.compile(r"// InheritanceNode\d: \w+\n")


def specified(text: str) -> tuple[Configuration, str]:
    """Return a minimal specification, and its text with the declarations of all modules."""
    project = read(text)
    found = synthesised(project)
    assert found is not None
    whole = found.specification.configuration
    return whole, print_configuration(replace(whole, declared=project.configuration.declared))


def commands_of(specification: Configuration) -> dict[str, object]:
    """Return the command of each module if A commands `Trans_X` at 5 mm/s."""
    got: dict[str, object] = {}

    def obeying(name: str) -> Behaviour:
        return Behaviour(lambda command: got.update({name: command}))

    behaviours = {name.text: obeying(name.text) for name in specification.modules}
    behaviours["A"] = Behaviour(lambda: ("Trans_X", 5), ms(1000))
    executor = Executor(specification, {}, behaviours)
    executor.step_until(0)
    assert not executor.failures
    return got


@pytest.mark.parametrize(
    ("led", "function", "rate"), [("Pan", "Trans_X", 5), ("Cam", "Trans_Z", -5)]
)
def test_a_turned_rider_without_a_controller_turns_no_command(
    led: str, function: str, rate: float
) -> None:
    whole, text = specified(TURNED.format(led=led))
    assert f"// InheritanceNode1: {led}\nInheritanceNode1 is_controlled_by A\n" in text
    for specification in (
        replace(whole, declared=read(TURNED.format(led=led)).configuration.declared),
        parse_text(text, "s.mars").configuration,
    ):
        assert commands_of(specification)["Base"] == pytest.approx({function: rate})


def test_several_fitting_modules_require_a_comment() -> None:
    _, text = specified(TURNED.format(led="Pan"))
    found = refusal(commands_of, parse_text(COMMENT.sub("", text), "s.mars").configuration)
    assert found.message == (
        "`InheritanceNode1` may serve `Cam` or `Pan`, which move in different ways"
    )


def test_a_comment_about_a_module_that_is_not_carried_is_refused() -> None:
    _, text = specified(TURNED.format(led="Pan"))
    assert (
        "do not carry `Base`"
        in refusals(
            commands_of,
            parse_text(COMMENT.sub("// InheritanceNode1: Base\n", text), "s.mars").configuration,
        )[0].message
    )


def test_two_nodes_with_the_same_controllers_and_providers() -> None:
    other = "Eye is_mounted_on Base (y,180,_,_,_,_,_)\nEye is_controlled_by A\nCam is_mounted_on"
    text = (
        TURNED.format(led="Cam")
        .replace("Cam is_mounted_on", other)
        .replace("Cam, A", "Cam, Eye, A")
    )
    text += "@module_start\n@module_name Eye\n@Sense NotifyWhenReady\nImage look();\n@module_end\n"
    project = read(text)
    _, spec = specified(text)
    pairs = dict(re.findall(r"// (InheritanceNode\d): (\w+)\n", spec))
    assert sorted(pairs.values()) == ["Cam", "Eye"]
    read_back = parse_text(spec, "s.mars").configuration
    assert verify(read_back, project, RULEBOOK) == ()
    assert verify(replace(read_back, stand_ins=()), project, RULEBOOK) == ()
    same = COMMENT.sub(lambda match: re.sub(r"Cam|Eye", "Cam", match[0]), spec)
    wrong = verify(parse_text(same, "s.mars").configuration, project, RULEBOOK)
    assert {violation.clause for violation in wrong} == {5}


def test_a_comment_is_printed_only_where_it_is_needed() -> None:
    text = TURNED.format(led="Pan").replace(" (y,90,_,_,_,_,_)", "")
    project = read(text)
    found = synthesised(project)
    assert found is not None
    assert "//" not in print_configuration(found.specification.configuration)
    document = json.loads(json.dumps(synthesis_json(project, found)))
    (node,) = [each for each in document["modules"] if each["kind"] == "inheritance_node"]
    assert node["stands_for"] == "Pan"


def test_comments_stay_where_a_specification_is_read_laid_out_and_resolved_again() -> None:
    _, text = specified(TURNED.format(led="Pan"))
    line = "// InheritanceNode1: Pan\n"
    assert line in format_text(text, "s.mars")
    assert line in specified(text)[1]


def test_comments_with_unknown_names_are_located() -> None:
    _, text = specified(TURNED.format(led="Pan"))
    changed = text.replace("// InheritanceNode1: Pan", "// InheritanceNode2: Pam")
    node, module = parse_text(changed, "s.mars").warnings
    assert (node.help, module.help) == ("did you mean `InheritanceNode1`?", "did you mean `Pan`?")
    assert node.span.line == text[: text.index("//")].count("\n") + 1
    with pytest.raises(MarsError, match="InheritanceNode1"):
        parse_text(text.replace("// I", "// InheritanceNode1: Cam\n// I"), "s.mars")
