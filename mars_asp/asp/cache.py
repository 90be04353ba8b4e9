"""Values that are dear to make, made of what is known when the package is built.

`hatch_build.py` has `written` what a build makes, by the names of tables; nothing is written when
the program runs. A table counts while the files of its maker are those that made it and a checksum
holds. What no table holds is made, and kept for the process.

A table's file is a checksum and, in the form of `marshal`, the digest of its maker's files, the
names of classes, and pairs of keys and values; a value is packed by itself, for most commands ask
for few.
"""

import marshal
from collections.abc import Callable, Hashable, Iterable, Iterator, Set
from functools import cache
from hashlib import sha256
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import Any, TypeVar

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")
#: Where the tables are.
FOLDER = Path(__file__).parents[1] / "__tables__"
#: Where more values of one name were made than this, they are forgotten.
_MOST = 5000
#: Every Python reads it.
_VERSION = 2
_CHECKSUM = sha256().digest_size
#: The values that this process knows, and the files of their makers, by the names of tables.
_known: dict[str, dict[Any, Any]] = {}
_makers: dict[str, tuple[Path, ...]] = {}


def made_of(
    name: str, files: Iterable[Path], keys: Iterable[_Key], make: Callable[[_Key], _Value]
) -> dict[_Key, _Value]:
    """Return what is made of each key, in their order; `files` are those of the maker."""
    makers = _makers.setdefault(name, tuple(files))
    known = _known.setdefault(name, {})
    if len(known) > _MOST:
        known.clear()
    held = _held(name, makers)
    found: dict[_Key, _Value] = {}
    for key in keys:
        if key not in known:
            known[key] = held.value(key) if key in held.packed else make(key)
        found[key] = known[key]
    return found


class _Table:
    """What a table holds, packed, by its keys."""

    def __init__(self, packed: dict[Any, bytes], classes: tuple[str, ...]) -> None:
        self.packed, self._classes = packed, classes

    def value(self, key: object) -> Any:
        return _unpacked(marshal.loads(self.packed[key]), self._classes)


@cache
def _held(name: str, files: tuple[Path, ...]) -> _Table:
    """Return a table; an empty one where its file is not there, not whole, or of other makers."""
    try:
        content = (FOLDER / name).read_bytes()
        if sha256(content[_CHECKSUM:]).digest() != content[:_CHECKSUM]:
            return _Table({}, ())
        maker, classes, pairs = marshal.loads(content[_CHECKSUM:])
        if maker != _digest(files):
            return _Table({}, ())
    except (OSError, ValueError, EOFError, TypeError):  # the last are of another Python's marshal
        return _Table({}, ())
    return _Table({_unpacked(key, classes): value for key, value in pairs}, classes)


def _digest(files: Iterable[Path]) -> bytes:
    """Return what changes with any of the files that values are made by."""
    return sha256(b"".join(map(_digest_of, files))).digest()


@cache
def _digest_of(file: Path) -> bytes:
    return sha256(file.read_bytes()).digest()


# ---- Building ------------------------------------------------------------------------------------


def forget(folder: Path) -> None:
    """Forget what this process knows, and take tables from another folder."""
    global FOLDER  # noqa: PLW0603 -- a build and a test of it are all that ever change it
    FOLDER = folder
    for known in (_known, _makers):
        known.clear()
    for function in (_held, _digest_of):
        function.cache_clear()


def written() -> Iterator[tuple[str, bytes]]:
    """Yield the name and the file of each table that holds what this process knows."""
    for name, known in sorted(_known.items()):
        classes: dict[str, int] = {}
        pairs = [
            (_packed(key, classes), marshal.dumps(_packed(value, classes), _VERSION))
            for key, value in known.items()
        ]
        pairs.sort(key=repr)
        held = (_digest(_makers[name]), tuple(classes), pairs)
        content = marshal.dumps(held, _VERSION)
        yield name, sha256(content).digest() + content


def _packed(value: Any, classes: dict[str, int]) -> Any:
    """Return a value as `marshal` takes it; a list stands for what has to be made again.

    A list begins with what it stands for, a class by its number in `classes`. Behind a class stand
    the names of what a value knows, or `None` where it is made of its fields.

    Raises:
        TypeError: it is no value of ours.
    """
    if value is None or isinstance(value, bool | int | str | bytes):
        return value
    if type(value) in (tuple, list, dict) or isinstance(value, Set):
        return _container(value, classes)
    kind = type(value)
    if not kind.__module__.startswith("mars_asp."):
        raise TypeError(f"{value!r} is not for a table")
    number = classes.setdefault(f"{kind.__module__}:{kind.__qualname__}", len(classes))
    if isinstance(value, tuple):
        return [number, None, *(_packed(part, classes) for part in value)]
    state = value.__getstate__()
    if isinstance(state, list):  # of a frozen dataclass with slots
        return [number, None, *(_packed(part, classes) for part in state)]
    return [number, tuple(state), *(_packed(part, classes) for part in state.values())]


def _container(value: Any, classes: dict[str, int]) -> Any:
    """Return a container as it is where none of its parts has to be made again."""
    pairs = value.items() if isinstance(value, dict) else [(None, part) for part in value]
    keys = [_packed(key, classes) for key, _ in pairs]
    parts = [_packed(part, classes) for _, part in pairs]
    plain = not any(type(part) is list for part in (*keys, *parts))
    match value:
        case dict():
            return dict(zip(keys, parts, strict=True)) if plain else ["dict", *keys, *parts]
        case tuple():
            return tuple(parts) if plain else ["tuple", *parts]
        case Set():
            return frozenset(parts) if plain else ["frozenset", *parts]
    return ["list", *parts]


def _unpacked(form: Any, classes: tuple[str, ...]) -> Any:
    if type(form) is not list:
        return form
    sort, *rest = form
    parts = [_unpacked(part, classes) if type(part) is list else part for part in rest]
    match sort:
        case "tuple":
            return tuple(parts)
        case "frozenset":
            return frozenset(parts)
        case "list":
            return parts
        case "dict":
            half = len(parts) // 2
            return dict(zip(parts[:half], parts[half:], strict=True))
    kind = _class(classes[sort])
    if parts[0] is None:
        return kind(*parts[1:])
    value = kind.__new__(kind)
    value.__dict__.update(zip(parts[0], parts[1:], strict=True))
    return value


@cache
def _class(name: str) -> Any:
    module, _, path = name.partition(":")
    return attrgetter(path)(import_module(module))
