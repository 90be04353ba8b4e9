"""The part of a configuration that one question about a module needs.

Rules of the base relate modules through relationships, all but those of kinds `BY_TYPE`, and each
component of a configuration is resolved by itself; so what follows for a module follows from what
it is connected with. Of a large component, most questions need no more than what stands near the
module.
"""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace

from mars_asp.model.declarations import Control, Module, Mount, Relationship, ends_of
from mars_asp.reasoning.project import Project

#: Kinds of consequences that bring together modules which no relationship connects.
BY_TYPE = frozenset({"loose_end"})
#: A component of so many modules is taken whole.
MOST_WHOLE = 200
#: Of a larger one, what so many relationships lead to; mounts do not count, as motions add up.
NEAR = 2
#: Beyond another module that is related to more than so many, only its controllers are looked for.
MOST_BESIDE = 50


def vicinity(project: Project, modules: Set[str], whole: bool) -> tuple[Project, bool]:
    """Return a project with what is connected with modules, `whole` or near them.

    The second value is whether all that is connected with them is in it. Converters stay, as each
    may serve everybody.
    """
    configuration = project.configuration
    beside: dict[str, list[Relationship]] = {}
    for relationship in configuration.relationships:
        for end in ends_of(relationship):
            beside.setdefault(end, []).append(relationship)
    names = _connected(modules, beside, None)
    cut = not whole and len(names) > MOST_WHOLE
    if cut:
        names = _connected(modules, beside, NEAR)
    kept = (r for r in configuration.relationships if names.issuperset(ends_of(r)))
    declared = (each for each in configuration.declared if _is_kept(each, names))
    part = replace(
        configuration,
        modules=tuple(name for name in configuration.modules if name.text in names),
        relationships=tuple(kept),
        declared=tuple(declared),
    )
    kept_modules = {n: each for n, each in project.modules.items() if _is_kept(each, names)}
    return replace(project, configuration=part, modules=kept_modules), not cut


def _connected(
    modules: Set[str], beside: Mapping[str, Sequence[Relationship]], most: int | None
) -> frozenset[str]:
    """Return the modules that at most so many relationships lead to."""
    reached, front, steps = set(modules), set(modules), 0
    while front and (most is None or steps < most):
        crowded = {n for n in front - modules if len(beside.get(n, ())) > MOST_BESIDE}
        hubs = crowded if most is not None else set()
        front = {
            *_next(front - hubs, beside, reached),
            # What a module is commanded reaches those that carry it.
            *_controllers(hubs, beside, reached),
        }
        # Whatever carries a module moves it.
        mounted = set(front)
        while mounted:
            reached |= mounted
            mounted = set(_next(mounted, beside, reached, Mount))
            front |= mounted
        steps += 1
    return frozenset(reached)


def _next(
    front: Set[str],
    beside: Mapping[str, Sequence[Relationship]],
    reached: Set[str],
    kind: type | None = None,
) -> Iterator[str]:
    """Yield the modules that relationships of a kind, or any, lead to from others."""
    for name in front:
        for relationship in beside.get(name, ()):
            if kind is None or isinstance(relationship, kind):
                yield from (end for end in ends_of(relationship) if end not in reached)


def _controllers(
    modules: Set[str], beside: Mapping[str, Sequence[Relationship]], reached: Set[str]
) -> Iterator[str]:
    for name in modules:
        for each in beside.get(name, ()):
            if isinstance(each, Control) and each.controlled == name:
                yield from {each.controller} - reached


def _is_kept(module: Module, names: Set[str]) -> bool:
    return module.name in names or any(each.kind == "Converts" for each in module.services)
