"""The output of a command: standard output and files, whole or not at all.

A worker sends its output through a pipe, as messages of a name and values. The command collects
them and writes everything when the worker has sent its exit status, so a worker that was ended, or
that user code broke off, leaves nothing.
"""

import errno
import io
import os
import stat
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from mars_asp.asp.contained import send
from mars_asp.diagnostic import refusal
from mars_asp.output import AtomicFile, GrowingFile, replace_together, visible, write_whole
from mars_asp.reading import files_read

#: So many bytes of a stream are sent at a time.
_PORTION = 1 << 16
#: The pipe to the command, in a worker, and the process that may write to it.
_pipe: int | None = None
_writer: int | None = None
#: The file that grows by lines, in the process that writes.
_growing: GrowingFile | None = None
#: The identities of outputs.
_claimed: set[object] = set()
#: Keeps the messages of several threads from mixing.
_sending = threading.Lock()


class OutputFile(NamedTuple):
    """A file to write; `read` is its expected old content if it is to be replaced."""

    path: str
    content: bytes
    read: bytes | None = None


def write_file(path: str, content: str | bytes) -> None:
    """Write a file; a worker's files are written after the command has ended.

    Raises:
        OSError: the file cannot be written.
        MarsError: the file was read as an input, or is another output.
    """
    _claim(path)
    raw = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    _write_files([OutputFile(path, raw)])


def write_result(path: str, content: str | bytes) -> None:
    """Write the result of a command to a file, or to standard output if the path is `-`.

    Raises:
        OSError: the file cannot be written.
        MarsError: it was read as an input, or is another output.
    """
    if path != "-":
        write_file(path, content)
    elif isinstance(content, str):
        print(content, end="")
    else:
        sys.stdout.buffer.write(content)


def replace_files(files: Sequence[tuple[str, bytes, bytes]]) -> None:
    """Replace files, all or none, in a worker after the command has ended.

    Each entry has the path, the new content, and the expected old content.

    Raises:
        OSError: a file cannot be written, or its content has changed.
    """
    _write_files([OutputFile(*each) for each in files])


def grow_file(path: str, kept: int, size: int) -> None:
    """Open a file to append lines after its first `kept` bytes, of `size`.

    The file is locked until `write_file` replaces it, or the command ends.

    Raises:
        OSError: the file cannot be written.
        MarsError: the file was read as an input.
    """
    global _growing  # noqa: PLW0603 -- there is one
    _check_unread(path)
    if _pipe is None:
        _growing = GrowingFile(path, kept, size)
        return
    _send("grow", path, kept, size)


def add_line(line: bytes) -> None:
    """Append a line to the file of `grow_file` at once.

    Raises:
        OSError: the line cannot be written.
    """
    if _pipe is not None:
        _send("line", line)
    elif _growing is not None:
        _growing.append(line)


def write_closing(text: str) -> None:
    """Write text to standard error, after all output to standard output."""
    if _pipe is not None:
        _send("closing", text)
        return
    sys.stdout.flush()
    sys.stderr.write(text)


def end_growing() -> None:
    """Close the file of `grow_file`, if one is open."""
    global _growing  # noqa: PLW0603 -- there is one
    if _growing is not None:
        _growing.close()
        _growing = None


def file_key(path: str) -> object:
    """Return a key that is equal for all paths of a file, None if it is not a regular file."""
    try:
        status = os.stat(path)  # noqa: PTH116 -- a path that may be no text
    except (OSError, ValueError):
        return os.path.realpath(path)
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None


def begin_outputs() -> None:
    """Forget the files that were read and written, at the start of a command."""
    files_read.clear()
    _claimed.clear()


def _check_unread(path: str) -> object:
    """Return the key of an output; MarsError if the file was read as an input.

    Raises:
        MarsError: the file was read as an input.
    """
    key = file_key(path)
    if key in files_read:
        message = f"`{path}` was read as an input of this command"
        raise refusal("usage", message, path, "give the output another name")
    return key


def _claim(path: str) -> None:
    """Register an output; MarsError if it was read as an input or is another output.

    Raises:
        MarsError: the file was read as an input, or is another output.
    """
    key = _check_unread(path)
    if key is not None and key in _claimed:
        raise refusal("usage", f"`{path}` is written twice", path, "give each output its own name")
    _claimed.add(key)


