"""The part of a configuration that a question about modules needs.

Rules of the base relate modules through relationships, except for kinds `BY_TYPE`, and each
component of a configuration is resolved independently. So the answer for a module depends on its
connected component alone.
"""

from collections.abc import Set
from dataclasses import replace

from mars_asp.asp.solve.disjoint_sets import DisjointSets
from mars_asp.model.declarations import Module, ends_of
from mars_asp.reasoning.project import Project

#: Kinds of consequences that relate modules without a relationship between them.
BY_TYPE = frozenset({"loose_end"})


def connected_part(project: Project, modules: Set[str]) -> Project:
    """Return the project without modules that no path of relationships connects with `modules`.

    Each converter stays, as it may serve any module.
    """
    configuration = project.configuration
    components: DisjointSets[str] = DisjointSets()
    for relationship in configuration.relationships:
        components.join(tuple(ends_of(relationship)))
    roots = set(map(components.find, modules))
    names = {name for name in (*modules, *components.parent) if components.find(name) in roots}

    def is_kept(module: Module) -> bool:
        return module.name in names or any(each.kind == "Converts" for each in module.services)

    part = replace(
        configuration,
        modules=tuple(name for name in configuration.modules if name.text in names),
        relationships=tuple(
            each for each in configuration.relationships if names.issuperset(ends_of(each))
        ),
        declared=tuple(filter(is_kept, configuration.declared)),
    )
    kept = {name: each for name, each in project.modules.items() if is_kept(each)}
    return replace(project, configuration=part, modules=kept)
