"""The sources of a specification: those of its configuration, relative to another folder.

Paths are resolved as the system does it: `..` after a symbolic link is the parent folder of the
link's target.
"""

import glob
import os
from collections.abc import Iterable
from pathlib import Path

from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.language.layout import COMMENT
from mars_asp.model.declarations import Configuration, Name

_UP = os.pardir


def sources_seen_from(
    folder: Path, configuration: Configuration, arguments: Iterable[str] = ()
) -> tuple[Name, ...]:
    """Return the sources of a configuration and of `--sources` as paths relative to a folder.

    Absolute paths remain unchanged, and duplicates are removed.

    Raises:
        MarsError: a resulting path has a character that `@sources` cannot contain.
    """
    declared = [(Path(name.span.path).parent, name) for name in configuration.sources]
    given = [(Path(), Name(path, whole_file(path))) for path in arguments]
    moved = [
        Name(relocated(name.text, origin, folder), name.span)
        for origin, name in (*declared, *given)
    ]
    problems = [_unsayable(name, folder) for name in moved if not _is_sayable(name.text)]
    if problems:
        raise MarsError(problems)
    first: dict[str, Name] = {}
    for name in moved:
        first.setdefault(name.text, name)
    return tuple(first.values())


def relocated(written: str, origin: Path, folder: Path) -> str:
    """Return a path or glob relative to `origin` as one relative to `folder`."""
    here, there = os.path.realpath(folder), os.path.realpath(origin)
    if here == there or Path(written).is_absolute():
        return written
    # In a glob, the folders added before the pattern are escaped.
    literal = not glob.has_magic(written) or (origin / written).exists()
    parts = [part for part in Path(written).parts if part != os.curdir]
    while parts[:1] == [_UP]:
        there, parts = str(Path(there).parent), parts[1:]
    if _UP in parts or not parts:
        # After a symbolic link `..` is the parent of its target, so it is not shortened.
        start = os.path.relpath(there, here)
        return str(Path(start if literal else glob.escape(start), *parts))
    whole = Path(os.path.relpath(Path(there, *parts), here))
    if literal:
        return str(whole)
    kept = len(whole.parts) - len(parts)
    if kept < 0 or whole.parts[kept:] != tuple(parts):
        return str(whole)
    return str(Path(*map(glob.escape, whole.parts[:kept]), *parts))


def _is_sayable(path: str) -> bool:
    return (
        not any(character in path for character in ",\n\r")
        and path == path.strip()
        and path.encode(errors="replace") == path.encode(errors="surrogateescape")
        and COMMENT.search(path) is None
    )


def _unsayable(name: Name, folder: Path) -> Diagnostic:
    return Diagnostic(
        "sources",
        "error",
        f"`{name.text}`, relative to `{folder}`, is not a path that `@sources` can name",
        name.span,
        help="write the specification where the path contains no comma, `#`, `//` or line end",
    )
