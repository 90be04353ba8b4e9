"""The representations of a service, from a declaration and its overrides."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mars_asp.annotations.declarations import DeclaredParameter, SourceDeclaration
from mars_asp.annotations.overrides import Overrides
from mars_asp.annotations.type_words import ARITHMETIC, BUILTIN, NOT_INPUTS
from mars_asp.annotations.types import CALLBACK, representation

_STATUS = re.compile(
    r"(?:.*::)?(?:Status|StatusCode|ErrorCode|error_code|Result|ReturnCode|esp_err_t)"
)
#: Types that are unclear as representations; a lock is a `bool`.
_UNCLEAR = BUILTIN - {"bool"}
#: The name of the context of a behaviour in Python, which needs no type.
_CONTEXT = "ctx"


@dataclass(frozen=True, slots=True)
class ServiceSignature:
    """The representations of a function's output and inputs.

    `parameters` are the names of the inputs, None for unnamed ones; `remarks` have code, message
    and help.
    """

    output: str | None
    inputs: tuple[str | None, ...]
    parameters: tuple[str | None, ...]
    remarks: tuple[tuple[str, str, str], ...]


def read_signature(
    declaration: SourceDeclaration, overrides: Overrides, delivers: bool
) -> ServiceSignature:
    """Return a function's representations; `delivers` is whether it must have an output."""
    parameters = list(declaration.parameters)
    remarks: list[tuple[str, str, str]] = []
    output: str | None
    if overrides.output is not None:
        output, parameters = _overridden(overrides.output, parameters)
    else:
        output = None if declaration.output is None else representation(declaration.output)
        beside = output is not None and (output in ARITHMETIC or _STATUS.fullmatch(output))
        if output in ("", CALLBACK) or (beside and any(p.out for p in parameters)):
            if delivers:
                remarks.append(_no_output(declaration, parameters))
            output = None
        elif output is None and delivers:
            remarks.append(
                (
                    "MARS205",
                    f"the output of `{declaration.name}` is unknown",
                    "state its output: `@Output TYPE`",
                )
            )
    found = tuple(_named_inputs(parameters, overrides))
    inputs = tuple(representation for _, representation in found)
    names = tuple(name for name, _ in found)
    builtin = [name for name in inputs if name in _UNCLEAR]
    if delivers and overrides.output is None and output in _UNCLEAR:
        builtin.insert(0, output)
    if builtin:
        remarks.append(_builtin(list(dict.fromkeys(builtin))))
    return ServiceSignature(output or None, inputs, names, tuple(remarks))


def _overridden(
    written: str, parameters: Sequence[DeclaredParameter]
) -> tuple[str | None, list[DeclaredParameter]]:
    """Return the representation that `@Output` states, and the remaining parameters."""
    rest = [parameter for parameter in parameters if parameter.name != written]
    if len(rest) < len(parameters):
        named = next(parameter for parameter in parameters if parameter.name == written)
        return (None if named.type is None else representation(named.type)), rest
    return (None if written == "none" else representation(written)), list(parameters)


def _no_output(
    declaration: SourceDeclaration, parameters: Sequence[DeclaredParameter]
) -> tuple[str, str, str]:
    line = next((p.name for p in parameters if p.out and p.name), "TYPE")
    return (
        "MARS206",
        f"`{declaration.name}` returns `{declaration.output}`, which cannot be an output",
        f"state its output: `@Output {line}`",
    )


def _builtin(names: Sequence[str | None]) -> tuple[str, str, str]:
    listed = ", ".join(f"`{name}`" for name in names)
    return (
        "MARS207",
        f"built-in types are used as representations: {listed}",
        "a named type is clearer",
    )


def _named_inputs(
    parameters: Sequence[DeclaredParameter], overrides: Overrides
) -> Iterator[tuple[str | None, str | None]]:
    """Yield name and representation, if known, of each input; contexts and times are skipped."""
    if overrides.inputs is not None:
        declared = [written for written in overrides.inputs if written != "none"]
        # With as many stated types as parameters, the types belong to the parameters.
        own = [parameter.name for parameter in parameters]
        names = own if len(own) == len(declared) else [None] * len(declared)
        for name, written in zip(names, declared, strict=True):
            yield name, representation(written) or None
        return
    for parameter in parameters:
        written = overrides.named.get(parameter.name or "", parameter.type or "")
        if written == "none" or (not written and parameter.name == _CONTEXT):
            continue
        if not written:
            yield parameter.name, None
            continue
        name = representation(written)
        if name is None:
            yield parameter.name, None
        elif name and name.partition("<")[0].rsplit("::", 1)[-1] not in NOT_INPUTS:
            yield parameter.name, name
    for called, written in overrides.further.items():
        if written != "none":
            yield called, representation(written) or None
