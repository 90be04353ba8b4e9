"""Values that are dear to make, made of what is known when the package is built.

`hatch_build.py` has `written` what a build makes, by the names of tables; nothing is written when
the program runs. A table counts while the files of its maker are those that made it and a checksum
holds. What no table holds is made, and kept for the process.

A table's file is a checksum and, in the form of `marshal`, the digest of its maker's files, the
names of classes, small values that stand in many others, and pairs of keys and values; a value is
packed by itself, for most commands ask for few.
"""

import marshal
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence, Set
from functools import cache
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import Any, TypeVar
from zlib import adler32, crc32

_Key = TypeVar("_Key", bound=Hashable)
_Value = TypeVar("_Value")
#: Where the tables are.
FOLDER = Path(__file__).parents[1] / "__tables__"
#: Where more values of one name were made than this, they are forgotten.
_MOST = 5000
#: Every Python from 3.4 on reads it.
_VERSION = 4
_CHECKSUM = 4
#: Of what a small value is made that many others have.
_SMALL = (bool, int, str, frozenset, tuple)
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
            value = held.value(key)
            known[key] = make(key) if value is _NOTHING else value
        found[key] = known[key]
    return found


#: Stands for what a table does not hold.
_NOTHING = object()
#: What another Python's `marshal` raises, and classes that are not what they were.
_UNREADABLE = (ValueError, EOFError, TypeError, AttributeError, ImportError, LookupError)
#: Files whose values stand in all tables.
_COMMON = (
    Path(__file__),
    Path(__file__).with_name("signature.py"),
    Path(__file__).parents[1] / "diagnostic.py",
)


class _Table:
    """What a table holds, packed, by its keys."""

    def __init__(
        self, pairs: Iterable[tuple[Any, bytes]], classes: Sequence[str], shared: Iterable[Any]
    ) -> None:
        self._classes = classes
        self._shared = [_class(classes[number])(*parts) for number, *parts in shared]
        self.packed = {self._unpacked(key): value for key, value in pairs}

    def value(self, key: object) -> Any:
        packed = self.packed.get(key)
        if packed is None:
            return _NOTHING
        try:
            return self._unpacked(marshal.loads(packed))
        except _UNREADABLE:
            return _NOTHING

    def _unpacked(self, form: Any) -> Any:
        if type(form) is not list:
            return form
        sort, *rest = form
        if sort in _CONTAINERS:
            return _CONTAINERS[sort](map(self._shared.__getitem__, rest))
        if sort == "shared":
            return self._shared[rest[0]]
        shared, unpacked = self._shared, self._unpacked
        # Most of what has to be made again is shared, and each call costs as much as what it does.
        parts = [
            part
            if type(part) is not list
            else shared[part[1]]
            if part[0] == "shared"
            else unpacked(part)
            for part in rest
        ]
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
        kind = _class(self._classes[sort])
        if parts[0] is None:
            return kind(*parts[1:])
        value = kind.__new__(kind)
        value.__dict__.update(zip(parts[0], parts[1:], strict=True))
        return value


#: How containers are made that hold shared values alone, by their numbers.
_CONTAINERS: Mapping[str, Callable[[Iterable[Any]], Any]] = {
    "tuple of shared": tuple,
    "frozenset of shared": frozenset,
}


@cache
def _held(name: str, files: tuple[Path, ...]) -> _Table:
    """Return a table; an empty one where its file is not there, not whole, or of other makers."""
    try:
        content = (FOLDER / name).read_bytes()
        held = memoryview(content)[_CHECKSUM:]
        if _checksum(held) == content[:_CHECKSUM]:
            maker, classes, shared, pairs = marshal.loads(held)
            if maker == _digest(files):
                return _Table(pairs, classes, shared)
    except (OSError, *_UNREADABLE):
        pass
    return _Table((), (), ())


def _checksum(content: bytes | memoryview) -> bytes:
    """Return what shows that a file was damaged, which is all that it is for."""
    return crc32(content).to_bytes(_CHECKSUM, "big")


def digest(content: bytes) -> bytes:
    """Return what changes with a content that somebody edits, without a library to be loaded."""
    found = (len(content), crc32(content), adler32(content))
    return b"".join(number.to_bytes(8, "big") for number in found)


def _digest(files: Iterable[Path]) -> bytes:
    """Return what changes with any of the files that values are made by."""
    return b"".join(map(_digest_of, (*_COMMON, *files)))


@cache
def _digest_of(file: Path) -> bytes:
    return digest(file.read_bytes())


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
        packer = _Packer()
        pairs = [
            (packer.packed(key), marshal.dumps(packer.packed(value), _VERSION))
            for key, value in known.items()
        ]
        pairs.sort(key=repr)
        shared = [[number, *parts] for number, parts, _ in packer.shared]
        held = (_digest(_makers[name]), tuple(packer.classes), shared, pairs)
        content = marshal.dumps(held, _VERSION)
        yield name, _checksum(content) + content


class _Packer:
    """Packs values for one table."""

    def __init__(self) -> None:
        #: The names of classes by their numbers, and small values that stand in many others.
        self.classes: dict[str, int] = {}
        self.shared: dict[tuple[int, tuple[Any, ...], tuple[type, ...]], int] = {}

    def packed(self, value: Any) -> Any:
        """Return a value as `marshal` takes it; a list stands for what has to be made again.

        A list begins with what it stands for, a class by its number. Behind a class stand the names
        of what a value knows, or `None` where it is made of its fields.

        Raises:
            TypeError: it is no value of ours.
        """
        if value is None or isinstance(value, bool | int | str | bytes):
            return value
        if type(value) in (tuple, list, dict) or isinstance(value, Set):
            return self._container(value)
        kind = type(value)
        if not kind.__module__.startswith("mars_asp."):
            raise TypeError(f"{value!r} cannot be kept in a table")
        number = self.classes.setdefault(
            f"{kind.__module__}:{kind.__qualname__}", len(self.classes)
        )
        if isinstance(value, tuple):
            parts = [self.packed(part) for part in value]
            if all(part is None or isinstance(part, _SMALL) for part in parts):
                # What is equal, as 1 and True are, need not be the same.
                key = (number, tuple(parts), tuple(map(type, parts)))
                return ["shared", self.shared.setdefault(key, len(self.shared))]
            return [number, None, *parts]
        state = value.__getstate__()
        if isinstance(state, list):  # of a frozen dataclass with slots
            return [number, None, *map(self.packed, state)]
        return [number, tuple(state), *map(self.packed, state.values())]

    def _container(self, value: Any) -> Any:
        """Return a container as it is where none of its parts has to be made again."""
        pairs = value.items() if isinstance(value, dict) else [(None, part) for part in value]
        keys = [self.packed(key) for key, _ in pairs]
        parts = [self.packed(part) for _, part in pairs]
        plain = not any(type(part) is list for part in (*keys, *parts))
        shared = all(type(part) is list and part[0] == "shared" for part in parts) and bool(parts)
        numbers = [part[1] for part in parts] if shared else []
        match value:
            case dict():
                return dict(zip(keys, parts, strict=True)) if plain else ["dict", *keys, *parts]
            case tuple():
                sort = "tuple"
            case Set():
                sort = "frozenset"
            case _:
                return ["list", *parts]
        if shared:
            return [f"{sort} of shared", *numbers]
        if plain:
            return tuple(parts) if sort == "tuple" else frozenset(parts)
        return [sort, *parts]


@cache
def _class(name: str) -> Any:
    module, _, path = name.partition(":")
    return attrgetter(path)(import_module(module))
