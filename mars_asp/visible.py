"""Text made safe to show and files written whole."""

import contextlib
import os
import stat
import tempfile
import unicodedata
from pathlib import Path

_HIDDEN = frozenset({"Cc", "Cf", "Cs", "Co", "Zl", "Zp"})


def visible(text: str) -> str:
    r"""Return a text with control, format and surrogate characters escaped, but not `\n`."""
    if text.isascii() and text.replace("\n", "").isprintable():
        return text
    return "".join(map(_visible_character, text))


def _visible_character(character: str) -> str:
    if character == "\n" or unicodedata.category(character) not in _HIDDEN:
        return character
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")


def write_whole(path: str, content: str | bytes) -> None:
    """Write a file whole or not at all; keep its mode and follow links. Text is written as UTF-8.

    Raises:
        OSError: the file cannot be written.
    """
    if isinstance(content, str):
        content = content.encode()
    target = Path(os.path.realpath(path))
    if target.exists() and not stat.S_ISREG(target.stat().st_mode):
        target.write_bytes(content)
        return
    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".mars-asp.")
    except OSError as error:
        # The name of a file that its reader never heard of would say nothing.
        raise type(error)(error.errno, error.strerror, path) from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        mode = stat.S_IMODE(target.stat().st_mode) if target.exists() else 0o666 & ~_umask()
        Path(temporary).chmod(mode)
        Path(temporary).replace(target)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
