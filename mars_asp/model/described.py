"""What modules are described to be."""

from collections.abc import Iterator, Mapping

from mars_asp.model.declarations import Configuration, Module, ends_of

#: The classes of modules, in the order in which they are told.
CLASSES = (
    "sensor",
    "effector",
    "end_effector",
    "data_out_algorithm",
    "control_out_algorithm",
    "data_sink",
    "converter",
)


def described_modules(
    configuration: Configuration, modules: Mapping[str, Module]
) -> dict[str, Module]:
    """Return the modules that rules are told of, by name: those named, and every converter."""
    every = {**modules, **{module.name: module for module in configuration.declared}}
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
    """Yield the classes that a module's annotations make it, in the order of `cli.md`."""
    kinds = {service.kind for service in module.services}
    functions = {function.name for function in module.functions}
    tests = (
        "Sense" in kinds,
        bool(functions - {"Grasp"}),
        "Grasp" in functions,
        "DataOut" in kinds,
        "ControlOut" in kinds,
        "DataIn" in kinds,
        "Converts" in kinds,
    )
    return (name for name, holds in zip(CLASSES, tests, strict=True) if holds)
