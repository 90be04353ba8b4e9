"""The described modules of a configuration, and their classes."""

from collections.abc import Iterator, Mapping

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import Configuration, Module, ServiceKind, ends_of
from mars_asp.model.remembered import remembered

#: The classes of modules, in the order of their facts.
CLASSES = (
    "sensor",
    "effector",
    "end_effector",
    "data_out_algorithm",
    "control_out_algorithm",
    "data_sink",
    "converter",
)
_OF_SERVICE: Mapping[ServiceKind, str] = {
    "Sense": "sensor",
    "DataOut": "data_out_algorithm",
    "ControlOut": "control_out_algorithm",
    "DataIn": "data_sink",
    "Converts": "converter",
    "Done": "data_out_algorithm",
}


@remembered
def described_modules(
    configuration: Configuration, modules: Mapping[str, Module]
) -> Mapping[str, Module]:
    """Return the described modules that a configuration names, and all converters, by name."""
    every = configuration.with_declared(modules)
    named = {name.text for name in configuration.modules}
    named |= {
        name for relationship in configuration.relationships for name in ends_of(relationship)
    }
    return {
        name: every[name]
        for name in sorted(every)
        if name in named or any(s.kind == "Converts" for s in every[name].services)
    }


def module_classes(module: Module) -> Iterator[str]:
    """Yield the classes of a module, such as `sensor`, that follow from its annotations."""
    return iter(annotated_classes(module))


def annotated_classes(module: Module) -> dict[str, Span]:
    """Return the classes of a module, each with the first annotation that implies it."""
    found: dict[str, Span] = {}
    for service in module.services:
        if service.kind != "Reset":
            found.setdefault(_OF_SERVICE[service.kind], service.span)
    for function in module.functions:
        found.setdefault("end_effector" if function.name == "Grasp" else "effector", function.span)
    return {name: found[name] for name in CLASSES if name in found}
