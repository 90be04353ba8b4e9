"""Values that are dear to make, kept with Python's own compiled files.

What is kept is trusted like those files. It is made anew for another version of its maker. Where
Python keeps none of its own it is kept for this process alone. Before it stands a checksum: a file
that was damaged holds nothing, for a value that was read wrongly would be a wrong answer.
"""

import contextlib
import importlib.util
import os
import pickle
import sys
import zlib
from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from mars_asp import __version__

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")
#: Where more values are kept than this, those that the last command did not ask for go.
_MOST = 5000
#: How many bytes of a file are its checksum.
_CHECKSUM = 4
#: What is kept for this process alone: versions and values by their names.
_here: dict[str, tuple[str, object]] = {}


def version_of(files: Iterable[Path]) -> str:
    """Return what changes with any of the files that a value is made from or by."""
    stats = ((path, path.stat()) for path in files)
    told = [f"{path}:{found.st_mtime_ns}:{found.st_size}" for path, found in stats]
    return "\0".join([__version__, sys.version, *told])


def recall(name: str, version: str) -> Any:
    """Return what was kept under a name; `None` where that is nothing, or of another version."""
    if _here.get(name, ("",))[0] == version:
        return _here[name][1]
    try:
        held = _place(name).read_bytes()
        checksum, pickled = held[:_CHECKSUM], held[_CHECKSUM:]
        if _checksum(pickled) != checksum:
            return None
        written, value = pickle.loads(pickled)
    except Exception:  # whatever is wrong with the file, it holds nothing
        return None
    return value if written == version else None


def keep(name: str, version: str, value: object) -> None:
    """Keep a value under a name, whole or not at all."""
    if sys.dont_write_bytecode:
        _here[name] = version, value
        return
    place = _place(name)
    part = place.with_name(f"{place.name}.{os.getpid()}")
    with contextlib.suppress(OSError):
        pickled = pickle.dumps((version, value))
        part.write_bytes(_checksum(pickled) + pickled)
        part.replace(place)


def made_of(
    name: str, files: Iterable[Path], keys: Iterable[_Key], make: Callable[[_Key], _Value]
) -> dict[_Key, _Value]:
    """Return what is made of each key, in their order, kept from one command to the next.

    `files` are those of the maker: what is kept under `name` is made anew when one changes.
    """
    version = version_of(files)
    known: dict[_Key, _Value] = recall(name, version) or {}
    used: dict[_Key, _Value] = {}
    for key in keys:
        used[key] = known[key] if key in known else make(key)
    if not used.keys() <= known.keys():
        keep(name, version, {**known, **used} if len(known) < _MOST else used)
    return used


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(_CHECKSUM, "big")


def _place(name: str) -> Path:
    compiled = Path(importlib.util.cache_from_source(__file__))
    return compiled.with_name(f"{name}.{sys.implementation.cache_tag}.kept")
