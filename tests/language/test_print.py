"""Printed text, read back, gives the same configuration."""

import dataclasses
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.diagnostic import Span
from mars_asp.language import parse_file, parse_text, print_configuration
from mars_asp.model.declarations import (
    MOTION_FUNCTIONS,
    SERVICE_KINDS,
    Configuration,
    Control,
    Function,
    Include,
    Mode,
    Module,
    Mount,
    Name,
    Service,
    Transformation,
    Vertex,
)
from mars_asp.model.ranges import ANGLE, FREQUENCY, LENGTH, MOST, RATE, NumberRange
from mars_asp.model.rates import Rate, every
from tests.support.campaigns import examples
from tests.support.documents import ROOT
from tests.support.robots import HERE
from tests.support.strategies import control, data, mount

FILES = [*ROOT.glob("examples/*/*.mars"), *ROOT.glob("tests/*.mars")]


def placeless(value: Any) -> Any:
    """Return a value with all its locations replaced by `HERE`."""
    if isinstance(value, Span):
        return HERE
    if isinstance(value, tuple):
        return tuple(map(placeless, value))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [field.name for field in dataclasses.fields(value)]
        changed = {name: placeless(getattr(value, name)) for name in fields if name != "path"}
        return dataclasses.replace(value, **changed)
    return value


def numbered(configuration: Configuration) -> Configuration:
    """Take priorities of lists for numbers, as which hierarchical control prints them."""
    if configuration.architecture == "flat":
        return configuration
    lines = (
        dataclasses.replace(line, listed=False) if isinstance(line, Control) else line
        for line in configuration.relationships
    )
    return dataclasses.replace(configuration, relationships=tuple(lines))


def assert_reads_back(configuration: Configuration) -> None:
    text = print_configuration(configuration)
    read = parse_text(text, configuration.path)
    assert placeless(read.configuration) == placeless(numbered(configuration)), text
    assert read.warnings == (), text
    assert print_configuration(read.configuration) == text


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_file_reads_back(path: Path) -> None:
    assert_reads_back(parse_file(path).configuration)


def within(wanted: NumberRange, places: int) -> st.SearchStrategy[Decimal]:
    """Return numbers of a range, its ends among them."""
    ends = st.sampled_from([wanted.least + Decimal(1).scaleb(-places), wanted.most])
    return ends | st.decimals(wanted.least + 1, wanted.most, places=places)


numbers = within(LENGTH, 3) | st.integers(-720, 720).map(Decimal)
angles = within(ANGLE, 6) | st.integers(-720, 720).map(Decimal)
turns = st.tuples(st.sampled_from("xyz"), angles)
transformations = st.builds(
    Transformation,
    st.lists(turns, max_size=2).map(tuple),
    st.tuples(numbers, numbers, numbers),
)
bounds = st.tuples(numbers, numbers).map(sorted) | st.sampled_from(
    [[None, None], [Decimal(-1), None], [None, Decimal("0.5")]]
)
functions = st.builds(
    lambda name, pair, rate: Function(name, HERE, pair[0], pair[1], rate),
    st.sampled_from((*MOTION_FUNCTIONS, "Grasp")),
    bounds,
    st.none() | within(RATE, 3),
)
representations = st.sampled_from(
    ["RawImage", "nav::Odometry", "Line[]", "map<Key,Line[]>", "(A,B)", "(A,B)[]", "Grid<Cell,3>"]
)
written_names = st.sampled_from(["image", "/imu/data", "3", "bumper response", 'say "go"', "a.b"])
words = st.sampled_from(["left", "right", "x1", "auto", "const", "map", "self"])
parameters = words | written_names
modes = st.sampled_from(
    [
        Mode("NotifyWhenReady"),
        Mode("RequestWhenReady"),
        Mode("NotifyAtFrequency"),
        Mode("NotifyOnValue", (Decimal("-30.5"), Decimal(1))),
        Mode("NotifyOnMin", (Decimal(3),), "nearest"),
        Mode("NotifyOnMax", of="first"),
    ]
)


READY = (Mode("NotifyWhenReady", text="NotifyWhenReady"),)


