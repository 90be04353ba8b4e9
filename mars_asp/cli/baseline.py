"""Baselines: files that list known findings, so that only new findings are reported.

An entry identifies a finding by file, kind, subject and participants, not by its line. A finding
that occurs twice is listed twice. Paths are relative to the folder of the baseline.
"""

import json
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from mars_asp.cli.inputs import STANDARD_INPUT
from mars_asp.cli.worker import read_standard_input
from mars_asp.diagnostic import Diagnostic, MarsError, point, refusal, whole_file
from mars_asp.language.parse import decode, read_bytes
from mars_asp.language.toml_text import long_number
from mars_asp.output import counted
from mars_asp.reasoning.analysis import Consequence

_FORMAT, _VERSION = "mars-baseline", 1
#: Some 200,000 findings.
_MOST_BYTES = 32 * 1024 * 1024
#: A note names at most so many entries without a finding.
_MOST_NAMED = 5
#: The start of each baseline, however it is laid out.
_START = re.compile(rb'\s*\{\s*"format"\s*:\s*"mars-baseline"')
_KEYS = ("file", "kind", "subject", "participants")


class BaselineEntry(NamedTuple):
    """A finding that a baseline lists; sorted entries have the order of the file."""

    file: str
    kind: str
    subject: str
    participants: tuple[str, ...]


class Baseline:
    """Known findings; `path` is shown in messages."""

    def __init__(self, path: str, entries: Iterable[BaselineEntry]) -> None:
        """Store the entries of the baseline at `path`."""
        self.path = path
        self.entries = Counter(entries)
        #: The unused entries.
        self.left = self.entries.copy()

    def takes(self, finding: Consequence | Diagnostic) -> bool:
        """Whether an unused entry of the baseline lists a finding; then the entry is used up."""
        known = known_of(finding, self.path)
        if not self.left[known]:
            return False
        self.left[known] -= 1
        return True

    def unmatched(self, files: Iterable[str]) -> Iterator[Diagnostic]:
        """Yield a note on the unused entries whose file was read or does not exist."""
        others = _of_others(self.left, self.path, files)
        gone = sorted((self.left - others).elements())
        if gone:
            named = [
                f"`{each.kind}({each.subject})` of `{each.file}`" for each in gone[:_MOST_NAMED]
            ]
            more = f" and {len(gone) - _MOST_NAMED} more" if len(gone) > _MOST_NAMED else ""
            matches = "matches" if len(gone) == 1 else "match"
            yield Diagnostic(
                "baseline",
                "note",
                f"{counted(len(gone), 'finding')} of the baseline {matches} nothing any more: "
                f"{', '.join(named)}{more}",
                whole_file(self.path),
                help=f"write it anew: --write-baseline {self.path}",
            )


def known_of(finding: Consequence | Diagnostic, baseline: str) -> BaselineEntry:
    """Return the entry of a finding, or of a message on reading, in the baseline at a path."""
    if isinstance(finding, Diagnostic):
        file = _relative(finding.span.path, baseline)
        return BaselineEntry(file, finding.kind or finding.code, finding.message, ())
    file = _relative(finding.spans[0].path, baseline)
    # What a finding is about may be its file, of which the path depends on the working folder.
    paths = {span.path for span in finding.spans}
    subject, *participants = (
        _relative(name, baseline) if name in paths else name
        for name in (finding.subject, *finding.participants)
    )
    return BaselineEntry(file, finding.kind, subject, tuple(participants))


@cache
def _relative(path: str, baseline: str) -> str:
    """Return a path relative to the baseline's folder; names like `<stdin>` stay unchanged."""
    if path.startswith("<"):
        return path
    folder = os.path.realpath(Path(baseline).parent)
    return Path(os.path.relpath(os.path.realpath(path), folder)).as_posix()


def _of_others(
    entries: Counter[BaselineEntry], baseline: str, files: Iterable[str]
) -> Counter[BaselineEntry]:
    """Return the entries whose file exists and is none of those that were read."""
    read = {_relative(path, baseline) for path in files}
    folder = Path(baseline).parent
    names = {entry.file for entry in entries} - read
    there = {name for name in names if (folder / name).exists()}
    return Counter({entry: count for entry, count in entries.items() if entry.file in there})


