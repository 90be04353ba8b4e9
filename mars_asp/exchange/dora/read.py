"""A dora dataflow as a configuration: nodes and operators as modules, timers as sensors."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.exchange import ports
from mars_asp.exchange.dora.document import Dataflow, Wire, Worker, read_dataflow
from mars_asp.exchange.unread import Unread, notes
from mars_asp.language import Parsed
from mars_asp.language.print import print_module
from mars_asp.model.declarations import (
    Configuration,
    Data,
    MissingFile,
    Mode,
    Module,
    Name,
    Service,
)

_PERIODIC = Mode("NotifyAtFrequency", text="NotifyAtFrequency")


def import_dora(files: Sequence[tuple[str, str]]) -> Parsed:
    """Return the configuration of the dataflows of one robot, each a text and its path.

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
    workers: dict[str, Worker] = {}
    missing: list[MissingFile] = []
    for (_, path), dataflow in zip(files, dataflows, strict=False):
        missing += _missing(dataflow, Path(path))
    for worker in (worker for dataflow in dataflows for worker in dataflow.workers):
        if worker.name in workers:
            problems.append(_named_twice(worker, workers[worker.name]))
        workers.setdefault(worker.name, worker)
    if problems:
        raise MarsError(problems)
    configuration = _configuration(tuple(workers.values()), files[0][1])
    configuration = replace(configuration, missing=tuple(missing))
    unread: list[Unread] = [each for dataflow in dataflows for each in dataflow.unread]
    return Parsed(
        configuration, tuple(notes(unread)), tuple(map(print_module, configuration.declared))
    )


def _missing(dataflow: Dataflow, path: Path) -> Iterator[MissingFile]:
    """Yield the programs of nodes that do not exist beside the dataflow.

    A dataflow that is not a file, or of which no program exists, is away from its sources, unless
    all of them are in one folder beside it.
    """
    found: list[MissingFile] = []
    there = 0
    for worker in dataflow.workers if path.is_file() else ():
        if worker.program is not None:
            with suppress(OSError):
                if (path.parent / worker.program.path).exists():
                    there += 1
                    continue
            found.append(MissingFile(worker.name, *worker.program))
    if there or (found and _are_in_a_folder(found, path.parent)):
        yield from found


def _are_in_a_folder(missing: Sequence[MissingFile], around: Path) -> bool:
    """Whether a folder has a file of each name."""
    names = {Path(each.path).name for each in missing}
    with suppress(OSError):
        folders = [each for each in around.iterdir() if each.is_dir()]
        return any(all((folder / name).is_file() for name in names) for folder in folders)
    return False


def _named_twice(worker: Worker, first: Worker) -> Diagnostic:
    message = f"two nodes have the id `{worker.name}`"
    labels = ((first.span, "the first one"),)
    return Diagnostic("dora", "error", message, worker.span, labels, "give each an id of its own")


def _configuration(workers: Sequence[Worker], path: str) -> Configuration:
    virtual: dict[str, Wire] = {}
    for wire in (wire for worker in workers for wire in worker.wires):
        if wire.is_virtual:
            virtual.setdefault(wire.source, wire)
    names = [Name(worker.name, worker.span) for worker in workers]
    names += [Name(name, wire.span) for name, wire in virtual.items()]
    return Configuration(
        path,
        whole_file(path),
        architecture="hierarchical",
        declares_architecture=True,
        modules=tuple(names),
        relationships=tuple(_wire_relationship(w.name, wire) for w in workers for wire in w.wires),
        declared=(
            *(_worker_module(worker) for worker in workers if worker.complete),
            *(_source(name, wire) for name, wire in virtual.items()),
        ),
    )


def _wire_relationship(client: str, wire: Wire) -> Data:
    """Return the relationship of a wire."""
    mode = None if wire.rate is None else _PERIODIC
    return Data(client, wire.source, wire.span, mode, wire.rate, wire.input, wire.output)


def _worker_module(worker: Worker) -> Module:
    services = (
        *(ports.output(port.name, port.type, port.span, None) for port in worker.outputs),
        *(ports.taken(port.name, port.type, port.span) for port in worker.inputs),
    )
    return Module(worker.name, worker.span, services, named=worker.span)


def _source(name: str, wire: Wire) -> Module:
    """Return the module of a virtual input: a sensor for a timer with a rate."""
    if wire.rate is None:
        service = ports.output(wire.output, None, wire.span, None)
    else:
        modes = (_PERIODIC,)
        service = Service("Sense", wire.span, "tick", modes=modes, hz=wire.rate, port=wire.output)
    return Module(name, wire.span, (service,), named=wire.span)
