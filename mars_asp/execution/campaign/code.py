"""The Python files that runs of a scenario import, and the hashes of what runs depend on."""

import ast
import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path


def imported_code(paths: Iterable[Path]) -> dict[str, bytes]:
    """Return files of behaviours and what these import from beside them, by absolute paths.

    Nothing is run: an import that a function computes is not found.

    Raises:
        OSError: one of the given files cannot be read.
    """
    # The name of the folder counts, not what it may be a link to.
    waiting = [os.path.abspath(path) for path in paths]  # noqa: PTH100
    found: dict[str, bytes] = {}
    while waiting:
        path = waiting.pop()
        if path not in found:
            found[path] = Path(path).read_bytes()
            waiting += map(str, _imports(found[path], Path(path).parent))
    return found


def _imports(source: bytes, folder: Path) -> Iterator[Path]:
    """Yield the files beside a source that it imports, of packages all on the way."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from _files(folder, alias.name)
        elif isinstance(node, ast.ImportFrom):
            parents = (folder, *folder.parents)
            base = parents[min(max(0, node.level - 1), len(parents) - 1)]
            if node.module:
                yield from _files(base, node.module)
            for alias in node.names:
                yield from _files(
                    base, f"{node.module}.{alias.name}" if node.module else alias.name
                )


def _files(folder: Path, name: str) -> Iterator[Path]:
    """Yield the files of a module, which may be in packages, as far as they are in a folder."""
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
    """Return the hash of a text and of files by their names, wherever their folders are."""
    whole = hashlib.sha256(text.encode())
    named = sorted((os.path.basename(path), content) for path, content in files.items())  # noqa: PTH119
    for name, content in named:
        whole.update(os.fsencode(f"\0{name}\0"))
        whole.update(hashlib.sha256(content).digest())
    return whole.hexdigest()