def entries_of_others(path: str, files: Iterable[str]) -> Counter[BaselineEntry]:
    """Return the entries of the baseline at a path that are about none of the files.

    Raises:
        MarsError: the file at the path is not a baseline that can be read.
    """
    if path == STANDARD_INPUT or not Path(path).is_file() or not Path(path).stat().st_size:
        return Counter()
    # The command replaces the file, so it does not count as an input.
    with Path(path).open("rb") as file:
        old = _parsed(file.read(_MOST_BYTES + 1), path)
    return _of_others(old.entries, path, files)


def baseline_text(entries: Iterable[BaselineEntry]) -> str:
    """Return the text of a baseline: its entries, sorted, one a line."""
    lines = [json.dumps(entry._asdict(), ensure_ascii=False) for entry in sorted(entries)]
    inside = "".join(f"\n  {line}," for line in lines).removesuffix(",")
    end = "\n" if lines else ""
    return f'{{"format": "{_FORMAT}", "version": {_VERSION}, "findings": [{inside}{end}]}}\n'


def check_replaceable(path: str) -> None:
    """Raise MarsError if a path has a file that is neither empty nor a baseline.

    Raises:
        MarsError: a file is there that is neither empty nor a baseline.
    """
    # Opening a pipe would block, and an unreadable file cannot be written either.
    if not os.path.isfile(path) or not os.access(path, os.R_OK):  # noqa: PTH113 -- never raises
        return
    with Path(path).open("rb") as file:
        start = file.read(200)
    if start.strip() and _START.match(start) is None:
        message = "the file is not a baseline, so no baseline replaces it"
        help_text = "give the baseline another name, or delete the file first"
        raise refusal("baseline", message, path, help_text)


def read_baseline(path: str) -> Baseline:
    """Read a baseline.

    Raises:
        MarsError: the file cannot be read, or is not a baseline.
    """
    is_input = path == STANDARD_INPUT
    raw = read_standard_input(_MOST_BYTES + 1) if is_input else read_bytes(Path(path), _MOST_BYTES)
    return _parsed(raw, path)


def _parsed(raw: bytes, path: str) -> Baseline:
    text = decode(raw, path, _MOST_BYTES)
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise _baseline_error(
            path, f"the baseline is not JSON: {error.msg}", error.lineno, error.colno
        ) from None
    except RecursionError:
        raise _baseline_error(path, "the JSON is nested too deep for a baseline") from None
    except ValueError:  # more digits than Python reads
        place = long_number(text, path)
        message = "a number with more than 4300 digits"
        raise _baseline_error(path, message, place.line, place.column) from None
    if not isinstance(document, dict) or document.get("format") != _FORMAT:
        raise _baseline_error(path, f'a baseline begins with {{"format": "{_FORMAT}"')
    version = document.get("version")
    if version != _VERSION:
        message = f"this baseline has version {json.dumps(version)}; only {_VERSION} is read"
        raise _baseline_error(path, message)
    listed = document.get("findings")
    if not isinstance(listed, list):
        raise _baseline_error(path, "`findings` must be a list")
    return Baseline(path, [_entry(path, number, each) for number, each in enumerate(listed, 1)])


def _entry(path: str, number: int, value: object) -> BaselineEntry:
    """Return entry `number` of the baseline at `path`, as read from its JSON `value`.

    Raises:
        MarsError: the value is not an entry.
    """
    fields = [value.get(key) for key in _KEYS] if isinstance(value, dict) else []
    match fields:
        case [str(file), str(kind), str(subject), list(participants)] if all(
            isinstance(each, str) for each in participants
        ):
            return BaselineEntry(file, kind, subject, tuple(participants))
    keys = ", ".join(f"`{key}`" for key in _KEYS)
    raise _baseline_error(path, f"entry {number} of `findings` must be an object with {keys}")


def _baseline_error(path: str, message: str, line: int = 1, column: int = 1) -> MarsError:
    help_text = "name a file that `--write-baseline` wrote"
    place = point(path, line, column)
    return MarsError((Diagnostic("baseline", "error", message, place, help=help_text),))