@contextmanager
def streamed(path: str) -> Iterator[io.BufferedIOBase | AtomicFile]:
    """Yield a file to write in parts, which appears under `path` after the block.

    In a worker it appears after the command has ended. If the block raises, it never appears.

    Raises:
        OSError: the file cannot be written.
        MarsError: the file was read as an input, or is another output.
    """
    _claim(path)
    if _pipe is not None:
        with io.BufferedWriter(_MessageStream("part", path), _PORTION) as file:
            yield file
        _send("whole", path)
        return
    begun = AtomicFile(path)
    try:
        yield begun
        begun.replace()
    finally:
        begun.drop()


# ---- In the worker -------------------------------------------------------------------------------


def to_pipe(pipe: int) -> None:
    """Send standard output and files through a pipe.

    Writes to the descriptor of standard output that bypass Python reach standard error: they do
    not belong to the result.
    """
    global _pipe, _writer
    _pipe, _writer = pipe, os.getpid()
    shown = sys.stdout is not None and sys.stdout.isatty()
    raw = io.BufferedWriter(_MessageStream("output", is_terminal=shown), _PORTION)
    sys.stdout = _Text(raw, encoding="utf-8", errors="backslashreplace")
    os.dup2(2, 1)


class _Text(io.TextIOWrapper):
    """Standard output that the code of a behaviour cannot close."""

    def close(self) -> None:
        raise RuntimeError("standard output belongs to the command")


class _MessageStream(io.RawIOBase):
    """A stream that sends each piece of data as a message that begins with given values."""

    def __init__(self, *head: str, is_terminal: bool = False) -> None:
        self._head, self._is_terminal, self._size = head, is_terminal, 0

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return self._is_terminal

    def tell(self) -> int:
        return self._size

    def write(self, data: object) -> int:
        raw = bytes(data)  # type: ignore[call-overload]
        _send(*self._head, raw)
        self._size += len(raw)
        return len(raw)


def runs_code_of(paths: Iterable[str]) -> None:
    """Send the paths of user files whose code runs next, and may end the worker."""
    if _pipe is not None:
        _send("code", tuple(paths))


def end(status: int) -> None:
    """Send the exit status as the last message.

    Raises:
        ValueError: user code closed standard output.
    """
    sys.stdout.flush()
    _send("end", status)


def _send(*message: object) -> None:
    assert _pipe is not None
    # A process that user code forked must not deliver anything.
    if os.getpid() == _writer:
        with _sending:
            send(_pipe, message)


# ---- In the command ------------------------------------------------------------------------------


