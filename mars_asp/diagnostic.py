"""Findings and the stretches of files that they are about, as plain values."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeAlias

Severity: TypeAlias = Literal["error", "warning", "note"]

#: The code of notes that list what was not read of a file.
NOT_READ = "not-read"
#: The names of warnings and notes about the input, kinds and codes: they can be ignored.
INPUT_WARNINGS = frozenset(
    "catalogue launch mux not_read not-read annotations-missing module-twice unused-ignore baseline"
    " urdf-mimic urdf-angle MARS204 MARS205 MARS206 MARS207 MARS302 MARS308".split()
) | {"stand-in"}
#: The codes of errors of the input, without those of annotations: they are always reported.
INPUT_ERRORS = frozenset(
    "atom attribute constant costs costs-too-large dora dot encoding external format include kind"
    " pack part ports query ros2 rosgraph rule-clause rule-constant rule-cost rule-declaration"
    " rule-head rule-later rule-metadata rule-number rule-private rule-reserved rule-severity"
    " rule-statement rule-syntax rule-undecided rule-undefined rule-unknown rule-unsafe"
    " rules-include rules-missing rules-refused settings sources sources-missing subject syntax"
    " unfixed unreadable unsatisfiable urdf usage yaml".split()
)
_ANNOTATION = re.compile(r"MARS[0-9]{3}")
#: Longer than any name or path that a person reads, and how much of both ends tells it apart.
_LONG = re.compile(r"\S{301,}")
_KEPT = 100


class Span(NamedTuple):
    """A stretch of one file; spans are in the order of their files.

    Lines and columns count from 1 in code points; a byte order mark counts for nothing; the
    end column is the first one behind the stretch. `path` is shown to users as it stands.
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int


def point(path: str, line: int, column: int) -> Span:
    """Return the empty span at one place."""
    return Span(path, line, column, line, column)


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    `code` is a rule id or a fixed id such as `syntax`; `message` is one lower-case clause with
    names in backticks and no full stop, stating what is the case; `effect` is a sentence on what
    will happen; `help` says what to do; `labels` are other places that help, each with words of its
    own or none; `excerpt` is the line of the file at `span`, empty where that shows nothing. `kind`
    is the kind of a finding, `launch_files` are the launch trees in which it holds.
    """

    code: str
    severity: Severity
    message: str
    span: Span
    labels: tuple[tuple[Span, str], ...] = ()
    help: str | None = None
    excerpt: str | None = None
    effect: str | None = None
    kind: str | None = None
    launch_files: tuple[str, ...] = ()


def brief(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic whose words end within reason: what others wrote has any length."""
    message, help_text, effect = (
        text and _LONG.sub(_cut, text)
        for text in (diagnostic.message, diagnostic.help, diagnostic.effect)
    )
    labels = tuple((span, _LONG.sub(_cut, text)) for span, text in diagnostic.labels)
    return replace(diagnostic, message=message or "", labels=labels, help=help_text, effect=effect)


def _cut(word: re.Match[str]) -> str:
    return f"{word[0][:_KEPT]}...{word[0][-_KEPT:]}"


def is_input_error(name: str) -> bool:
    """Whether a name is the code of an error of the input, which cannot be ignored."""
    if name in INPUT_WARNINGS:
        return False
    return name in INPUT_ERRORS or _ANNOTATION.fullmatch(name) is not None


def by_place(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return diagnostics in the order of their places."""
    return tuple(sorted(diagnostics, key=lambda d: (d.span, d.code, d.message)))


class MarsError(Exception):
    """Raised once per stage, with everything that stage found wrong, sorted by place.

    `status` is how a command ends that is ended by it: 2 for bad input, 1 for what the input means.
    """

    status = 2

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Keep the diagnostics for the command line to render."""
        self.diagnostics = by_place(diagnostics)
        first = self.diagnostics[0]
        more = len(self.diagnostics) - 1
        others = f", and {more} more" if more else ""
        place = f"{first.span.path}:{first.span.line}:{first.span.column}"
        super().__init__(f"{place}: {first.message}{others}")


def refusal(code: str, message: str, place: str, help_text: str | None = None) -> MarsError:
    """Return an error about a word of the command or a whole file, of which no line is shown."""
    where = point(place, 1, 1)
    return MarsError([Diagnostic(code, "error", message, where, help=help_text, excerpt="")])
