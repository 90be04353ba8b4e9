"""Values that are expensive to compute, memoized from tables that the build of the package writes.

`hatch_build.py` writes the `tables` of what a build has computed; nothing is written when the
program runs. A table is used while the files that compute its values are unchanged and its
checksum is right. A value that no table has is computed, and kept for the process.

A table is a checksum and a pickle of the digest of these files and of the pickled values by their
keys: each value is unpickled by itself, as most commands need few.
"""

import pickle
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeVar
from zlib import adler32, crc32

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")
#: The folder of the tables.
FOLDER = Path(__file__).parents[1] / "__tables__"
#: The maximal number of computed values of one name; beyond it, they are dropped.
_MOST = 5000
_CHECKSUM = 4
#: The values in this process, and the files that compute them, by the names of tables.
_known: dict[str, dict[Any, Any]] = {}
_makers: dict[str, tuple[Path, ...]] = {}
#: Errors of another Python's pickles, and of classes that have changed.
_UNREADABLE = (
    *(pickle.UnpicklingError, ValueError, EOFError, TypeError),
    *(AttributeError, ImportError, LookupError),
)
#: Files whose classes occur in all tables.
_COMMON = (
    Path(__file__),
    Path(__file__).with_name("signature.py"),
    Path(__file__).parents[1] / "diagnostic.py",
)


def memoized(
    name: str, files: Iterable[Path], keys: Iterable[_Key], make: Callable[[_Key], _Value]
) -> dict[_Key, _Value]:
    """Return `make(key)` for each key, in order, from a table of the build where it is current.

    `files` are those that define `make`: a table is outdated if one of them changed.
    """
    makers = _makers.setdefault(name, tuple(files))
    known = _known.setdefault(name, {})
    if len(known) > _MOST:
        known.clear()
    table = _table(name, makers)
    found: dict[_Key, _Value] = {}
    for key in keys:
        if key not in known:
            known[key] = _unpickled(table[key], key, make) if key in table else make(key)
        found[key] = known[key]
    return found


def _unpickled(packed: bytes, key: _Key, make: Callable[[_Key], _Value]) -> _Value:
    try:
        value: _Value = pickle.loads(packed)
    except _UNREADABLE:
        return make(key)
    return value


@cache
def _table(name: str, files: tuple[Path, ...]) -> Mapping[Any, bytes]:
    """Return the pickled values of a table; none if it is missing, damaged or outdated."""
    try:
        content = (FOLDER / name).read_bytes()
        packed = memoryview(content)[_CHECKSUM:]
        if _checksum(packed) == content[:_CHECKSUM]:
            maker, values = pickle.loads(packed)
            if maker == _digest(files):
                return dict(values)
    except (OSError, *_UNREADABLE):
        pass
    return {}


def _checksum(content: bytes | memoryview) -> bytes:
    """Return a checksum against damage, not against forgery."""
    return crc32(content).to_bytes(_CHECKSUM, "big")


def digest(content: bytes) -> bytes:
    """Return a digest that detects edits, computed without loading a library."""
    found = (len(content), crc32(content), adler32(content))
    return b"".join(number.to_bytes(8, "big") for number in found)


def _digest(files: Iterable[Path]) -> bytes:
    return b"".join(map(_digest_of, (*_COMMON, *files)))


@cache
def _digest_of(file: Path) -> bytes:
    return digest(file.read_bytes())


# ---- Building ------------------------------------------------------------------------------------


def forget(folder: Path) -> None:
    """Forget the memoized values of this process, and read the tables in another folder."""
    global FOLDER  # noqa: PLW0603 -- a build and a test of it are all that ever change it
    FOLDER = folder
    for known in (_known, _makers):
        known.clear()
    for function in (_table, _digest_of):
        function.cache_clear()


def tables() -> Iterator[tuple[str, bytes]]:
    """Yield name and content of each table with the values that this process has computed."""
    for name, known in sorted(_known.items()):
        values = {key: pickle.dumps(value, pickle.HIGHEST_PROTOCOL) for key, value in known.items()}
        content = pickle.dumps((_digest(_makers[name]), values), pickle.HIGHEST_PROTOCOL)
        yield name, _checksum(content) + content
