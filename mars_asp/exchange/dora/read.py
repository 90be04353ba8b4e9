"""A dora dataflow as a configuration: nodes and operators as modules, timers as sensors."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange import ports
from mars_asp.exchange.dora.document import PERIODIC, Dataflow, read_dataflow
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language import Parsed
from mars_asp.model.declarations import (
    Configuration,
    Data,
    MissingFile,
    Module,
    Name,
    Service,
)


def import_dora(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of the dataflows of one robot; a file is a pair of text and path.

    Each input is a line that names both ports; a timer is a sensor by its own name that delivers at
    its rate, and any other virtual input of dora is a source by its own name. Notes list the keys
    that were not read.

    Raises:
        MarsError: all that is wrong with the files.
    """
    dataflows: list[Dataflow] = []
    problems: list[Diagnostic] = []
    for text, path in files:
        try:
            dataflows.append(read_dataflow(text, path))
        except MarsError as error:
            problems += error.diagnostics
    modules: dict[str, Module] = {}
    missing: list[MissingFile] = []
    for (_, path), dataflow in zip(files, dataflows, strict=False):
        missing += _missing(dataflow, Path(path))
        for module in (worker.module for worker in dataflow.workers):
            if module.name in modules:
                message = f"two nodes have the id `{module.name}`"
                labels = ((modules[module.name].span, "the first one"),)
                advice = "give each an id of its own"
                problems.append(Diagnostic("dora", "error", message, module.span, labels, advice))
            modules.setdefault(module.name, module)
    if problems:
        raise MarsError(problems)
    configuration = _configuration(dataflows, files[0][1])
    configuration = replace(configuration, missing=tuple(missing))
    unread: list[Unread] = [each for dataflow in dataflows for each in dataflow.unread]
    return Parsed(configuration, tuple(notes(unread)))


def _missing(dataflow: Dataflow, path: Path) -> Iterator[MissingFile]:
    """Yield the program files of nodes that do not exist relative to the dataflow's folder.

    None is yielded if the dataflow is not a file. If all are missing, it may be a copy: they are
    yielded only if one folder beside it has files with all their names.
    """
    found: list[MissingFile] = []
    there = 0
    for worker in dataflow.workers if path.is_file() else ():
        if worker.program is not None:
            with suppress(OSError):
                if (path.parent / worker.program.path).exists():
                    there += 1
                    continue
            found.append(worker.program)
    if there or (found and _are_in_a_folder(found, path.parent)):
        yield from found


def _are_in_a_folder(missing: Sequence[MissingFile], around: Path) -> bool:
    """Whether some folder in `around` contains a file with each of the names."""
    names = {Path(each.path).name for each in missing}
    with suppress(OSError):
        folders = [each for each in around.iterdir() if each.is_dir()]
        return any(all((folder / name).is_file() for name in names) for folder in folders)
    return False


def _configuration(dataflows: Sequence[Dataflow], path: str) -> Configuration:
    workers = [worker for dataflow in dataflows for worker in dataflow.workers]
    virtual: dict[str, Data] = {}
    for name, line in chain.from_iterable(each.virtual.items() for each in dataflows):
        virtual.setdefault(name, line)
    names = [Name(worker.module.name, worker.module.span) for worker in workers]
    names += [Name(name, line.span) for name, line in virtual.items()]
    return Configuration(
        path,
        whole_file(path),
        architecture="hierarchical",
        declares_architecture=True,
        modules=tuple(names),
        relationships=tuple(line for worker in workers for line in worker.inputs),
        declared=(
            *(worker.module for worker in workers if worker.complete),
            *(_source(name, line) for name, line in virtual.items()),
        ),
    )


def _source(name: str, line: Data) -> Module:
    """Return the module of an input that dora itself feeds: a sensor for a timer with a rate."""
    port = line.source_port or ""
    if line.hz is None:
        service = ports.output(port, None, line.span, None)
    else:
        modes = (PERIODIC,)
        service = Service("Sense", line.span, "tick", modes=modes, hz=line.hz, port=port)
    return Module(name, line.span, (service,), named=line.span)
