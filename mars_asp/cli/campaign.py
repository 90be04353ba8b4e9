"""Run a specification in many worlds, and show what holds in how many of them."""

import argparse
import pickle
import sys
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mars_asp import __version__
from mars_asp.cli.arguments import add_output, positive
from mars_asp.cli.deliver import add_line, grow_file, write_file
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.inputs import STANDARD_INPUT, add_file, check_inputs, read_project
from mars_asp.cli.limits import load_freely
from mars_asp.cli.output_files import ending
from mars_asp.cli.progress import live_line
from mars_asp.cli.schemas import add_schema, schema_text
from mars_asp.cli.suggested_commands import command, way_to_install
from mars_asp.cli.trials import scenario_text, specified
from mars_asp.diagnostic import Diagnostic, MarsError, refusal, whole_file

if TYPE_CHECKING:
    from mars_asp.cli.campaign_runner import Job, RunOutcome
    from mars_asp.execution.campaign.grid import Grid, Run
    from mars_asp.execution.campaign.journal import FinishedRun, Journal
    from mars_asp.execution.campaign.summary import Share


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add_file(parser)
    add("--scenario", metavar="S.toml", required=True)
    add("--seeds", metavar="SEEDS", type=_seeds, required=True)
    add("--vary", metavar="KEY=VALUE,...", action="append", default=[])
    add_output(parser, "OUT.jsonl")
    add("--fresh", action="store_true")
    add("--workers", metavar="N", type=_positive_integer, default=1)
    add("--cluster", metavar="ADDRESS")
    add("--run-limit", metavar="SECONDS", type=positive)
    add("--plot", metavar="OUT.svg", type=ending(".svg"))
    add_schema(parser, "a line of OUT.jsonl", partial(schema_text, "campaign"))


