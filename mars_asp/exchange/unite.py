"""Merge the configurations of several files of one robot."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from mars_asp.language import Parsed
from mars_asp.model.declarations import Module, Name


def united(parts: Sequence[Parsed]) -> Parsed:
    """Return the configurations of one robot merged; modules of one name are the same module."""
    if len(parts) == 1:
        return parts[0]
    first, *others = (part.configuration for part in parts)
    every = (first, *others)
    ranked = next((each for each in every if each.declares_architecture), first)
    configuration = replace(
        first,
        architecture=ranked.architecture,
        declares_architecture=ranked.declares_architecture,
        modules=_each_once(name for each in every for name in each.modules),
        relationships=tuple(line for each in every for line in each.relationships),
        declared=_merged(module for each in every for module in each.declared),
        muxes=tuple(mux for each in every for mux in each.muxes),
        relays=tuple(relay for each in every for relay in each.relays),
        opaque=_each_once(name for each in every for name in each.opaque),
        missing=tuple(file for each in every for file in each.missing),
    )
    warnings = tuple(warning for part in parts for warning in part.warnings)
    return Parsed(
        configuration,
        warnings,
        trees=tuple(tree for part in parts for tree in part.trees),
    )


def _each_once(names: Iterable[Name]) -> tuple[Name, ...]:
    first: dict[str, Name] = {}
    for name in names:
        first.setdefault(name.text, name)
    return tuple(first.values())


def _merged(modules: Iterable[Module]) -> tuple[Module, ...]:
    """Return modules merged by name, with the services of all."""
    found: dict[str, Module] = {}
    for module in modules:
        known = found.setdefault(module.name, module)
        if known is not module:
            found[module.name] = replace(known, services=known.services + module.services)
    return tuple(found.values())
