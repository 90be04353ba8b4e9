"""Annotated files of a tree: found by a search over bytes, decoded, read."""

import codecs
import contextlib
import fnmatch
import glob
import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from itertools import islice
from operator import attrgetter
from pathlib import Path
from types import MappingProxyType

from mars_asp.annotations.languages import LANGUAGES
from mars_asp.annotations.modules import read_modules
from mars_asp.annotations.repeated import repeated
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import (
    Diagnostic,
    MarsError,
    Severity,
    Span,
    by_place,
    point,
    refusal,
    whole_file,
)
from mars_asp.model.declarations import Module
from mars_asp.reading import (
    KERNEL,
    OUTSIDE,
    files_read,
    hide_lines,
    holds_home,
    is_kernels,
    is_outside,
    overlay_bytes,
)

MOST_BYTES = 256 * 1024 * 1024
#: Files and folders below one path or glob.
MOST_ENTRIES = 1_000_000
_HERE = Path()
#: A mark that a file must contain to be read, in single bytes and in both byte orders of UTF-16.
#: Words that other tools use as well, such as `@Input`, are not sufficient.
_MARK = re.compile(
    rb"@(?:[mM][oO][dD][uU][lL][eE]_"
    rb"|(?:Sense|DataOut|ControlOut|DataIn|Converts|(?:Rotn|Trans)_[XYZ])(?![\w:(.@-]))"
)
_MARK_16 = re.compile(rb"(?i)@\0m\0o\0d\0u\0l\0e\0_|\0@\0m\0o\0d\0u\0l\0e")
_SMALLER = "name the folders of the sources alone"
_SKIPPED = frozenset({".git", ".hg", ".svn", "node_modules", "__pycache__", ".venv"})


@dataclass(frozen=True, slots=True)
class Extraction:
    """The modules found, in the order of their files, and the diagnostics, by location."""

    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]


def find_paths(written: str, folder: Path = _HERE, entries: "Entries | None" = None) -> list[Path]:
    """Return the files and folders that match a path or a glob within a folder, sorted.

    A glob means the sources among its matches, if there are some. `entries` are shared by
    several calls.

    Raises:
        MarsError: too many folders would have to be listed.
    """
    path = folder / written
    if path.exists():
        return [path]
    pattern = Path(written)
    start = Path(pattern.anchor) if pattern.is_absolute() else folder
    found: dict[Path, None] = {}
    _match(start, pattern.parts[pattern.is_absolute() :], found, set(), entries or Entries())
    matches = sorted(found, key=str)
    return [at for at in matches if at.is_dir() or at.suffix.lower() in LANGUAGES] or matches


def _match(
    folder: Path,
    parts: Sequence[str],
    found: dict[Path, None],
    seen: set[tuple[str, int]],
    entries: "Entries",
) -> None:
    """Add to `found` the paths below a folder that match the parts of a glob.

    `seen` are the visited pairs of folder and remaining parts, `entries` lists folders.
    """
    key = os.path.realpath(folder), len(parts)
    if not parts or key in seen or key[0] in KERNEL:
        if not parts and os.path.lexists(folder):
            found[folder] = None
        return
    seen.add(key)
    first, *rest = parts
    if not glob.has_magic(first):
        _match(folder / first, rest, found, seen, entries)
        return
    is_deep = first == "**"
    if is_deep:
        entries.check_depth(folder)
        _match(folder, rest, found, seen, entries)
    for entry in entries.in_folder(folder):
        is_shown = entry.name[0] != "." or first[0] == "."
        if is_shown and is_deep and (entry.is_dir() or not rest):
            _match(folder / entry.name, parts if entry.is_dir() else (), found, seen, entries)
        elif is_shown and not is_deep and fnmatch.fnmatchcase(entry.name, first):
            if not rest or entry.is_dir():
                _match(folder / entry.name, rest, found, seen, entries)


@dataclass
class Entries:
    """Lists folders, up to a limit of entries in total.

    `named_in` is the file that names the folders, or None if the user names them.
    """

    named_in: str | None = None
    left: int = field(default_factory=lambda: MOST_ENTRIES)

    def check_depth(self, folder: str | Path) -> None:
        """Check that the whole tree below a folder may be listed.

        Raises:
            MarsError: a file names a folder with everything that a user has.
        """
        if self.named_in is not None and holds_home(folder):
            message = f"`{folder}` holds all files of a user, not those of a robot"
            raise refusal("MARS307", message, str(folder), _SMALLER)

    def in_folder(self, folder: str | Path) -> list[os.DirEntry[str]]:
        """Return the entries of a folder, sorted by name; none if it cannot be read.

        Raises:
            MarsError: the entries exceed the limit, together with all folders before.
        """
        try:
            with os.scandir(folder) as listed:
                entries = sorted(islice(listed, self.left + 1), key=attrgetter("name"))
        except OSError:
            return []
        self.left -= len(entries)
        if self.left < 0:
            message = f"more than {MOST_ENTRIES} files and folders are there to be searched"
            raise refusal("MARS307", message, str(folder), _SMALLER)
        return entries


