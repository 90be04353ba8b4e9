"""Annotated files of a tree: found by a search over bytes, decoded, read."""

import os
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mars_asp.annotations.comments import LANGUAGES, lex
from mars_asp.annotations.modules import read_modules
from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.model import Module
from mars_asp.source import point

MOST_BYTES = 256 * 1024 * 1024
#: What a file must hold to be worth reading, in single bytes and in both orders of UTF-16. Words
#: that other annotations use as well, such as `@Input`, make no file worth reading by themselves.
_MARKS = re.compile(
    rb"(?i:@module_|@\0m\0o\0d\0u\0l\0e\0_|\0@\0m\0o\0d\0u\0l\0e)"
    rb"|@(?:Sense|DataOut|ControlOut|DataIn|Converts|(?:Rotn|Trans)_[XYZ])(?![\w:(.@-])"
)
_SKIPPED = frozenset({".git", ".hg", ".svn", "node_modules", "__pycache__", ".venv"})


@dataclass(frozen=True, slots=True)
class Extraction:
    """The modules found, in the order of their files, and what is wrong or noteworthy."""

    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]


def extract(paths: Sequence[Path]) -> Extraction:
    """Read the annotated modules of files and folders.

    A path that is no regular file is passed over inside a folder and reported when it is named.
    """
    modules: list[Module] = []
    problems: list[Diagnostic] = []
    for path, named in _files(paths):
        found, wrong = _read(path, named)
        modules += found
        problems += wrong
    problems += _twice(modules)
    return Extraction(tuple(modules), tuple(problems))


def _files(paths: Iterable[Path]) -> Iterator[tuple[Path, bool]]:
    """Yield each regular file once, and whether it was named itself."""
    seen: set[tuple[int, int]] = set()
    for path in paths:
        if not path.is_dir():
            yield path, True
            continue
        for folder, names, files in os.walk(path):
            names[:] = sorted(name for name in names if name not in _SKIPPED)
            for name in sorted(files):
                if Path(name).suffix.lower() not in LANGUAGES:
                    continue
                file = Path(folder, name)
                try:
                    status = file.stat()
                except OSError:
                    continue
                key = (status.st_dev, status.st_ino)
                if stat.S_ISREG(status.st_mode) and key not in seen:
                    seen.add(key)
                    yield file, False


def _read(path: Path, named: bool) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
    shown = str(path)
    language = LANGUAGES.get(path.suffix.lower())
    if language is None:
        known = ", ".join(sorted(LANGUAGES))
        return (), (
            _about(shown, "MARS306", "error", "is in no known language", f"known: {known}"),
        )
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            return (), (_about(shown, "MARS305", "error", "is no regular file", "name a file"),)
        if status.st_size > MOST_BYTES:
            reason = f"is larger than {MOST_BYTES} bytes and was not read"
            return (), (_about(shown, "MARS301", "error", reason, "split it, or leave it out"),)
        raw = path.read_bytes()
    except OSError as error:
        reason = f"cannot be read: {error.strerror}"
        return (), (_about(shown, "MARS300", "error", reason, "make it readable"),)
    if _MARKS.search(raw) is None:
        return (), ()
    text, notes = _decode(raw, shown)
    if text is None:
        return (), notes
    modules, problems = read_modules(lex(shown, language, text))
    return modules, (*notes, *problems)


def _decode(raw: bytes, shown: str) -> tuple[str | None, tuple[Diagnostic, ...]]:
    notes: tuple[Diagnostic, ...] = ()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = raw.decode("utf-16", "replace")
        notes = (_about(shown, "MARS304", "note", "is UTF-16", "save it as UTF-8"),)
    elif b"\0" in raw:
        reason = "holds a NUL byte: it is binary and was skipped"
        return None, (_about(shown, "MARS302", "warning", reason, "save it as UTF-8 text"),)
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
            reason = "is not UTF-8 and was read as Latin-1"
            notes = (_about(shown, "MARS303", "note", reason, "save it as UTF-8"),)
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n"), notes


def _about(shown: str, code: str, severity: Severity, reason: str, help_text: str) -> Diagnostic:
    return Diagnostic(code, severity, f"`{shown}` {reason}", point(shown, 1, 1), help=help_text)


def _twice(modules: Iterable[Module]) -> Iterator[Diagnostic]:
    first: dict[str, Module] = {}
    for module in modules:
        earlier = first.setdefault(module.name, module)
        if earlier is not module:
            where = earlier.span
            yield Diagnostic(
                "MARS121",
                "error",
                f"module `{module.name}` is annotated twice, first at {where.path}:{where.line}",
                module.named or module.span,
                ((where, "first annotated here"),),
                "give one of the two another name",
            )
