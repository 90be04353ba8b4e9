"""Run a verb in a child process, so that no rule file can hang or kill the command.

Grounding cannot be interrupted and some programs abort the process; a child with limits of its own
contains both. Where the system cannot fork, the verb runs here and only solving is limited.
"""

import argparse
import gc
import os
import signal
import sys
import time
from collections.abc import Callable
from types import FrameType

from mars_asp.cli.report import report_error
from mars_asp.diagnostic import MarsError
from mars_asp.visible import visible

#: Beyond the limit, so that a solver that stops in time can still say what it found.
GRACE_SECONDS = 5.0
#: Who keeps the clock, in a child that has a time limit.
_keeper: int | None = None


def run_limited(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Return a verb's exit status; 3 where a time or memory limit ended it."""
    if not hasattr(os, "fork"):
        return run_plain(run, arguments)
    sys.stdout.flush()
    sys.stderr.flush()
    # What both have in common is not written to, and so not copied, by a collection in the child.
    gc.freeze()
    # A run makes millions of values and hardly a cycle, so it is enough to look for some rarely.
    gc.set_threshold(50_000, 20, 20)
    keeper = os.getpid() if arguments.time_limit is not None else None
    if keeper is not None:
        signal.signal(signal.SIGUSR1, lambda *_: _set_clock(arguments))
    child = os.fork()
    if child:
        return _wait(child, arguments)
    status = 2
    global _keeper  # noqa: PLW0603 -- this process ends with the verb
    _keeper = keeper
    try:
        _limit_memory(arguments.memory_limit)
        status = run_plain(run, arguments)
        sys.stdout.flush()
        sys.stderr.flush()
    except BrokenPipeError:
        status = 141
    except KeyboardInterrupt:
        status = 130
    except Exception as error:  # whatever it is, the child must not end without a word
        print(f"mars-asp: a fault of ours, please report it: {error!r:.300}", file=sys.stderr)
        sys.stderr.flush()
    finally:
        os._exit(status)


def run_plain(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Run a verb here; report what it raises and return its exit status."""
    try:
        return run(arguments)
    except MarsError as error:
        report_error(error, arguments)
        return 2
    except MemoryError:
        print("mars-asp: the memory limit ended this", file=sys.stderr)
        return 3
    except TimeoutError:
        print("mars-asp: the time limit ended this before anything was found", file=sys.stderr)
        return 3
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "the output" if error.filename is None else f"`{visible(str(error.filename))}`"
        print(f"mars-asp: {name}: {error.strerror or error}", file=sys.stderr)
        return 2


def seconds_to_search(arguments: argparse.Namespace) -> float | None:
    """Return how long a search may take so that what it finds is judged and printed in time.

    Judging takes about as long as all that came before the search.
    """
    if arguments.time_limit is None:
        return None
    used = time.monotonic() - arguments.started
    return float(max(0.0, arguments.time_limit - 2 * used))


def begin_clock_anew() -> None:
    """Ask for the time to judge and print what was found, however slow the machine is."""
    if _keeper is not None:
        os.kill(_keeper, signal.SIGUSR1)


def _set_clock(arguments: argparse.Namespace) -> None:
    signal.setitimer(signal.ITIMER_REAL, arguments.time_limit + GRACE_SECONDS)


def _limit_memory(megabytes: float | None) -> None:
    if megabytes is None:
        return
    import resource

    most = int(megabytes * 1024 * 1024)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _wait(child: int, arguments: argparse.Namespace) -> int:
    """Wait for the child, pass on an interrupt, and end it when its time is over."""
    if arguments.time_limit is not None:

        def expire(number: int, frame: FrameType | None) -> None:
            os.kill(child, signal.SIGKILL)

        signal.signal(signal.SIGALRM, expire)
        _set_clock(arguments)
    started = time.monotonic()
    while True:
        try:
            _, status = os.waitpid(child, 0)
            break
        except KeyboardInterrupt:
            continue
    if os.WIFEXITED(status):
        return os.WEXITSTATUS(status)
    return _killed(os.WTERMSIG(status), time.monotonic() - started, arguments)


def _killed(number: int, seconds: float, arguments: argparse.Namespace) -> int:
    limited = arguments.time_limit is not None and seconds >= arguments.time_limit
    if limited:
        print(f"mars-asp: the time limit ended this after {seconds:.1f} s", file=sys.stderr)
        return 3
    if number == signal.SIGINT:
        return 130
    if arguments.memory_limit is not None:
        print("mars-asp: the memory limit ended this", file=sys.stderr)
        return 3
    name = signal.Signals(number).name
    print(f"mars-asp: a rule file or the system ended the reasoner ({name})", file=sys.stderr)
    return 2
