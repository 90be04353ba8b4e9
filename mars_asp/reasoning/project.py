"""A configuration together with the sources that describe its modules."""

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.asp.signature import plain
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.diagnostic import Diagnostic, MarsError, Span, by_place, whole_file
from mars_asp.language import Parsed, parse_text
from mars_asp.language.parse import plain_lines, read_text
from mars_asp.model.declarations import (
    Configuration,
    Module,
    Mount,
    Name,
    PackKind,
    PackNode,
    ends_of,
)
from mars_asp.model.described import described_modules
from mars_asp.model.graph import LaunchTree
from mars_asp.model.names import end
from mars_asp.model.ports import inputs, outputs
from mars_asp.output import brief_repr, encodable
from mars_asp.reasoning.facts.compile import FRAMES, configuration_facts
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.facts.rates import Rates, rates_in
from mars_asp.reasoning.includes import (
    described_twice,
    instances,
    paths_advice,
    undescribed,
    with_includes,
    without_idle,
)
from mars_asp.spelling import resemblances, suggestion

if TYPE_CHECKING:
    from mars_asp.annotations.files import Entries, Extraction

_HERE = Path()


@dataclass(frozen=True, slots=True, repr=False)
class Project:
    """A configuration, the modules described for it, and the diagnostics of their files.

    `text` is the text of the configuration, `found` the content of the sources; `blocks` are the
    texts of the configuration's own module blocks. `brought` are the kinds of nodes and the
    attributes that rule packs declare, `None` until it is known; `attributes` are the facts of
    attributes that packs declare. `included` are the texts of included files by path, `trees` the
    launch trees.

    >>> project = load_project("examples/level0/config.mars")
    >>> len(project.configuration.modules)
    8
    """

    __repr__ = brief_repr

    configuration: Configuration
    modules: Mapping[str, Module]
    diagnostics: tuple[Diagnostic, ...]
    text: str = ""
    found: "Extraction | None" = None
    blocks: tuple[str, ...] = ()
    brought: tuple[object, ...] | None = None
    attributes: tuple[Fact, ...] = ()
    included: Mapping[str, str] = field(default_factory=dict)
    trees: tuple[LaunchTree, ...] = ()

    @property
    def described(self) -> Mapping[str, Module]:
        """Return the modules described in sources or blocks, by name."""
        return described_modules(self.configuration, self.modules)

    @property
    def rates(self) -> Rates:
        """Return the numbers that represent the rates of the configuration in facts."""
        return rates_in(self.configuration, self.described)

    @property
    def format(self) -> str | None:
        """Return the format of the file, or None for a `.mars` file."""
        return self.configuration.format


def load_project(
    path: str | os.PathLike[str],
    sources: Sequence[str | os.PathLike[str]] = (),
    text: str | None = None,
) -> Project:
    """Read a `.mars` file and the annotated sources that it and `sources` name.

    `text` replaces the file's content, as it does for standard input. Paths of `@sources` are
    relative to the file.

    Raises:
        MarsError: syntax errors of the file, and sources that are missing or wrongly annotated.

    >>> load_project("examples/level0/config.mars").configuration.architecture
    'hierarchical'
    """
    text = read_text(Path(path)) if text is None else plain_lines(text)
    return described(parse_text(text, os.fspath(path)), text, [os.fspath(s) for s in sources])


def described(
    parsed: Parsed,
    text: str,
    sources: Sequence[str] = (),
    format: str | None = None,
    optional: bool = False,
) -> Project:
    """Return a configuration with the modules of the sources that it and `sources` name.

    `text` is the text of the configuration, in a foreign `format` unless None. If `optional`,
    missing sources are warnings.

    Raises:
        MarsError: sources that are missing or wrongly annotated.
    """
    parsed = with_includes(parsed)
    configuration = replace(parsed.configuration, format=format)
    parsed = parsed._replace(configuration=configuration)
    problems: list[Diagnostic] = []
    paths: list[Path] = []
    named_at: dict[Path, Span] = {}
    entries = None
    if configuration.sources:
        from mars_asp.annotations.files import Entries  # noqa: PLC0415 -- as below

        entries = Entries(configuration.path)
    for name in configuration.sources:
        folder = Path(name.span.path).parent
        advice = paths_advice("sources", name.span, "the configuration's own file")
        missing = _missing(name.text, name.span, advice)
        matches = _source_paths(name.text, missing, problems, folder, entries)
        named_at |= dict.fromkeys(matches, name.span)
        paths += matches
    for argument in sources:
        advice = "paths of `--sources` are relative to the current folder"
        place = whole_file(argument)
        given = _source_paths(argument, _missing(argument, place, advice), problems)
        named_at = {path: place for path, place in named_at.items() if path not in given}
        paths += given
    if optional:
        problems = [replace(each, severity="warning") for each in problems]
        parsed = parsed._replace(warnings=(*parsed.warnings, *problems))
    elif problems:
        raise MarsError(problems)
    found = None
    if paths:
        from mars_asp.annotations.files import extract  # noqa: PLC0415 -- only where there are sources

        found = extract(paths, named_at, configuration.path)
    return _project_of(parsed, text, found)


