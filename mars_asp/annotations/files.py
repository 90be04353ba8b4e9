"""Annotated files of a tree: found by a search over bytes, decoded, read."""

import codecs
import contextlib
import glob
import os
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mars_asp.annotations.languages import LANGUAGES
from mars_asp.annotations.modules import read_modules
from mars_asp.annotations.repeated import repeated
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic, Severity, by_place, point
from mars_asp.model.declarations import Module
from mars_asp.unsaved import unsaved_bytes

MOST_BYTES = 256 * 1024 * 1024
_HERE = Path()
#: What a file must hold to be worth reading, in single bytes and in both orders of UTF-16. Words
#: that other annotations use as well, such as `@Input`, make no file worth reading by themselves.
_MARK = re.compile(
    rb"@(?:[mM][oO][dD][uU][lL][eE]_"
    rb"|(?:Sense|DataOut|ControlOut|DataIn|Converts|(?:Rotn|Trans)_[XYZ])(?![\w:(.@-]))"
)
_MARK_16 = re.compile(rb"(?i)@\0m\0o\0d\0u\0l\0e\0_|\0@\0m\0o\0d\0u\0l\0e")
_PIECE = 1 << 20
_SKIPPED = frozenset({".git", ".hg", ".svn", "node_modules", "__pycache__", ".venv"})


@dataclass(frozen=True, slots=True)
class Extraction:
    """The modules found, in the order of their files, and by place what is wrong or noteworthy."""

    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]


def find_paths(written: str, folder: Path = _HERE) -> list[Path]:
    """Return the files and folders that a path or a glob of a folder names, sorted.

    A glob means the sources among what it matches, if there are some.
    """
    path = folder / written
    if path.exists():
        return [path]
    # `Path.glob` knows no pattern that is absolute or leads upwards.
    pattern = str(Path(glob.escape(str(folder))) / written)
    matches = [Path(match) for match in sorted(glob.glob(pattern, recursive=True))]  # noqa: PTH207
    return [at for at in matches if at.is_dir() or at.suffix.lower() in LANGUAGES] or matches


def extract(paths: Sequence[Path]) -> Extraction:
    """Read the annotated modules of files and folders.

    A path that is not a regular file is passed over inside a folder and reported when it is named.
    A file is read once, by however many paths it is found.
    """
    modules: list[Module] = []
    problems: list[Diagnostic] = []
    for path, status in _files(paths):
        found, wrong = _read(path, status)
        modules += found
        problems += wrong
    problems += repeated(modules)
    return Extraction(tuple(modules), by_place(problems))


def _files(paths: Iterable[Path]) -> Iterator[tuple[Path, os.stat_result | OSError]]:
    """Yield each file once, and what the system says of it."""
    seen: set[tuple[int, int]] = set()
    for path in paths:
        for file, status in _below(path) if path.is_dir() else (_named(path),):
            if isinstance(status, os.stat_result):
                key = status.st_dev, status.st_ino
                if key in seen:
                    continue
                seen.add(key)
            yield file, status


def _named(path: Path) -> tuple[Path, os.stat_result | OSError]:
    try:
        return path, path.stat()
    except OSError as error:
        return path, error


