"""Configurations merged with the ones that they include, whose names get the prefix of the include.

A leading `/` stays in front: `/base`, included as `left`, becomes `/left/base`. Locations remain
those in the included file.
"""

import os
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.language import Parsed, parse_text
from mars_asp.language.parse import MOST_ERRORS, read_text
from mars_asp.language.print import print_module
from mars_asp.model.declarations import (
    Configuration,
    Include,
    Module,
    Name,
    ends_of,
    with_ends,
)
from mars_asp.reading import SHOWN_INPUT, WallError, check_walls

#: Limit of the depth of nested includes.
MOST_DEEP = 100
#: Limit of the number of includes, nested ones counted.
MOST_INCLUDES = 1000


def with_includes(parsed: Parsed, texts: Mapping[str, str] = MappingProxyType({})) -> Parsed:
    """Return a configuration merged with its includes, which are read from their files.

    `texts` replaces the contents of files, by path.

    Raises:
        MarsError: all errors of included files, includes that are missing or go in a circle, and
            contradictory architectures.
    """
    if not parsed.configuration.includes:
        return parsed
    real = _real(parsed.configuration.path)
    reading = _Reading(
        iter(range(MOST_INCLUDES)),
        {real: parsed.configuration.path},
        parsed.configuration.path,
        dict(texts),
    )
    return _expanded(parsed, (real,), reading)._replace(included=reading.texts)


class _TooManyError(MarsError):
    """An include beyond a limit; it ends the reading, so that the limit is reported once."""


class _Reading(NamedTuple):
    """The state of reading includes: how many are `left`, and the files that were read.

    `shown` has the first name of each file. `top` is the user's file, which fixes the folders that
    may be read; `texts` are the contents of files by their shown names.
    """

    left: Iterator[int]
    shown: dict[str, str]
    top: str
    texts: dict[str, str]


def _expanded(parsed: Parsed, chain: tuple[str, ...], reading: _Reading) -> Parsed:
    """Return a configuration merged with its includes; `chain` are the files from the top to it."""
    own = parsed.configuration
    problems: list[Diagnostic] = []
    found: list[Parsed] = []
    for include in own.includes:
        try:
            found.append(_taken_in(include, own, chain, reading))
        except _TooManyError as error:
            raise _TooManyError(dict.fromkeys((*problems, *error.diagnostics))) from None
        except MarsError as error:
            problems += error.diagnostics
            if len(problems) >= MOST_ERRORS:
                break
    if problems:
        # The errors of a file that is included twice are reported once.
        raise MarsError(dict.fromkeys(problems))
    inner = [each.configuration for each in found]
    modules = {name.text: name for each in (*inner, own) for name in each.modules}
    blocks = _blocks((*found, parsed))
    configuration = replace(
        own,
        includes=(),
        sources=tuple(name for each in (*inner, own) for name in each.sources),
        modules=tuple(modules.values()),
        # Two files can include the same file, whose relationships count once.
        relationships=tuple(
            dict.fromkeys(line for each in (*inner, own) for line in each.relationships)
        ),
        declared=tuple(blocks.values()),
        attributed=tuple(dict.fromkeys(line for each in (*inner, own) for line in each.attributed)),
        opaque=tuple(dict.fromkeys(name for each in (*inner, own) for name in each.opaque)),
        muxes=tuple(dict.fromkeys(mux for each in (*inner, own) for mux in each.muxes)),
    )
    warnings = tuple(dict.fromkeys(warning for each in found for warning in each.warnings))
    return Parsed(configuration, (*warnings, *parsed.warnings), tuple(blocks))


def _blocks(found: Iterable[Parsed]) -> dict[str, Module]:
    """Return the modules that files describe in `@module` blocks, by the text of the block.

    Raises:
        MarsError: two blocks describe one module differently.
    """
    first: dict[str, tuple[str, Module]] = {}
    problems: list[Diagnostic] = []
    for each in found:
        for block, module in zip(each.blocks, each.configuration.declared, strict=True):
            _, other = first.setdefault(module.name, (block, module))
            if print_module(module) != print_module(other):
                problems.append(described_twice(module, other))
    if problems:
        raise MarsError(dict.fromkeys(problems))
    return dict(first.values())


