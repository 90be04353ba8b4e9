"""The limits of time and memory of a command, and the messages when one is exceeded."""

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
from mars_asp.diagnostic import Diagnostic, MarsError, refusal, whole_file
from mars_asp.output import visible

#: The folder of the control groups of Linux, and the names of the files in them with the memory
#: limit, in bytes or `max`, in the second version and in the first.
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
    """Run a command in this process; report its errors and return its exit status."""
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
        # Without memory clingo passes on an error of C++, and Python one of the loader.
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
    """Check, before anything runs, that no output is an input or another output, nor a folder.

    Raises:
        MarsError: an output is also another file of the command, or no file can have its name.
    """
    begin_outputs()
    given = vars(arguments)
    named = {each: given[each] for each in _OUTPUTS if given.get(each) not in (None, "-")}
    problems = list(filter(None, map(_not_writable, named.values())))
    if problems:
        raise MarsError(problems)
    if given.get("fresh") is False:
        # A campaign continues its own file, and refuses any other.
        named.pop("output", None)
    if not named:
        return
    words = [given[each] for each in _INPUTS if given.get(each) is not None]
    words = [word for each in words for word in ([each] if isinstance(each, str) else each)]
    # Pipes and folders have no key, so they may be named twice.
    used = {file_key(word): word for word in words}
    for path in named.values():
        key = file_key(path)
        if key is not None and key in used:
            message = f"`{path}` is also `{used[key]}` of the same command"
            if path == used[key]:
                message = f"`{path}` is an input or another output of the same command"
            raise refusal("usage", message, path, "give each output a name of its own")
        used[key] = path


def _not_writable(output: str) -> Diagnostic | None:
    """Return the error that an output is a folder, or in none; None if a file can be there."""
    folder = os.path.dirname(output) or "."  # noqa: PTH120 -- a path that may be no text
    if os.path.isdir(output):  # noqa: PTH112
        message, advice = "this is a folder, not a file to write", "name a file in it"
    elif not os.path.isdir(folder):  # noqa: PTH112
        message, advice = f"there is no folder `{folder}` to write to", "make it first"
    else:
        return None
    return Diagnostic("usage", "error", message, whole_file(output), help=advice, excerpt="")


def seconds_to_search(arguments: argparse.Namespace) -> float | None:
    """Return the seconds that a search may take, None without a time limit.

    Judging and printing the result takes about as long as everything before the search.
    """
    if arguments.time_limit is None:
        return None
    used = time.monotonic() - arguments.started
    return float(max(0.0, arguments.time_limit - 2 * used))


def memory_limit(arguments: argparse.Namespace) -> float | None:
    """Return the memory limit in MB: the option, else half of the memory; None if unknown."""
    if arguments.memory_limit is not None:
        return float(arguments.memory_limit)
    bounds = [bound for bound in (_machine(), *_containers()) if bound]
    return min(bounds) / 2 / _MEGABYTE if bounds else None


def load_freely(*modules: str) -> None:
    """Import modules without the memory limit, at which NumPy would end the process.

    Raises:
        MemoryError: too little memory is left under the limit.
    """
    before = _lift()
    for module in modules:
        importlib.import_module(module)
    _lift(before)
    try:
        mmap.mmap(-1, _MEGABYTE).close()
    except OSError:
        raise MemoryError from None


def _lift(most: int = -1) -> int:
    """Set the limit of address space to `most` bytes, or to the maximum; return the old limit."""
    import resource

    before, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (hard if most < 0 else most, hard))
    return before


def say_memory_ended(arguments: argparse.Namespace) -> None:
    """Report that the memory limit ended the command, and how to raise the limit."""
    _lift()  # reporting takes some memory
    most = memory_limit(arguments)
    is_explicit = arguments.memory_limit is not None
    half = "" if is_explicit else ", half of what there is; --memory-limit MB allows more"
    text = "" if most is None else f" of {most:.0f} MB{half}"
    print(f"mars-asp: the memory limit{text} ended this", file=sys.stderr)


def _machine() -> int | None:
    with contextlib.suppress(ValueError, OSError, AttributeError):
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return None


def _containers() -> Iterator[int]:
    """Yield the memory limits of the control groups of this process, in bytes."""
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