def extract(
    paths: Sequence[Path],
    named_at: Mapping[Path, Span] = MappingProxyType({}),
    named_in: str = "",
) -> Extraction:
    """Read the annotated modules of files and folders.

    A path that is not a regular file is passed over inside a folder and reported when it is named.
    A file is read once, by however many paths it is found. `named_at` is where some of
    the paths are named in the file `named_in`, or in one that it includes: mistakes in files
    outside of its project are not shown.

    Raises:
        MarsError: a folder holds too many files.
    """
    modules: list[Module] = []
    problems: list[Diagnostic] = []
    for path, file, status in _source_files(paths, named_at, named_in):
        found, wrong = _read_source(file, status)
        if not (found or wrong):
            continue  # most files have no annotations
        place = named_at.get(path)
        # For a folder that the user names, the project of all files in it counts.
        around = str(path / "_" if path.is_dir() else path) if place is None else named_in
        if is_outside(file, around):
            hide_lines(str(file))
            wrong = tuple(_hidden(file, wrong, place))
        elif place is not None and path == file:
            # The file with the name is at fault, if the other one is as a whole.
            wrong = tuple(
                each if each.span.line else replace(each, span=place, excerpt=None)
                for each in wrong
            )
        modules += found
        problems += wrong
    read = {*(each.span for each in modules), *(each.span for each in problems)}
    problems += _unannotated(named_at, read)
    problems += repeated(modules)
    return Extraction(tuple(modules), by_place(problems))


def _unannotated(named_at: Mapping[Path, Span], found: Set[Span]) -> Iterator[Diagnostic]:
    """Yield a warning for each place that names sources without any annotation.

    `found` are the locations of modules and mistakes.
    """
    files = {Path(span.path) for span in found}
    read = files.union(*(file.parents for file in files))
    places: dict[Span, list[Path]] = {}
    for path, place in named_at.items():
        places.setdefault(place, []).append(path)
    for place, paths in places.items():
        if place not in found and read.isdisjoint(paths):
            one = f"no annotated module in `{paths[0]}`"
            message = one if len(paths) == 1 else f"no annotated module in these {len(paths)} paths"
            advice = "annotate a source there, or leave it out"
            yield Diagnostic("annotations-missing", "warning", message, place, help=advice)


def _hidden(file: Path, wrong: Sequence[Diagnostic], place: Span | None) -> Iterator[Diagnostic]:
    """Yield one diagnostic in place of the mistakes in a file outside of the project."""
    if wrong:
        severity = min((each.severity for each in wrong), key=("error", "warning", "note").index)
        message = f"mistakes in `{file}` are not shown: {OUTSIDE}"
        at = place or whole_file(str(file))
        help_text = "give it by --sources to see them"
        yield Diagnostic("MARS308", severity, message, at, help=help_text)


def _source_files(
    paths: Iterable[Path], named_at: Mapping[Path, Span], named_in: str
) -> Iterator[tuple[Path, Path, os.stat_result | OSError]]:
    """Yield (named path, file, status) for each file of some paths, without duplicates.

    Raises:
        MarsError: a folder holds too many files.
    """
    seen: set[tuple[int, int]] = set()
    own, others = Entries(), Entries(named_in)
    for path in paths:
        listed: Iterable[tuple[Path, os.stat_result | OSError]] = (_path_status(path),)
        try:
            if path.is_dir():
                # A folder is listed completely before any file in it is read.
                listed = tuple(_below(path, others if path in named_at else own))
        except MarsError as error:
            place = named_at.get(path)
            raise MarsError(
                each if place is None else replace(each, span=place, excerpt=None)
                for each in error.diagnostics
            ) from None
        for file, status in listed:
            if isinstance(status, os.stat_result):
                key = status.st_dev, status.st_ino
                if key in seen:
                    continue
                seen.add(key)
            yield path, file, status


def _path_status(path: Path) -> tuple[Path, os.stat_result | OSError]:
    try:
        return path, path.stat()
    except OSError as error:
        return path, error