class WorkerOutput:
    """The messages of a worker; `status` is its exit status, None until it arrives.

    `code` are the files of the user whose code the worker runs.
    """

    def __init__(self) -> None:
        self.output: list[bytes] = []
        #: Text for standard error after the output.
        self.closing = ""
        #: The files to write in the end: a path to report, and the function that writes them.
        self._writes: list[tuple[str, Callable[[], None]]] = []
        #: Files that arrive in parts, by path, and the first error of each.
        self._begun: dict[str, AtomicFile] = {}
        self._unwritten: dict[str, OSError] = {}
        self.code: tuple[str, ...] = ()
        self.status: int | None = None
        #: Whether a line could not be written, so that continuing is pointless.
        self.failed = False

    def take(self, message: object) -> None:
        """Store the values of a message, or write a line or a part of a file.

        Raises:
            ValueError: the message is not from the worker's own code; user code wrote to the pipe.
        """
        match message:
            case "output", bytes(raw):
                self.output.append(raw)
            case "closing", str(text):
                self.closing += text
            case "files", list(group) if group:
                self._writes.append((group[0].path, lambda: _write_files(group)))
            case "part", str(path), bytes(content):
                self._extend(path, content)
            case "whole", str(path):
                self._writes.append((path, lambda: self._replace(path)))
            case "grow", str(path), int(kept), int(size):
                self._grown = path
                self._grow(lambda: grow_file(path, kept, size))
            case "line", bytes(line):
                self._grow(lambda: add_line(line))
            case "code", tuple(paths):
                self.code = paths
            case "end", int(status):
                self.status = status
            case _:
                raise ValueError(message)

    def _grow(self, write: Callable[[], None]) -> None:
        """Call `write` for the growing file; report its first failure, and skip later calls."""
        if self.failed:
            return
        try:
            write()
        except OSError as error:
            _say_unwritten(f"`{visible(self._grown)}`", error)
            self.failed = True

    def _extend(self, path: str, content: bytes) -> None:
        """Append to a new file beside the one that it replaces; failures are reported later."""
        if path in self._unwritten:
            return
        try:
            if path not in self._begun:
                self._begun[path] = AtomicFile(path)
            self._begun[path].write(content)
        except OSError as error:
            self._unwritten[path] = error

    def _replace(self, path: str) -> None:
        """Move a file that arrived in parts to its path."""
        if path in self._unwritten:
            raise self._unwritten[path]
        self._begun[path].replace()

    def drop(self) -> None:
        """Remove the partial files that were not delivered."""
        for begun in self._begun.values():
            begun.drop()

    def deliver(self) -> int:
        """Write the files, then standard output, and return the exit status.

        Raises:
            BrokenPipeError: the reader of standard output is gone.
        """
        is_unwritten = False
        for path, write in self._writes:
            try:
                write()
            except OSError as error:
                named = error.filename if isinstance(error.filename, str) else path
                _say_unwritten(f"`{visible(named)}`", error)
                is_unwritten = True
        end_growing()
        if self.output:
            try:
                _write_out(self.output)
            except BrokenPipeError:
                raise
            except OSError as error:
                _say_unwritten("standard output", error)
                is_unwritten = True
        # After a failure the summary would count repairs, or a baseline, that do not exist.
        if not is_unwritten:
            sys.stderr.write(self.closing)
        return 2 if is_unwritten else self.status or 0


def _write_out(chunks: list[bytes]) -> None:
    """Write to the descriptor itself: Python's buffers would lose data on a full disk."""
    for chunk in chunks:
        rest = memoryview(chunk)
        while rest:
            rest = rest[os.write(1, rest) :]


def _write_files(files: list[OutputFile]) -> None:
    """Write files, all or none, in a worker after the command has ended."""
    if _pipe is not None:
        for file in files:
            if file.read is not None:
                # The caller reports the file as written before the command writes it.
                _check_writable(file.path)
        _send("files", files)
        return
    for file in files:
        if file.read is not None:
            _check_unchanged(file)
    if len(files) != 1:
        replace_together({file.path: file.content for file in files})
        return
    [file] = files
    is_growing = _growing is not None and _growing.path == file.path
    if _growing is not None and is_growing:
        _growing.check_own()
    write_whole(file.path, file.content)
    if is_growing:
        end_growing()


def _check_unchanged(file: OutputFile) -> None:
    """Check that a file has not changed since it was read, and may be written.

    Raises:
        OSError: the file has changed, or is read-only.
    """
    with open(file.path, "rb") as there:  # noqa: PTH123 -- a path that may be no text
        _check_writable(file.path)
        if there.read() != file.read:
            text = "it has changed since it was read, so it was left alone"
            raise OSError(0, text, file.path)


def write_obstacle(path: str) -> str | None:
    """Return the reason why a file cannot be replaced, or None if it can.

    The mode of the file counts also for root, which could ignore it.

    Raises:
        OSError: the file does not exist.
    """
    mode, folder = os.stat(path).st_mode, os.path.dirname(os.path.realpath(path))  # noqa: PTH116, PTH120 -- raw
    if not mode & 0o222 or not os.access(path, os.W_OK):
        return "it is read-only"
    # A regular file is replaced by one that is written beside it.
    if stat.S_ISREG(mode) and not os.access(folder, os.W_OK | os.X_OK):
        return f"its folder `{folder}` is read-only"
    return None


def _check_writable(path: str) -> None:
    if obstacle := write_obstacle(path):
        raise PermissionError(errno.EACCES, f"{obstacle}, so it was left alone", path)


def _say_unwritten(what: str, error: OSError) -> None:
    print(visible(f"mars-asp: error: {what}: {error.strerror or error}"), file=sys.stderr)
