"""Files that are changed in an editor and not written yet: what is read of them is what it shows.

>>> with unsaved({"robot.mars": "@modules Camera"}):
...     unsaved_bytes(Path("robot.mars"))
b'@modules Camera'
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

_NONE: Mapping[str, bytes] = {}
_texts: ContextVar[Mapping[str, bytes]] = ContextVar("unsaved", default=_NONE)


@contextmanager
def unsaved(texts: Mapping[str, str]) -> Iterator[None]:
    """Have files read as these texts, by their paths; others are read from the disk."""
    held = {os.path.realpath(path): text.encode("utf-8", "replace") for path, text in texts.items()}
    before = _texts.set(held)
    try:
        yield
    finally:
        _texts.reset(before)


def unsaved_bytes(path: Path) -> bytes | None:
    """Return what an editor holds of a file, as UTF-8; nothing where the disk has it."""
    texts = _texts.get()
    return texts.get(os.path.realpath(path)) if texts else None