def _below(folder: Path, entries: Entries) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield the sources below a folder, sorted; files of a folder come before its subfolders.

    Raises:
        MarsError: the folder holds too many files and folders.
    """
    entries.check_depth(folder)
    folders = [] if is_kernels(folder) else [str(folder)]
    while folders:
        inner = []
        for entry in entries.in_folder(folders.pop()):
            if entry.is_dir(follow_symlinks=False):
                if entry.name not in _SKIPPED and entry.path not in KERNEL:
                    inner.append(entry.path)
            elif _language(entry.name) is not None:
                with contextlib.suppress(OSError):
                    status = entry.stat()
                    if stat.S_ISREG(status.st_mode) and not (
                        entry.is_symlink() and is_kernels(entry.path)
                    ):
                        yield Path(entry.path), status
        folders += reversed(inner)


def _language(name: str) -> str | None:
    dot = name.rfind(".")
    return LANGUAGES.get(name[dot:].lower()) if dot > 0 else None


def _read_source(
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
        return (), (_file_diagnostic(shown, "MARS306", "error", reason, help_text),)
    try:
        if isinstance(status, OSError):
            raise status
        if not stat.S_ISREG(status.st_mode) or is_kernels(path):
            return (), (
                _file_diagnostic(shown, "MARS305", "error", "is not a regular file", "name a file"),
            )
        if status.st_size > MOST_BYTES:
            reason = f"is larger than {MOST_BYTES} bytes and was not read"
            return (), (
                _file_diagnostic(shown, "MARS301", "error", reason, "split it, or leave it out"),
            )
        raw = _raw(path, status.st_size)
        files_read.add((status.st_dev, status.st_ino))
    except OSError as error:
        reason = f"cannot be read: {error.strerror}"
        return (), (_file_diagnostic(shown, "MARS300", "error", reason, "make it readable"),)
    if not (_MARK.search(raw) or (b"\0" in raw and _MARK_16.search(raw))):
        return (), ()
    text, notes = _decoded(raw, shown)
    if text is None:
        return (), notes
    modules, problems = read_modules(Source(shown, language, text))
    return modules, (*notes, *problems)


def _raw(path: Path, most: int = MOST_BYTES) -> bytes:
    held = overlay_bytes(path)
    if held is not None:
        return held
    # With a buffer, reading takes twice the time.
    with path.open("rb", buffering=0) as file:
        return file.read(most)


def read_source(path: Path) -> Source:
    """Read a file again after annotations were found in it.

    Raises:
        OSError: it cannot be read any more.
        ValueError: it is not text any more.
    """
    text, _ = _decoded(_raw(path), str(path))
    language = _language(path.name)
    if text is None or language is None:
        raise ValueError(path)
    return Source(str(path), language, text)


def reread(found: Extraction, path: str, text: str) -> Extraction:
    """Return an extraction in which the file at `path` has the content `text`."""
    language = _language(Path(path).name)
    assert language is not None, "the file is a source"
    modules, problems = read_modules(Source(path, language, text))
    kept = [module for module in found.modules if module.span.path != path]
    others = [problem for problem in found.diagnostics if problem.span.path != path]
    return Extraction((*kept, *modules), by_place([*others, *problems]))


def _decoded(raw: bytes, shown: str) -> tuple[str | None, tuple[Diagnostic, ...]]:
    """Return the text of a file without byte order mark, its lines ended by LF; None if binary."""
    notes: tuple[Diagnostic, ...] = ()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = raw.decode("utf-16", "replace").removeprefix("\ufeff")
        notes = (_file_diagnostic(shown, "MARS304", "note", "is UTF-16", "save it as UTF-8"),)
    elif b"\0" in raw:
        reason = "contains a NUL byte: it is binary and was skipped"
        return None, (
            _file_diagnostic(shown, "MARS302", "warning", reason, "save it as UTF-8 text"),
        )
    else:
        raw = raw.removeprefix(codecs.BOM_UTF8)
        try:
            text = raw.decode()
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
            reason = "is not UTF-8 and was read as Latin-1"
            notes = (_file_diagnostic(shown, "MARS303", "note", reason, "save it as UTF-8"),)
    return text.replace("\r\n", "\n").replace("\r", "\n"), notes


#: NUL bytes, Latin-1 and UTF-16.
_ENCODINGS = ("MARS302", "MARS303", "MARS304")


def _file_diagnostic(
    shown: str, code: str, severity: Severity, reason: str, help_text: str
) -> Diagnostic:
    # A problem of the encoding is located at the first line, any other at the whole file.
    span = point(shown, 1, 1) if code in _ENCODINGS else whole_file(shown)
    return Diagnostic(code, severity, f"`{shown}` {reason}", span, help=help_text, excerpt="")