def described_twice(module: Module, other: Module) -> Diagnostic:
    """Return the error that one module has two descriptions."""
    return Diagnostic(
        "module-twice",
        "error",
        f"module `{module.name}` is described twice",
        module.span,
        ((other.span, "also here"),),
        "keep one of the two descriptions",
    )


def _taken_in(
    include: Include, own: Configuration, chain: tuple[str, ...], reading: _Reading
) -> Parsed:
    """Return the configuration of one include, each name prefixed with the name of the include.

    `own` is the including configuration, `chain` the files from the top to it.
    """
    if next(reading.left, None) is None:
        message = f"more than {MOST_INCLUDES} includes"
        raise _too_many(include.span, message, "include fewer, or write their modules here")
    path = Path(include.span.path).parent / include.path
    real = _real(str(path))
    if real in chain:
        circle = " -> ".join(os.path.relpath(each) for each in (*chain[chain.index(real) :], real))
        raise _include_error(
            include.span, f"the includes go in a circle: {circle}", "drop one of them"
        )
    if len(chain) > MOST_DEEP:
        message = f"more than {MOST_DEEP} includes within includes"
        raise _too_many(include.span, message, "drop some")
    try:
        check_walls(path, reading.top)
    except WallError as error:
        raise _include_error(
            include.span, f"`{include.path}`: {error.strerror}", error.advice
        ) from None
    if not path.is_file():
        help_text = paths_advice("include", include.span, "the file that includes")
        raise _include_error(include.span, f"`{include.path}` is not a file", help_text)
        # A file keeps its first path, so that its lines count once.
    shown = reading.shown.setdefault(real, _without_dots(path))
    if shown not in reading.texts:
        reading.texts[shown] = read_text(path)
    parsed = parse_text(reading.texts[shown], shown)
    inner = parsed.configuration
    if inner.kind != "configuration":
        message = f"`{include.path}` is a specification, and only configurations are included"
        raise _include_error(include.span, message, "include the configuration that it realises")
    if inner.declares_architecture and inner.architecture != own.architecture:
        message = f"`{include.path}` is {inner.architecture}, but is included as {own.architecture}"
        help_text = "one robot has one architecture: state the same, or none in what is included"
        labels = ((inner.span, f"{inner.architecture} is stated here"),)
        raise MarsError((Diagnostic("include", "error", message, include.span, labels, help_text),))
    # A file without an architecture takes that of the including file.
    inner = replace(inner, architecture=own.architecture)
    expanded = _expanded(parsed._replace(configuration=inner), (*chain, real), reading)
    if include.name is None:
        return expanded
    return _with_prefix(include.name, expanded)


def paths_advice(keyword: str, span: Span, file: str) -> str:
    """Return the sentence on the folder of paths; `file` describes the file with the keyword."""
    if span.path == SHOWN_INPUT:
        return f"from standard input, paths of `@{keyword}` are relative to the current folder"
    return f"paths of `@{keyword}` are relative to {file}"


def _with_prefix(prefix: str, parsed: Parsed) -> Parsed:
    """Return a configuration with `prefix` before each name."""
    inner = parsed.configuration
    in_blocks = {module.name for module in inner.declared}
    names = tuple(
        Name(
            _prefixed(prefix, name.text), name.span, _prefixed_description(prefix, name, in_blocks)
        )
        for name in inner.modules
    )
    declared = tuple(
        replace(module, name=_prefixed(prefix, module.name)) for module in inner.declared
    )
    lines = tuple(
        with_ends(line, *(_prefixed(prefix, name) for name in ends_of(line)))
        for line in inner.relationships
    )
    attributed = tuple(
        replace(line, module=name)
        for line in inner.attributed
        for name in _attributed_names(prefix, line.module, names, inner)
    )
    configuration = replace(
        inner,
        modules=names,
        relationships=lines,
        declared=declared,
        attributed=attributed,
        opaque=tuple(replace(each, text=_prefixed(prefix, each.text)) for each in inner.opaque),
        muxes=tuple(replace(each, module=_prefixed(prefix, each.module)) for each in inner.muxes),
    )
    return Parsed(configuration, parsed.warnings, tuple(map(print_module, declared)))