def revised(project: Project, texts: Mapping[str, str]) -> Project:
    r"""Return a project with other texts of some of its files.

    `texts` are by path, with `\n` for every line end; other files are not read again.

    Raises:
        MarsError: errors in the new texts.
    """
    path = project.configuration.path
    text = texts.get(path, project.text)
    parsed = with_includes(parse_text(text, path), {**project.included, **texts})
    changed = texts.keys() - {path} - project.included.keys()
    found = project.found
    if found is not None and changed:
        from mars_asp.annotations.files import reread  # noqa: PLC0415 -- as above

        for source in sorted(changed):
            found = reread(found, source, texts[source])
    return with_brought(_project_of(parsed, text, found), project.brought or ())


def with_brought(project: Project, brought: tuple[object, ...]) -> Project:
    """Return a project with the kinds of nodes and the attributes that rule packs declare.

    `brought` contains values of `PackKind` and `AttributeKind`.

    Raises:
        MarsError: attributes that no pack declares, values of the wrong sort, and nodes of missing
            packs.
    """
    kinds = tuple(each for each in brought if isinstance(each, PackKind))
    configuration = with_kinds(project.configuration, kinds)
    found: tuple[Fact, ...] = ()
    if has_attributes(project):
        from mars_asp.reasoning.attributes import AttributeKind, attribute_facts  # noqa: PLC0415

        declared = [each for each in brought if isinstance(each, AttributeKind)]
        found = attribute_facts(configuration, project.modules, declared)
    return replace(project, configuration=configuration, brought=brought, attributes=found)


def with_kinds(configuration: Configuration, kinds: tuple[PackKind, ...]) -> Configuration:
    """Return a configuration with the kinds of nodes that rule packs provide.

    Raises:
        MarsError: comments name nodes that none of these packs provide.
    """
    if kinds != configuration.kinds:
        configuration = replace(configuration, kinds=kinds)
    named = {name.text for name in configuration.modules}
    strangers = [
        each
        for each in configuration.pack_nodes
        if each.node in named
        and ((kind := configuration.pack_kind(each.node)) is None or kind.pack != each.pack)
    ]
    if strangers:
        given = {kind.pack for kind in kinds}
        raise MarsError(_not_brought(each, each.pack in given) for each in strangers)
    return configuration


def _not_brought(node: PackNode, is_given: bool) -> Diagnostic:
    """Return the error that a node's pack is missing or, if it `is_given`, lacks the kind."""
    if is_given:
        message = f"the pack `{node.pack}` has no nodes named as `{node.node}` is"
        advice = f"give the version of `{node.pack}` that this specification was made with"
    else:
        message = f"`{node.node}` is a node of the pack `{node.pack}`, which is not given"
        advice = "give the folder of the pack with `--rules`"
    return Diagnostic("pack", "error", message, node.span, help=advice)


def has_attributes(project: Project) -> bool:
    """Whether any module has an attribute; only then are the declarations of packs needed."""
    described = (*project.modules.values(), *project.configuration.declared)
    return bool(project.configuration.attributed) or any(each.attributes for each in described)


def _project_of(parsed: Parsed, text: str, found: "Extraction | None") -> Project:
    """Return a project of a parsed configuration and its sources, with warnings about names.

    `text` is the text of the configuration, `found` the content of its sources, None without any.

    Raises:
        MarsError: errors in the annotations.
    """
    configuration = parsed.configuration
    modules: dict[str, Module] = {}
    diagnostics = parsed.warnings
    if found is not None:
        diagnostics += found.diagnostics
        modules = {module.name: module for module in found.modules}
    clashes = [
        described_twice(module, modules[module.name])
        for module in configuration.declared
        if module.name in modules
    ]
    described = configuration.with_declared(modules)
    configuration = without_idle(configuration, described)
    if found is not None:
        diagnostics += tuple(_misspelt(configuration, modules))
    diagnostics += tuple(
        _has_its_own(name)
        for name in configuration.modules
        if name.text in described and name.described not in (None, name.text)
    )
    modules |= {module.name: module for module in instances(configuration, described)}
    diagnostics += tuple(
        _not_described(name, described) for name in undescribed(configuration, described)
    )
    errors = [d for d in diagnostics if d.severity == "error"] + clashes
    if errors:
        raise MarsError([*errors, *(d for d in diagnostics if d.severity != "error")])
    return Project(
        configuration,
        modules,
        by_place(diagnostics),
        text,
        found,
        parsed.blocks,
        included=parsed.included,
        trees=parsed.trees,
    )


