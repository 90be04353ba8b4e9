"""Runs of a campaign on the workers of a running Dask scheduler.

The client sends the pickled job and the runs; workers need mars-asp, the scheduler does not.
Each thread of a worker has its own server, which carries out one run after another.
"""

import hashlib
import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from mars_asp import __version__
from mars_asp.asp.contained import Server
from mars_asp.cli.campaign_runner import RunOutcome
from mars_asp.diagnostic import MarsError, refusal
from mars_asp.execution.campaign.grid import Run

if TYPE_CHECKING:
    from distributed import Client, Future

#: At most so many runs are submitted to the scheduler at a time.
_AT_A_TIME = 1000
#: Seconds between two checks of a cluster that delivers no outcome.
_GLANCE = 1.0
#: Seconds to wait for the scheduler, and seconds that it may be without workers.
_ANSWER, _PATIENCE = 10.0, 60.0
#: A run whose workers are lost is submitted at most so often.
_TRIES = 5


def has_dask() -> bool:
    """Whether the extra `campaign` is installed."""
    return find_spec("distributed") is not None


def on_cluster(job: bytes, runs: Sequence[Run], address: str) -> Iterator[tuple[Run, RunOutcome]]:
    """Yield runs with their outcomes, as they end.

    Raises:
        MarsError: the cluster cannot be reached, is lost, or has no workers.
    """
    # Logs of Dask are about its own machinery; problems of a run are in its outcome.
    logging.disable(logging.CRITICAL)
    try:
        with _client(address) as client:
            yield from _outcomes(client, job, runs, address)
    finally:
        logging.disable(logging.NOTSET)


@contextmanager
def _client(address: str) -> "Iterator[Client]":
    from distributed import Client

    try:
        client = Client(address, timeout=_ANSWER, set_as_default=False)
    except (OSError, ValueError, RuntimeError) as error:
        text = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        raise _cluster_error(f"no scheduler answers at `{address}`: {text}") from None
    with client:
        yield client


def _outcomes(
    client: "Client", job: bytes, runs: Sequence[Run], shown: str
) -> Iterator[tuple[Run, RunOutcome]]:
    name = hashlib.sha256(job).hexdigest()[:16]
    # The job is a task, so that the cluster computes it again if its worker is lost.
    shared = client.submit(bytes, job, key=f"mars-asp-job-{name}", pure=False)
    task, ended = _task(), SimpleQueue[Any]()
    pending: dict[str, tuple[Run, int, Future[Any]]] = {}
    waiting = iter(enumerate(runs))
    seen = time.monotonic()

    def submit(number: int, run: Run, tries: int) -> None:
        key = f"mars-asp-{name}-{number}-{tries}"
        future = client.submit(task, __version__, shared, tuple(run), key=key, pure=False)
        pending[key] = run, tries, future
        future.add_done_callback(ended.put)

    while True:
        for number, run in waiting:
            submit(number, run, 0)
            if len(pending) >= _AT_A_TIME:
                break
        if not pending:
            return
        try:
            future = ended.get(timeout=_GLANCE)
        except Empty:
            if client.status != "running":
                raise _cluster_error(f"the scheduler of {shown} is gone") from None
            if client.scheduler_info()["workers"]:
                seen = time.monotonic()
            elif time.monotonic() - seen > _PATIENCE:
                raise _cluster_error(f"{shown} has had no worker for {_PATIENCE:g} s") from None
            continue
        seen = time.monotonic()
        run, tries, _ = pending.pop(future.key)
        outcome = _outcome(future, shown)
        if outcome is not None:
            yield run, outcome
        elif tries + 1 < _TRIES:
            submit(int(future.key.split("-")[-2]), run, tries + 1)
        else:
            raise _cluster_error(f"the workers of {shown} were lost {_TRIES} times with one run")


def _outcome(future: "Future[Any]", shown: str) -> RunOutcome | None:
    """Return the outcome of a run, None if its workers died; MarsError if the cluster is lost."""
    from distributed import KilledWorker

    if future.status in ("cancelled", "lost"):
        raise _cluster_error(f"the scheduler of {shown} is gone")
    error = future.exception()
    if error is None:
        found: RunOutcome | None = future.result()
        return found
    if isinstance(error, KilledWorker):
        return None
    if isinstance(error, ModuleNotFoundError) and (error.name or "").startswith("mars_asp"):
        raise _cluster_error(
            f"a worker of {shown} cannot import mars-asp: install it there"
        ) from None
    text = f"{type(error).__name__}: {error}"[:300]
    raise _cluster_error(f"a worker of {shown} cannot carry out runs: {text}") from None


def _task() -> Callable[[str, bytes, tuple[Any, ...]], RunOutcome | None]:
    """Return the function for workers, which imports mars-asp as the scheduler may lack it."""

    def carry_out(version: str, job: bytes, run: tuple[Any, ...]) -> RunOutcome | None:
        from mars_asp.cli.campaign_dask import carry_out_here

        return carry_out_here(version, job, run)

    return carry_out


# ---- In a worker of Dask -------------------------------------------------------------------------

#: The server of each thread, and its job.
_here = threading.local()


def carry_out_here(version: str, job: bytes, run: tuple[Any, ...]) -> RunOutcome | None:
    """Return the outcome of a run in the server of this thread.

    The result is None if the run is no longer wanted, or if the server was lost twice. The client
    and the worker need the same `version`.
    """
    from distributed import get_worker

    if version != __version__:
        raise RuntimeError(f"it has mars-asp {__version__}, and the command {version}")
    worker = get_worker()
    key = worker.get_current_task()

    def wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state in ("executing", "long-running")

    for _ in range(2):
        if getattr(_here, "job", None) != job:
            if getattr(_here, "server", None) is not None:
                _here.server.end()
            _here.server = Server("mars_asp.cli.campaign_runner", "serve_runs", job)
            _here.job = job
        outcome: RunOutcome | None = _here.server.ask(Run(*run), wanted)
        if outcome is not None:
            return outcome
        # The server may have ended because it was idle for too long.
        _here.job = _here.server = None
        if not wanted():
            break
    return None


def _cluster_error(message: str) -> MarsError:
    help_text = "start the command again with the same -o to go on"
    return refusal("campaign", message, "--cluster", help_text)