@st.composite
def services(draw: st.DrawFn) -> Service:
    kind = draw(st.sampled_from(SERVICE_KINDS))
    inputs = draw(st.lists(st.none() | representations, max_size=3))
    offered = draw(st.lists(modes, min_size=1, max_size=3, unique=True))
    periodic = any(mode.name == "NotifyAtFrequency" for mode in offered)
    delivers = kind in ("Sense", "DataOut")
    inputs = [draw(representations)] if kind == "Converts" else inputs
    inputs = inputs[: {"Done": 0, "Reset": 1}.get(kind, len(inputs))]
    called = st.lists(parameters, min_size=len(inputs), max_size=len(inputs), unique=True)
    names = draw(st.just([None] * len(inputs)) | called)
    rate = st.builds(Rate, within(FREQUENCY, 6)) | st.builds(
        every, st.integers(1, 10**6), st.sampled_from(["ms", "s"])
    )
    return Service(
        kind,
        HERE,
        draw(st.sampled_from(["grab", "Eye::look", "operator()"])),
        draw(st.none() | representations),
        tuple(inputs),
        tuple(offered) if delivers else READY if kind == "Done" else (),
        draw(rate) if delivers and periodic else None,
        tuple(draw(st.lists(st.sampled_from(MOTION_FUNCTIONS), unique=True, max_size=2)))
        if kind == "ControlOut"
        else (),
        draw(st.integers(1, 99) | st.just(1_000_000)) if kind == "Converts" else 1,
        draw(st.none() | written_names) if delivers else None,
        tuple(names),
        draw(st.none() | st.integers(1, MOST)) if inputs and kind != "Reset" else None,
    )


@st.composite
def modules(draw: st.DrawFn, name: str) -> Module:
    each = st.lists(services(), max_size=3)
    offered = tuple(draw(each.filter(lambda s: [e.kind for e in s].count("Reset") < 2)))
    senses = any(service.kind == "Sense" for service in offered)
    commands = any(service.kind == "ControlOut" for service in offered)
    moves = draw(st.lists(functions, max_size=3, unique_by=lambda f: f.name))
    placed = st.builds(Vertex, st.integers(0, 9) | st.just(MOST), transformations, st.just(HERE))
    return Module(
        name,
        HERE,
        offered,
        () if senses else tuple(moves),
        tuple(draw(st.lists(placed, max_size=2, unique_by=lambda vertex: vertex.number))),
        HERE,
        draw(st.sampled_from([None, HERE])) if commands else None,
    )


#: Words of the language, names in quotes and such as need none.
names = st.sampled_from(
    ["A", "as", "hold", "every", "/robot1/base", "dora-camera", "a.b", "3", 'b "as" c', "x as y"]
)
paths = st.sampled_from(["left.mars", "../arms/left arm.mars", "as.mars", "a as b.mars"])
includes = st.builds(Include, paths, st.none() | names, st.just(HERE)).filter(
    # Without a name of its own the text after `as` would be read as one.
    lambda include: include.name is not None or " as " not in include.path
)


@st.composite
def configurations(draw: st.DrawFn) -> Configuration:
    placements = draw(st.lists(st.none() | transformations, max_size=3))
    named = draw(st.lists(names, min_size=2, max_size=5, unique=True))
    described = [Name(name, HERE, draw(st.none() | names)) for name in named]
    lines = draw(st.lists(data | control | mount, max_size=4))
    blocks = draw(st.lists(names, max_size=2, unique=True))
    return Configuration(
        "robot.mars",
        HERE,
        modules=tuple(described),
        relationships=(
            *(Mount("A", "B", HERE, transformation=at) for at in placements),
            *lines,
        ),
        declared=tuple(draw(modules(name)) for name in blocks),
        includes=tuple(draw(st.lists(includes, max_size=2))),
    )


@settings(max_examples=examples(40, 100), deadline=None, derandomize=True)
@given(configurations())
def test_declared_modules_and_tuples_read_back(configuration: Configuration) -> None:
    assert_reads_back(configuration)


def test_a_number_of_as_many_digits_as_may_be_written_reads_back() -> None:
    text = "@configuration\n@modules A, B\nA is_mounted_on B\n"
    text += "@module_start\n@module_name A\n@Rotn_X -.12345678901234567 .12345678901234567\n"
    assert_reads_back(parse_text(text + "@module_end\n", "a.mars").configuration)