def _attributed_names(
    prefix: str, module: str, names: Iterable[Name], inner: Configuration
) -> Iterator[str]:
    """Yield the modules to which an attribute line of an included file applies, with their prefix.

    `module` is the name on the line and `names` are the prefixed modules of `inner`. If `module`
    only describes other modules, these are yielded instead.
    """
    is_its_own = any(name.text == module for name in inner.modules)
    instances = [
        name.text
        for name, original in zip(names, inner.modules, strict=True)
        if original.described == module and name.described == module
    ]
    yield from [_prefixed(prefix, module)] if is_its_own or not instances else instances


def _prefixed_description(prefix: str, name: Name, in_blocks: Iterable[str]) -> str | None:
    """Return the module that describes an included one, or None if its own block does.

    The name has the prefix if a block of the included file is the description, else not.
    """
    describing = name.described or name.text
    if describing in in_blocks:
        return None if name.described is None else _prefixed(prefix, describing)
    return describing


def _prefixed(prefix: str, name: str) -> str:
    return f"/{prefix}{name}" if name.startswith("/") else f"{prefix}/{name}"


def prefix_of(name: str, inner: str) -> str:
    """Return the include's prefix of the full name `name`, `inner` in its file; "" if none."""
    return name.removesuffix(inner).removesuffix("/").removeprefix("/" if inner[0] == "/" else "")


def name_within(prefix: str, name: str) -> str | None:
    """Return the name of a module in a file included as `prefix`, or None if it is outside.

    >>> name_within("left", "left/Camera"), name_within("left", "Camera")
    ('Camera', None)
    """
    if not prefix:
        return name
    candidates = (name.removeprefix(cut) for cut in (f"/{prefix}", f"{prefix}/"))
    return next((each for each in candidates if each and _prefixed(prefix, each) == name), None)


def instances(configuration: Configuration, described: Mapping[str, Module]) -> Iterator[Module]:
    """Yield the description of each module that shares another one's, under its own name.

    `@modules` states the sharing (`Left: Wheel`); a missing description is left out.
    """
    for name in configuration.modules:
        if name.described is not None and name.text not in described:
            module = described.get(name.described)
            if module is not None:
                yield replace(module, name=name.text)


def without_idle(configuration: Configuration, described: Iterable[str]) -> Configuration:
    """Return a configuration in which included modules refer to no missing description."""
    known = frozenset(described)

    def with_known_description(name: Name) -> Name:
        idle = name.described is not None and name.described not in known
        own = idle and name.text.endswith(f"/{name.described}".replace("//", "/"))
        return replace(name, described=None) if own else name

    return replace(configuration, modules=tuple(map(with_known_description, configuration.modules)))


def undescribed(configuration: Configuration, described: Iterable[str]) -> Iterator[Name]:
    """Yield the names whose describing module has no description."""
    known = frozenset(described)
    for name in configuration.modules:
        if name.described is not None and name.described not in known:
            yield name


def module_named(name: str, beside: str, known: Container[str]) -> str | None:
    """Return the module that `name` means in a statement about `beside`, or None if unknown.

    The name is tried with the prefix of `beside` first, then with ever shorter prefixes.
    """
    inner = beside.strip("/").split("/")[:-1]
    prefixes = ("/".join(inner[:length]) for length in range(len(inner), 0, -1))
    candidates = (*(_prefixed(prefix, name) for prefix in prefixes), name)
    return next((each for each in candidates if each in known), None)


def _real(path: str) -> str:
    return os.path.realpath(path)


def _without_dots(path: Path) -> str:
    """Return a path without `..`, or unchanged if it would then name another file."""
    plain = os.path.normpath(path)
    return plain if _real(plain) == _real(str(path)) else str(path)


def _include_error(span: Span, message: str, help_text: str | None) -> MarsError:
    return MarsError((Diagnostic("include", "error", message, span, help=help_text),))


def _too_many(span: Span, message: str, help_text: str) -> MarsError:
    return _TooManyError(_include_error(span, message, help_text).diagnostics)
