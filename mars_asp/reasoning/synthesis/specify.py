"""Builds a specification from the atoms that `rules/specify` derives.

The rules have decided the nodes and lines; here nodes get their names and lines their order, as in
the figures of the paper.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Module,
    Mount,
    Muxed,
    Name,
    Relationship,
    Reset,
    StandIn,
    Strategy,
)
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.synthesis.control_lines import ControlLines
from mars_asp.reasoning.synthesis.data_lines import DataLines
from mars_asp.reasoning.synthesis.derived import SpecifiedAtoms
from mars_asp.reasoning.synthesis.draft import IntroducedNode, SpecificationDraft
from mars_asp.reasoning.synthesis.inheritance_nodes import InheritanceNodes
from mars_asp.reasoning.synthesis.side_lines import SideLines


@dataclass(frozen=True)
class Specification:
    """A resolved configuration, its nodes, and the consequences that each resolves, by name."""

    nodes: tuple[IntroducedNode, ...]
    resolves: Mapping[str, tuple[str, ...]]
    configuration: Configuration


def _write(
    draft: SpecificationDraft, derived: SpecifiedAtoms, relationships: Iterable[Relationship]
) -> None:
    """Write relationships, with the derived nodes between their ends, into a draft."""
    places = draft.places(derived)
    sides = SideLines(draft, derived, places)
    data = DataLines(draft, derived, places, sides)
    control = ControlLines(draft, derived, places, sides)
    for place, relationship in enumerate(relationships):
        match relationship:
            case Data():
                data.write(relationship)
            case Control():
                control.write(relationship)
            case Mount():
                draft.lines.append(relationship)
            case Reset() | Gating() | Lock() | Limit() | Strategy():
                sides.write_at(place)
        while sides.pending:
            feeder = sides.pending.pop()
            data.open(feeder)
            control.open(feeder)


def specify(project: Project, derived: SpecifiedAtoms) -> Specification:
    """Build the specification that the rules derived."""
    configuration, draft = project.configuration, SpecificationDraft(project)
    _write(draft, derived, configuration.relationships)
    draft.name_positions()
    nodes = tuple(draft.nodes.values())
    resolves = {node.name: derived.resolved.get(term, ()) for term, node in draft.nodes.items()}
    # A specification that needs no more nodes keeps its order.
    stays = configuration.kind == "specification" and not nodes
    names = tuple(Name(node.name, configuration.span) for node in nodes)
    conversions = tuple(node.conversion for node in nodes if node.conversion is not None)
    printed = replace(
        configuration,
        kind="specification",
        declares_architecture=_states_architecture(configuration, nodes),
        sources=(),
        modules=(*configuration.modules, *names),
        relationships=configuration.relationships if stays else tuple(draft.lines),
        declared=(),
        conversions=(*configuration.conversions, *conversions),
        muxes=tuple(_at_arbiters(configuration.muxes, draft.lines, nodes)),
    )
    every = configuration.with_declared(project.modules)
    printed = replace(printed, stand_ins=(*printed.stand_ins, *_stand_ins(nodes, printed, every)))
    return Specification(nodes, resolves, printed)


def _at_arbiters(
    muxes: Iterable[Muxed], lines: Iterable[Relationship], nodes: Iterable[IntroducedNode]
) -> Iterator[Muxed]:
    """Yield muxes; one whose inputs have a new arbiter gets this as its module."""
    new = {node.name for node in nodes if node.kind == "arbitration_node"}
    arbiters = {
        line.controlled: line.controller
        for line in lines
        if isinstance(line, Control) and line.controller in new and line.controlled not in new
    }
    for mux in muxes:
        arbiter = arbiters.get(mux.module)
        yield mux if arbiter is None else replace(mux, module=arbiter, numbers=(), inner=())


def _stand_ins(
    nodes: Iterable[IntroducedNode], printed: Configuration, modules: Mapping[str, Module]
) -> Iterator[StandIn]:
    """Yield the module that each new InheritanceNode represents, and whether it is evident."""
    read = InheritanceNodes(printed, modules)
    for node in nodes:
        if node.stands_for is not None:
            evident = read.stands_alike(node.name, node.stands_for)
            yield StandIn(node.name, node.stands_for, printed.span, evident)


def _states_architecture(configuration: Configuration, nodes: Iterable[IntroducedNode]) -> bool:
    """Whether the specification needs a line with the architecture."""
    if configuration.architecture == "hierarchical" or configuration.period_ms is not None:
        return True
    if configuration.kind == "specification" and configuration.declares_architecture:
        return True
    return any(node.kind == "arbitration_node" for node in nodes)
