"""The Python files that runs of a scenario import, and hashes of files."""

import ast
import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from pathlib import Path


def imported_code(paths: Iterable[Path]) -> dict[str, bytes]:
    """Return behaviour files and the files they import from their folders, by absolute path.

    No file is run, so computed imports are not found.

    Raises:
        OSError: a file cannot be read.
    """
    # Links are not resolved: Python imports from the named folder.
    waiting = [Path(os.path.abspath(path)) for path in paths]  # noqa: PTH100
    folders = {folder for path in waiting for folder in (path.parent, _root(path))}
    found: dict[str, bytes] = {}
    while waiting:
        path = waiting.pop()
        if str(path) not in found:
            found[str(path)] = path.read_bytes()
            waiting += _imports(found[str(path)], path.parent, folders)
    return found


def _root(path: Path) -> Path:
    """Return the folder that contains the outermost package of a file."""
    return next(each for each in path.parents if not (each / "__init__.py").is_file())


def _imports(source: bytes, folder: Path, folders: Iterable[Path]) -> Iterator[Path]:
    """Yield the files in `folders`, or relative to `folder`, that a source imports."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for base, alias in product(folders, node.names):
                yield from _module_files(base, alias.name)
        elif isinstance(node, ast.ImportFrom):
            above = (folder, *folder.parents)[: node.level][-1:]
            for base, alias in product(above or folders, node.names):
                yield from _module_files(base, f"{node.module}.{alias.name}".removeprefix("None."))


def _module_files(folder: Path, name: str) -> Iterator[Path]:
    """Yield the existing files of a module, and of the packages that contain it, in a folder."""
    for part in name.split("."):
        if (file := folder / f"{part}.py").is_file():
            yield file
            return
        folder /= part
        if (package := folder / "__init__.py").is_file():
            yield package
        elif not folder.is_dir():
            return


def hash_of(text: str, files: Mapping[str, bytes]) -> str:
    """Return the hash of a text and of the names and contents of files, without folders."""
    whole = hashlib.sha256(text.encode())
    named = sorted((os.path.basename(path), content) for path, content in files.items())  # noqa: PTH119
    for name, content in named:
        whole.update(os.fsencode(f"\0{name}\0"))
        whole.update(hashlib.sha256(content).digest())
    return whole.hexdigest()
