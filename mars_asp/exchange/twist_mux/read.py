"""The muxes of a file as a configuration."""

from collections.abc import Sequence
from pathlib import PurePath

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange.locks import lock_line, lock_names
from mars_asp.exchange.twist_mux.document import MuxDocument, read_documents
from mars_asp.exchange.unite import united
from mars_asp.exchange.unread import notes
from mars_asp.exchange.yaml_document import MOST_BYTES
from mars_asp.language import Parsed
from mars_asp.model.declarations import Configuration, Control, Lock, Muxed, Name
from mars_asp.model.names import read_name


def import_muxes(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of the mux files of one robot, each a text and its path.

    Where two of them use one name, all names are prefixed with those of their files.

    Raises:
        MarsError: all errors of the files.
    """
    long = [path for text, path in files if len(text) > MOST_BYTES]
    if long:
        message = f"the file has more than {MOST_BYTES} characters, which no mux needs"
        help_text = "give the file with the parameters of the mux alone"
        raise MarsError(
            Diagnostic("mux", "error", message, whole_file(path), help=help_text) for path in long
        )
    paths = [path for _, path in files]
    documents = read_documents(files)
    parts = _configurations(documents, paths, [""] * len(paths))
    names = [name.text for part in parts for name in part.configuration.modules]
    if len(set(names)) < len(names):
        stems = [PurePath(path).stem for path in paths]
        distinct = stems if len(set(stems)) == len(stems) else paths
        parts = _configurations(documents, paths, [f"{name}/" for name in distinct])
    return united(parts)


def _configurations(
    documents: Sequence[MuxDocument], paths: Sequence[str], prefixes: Sequence[str]
) -> list[Parsed]:
    problems: list[Diagnostic] = []
    parts: list[Parsed] = []
    for document, path, within in zip(documents, paths, prefixes, strict=True):
        try:
            parts.append(_configuration_of(document, path, within))
        except MarsError as error:
            problems += error.diagnostics
    if problems:
        raise MarsError(problems)
    return parts


def _configuration_of(document: MuxDocument, path: str, within: str) -> Parsed:
    """Return the configuration of a mux file, with warnings, and notes of skipped contents.

    The output of a mux becomes a module, and each input a controller of that module, with its
    priority and its timeout as hold. Its locks are those of the module. All names get the prefix
    `within`.
    """
    names: dict[str, Name] = {}
    problems: list[Diagnostic] = []
    lines: list[Control | Lock] = []
    muxed: list[Muxed] = []
    for mux in document.muxes:
        # Several muxes of one file may name their inputs alike.
        before = within + (f"{mux.name}/" if len(document.muxes) > 1 and mux.name else "")
        controlled = before + mux.output
        for name, span in (
            (controlled, mux.span),
            *((before + i.name, i.span) for i in mux.inputs),
        ):
            if name in names:
                message = f"`{name}` is the name of two things"
                labels = ((names[name].span, "the first one"),)
                help_text = "give each input and output a name of its own"
                problems.append(Diagnostic("mux", "error", message, span, labels, help_text))
            names.setdefault(name, Name(name, span))
        name = mux.name if read_name(mux.name) == mux.name else mux.engine
        muxed.append(Muxed(controlled, mux.engine, mux.span, name=within + name, topic=mux.output))
        lines += (
            Control(controlled, before + i.name, i.span, i.priority, i.hold_ms, topic=i.topic)
            for i in mux.inputs
        )
        locks = lock_names(mux, before, names)
        lines += (lock_line(controlled, locks[each], each) for each in mux.locks)
        names |= {locks[each]: Name(locks[each], each.span) for each in mux.locks}
    if problems:
        raise MarsError(problems)
    configuration = Configuration(
        path,
        whole_file(path),
        architecture="hierarchical",
        declares_architecture=True,
        modules=tuple(names.values()),
        relationships=tuple(lines),
        muxes=tuple(muxed),
    )
    return Parsed(configuration, (*document.warnings, *notes(document.unread)))
