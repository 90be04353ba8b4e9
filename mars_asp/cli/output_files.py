"""The output files of a run: a plot, a replay, a recording."""

import argparse
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from typing import IO, TYPE_CHECKING, cast

from mars_asp.cli.deliver import streamed, write_file
from mars_asp.cli.suggested_commands import way_to_install
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file

if TYPE_CHECKING:
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.recording.record import Record
    from mars_asp.execution.trial import Trial
    from mars_asp.model.declarations import Configuration, Module

#: The package for files of an ending, and the extra that provides it.
_NEEDED = {".mcap": ("mcap", "mcap"), ".png": ("resvg_py", "png")}


def add_outputs(parser: argparse.ArgumentParser) -> None:
    """Add the options that name files to write."""
    for option, endings in (
        ("--plot", (".svg", ".png")),
        ("--replay", (".html",)),
        ("--report", (".html",)),
        ("--record", (".jsonl", ".mcap")),
    ):
        metavar = f"OUT{'|'.join(endings)}"
        parser.add_argument(option, metavar=metavar, type=ending(*endings))


def ending(*endings: str) -> Callable[[str], str]:
    """Return a function that checks that a path has one of some endings.

    The ending gives the format. If `-` is among the endings, standard output is allowed.
    """
    suffixes = tuple(each for each in endings if each != "-")

    def checked_path(path: str) -> str:
        if path not in endings and not path.endswith(suffixes):
            named = " or ".join(suffixes)
            message = f"cannot tell what to write to `{path}`: end it in {named}"
            raise argparse.ArgumentTypeError(message)
        return path

    return checked_path


def check_packages(arguments: argparse.Namespace) -> None:
    """Check, before the run, that the packages for the requested files are installed.

    Raises:
        MarsError: an optional package is not installed.
    """
    problems = []
    for path in (arguments.plot, arguments.replay, arguments.record):
        for ending, (package, extra) in _NEEDED.items():
            if path is not None and path.endswith(ending) and find_spec(package) is None:
                message = f"`{ending}` needs the package `{package}`, which is not installed"
                help_text = f"`{way_to_install(extra)}`, or choose another ending"
                place = whole_file(path)
                problems.append(Diagnostic("package", "error", message, place, (), help_text))
    if problems:
        raise MarsError(problems)


@contextmanager
def recorded(
    arguments: argparse.Namespace,
    specification: "Configuration",
    modules: "Mapping[str, Module]",
) -> "Iterator[Record | None]":
    """Yield the recorder of a run, None unless requested; the file appears after the block."""
    if not arguments.record:
        yield None
        return
    with streamed(arguments.record) as file:
        if arguments.record.endswith(".jsonl"):
            from mars_asp.execution.recording.record import Lines

            yield Lines(file.write)
        else:
            from mars_asp.execution.executor.plan import Plan
            from mars_asp.execution.parts import in_parts
            from mars_asp.execution.recording.mcap import Foxglove

            plan = Plan(*in_parts(specification, modules), {})
            yield Foxglove(cast("IO[bytes]", file), plan)


def write_outputs(trial: "Trial", judgement: "Judgement", arguments: argparse.Namespace) -> None:
    """Write the requested plot and replay, each file whole or not at all."""
    if arguments.plot:
        write_file(arguments.plot, _plotted(trial, judgement, arguments.plot))
    if arguments.replay:
        from mars_asp.execution.recording.replay import replay_page

        title = f"{trial.scenario.path}, seed {trial.scenario.seed}"
        write_file(arguments.replay, replay_page(trial, judgement, title))


def _plotted(trial: "Trial", judgement: "Judgement", path: str) -> str | bytes:
    from mars_asp.execution.recording.picture import plot_run

    svg = plot_run(trial, judgement)
    if path.endswith(".svg"):
        return svg
    from mars_asp.draw.png import png_bytes

    return png_bytes(svg, str(trial.scenario.path), f"`{way_to_install('png')}`")