def _seeds(text: str) -> tuple[int, ...]:
    from mars_asp.execution.campaign.grid import read_seeds

    try:
        return read_seeds(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _positive_integer(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and 0 < int(text) <= 1024):
        raise argparse.ArgumentTypeError(f"`{text}` must be a whole number from 1 to 1024")
    return int(text)


def run(arguments: argparse.Namespace) -> int:
    """Carry out the missing runs; return 1 if a run failed or no specification exists."""
    load_freely("mars_asp.execution.trial", "mars_asp.cli.campaign_runner")
    from mars_asp.cli.campaign_runner import hashes, job_of, needs_of
    from mars_asp.execution.campaign.journal import ended_run, header_of, in_order

    _check_engine(arguments)
    check_inputs(*arguments.files, arguments.scenario)
    project = read_project(arguments)
    text, path = scenario_text(arguments)
    grid = _grid(arguments, text, path)
    found = specified(project, arguments)
    if found is None:
        return 1
    code, remarks = needs_of(*found, grid, text, path)
    report(remarks, arguments)
    job = job_of(*found, text, path, code, arguments)
    header = header_of(*hashes(project, text, code, arguments), __version__)
    journal = _journal(header, arguments)
    ended = dict(journal.ended)
    missing = [each for each in grid.runs() if each.name not in ended]
    if arguments.output != STANDARD_INPUT:
        grow_file(arguments.output, journal.kept, journal.size)
        if not journal.kept:
            add_line(header)
    outcomes = _outcomes(job, missing, arguments)
    progress = Progress(grid, ended, len(missing))
    with closing(outcomes), live_line(arguments, Progress.line) as show:
        show(progress)
        for each, outcome in outcomes:
            if outcome.result is None:
                raise MarsError(_of_run(each, outcome.problems))
            ended[each.name] = ended_run(each, outcome.result)
            if arguments.output != STANDARD_INPUT:
                add_line(ended[each.name].line)
            progress.take(ended[each.name])
            show(progress)
    return _finish(header, in_order(grid.runs(), ended), grid, arguments)


def _check_engine(arguments: argparse.Namespace) -> None:
    """Check that the options are consistent, and that a requested cluster can be used.

    Raises:
        MarsError: Dask is not installed, two engines are requested, or `--fresh` has no file.
    """
    from mars_asp.cli.campaign_dask import has_dask

    if arguments.cluster and arguments.workers > 1:
        raise refusal(
            "campaign",
            "a cluster has workers of its own",
            "--cluster",
            "leave out --workers or --cluster",
        )
    if arguments.cluster and not has_dask():
        help_text = f"`{way_to_install('campaign')}`, or use --workers on this machine"
        message = "`--cluster` needs Dask, which is not installed"
        raise refusal("campaign", message, "--cluster", help_text)
    if arguments.fresh and arguments.output == STANDARD_INPUT:
        raise refusal(
            "campaign", "there is no file to begin anew", "--fresh", "name it: -o OUT.jsonl"
        )


def _grid(arguments: argparse.Namespace, text: str, path: Path) -> "Grid":
    """Return the requested runs: all combinations of seeds and varied values.

    Raises:
        MarsError: the scenario, a varied value or an option is wrong.
    """
    from mars_asp.execution.campaign.grid import MOST_RUNS, Grid
    from mars_asp.execution.scenario.read import read_scenario
    from mars_asp.execution.scenario.vary import read_axes

    read_scenario(text, path)
    grid = Grid(arguments.seeds, read_axes(arguments.vary))
    if len(grid) > MOST_RUNS:
        message = f"these are {len(grid)} runs; a campaign has at most {MOST_RUNS}"
        raise refusal("campaign", message, "--vary", "take fewer seeds or values")
    if arguments.plot and all(len(axis.values) == 1 for axis in grid.axes):
        raise refusal(
            "campaign", "there is no key with several values", "--plot", "--vary KEY=VALUE,VALUE"
        )
    problems: dict[Diagnostic, None] = {}
    for cell in grid.cells():
        try:
            read_scenario(text, path, cell)
        except MarsError as error:
            problems |= dict.fromkeys(error.diagnostics)
    if problems:
        raise MarsError(problems)
    return grid


def _journal(header: bytes, arguments: argparse.Namespace) -> "Journal":
    """Return the runs in the output file, if it exists.

    Raises:
        MarsError: the file is not a regular one, or is of another campaign.
        OSError: the file cannot be read.
    """
    from mars_asp.execution.campaign.journal import Journal, read_journal

    path = arguments.output
    if path == STANDARD_INPUT or not Path(path).exists():
        return Journal()
    if not Path(path).is_file():
        raise refusal(
            "campaign", "this is not a regular file, so runs cannot be added to it", path, None
        )
    raw = Path(path).read_bytes()
    return Journal(size=len(raw)) if arguments.fresh else read_journal(raw, header, path)


def _outcomes(
    job: "Job", runs: "Sequence[Run]", arguments: argparse.Namespace
) -> "Generator[tuple[Run, RunOutcome]]":
    if not runs:
        return
    if arguments.cluster:
        from mars_asp.cli.campaign_dask import on_cluster

        yield from on_cluster(pickle.dumps(job), runs, arguments.cluster)
        return
    from mars_asp.cli.campaign_runner import Runs

    with closing(Runs(job).outcomes(runs, arguments.workers)) as outcomes:
        yield from outcomes


def _of_run(run: "Run", problems: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield errors for problems that prevented a run, each naming the run."""
    from mars_asp.execution.scenario.vary import written_change

    changes = [written_change(key, value) for key, value in run.changes.items()]
    text = ", ".join((f"seed {run.seed}", *changes))
    for each in problems:
        effect = f"The run with {text} cannot begin."
        yield Diagnostic(each.code, "error", each.message, each.span, help=each.help, effect=effect)


class Progress:
    """The number of finished and of passed runs of a campaign."""

    def __init__(self, grid: "Grid", ended: "Mapping[str, FinishedRun]", missing: int) -> None:
        from mars_asp.execution.campaign.summary import share_passed

        before = [ended[each.name].result for each in grid.runs() if each.name in ended]
        self.passed: Share = share_passed(before)
        self.now, self.missing = 0, missing
        #: The number of ended runs when the first of them was seen, and the seconds until then.
        self.first: tuple[int, float] | None = None

    def take(self, ended: "FinishedRun") -> None:
        """Count a finished run."""
        from mars_asp.execution.campaign.summary import Share, share_passed

        more = share_passed([ended.result])
        self.passed = Share(self.passed.held + more.held, self.passed.of + more.of)
        self.now += 1

    def line(self, wall: float) -> str:
        """Return the line of progress after `wall` seconds."""
        left = self.missing - self.now
        total = self.passed.of + left
        # Until a first run has ended, workers were being started.
        if self.first is None and self.now:
            self.first = self.now, wall
        ran, began = self.first or (0, wall)
        about = ""
        if self.now > ran:
            about = f"  {_duration((wall - began) / (self.now - ran) * left)} left"
        return f"{self.passed.of} of {total} runs  passed {self.passed.text}{about}"


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest:02} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def _finish(
    header: bytes, ended: "Sequence[FinishedRun]", grid: "Grid", arguments: argparse.Namespace
) -> int:
    """Write the results, plot and summary of a campaign; return 1 if a run did not pass."""
    import json

    from mars_asp.cli.campaign_table import print_table
    from mars_asp.execution.campaign.journal import whole_text
    from mars_asp.execution.campaign.picture import campaign_picture
    from mars_asp.execution.campaign.summary import are_equal, cells, share_passed, summary_json

    results = [each.result for each in ended]
    summary = summary_json(results, lambda result: _command(result, arguments))
    whole = whole_text(header, ended, summary)
    streamed = arguments.output == STANDARD_INPUT
    if streamed:
        sys.stdout.write(whole.decode())
    else:
        write_file(arguments.output, whole)
    if arguments.plot:
        title = f"{Path(arguments.files[0]).name} in {Path(arguments.scenario).name}"
        write_file(arguments.plot, campaign_picture(cells(results), grid.axes, title))
    if arguments.format == "json":
        if not streamed:
            print(json.dumps(summary))
    elif not streamed or not arguments.quiet:
        print_table(results, summary["worst"], sys.stderr if streamed else sys.stdout)
    if are_equal(results):
        message = (
            "nothing in this scenario is drawn from the seed: its runs are equal for all seeds"
        )
        advice = "scatter obstacles, give sensors a `sigma` or links a `loss`, or take one seed"
        place = whole_file(arguments.scenario)
        report([Diagnostic("campaign", "warning", message, place, help=advice)], arguments)
    passed = share_passed(results)
    return int(passed.held < passed.of)


def _command(result: Mapping[str, Any], arguments: argparse.Namespace) -> str:
    """Return the `mars-asp run` command that repeats a run of the campaign."""
    from mars_asp.execution.scenario.vary import written_change

    words = ["--scenario", arguments.scenario, "--seed", str(result["seed"])]
    for key, value in result["vary"].items():
        words += ["--vary", written_change(key, value)]
    return command("run", arguments, *words)
