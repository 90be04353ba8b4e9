"""How functions are made up without a motion or a mount."""

from mars_asp.reasoning.facts.otherwise import otherwise
from mars_asp.reasoning.project import load_project
from tests.support.documents import ROOT


def changes(text: str, *names: str) -> list[str]:
    project = load_project("config.mars", (), text)
    return [str(atom) for atom in otherwise(project.configuration, project.modules, set(names))]


TURNED = (ROOT / "tests/accounts/turned_parts.mars").read_text(encoding="utf-8")
WITHOUT = '"Claw","Trans_Z",lost("Turret","Rotn_Y")'


def test_a_turn_between_two_motions_decides_which_make_up_a_function() -> None:
    assert [each for each in changes(TURNED, "Claw") if WITHOUT in each] == [
        f"made_otherwise({WITHOUT})",
        f'other_part({WITHOUT},"Rail","Trans_X")',
        f'other_part({WITHOUT},"Turret","Trans_Y")',
    ]


def test_only_differences_yield_facts() -> None:
    # Without one of the motions or of the mounts the rest do not make up the function, as is clear.
    assert {each.partition("(")[2] for each in changes(TURNED, "Claw") if "made" in each} == {
        f"{WITHOUT})"
    }
    assert changes(TURNED, "Rail", "Other") == []


def test_a_long_chain_is_left_out() -> None:
    names = [f"L{number}" for number in range(14)]
    mounts = [f"{a} is_mounted_on {b}" for a, b in zip(names[1:], names, strict=False)]
    longer = "\n".join(
        ["@configuration", f"@modules Rail, Turret, Lift, Claw, {', '.join(names)}"]
        + [*mounts, "Rail is_mounted_on L13", *TURNED.splitlines()[2:]]
        + [f"@module_start\n@module_name {name}\n@Trans_X\n@module_end" for name in names]
    )
    assert changes(longer, "Lift") == changes(longer, "Claw") == []
