"""Files that are read: regular ones within walls, and never more of them than a bound.

A file that another file names, by a path or as a link, may come from a stranger. It is read only if
it lies in the folder of that file, in the project around that folder, or in the working folder.
"""

import errno
import os
import re
import select
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path

#: The name of standard input in locations.
SHOWN_INPUT = "<stdin>"
#: What belongs to the kernel: environments of processes, devices without an end.
KERNEL = ("/proc", "/dev", "/sys")
#: A folder for files of users, in memory.
_MEMORY = "/dev/shm"
#: What the caller of the command has opened, and the file without content.
_STREAM = re.compile(r"/dev/(?:stdin|null|fd/[0-9]+)|/proc/self/fd/[0-9]+")
_PIPE = re.compile(r"/proc/[0-9]+/fd/pipe:\[[0-9]+\]|/dev/null")
#: What the folder of a repository holds, and that of a project in none.
_MARKS = ((".git",), ("mars.toml", "pyproject.toml", "package.xml"))
#: No system has longer paths.
_MOST_PATH = 4096
#: Seconds after which no process will write into a named pipe any more.
_PIPE_SECONDS = 5
OUTSIDE = "it lies outside of the project and of the working folder"
#: Device and inode of each regular file that was read: an output must be none of them.
files_read: set[tuple[int, int]] = set()
#: Sources that lie outside; their lines are not shown.
_unquoted: set[str] = set()
_NONE: Mapping[str, bytes] = {}
#: What an editor shows of files that are changed and not written yet.
_texts: ContextVar[Mapping[str, bytes]] = ContextVar("unsaved", default=_NONE)


class WallError(OSError):
    """A file outside of the permitted folders; `advice` is a way to read it, or None."""

    advice: str | None = None


def wall_error(path: str, reason: str, advice: str | None = None) -> WallError:
    """Return the error that a file must not be read."""
    error = WallError(errno.EACCES, reason, path)
    error.advice = advice
    return error


def read_file(path: str | Path, most: int, named_in: str | None = None) -> bytes:
    """Return the content of a file; of a larger one `most` bytes and one more.

    `named_in` is the file that names it; if None, the user named it, and it may be a pipe.

    Raises:
        WallError: it must not be read.
        OSError: it cannot be read.
    """
    check_walls(path, named_in)
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(handle, "rb") as file:
        status = os.fstat(handle)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if stat.S_ISREG(status.st_mode):
            files_read.add((status.st_dev, status.st_ino))
        elif named_in is not None:
            raise wall_error(str(path), "it is not a regular file")
        else:
            waiting = select.poll()
            waiting.register(handle, select.POLLIN)
            if not waiting.poll(_PIPE_SECONDS * 1000):
                raise wall_error(str(path), "it is a pipe that no process writes into")
            os.set_blocking(handle, True)
        return file.read(most + 1)


def check_walls(path: str | Path, named_in: str | None = None) -> None:
    """Check that a file lies in the project of the file `named_in` (None: its own).

    Raises:
        WallError: it is the kernel's, or lies outside.
    """
    written = os.fspath(path)
    if len(written) > _MOST_PATH:
        raise wall_error(written, os.strerror(errno.ENAMETOOLONG))
    real = os.path.realpath(written)
    if named_in is None and (_STREAM.fullmatch(written) or _PIPE.fullmatch(real)):
        return
    if _is_kernels(real):
        raise wall_error(written, "nothing in /proc, /dev and /sys is read")
    if _is_outside(real, written if named_in is None else named_in):
        if named_in is None:
            advice = f"name the file itself: `{real}`"
            raise wall_error(written, "it is a link out of its project", advice)
        advice = "copy it, or run the command in a folder that holds both"
        raise wall_error(written, OUTSIDE, advice)


def is_kernels(path: str | Path) -> bool:
    """Whether a path, with links resolved, is a file of the kernel."""
    return _is_kernels(os.path.realpath(path))


def _is_kernels(real: str) -> bool:
    return not _is_in(real, _MEMORY) and any(_is_in(real, each) for each in KERNEL)


def is_outside(path: str | Path, named_in: str) -> bool:
    """Whether a path in the file `named_in` leads out of the permitted folders around that file."""
    return _is_outside(os.path.realpath(path), named_in)


def _is_outside(real: str, named_in: str) -> bool:
    # Most files are in the working folder, and it takes long to follow the links of a path.
    if _is_in(real, os.getcwd()):  # noqa: PTH109 -- a path is made for each file
        return False
    roots = _roots(os.path.realpath(os.path.dirname(named_in)))  # noqa: PTH120 -- may be `<stdin>`
    return not any(_is_in(real, root) for root in roots)


def hide_lines(path: str) -> None:
    """Prevent messages from showing lines of a file, as it is outside."""
    _unquoted.add(path)


def is_hidden(path: str) -> bool:
    """Whether messages must not show lines of a file, as it is outside of the project."""
    return path in _unquoted


@lru_cache(maxsize=1000)
def _roots(folder: str) -> tuple[str, ...]:
    """Return a folder and the project around it: its repository, else the nearest marked folder.

    A home folder, or one above it, is not a project, as it contains all files of a user.
    """
    around = [Path(folder), *Path(folder).parents]
    home = os.path.realpath(os.path.expanduser("~"))  # noqa: PTH111 -- there may be none
    projects = [each for each in around if not _is_in(home, str(each))]
    for marks in _MARKS:
        for outer in projects:
            if any(os.path.exists(outer / mark) for mark in marks):  # noqa: PTH110 -- never raises
                return folder, str(outer)
    return (folder,)


def holds_home(folder: str | Path) -> bool:
    """Whether a folder is the user's home folder or one above it."""
    home = os.path.expanduser("~")  # noqa: PTH111 -- there may be none
    return _is_in(os.path.realpath(home), os.path.realpath(folder))


def _is_in(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder.rstrip("/") + "/")


@contextmanager
def overlay(texts: Mapping[str, str]) -> Iterator[None]:
    """Replace, in the block, the contents of the files at these paths.

    >>> with overlay({"robot.mars": "@modules Camera"}):
    ...     overlay_bytes(Path("robot.mars"))
    b'@modules Camera'
    """
    held = {os.path.realpath(path): text.encode("utf-8", "replace") for path, text in texts.items()}
    before = _texts.set(held)
    try:
        yield
    finally:
        _texts.reset(before)


def overlay_bytes(path: Path) -> bytes | None:
    """Return the replaced content of a file as UTF-8, or None if it is not replaced."""
    texts = _texts.get()
    return texts.get(os.path.realpath(path)) if texts else None


def decoded(raw: bytes) -> str:
    """Return the text of a file as editors show it, whatever its encoding."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return raw.decode("utf-16", "replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")
