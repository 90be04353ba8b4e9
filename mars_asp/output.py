"""Text made safe to show and files written whole, or by whole lines."""

import contextlib
import errno
import fcntl
import os
import re
import shutil
import stat
import tempfile
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import IO, Any

#: How the names of files begin that are being written.
_TEMPORARY = ".mars-asp."
#: The whole name of one: 16 random digits, and its inode.
_OF_INODE = re.escape(_TEMPORARY) + "[0-9a-f]{16}[.]([0-9a-f]{1,16})"
#: What opens a link, a picture, HTML, a character or code in Markdown, and a block in a line.
_SIGN = r"[\\<>\[\]&`]"
_FIRST = r"(?m)^( {0,3}[0-9]{0,9})([#+=|~*.)-])"
#: The length of a `repr` at most.
_LONGEST_REPR = 200
_HIDDEN = frozenset({"Cc", "Cf", "Cs", "Co", "Zl", "Zp"})


def visible(text: str) -> str:
    r"""Return a text in one line, with control, format and surrogate characters escaped.

    Line feeds are escaped as well: a foreign name or path must not begin a line of the output.
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(map(_visible_character, text))


def brief_repr(value: Any) -> str:
    """Return a dataclass value as one line of at most 200 characters; large fields by their type.

    It is the `__repr__` of public values, which may hold a whole robot.
    """
    shown = ", ".join(
        f"{each.name}={_brief(getattr(value, each.name))}" for each in fields(value) if each.repr
    )
    text = visible(f"{type(value).__name__}({shown})")
    return text if len(text) <= _LONGEST_REPR else f"{text[: _LONGEST_REPR - 4]}...)"


def _brief(value: object) -> str:
    if value is None or isinstance(value, bool | int | float):
        return repr(value)
    if isinstance(value, str):
        return repr(value if len(value) <= _LONGEST_REPR else value[:_LONGEST_REPR])
    if isinstance(value, tuple | list | dict):
        return f"<{len(value)}>"
    return f"<{type(value).__name__}>"


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: `1 error`, `2 errors`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def listing(texts: Sequence[str]) -> str:
    """Return texts as a list in a sentence: `A, B and C`; empty for none."""
    return " and ".join(filter(None, (", ".join(texts[:-1]), *texts[-1:])))


def markdown(text: str) -> str:
    """Return a text escaped for Markdown, except code between backticks."""
    parts = re.split(r"(`[^`\n]+`)", text)
    parts[::2] = [re.sub(_SIGN, r"\\\g<0>", part) for part in parts[::2]]
    return re.sub(_FIRST, r"\1\\\2", "".join(parts))


def fenced(text: str, language: str = "text") -> str:
    """Return a text as a fenced code block, with a fence that the text does not contain."""
    longest = max(map(len, re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"


def encodable(text: str) -> str:
    """Return a text for a program: bytes that are not UTF-8, and NUL, are escaped."""
    text = text.replace("\0", "\\0")
    return text if text.isascii() else text.encode(errors="backslashreplace").decode()


def _visible_character(character: str) -> str:
    if unicodedata.category(character) not in _HIDDEN:
        return character
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")


def write_whole(path: str, content: str | bytes) -> None:
    """Write a file whole or not at all; it keeps its mode, and links are followed.

    Raises:
        OSError: the file cannot be written.
    """
    begun = AtomicFile(path)
    try:
        begun.write(
            content.encode(errors="backslashreplace") if isinstance(content, str) else content
        )
        begun.replace()
    finally:
        begun.drop()


def replace_together(contents: Mapping[str, bytes]) -> None:
    """Replace the contents of files, by their paths, all of them or none.

    Raises:
        OSError: one of them cannot be written; all are as they were.
    """
    before = {path: Path(os.path.realpath(path)).read_bytes() for path in contents}
    replaced: list[str] = []
    with contextlib.ExitStack() as stack:
        staged = []
        for path, content in contents.items():
            staged.append(begun := AtomicFile(path))
            stack.callback(begun.drop)
            begun.write(content)
            begun.stage()
        try:
            for begun in staged:
                begun.replace()
                replaced.append(begun.path)
        except OSError:
            for path in replaced:
                write_whole(path, before[path])
            raise


class GrowingFile:
    """A file to which whole lines are appended; at most the last may be lost in a crash.

    It is locked while it is open, so that two commands cannot write to it.
    """

    def __init__(self, path: str, kept: int, size: int) -> None:
        """Open or make a file of `size` bytes, and truncate it to the first `kept` ones.

        Raises:
            OSError: it cannot be opened or locked, is not a regular file, or has another size.
        """
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NONBLOCK, 0o666)
        self._file = os.fdopen(handle, "ab", buffering=0)
        try:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise OSError(errno.EINVAL, "it is not a regular file", path)
            try:
                _lock(handle)
            except BlockingIOError:
                text = "another command is writing to it"
                raise BlockingIOError(errno.EAGAIN, text, path) from None
            if os.fstat(handle).st_size != size:
                raise OSError(errno.EBUSY, "it has changed since it was read", path)
            os.ftruncate(handle, kept)
            os.fsync(handle)
            self.path, self._state = path, _state_of(os.fstat(handle))
        except OSError:
            self._file.close()
            raise

    def append(self, line: bytes) -> None:
        """Append a line, and flush it to the disk.

        Raises:
            OSError: it cannot be written.
        """
        rest = memoryview(line)
        while rest:
            rest = rest[self._file.write(rest) :]
        os.fsync(self._file.fileno())
        self._state = _state_of(os.fstat(self._file.fileno()))

    def check_own(self) -> None:
        """Check that the path still is this file, and that no other program has written to it.

        Raises:
            OSError: the file was replaced or changed.
        """
        if _state_of(os.stat(self.path)) != self._state:  # noqa: PTH116 -- as `open`
            message = "it has changed since the last line, so it was left alone"
            raise OSError(errno.EBUSY, message, self.path)

    def close(self) -> None:
        """Close the file, and unlock it."""
        self._file.close()


def _state_of(status: os.stat_result) -> tuple[int, ...]:
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


class AtomicFile:
    """A temporary file beside a path, which replaces the file of the path whole or not at all.

    A path that is not a regular file, such as a pipe, is written only at the end. Each method may
    raise an `OSError`, which names `path`.
    """

    def __init__(self, path: str) -> None:
        self.path, self._target = path, Path(os.path.realpath(path))
        self._temporary: Path | None = None
        # The pipe of `/dev/stdout` has no path of its own.
        if os.path.exists(path) and not os.path.isfile(path):  # noqa: PTH110, PTH113
            self._target = Path(path)
            self._file: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 -- see `drop`
            return
        if self._target.exists() and not os.access(self._target, os.W_OK):
            # A folder that may be written would let the file be replaced.
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        handle, self._temporary = _temporary_beside(self._target, path)
        self._file = os.fdopen(handle, "w+b")

    def write(self, content: bytes) -> None:
        """Append to the temporary file."""
        with self._errors_name_path():
            self._file.write(content)

    def tell(self) -> int:
        """Return the number of bytes written so far."""
        return self._file.tell()

    def stage(self) -> None:
        """Flush the file to the disk, with the mode of the file that it replaces."""
        with self._errors_name_path():
            self._file.flush()
            if self._temporary is None:
                return
            os.fsync(self._file.fileno())
            exists = self._target.exists()
            mode = stat.S_IMODE(self._target.stat().st_mode) if exists else 0o666 & ~_umask()
            self._temporary.chmod(mode)

    def replace(self) -> None:
        """Move the file to its path; copy its content into a path that is not a regular file."""
        self.stage()
        with self._errors_name_path():
            if self._temporary is not None:
                self._temporary.replace(self._target)
                return
            self._file.seek(0)
            with self._target.open("wb") as target:
                shutil.copyfileobj(self._file, target)

    def drop(self) -> None:
        """Close the file, and remove it unless it has replaced the other one."""
        with contextlib.suppress(OSError):
            self._file.close()
        if self._temporary is not None:
            with contextlib.suppress(OSError):
                self._temporary.unlink()

    @contextlib.contextmanager
    def _errors_name_path(self) -> Iterator[None]:
        """Replace the temporary file's name in errors of the block by the target's."""
        try:
            yield
        except OSError as error:
            raise type(error)(error.errno, error.strerror, self.path) from None


def _temporary_beside(target: Path, path: str) -> tuple[int, Path]:
    """Return handle and path of a new, locked file in the folder of a target.

    Files of killed commands are removed: they are not locked. The name of a file ends with its
    inode, so that no other file is removed.

    Raises:
        OSError: no file can be made there; it names `path`: the other name is never shown.
    """
    folder = target.parent
    try:
        for other in folder.glob(f"{_TEMPORARY}*"):
            with contextlib.suppress(OSError):
                _remove_unlocked(other)
        with contextlib.suppress(AttributeError, OSError):
            return _named_by_inode(folder)
        # This system has no files without a name. Nothing removes such a file after a kill.
        handle, name = tempfile.mkstemp(dir=folder, prefix=_TEMPORARY)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, path) from None
    return handle, Path(name)


def _named_by_inode(folder: Path) -> tuple[int, Path]:
    """Return handle and path of a new file that is locked before it has a name (Linux only).

    Raises:
        OSError: the file system cannot do it.
    """
    handle = os.open(folder, os.O_TMPFILE | os.O_RDWR, 0o600)
    try:
        # Where files cannot be locked, nothing can be removed either.
        _lock(handle)
        name = folder / f"{_TEMPORARY}{os.urandom(8).hex()}.{os.fstat(handle).st_ino:x}"
        # A folder has to be given for the link to be followed; an absolute path ignores it.
        os.link(f"/proc/self/fd/{handle}", name, src_dir_fd=handle, follow_symlinks=True)
    except OSError:
        os.close(handle)
        raise
    return handle, name


def _remove_unlocked(path: Path) -> None:
    """Remove a temporary file that a killed command left; other files are kept.

    Raises:
        OSError: it is locked, or cannot be removed.
    """
    named = re.fullmatch(_OF_INODE, path.name)
    if named is None:
        return
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        status = os.fstat(handle)
        if stat.S_ISREG(status.st_mode) and status.st_ino == int(named[1], 16):
            _lock(handle)
            path.unlink()
    finally:
        os.close(handle)


def _lock(handle: int) -> None:
    """Lock a file until it is closed or this process ends.

    Raises:
        OSError: another process has locked it, or it cannot be locked here.
    """
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
