"""How much time and memory a verb may take, and what is said when that is not enough."""

import argparse
import contextlib
import importlib
import mmap
import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from mars_asp.cli.deliver import begin_outputs, file_key
from mars_asp.cli.diagnostic_text import report_error
from mars_asp.diagnostic import MarsError, refusal
from mars_asp.output import visible

#: Where the control groups of Linux are, and the files in them that tell how much memory theirs
#: may have, in bytes or `max`, in the second version and in the first.
_GROUPS = Path("/sys/fs/cgroup")
_MOST = ("memory.max", "memory.limit_in_bytes")
_MEGABYTE = 1 << 20
#: The options that name files to write, and the words and options that name files to read.
_OUTPUTS = ("output", "plot", "replay", "report", "record", "write_baseline", "junit")
_INPUTS = (
    *("files", "file", "old", "new", "specification", "configuration", "paths", "scenario"),
    *("sources", "rules"),
)


def run_plain(run: Callable[[argparse.Namespace], int], arguments: argparse.Namespace) -> int:
    """Run a verb here; report what it raises and return its exit status."""
    try:
        check_outputs(arguments)
        return run(arguments)
    except MarsError as error:
        report_error(error, arguments)
        return error.status
    except MemoryError:
        say_memory_ended(arguments)
        return 3
    except (RuntimeError, ImportError) as error:
        # clingo hands on what C++ says when there is no memory, and Python what the loader says.
        if not any(item in str(error) for item in ("bad_alloc", "failed to map segment")):
            raise
        say_memory_ended(arguments)
        return 3
    except TimeoutError:
        print("mars-asp: the time limit ended this before anything was found", file=sys.stderr)
        return 3
    except BrokenPipeError:
        raise
    except OSError as error:
        name = f"`{visible(str(error.filename))}`"
        if error.filename is None:
            # Only a lookup of the current folder finds no file without a name.
            is_folder = isinstance(error, FileNotFoundError)
            name = "the current folder" if is_folder else "the output"
        print(f"mars-asp: error: {name}: {error.strerror or error}", file=sys.stderr)
        return 2


def check_outputs(arguments: argparse.Namespace) -> None:
    """Check, before anything runs, that no option names an input or another output to write.

    Raises:
        MarsError: one does.
    """
    begin_outputs()
    given = vars(arguments)
    named = {each: given[each] for each in _OUTPUTS if given.get(each) not in (None, "-")}
    if given.get("fresh") is False:
        # A campaign goes on with its file, and refuses any other.
        named.pop("output", None)
    if not named:
        return
    words = [given[each] for each in _INPUTS if given.get(each) is not None]
    words = [word for each in words for word in ([each] if isinstance(each, str) else each)]
    # What comes twice through a pipe or a folder is another matter.
    used = {file_key(word): word for word in words}
    for path in named.values():
        key = file_key(path)
        if key is not None and key in used:
            message = f"`{path}` is also `{used[key]}` of the same command"
            if path == used[key]:
                message = f"`{path}` is an input or another output of the same command"
            raise refusal("usage", message, path, "give each output a name of its own")
        used[key] = path


def seconds_to_search(arguments: argparse.Namespace) -> float | None:
    """Return how long a search may take so that what it finds is judged and printed in time.

    Judging takes about as long as all that came before the search.
    """
    if arguments.time_limit is None:
        return None
    used = time.monotonic() - arguments.started
    return float(max(0.0, arguments.time_limit - 2 * used))


def memory_limit(arguments: argparse.Namespace) -> float | None:
    """Return how many megabytes a verb may take: as asked, else half of what there is."""
    if arguments.memory_limit is not None:
        return float(arguments.memory_limit)
    bounds = [bound for bound in (_machine(), *_containers()) if bound]
    return min(bounds) / 2 / _MEGABYTE if bounds else None


def load_freely(*modules: str) -> None:
    """Import modules, for which this process may take more: NumPy ends one that has less.

    Raises:
        MemoryError: nothing is left for what is to be done with them.
    """
    if not hasattr(os, "fork"):
        return
    before = _lift()
    for module in modules:
        importlib.import_module(module)
    _lift(before)
    try:
        mmap.mmap(-1, _MEGABYTE).close()
    except OSError:
        raise MemoryError from None


def _lift(most: int = -1) -> int:
    """Let this process take so many bytes, or all; return how many it was allowed before."""
    import resource

    before, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (hard if most < 0 else most, hard))
    return before


def say_memory_ended(arguments: argparse.Namespace) -> None:
    """Report that there was not enough memory, how much that was, and how to allow more."""
    if hasattr(os, "fork"):
        _lift()  # to report it takes a little, too
    most = memory_limit(arguments)
    asked = arguments.memory_limit is not None
    half = "" if asked else ", half of what there is; --memory-limit MB allows more"
    text = "" if most is None else f" of {most:.0f} MB{half}"
    print(f"mars-asp: the memory limit{text} ended this", file=sys.stderr)


def _machine() -> int | None:
    with contextlib.suppress(ValueError, OSError, AttributeError):
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return None


def _containers() -> Iterator[int]:
    """Yield how much memory the control groups of this process may have, in bytes."""
    with contextlib.suppress(OSError, ValueError):
        for line in Path("/proc/self/cgroup").read_text(encoding="utf-8").splitlines():
            _, controllers, path = line.split(":", 2)
            root = _GROUPS / controllers if controllers else _GROUPS
            group = root / path.lstrip("/")
            for folder in (group, *group.parents):
                if not folder.is_relative_to(root):
                    break
                for name in _MOST:
                    with contextlib.suppress(OSError, ValueError):
                        yield int((folder / name).read_text(encoding="utf-8"))