def _below(folder: Path) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield the sources below a folder in order, those of a folder before those in others."""
    folders = [str(folder)]
    while folders:
        try:
            with os.scandir(folders.pop()) as listed:
                entries = sorted(listed, key=lambda entry: entry.name)
        except OSError:
            continue
        inner = []
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                if entry.name not in _SKIPPED:
                    inner.append(entry.path)
            elif _language(entry.name) is not None:
                with contextlib.suppress(OSError):
                    status = entry.stat()
                    if stat.S_ISREG(status.st_mode):
                        yield Path(entry.path), status
        folders += reversed(inner)


def _language(name: str) -> str | None:
    dot = name.rfind(".")
    return LANGUAGES.get(name[dot:].lower()) if dot > 0 else None


def _read(
    path: Path, status: os.stat_result | OSError
) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
    shown = str(path)
    language = _language(path.name)
    if language is None:
        reason, help_text = (
            "is not in a supported language",
            f"supported: {', '.join(sorted(LANGUAGES))}",
        )
        if path.suffix.lower() == ".mars":
            reason = "is a configuration, not a source"
            help_text = "`mars-asp check` and `mars-asp analyse` read it"
        return (), (_about(shown, "MARS306", "error", reason, help_text),)
    try:
        if isinstance(status, OSError):
            raise status
        if not stat.S_ISREG(status.st_mode):
            return (), (_about(shown, "MARS305", "error", "is not a regular file", "name a file"),)
        if status.st_size > MOST_BYTES:
            reason = f"is larger than {MOST_BYTES} bytes and was not read"
            return (), (_about(shown, "MARS301", "error", reason, "split it, or leave it out"),)
        raw = _raw(path)
    except OSError as error:
        reason = f"cannot be read: {error.strerror}"
        return (), (_about(shown, "MARS300", "error", reason, "make it readable"),)
    if not _is_marked(raw):
        return (), ()
    data, encoding, notes = _normalised(raw, shown)
    # Of a large file there is never more than one copy beside the one that is made.
    del raw
    if data is None:
        return (), notes
    modules, problems = read_modules(Source(shown, language, data, encoding))
    return modules, (*notes, *problems)


def _raw(path: Path) -> bytes:
    held = unsaved_bytes(path)
    if held is not None:
        return held
    # A buffer would take twice the time.
    with path.open("rb", buffering=0) as file:
        return file.read()


def read_source(path: Path) -> Source:
    """Read a file again in which annotations were found.

    Raises:
        OSError: it cannot be read any more.
        ValueError: it is no text any more.
    """
    data, encoding, _ = _normalised(_raw(path), str(path))
    language = _language(path.name)
    if data is None or language is None:
        raise ValueError(path)
    return Source(str(path), language, data, encoding)


def reread(found: Extraction, path: str, text: str) -> Extraction:
    """Return an extraction with one of its files as it is with another text."""
    modules, problems = read_modules(read_source(Path(path)).replaced(text))
    kept = [module for module in found.modules if module.span.path != path]
    others = [problem for problem in found.diagnostics if problem.span.path != path]
    return Extraction((*kept, *modules), by_place([*others, *problems]))


def _is_marked(raw: bytes) -> bool:
    return _MARK.search(raw) is not None or (b"\0" in raw and _MARK_16.search(raw) is not None)


def _normalised(raw: bytes, shown: str) -> tuple[bytes | None, str, tuple[Diagnostic, ...]]:
    """Return a file as UTF-8 or Latin-1 without byte order mark, its lines ended by LF."""
    notes: tuple[Diagnostic, ...] = ()
    encoding = "utf-8"
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raw = raw.decode("utf-16", "replace").encode()
        notes = (_about(shown, "MARS304", "note", "is UTF-16", "save it as UTF-8"),)
    elif b"\0" in raw:
        reason = "contains a NUL byte: it is binary and was skipped"
        problem = _about(shown, "MARS302", "warning", reason, "save it as UTF-8 text")
        return None, encoding, (problem,)
    elif not _is_utf8(raw):
        encoding = "latin-1"
        reason = "is not UTF-8 and was read as Latin-1"
        notes = (_about(shown, "MARS303", "note", reason, "save it as UTF-8"),)
    raw = raw.removeprefix(codecs.BOM_UTF8)
    if b"\r" in raw:
        raw = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return raw, encoding, notes


def _is_utf8(raw: bytes) -> bool:
    """Decode piece by piece: a large file would need several times its size."""
    if raw.isascii():
        return True
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        for at in range(0, len(raw), _PIECE):
            decoder.decode(raw[at : at + _PIECE], at + _PIECE >= len(raw))
    except UnicodeDecodeError:
        return False
    return True


def _about(shown: str, code: str, severity: Severity, reason: str, help_text: str) -> Diagnostic:
    return Diagnostic(code, severity, f"`{shown}` {reason}", point(shown, 1, 1), help=help_text)