def project_facts(
    project: Project, queried: Iterable[tuple[str, str]] = (), wanted: Set[str] | None = None
) -> tuple[Fact, ...]:
    """Return the facts of a project, restricted to the predicates in `wanted`.

    Facts about motions by carriers are made for sensors, end-effectors, controlled modules, and
    the pairs of function and module in `queried`.
    """
    facts = configuration_facts(project.configuration, project.modules, wanted)
    facts += tuple(f for f in _attributes(project) if wanted is None or f.atom.name in wanted)
    if wanted is not None and not wanted & FRAMES:
        return facts
    described = (*project.modules.values(), *project.configuration.declared)
    # Without native functions nothing is inherited.
    if not has_mounts(project) or not any(module.functions for module in described):
        return facts
    from mars_asp.reasoning.facts.motion import frame_facts  # noqa: PLC0415 -- numpy

    frames = frame_facts(project.configuration, project.modules, queried)
    return facts + tuple(f for f in frames if wanted is None or f.atom.name in wanted)


def port_names(project: Project, module: str | None = None) -> Mapping[str, tuple[str, str]]:
    """Return the module and port for each name of a port in facts; only of `module` unless None."""
    described = project.described
    ends = ends_in(project.configuration, described)
    named = {
        end(name, port): (name, port)
        for name, each in described.items()
        if module in (None, name)
        for port in (*outputs(each), *inputs(each))
    }
    entries = [(text, each.module, each.port) for text, each in ends.outputs.items()]
    entries += [(text, each.module, each.port) for text, each in ends.entries.items()]
    return named | {text: (name, port) for text, name, port in entries if module in (None, name)}


def identified(attribute: Fact) -> Atom:
    """Return the term that identifies an attribute in facts, with the name that its pack uses."""
    return attribute.atom._replace(name=plain(attribute.atom.name))


def _attributes(project: Project) -> Iterator[Fact]:
    """Yield the attributes of modules that the configuration names, each with its place.

    Raises:
        MarsError: attributes are stated, and no rule packs are known.
    """
    if project.brought is None:
        project = with_brought(project, ())
    if not project.attributes:
        return
    configuration = project.configuration
    entries = {name.text for name in configuration.modules}
    entries |= {name for each in configuration.relationships for name in ends_of(each)}
    entries |= project.described.keys()
    for fact in project.attributes:
        if fact.atom.arguments[0] in entries:
            path, line, column = fact.span[:3]
            yield fact
            yield Fact(Atom("place", (identified(fact), encodable(path), line, column)), fact.span)


def has_mounts(project: Project) -> bool:
    """Whether a project has mounts; only then is numpy loaded."""
    return any(isinstance(r, Mount) for r in project.configuration.relationships)


def _source_paths(
    written: str,
    missing: Diagnostic,
    problems: list[Diagnostic],
    folder: Path = _HERE,
    entries: "Entries | None" = None,
) -> list[Path]:
    """Return the paths that a path or glob matches; if none, add `missing` to `problems`."""
    from mars_asp.annotations.files import find_paths  # noqa: PLC0415 -- only where there are sources

    try:
        matches = find_paths(written, folder, entries)
    except MarsError as error:
        problems += (replace(each, span=missing.span, excerpt=None) for each in error.diagnostics)
        return []
    if not matches:
        problems.append(missing)
    return matches


def _missing(written: str, place: Span, advice: str) -> Diagnostic:
    message = f"`{written}`: no such file or folder"
    return Diagnostic("sources-missing", "error", message, place, help=advice)


def _misspelt(configuration: Configuration, modules: Mapping[str, Module]) -> Iterator[Diagnostic]:
    """Yield warnings for unannotated modules named almost like an annotated, unused one."""
    # A module that another one describes is not misspelt, and uses the other one's name.
    spans = {name.text: name.span for name in configuration.modules if name.described is None}
    used = {name.described or name.text for name in configuration.modules}
    described = modules.keys() | {module.name for module in configuration.declared}
    unknown = (name for name in spans if name not in described)
    for name, near in resemblances(unknown, modules.keys() - used, 0.8):
        # `Camera1` and `Camera2` are two modules.
        if _undigited(near) == _undigited(name):
            continue
        place = modules[near].named or modules[near].span
        yield Diagnostic(
            "annotations-missing",
            "warning",
            f"`{name}` is not annotated in any source",
            spans[name],
            ((place, f"`{near}` is annotated here"),),
            f"did you mean `{near}`?",
        )


def _has_its_own(name: Name) -> Diagnostic:
    """Return the warning that a description is ignored, as the module has one of its own."""
    return Diagnostic(
        "module-twice",
        "warning",
        f"`{name.text}` has a description of its own, so `{name.described}` does not describe it",
        name.span,
        help=f"remove one of the two: the description, or `: {name.described}`",
    )


def _not_described(name: Name, described: Mapping[str, Module]) -> Diagnostic:
    """Return the warning that the module named as the description of another has none."""
    return Diagnostic(
        "annotations-missing",
        "warning",
        f"`{name.described}`, which is to describe `{name.text}`, is not described itself",
        name.span,
        help=suggestion(name.described or "", described, "annotate it, or declare it in a block"),
    )


def _undigited(name: str) -> str:
    return re.sub("[0-9]", "", name)
