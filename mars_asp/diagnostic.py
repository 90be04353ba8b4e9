"""Findings and the stretches of files that they are about, as plain values."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeAlias

Severity: TypeAlias = Literal["error", "warning", "note"]

#: The code of notes that list what was not read of a file.
NOT_READ = "not-read"
#: The meanings of warnings and notes about the input, by kind and by code: they can be ignored.
INPUT_WARNINGS: Mapping[str, str] = {
    "catalogue": "A node is described by the catalogue or by nothing: its code was not read.",
    "launch": "A launch file was read in part, or in every branch of a condition.",
    "mux": "A setting of a mux has no effect, or is not read.",
    "not_read": "A part of a foreign file was not read, so findings that need it are missing.",
    "not-read": "A part of a foreign file was not read, so findings that need it are missing.",
    "annotations-missing": "A name is annotated in no source, and much like one that is.",
    "module-twice": "A module is described twice, and one description counts.",
    "unused-ignore": "A comment `mars: ignore[...]` hides nothing, or names no finding.",
    "baseline": "A baseline was written, or lists a finding that is no longer there.",
    "urdf-mimic": "A joint of URDF moves with another one, which mounts cannot state.",
    "urdf-angle": "An angle of URDF is not a right angle, and is kept.",
    "stand-in": "A comment of a specification names a module or node that is not there.",
    "MARS204": "An `#if` is inside of an annotated declaration.",
    "MARS205": "The output of an annotated function is unknown.",
    "MARS206": "The return type of an annotated function cannot be an output.",
    "MARS207": "Built-in types are used as representations.",
    "MARS302": "A source has NUL bytes, and was skipped.",
    "MARS308": "Mistakes in a source outside of the project are not shown.",
}
#: The meanings of errors of the input by their codes: they are always reported.
INPUT_ERRORS: Mapping[str, str] = {
    "atom": "An atom does not hold, does hold, or cannot be read.",
    "attribute": "An attribute is stated that no rule pack declares, or has a wrong value.",
    "constant": "A constant of a program has no value that clingo takes.",
    "costs": "Costs of a program are too large to be added up.",
    "costs-too-large": "Costs are too large to be added up in 32 bits.",
    "dora": "A dataflow of dora is not as its format asks for.",
    "dot": "A graph in DOT is not as its format asks for.",
    "encoding": "A file is binary, or not in UTF-8.",
    "external": "A value is given for an atom that the program does not declare external.",
    "format": "A file or option names a format that is not read, or formatting failed.",
    "include": "A file that `@include` names cannot be read, or includes itself.",
    "kind": "An option, a setting or a comment names neither a kind of finding nor a rule.",
    "pack": "A rule pack or its manifest is wrong, or a pack is needed and not given.",
    "part": "A program has no part of a name.",
    "ports": "A port is named that cannot be written in `.mars`.",
    "query": "A query of `can` is not `FUNCTION of MODULE`.",
    "ros2": "A file or folder of ROS 2 cannot be read.",
    "rosgraph": "A dump of a ROS graph is not as its format asks for.",
    "rule-clause": "A rule in `verify` names a clause that there is not.",
    "rule-constant": "A rule pack states a constant that is not its own.",
    "rule-cost": "A rule pack minimises on a level that is not its own.",
    "rule-declaration": "A predicate is declared in a way that cannot be read.",
    "rule-head": "A rule pack derives a predicate that is not its own.",
    "rule-later": "A rule reads a predicate that a later stage derives.",
    "rule-metadata": "The lines `%!` above a rule are wrong, or two rules have one id.",
    "rule-number": "A number of a rule exceeds 32 bits.",
    "rule-private": "A rule reads a predicate that is private to the built-in rules.",
    "rule-reserved": "A rule pack derives a predicate of the built-in rules.",
    "rule-severity": "A rule gives a severity other than note, warning and error.",
    "rule-statement": "A rule pack holds a statement that is not allowed in its stage.",
    "rule-syntax": "A rule file is not a logic program.",
    "rule-undecided": "A message depends on a choice.",
    "rule-undefined": "A predicate of a rule, or an operation, is not defined.",
    "rule-unknown": "A rule reads a predicate that no stage derives.",
    "rule-unsafe": "A variable of a rule is not bound by a positive literal.",
    "rules-include": "A file that `#include` names cannot be read.",
    "rules-missing": "A path is not a rule pack, or holds no rules.",
    "rules-refused": "clingo or the gate refuses a rule file.",
    "settings": "The settings in `mars.toml` or `pyproject.toml` are wrong.",
    "sources": "The path of a source cannot be written in `@sources`.",
    "sources-missing": "A path of `@sources` or `--sources` does not exist.",
    "subject": "A question names nothing that there is.",
    "syntax": "A `.mars` file is wrong: the message names what was found and expected.",
    "unfixed": "A repair could not be written to a file.",
    "unreadable": "A file cannot be read.",
    "unrealisable": "No specification realises the configuration.",
    "unsatisfiable": "A program has no answer.",
    "urdf": "A document of URDF is wrong.",
    "usage": "The words of the command do not go together.",
    "yaml": "A file is not YAML as it is read here.",
    "MARS101": "A module is never closed.",
    "MARS102": "A module begins inside of another one.",
    "MARS103": "An annotation is outside of a module.",
    "MARS104": "A module has no `@module_name`.",
    "MARS105": "A `@module_name` has no name.",
    "MARS106": "A module has a second `@module_name`.",
    "MARS107": "The name of a module is invalid.",
    "MARS108": "Nothing follows an override.",
    "MARS109": "A word after `@` is much like an annotation.",
    "MARS110": "An annotation is written with other capitals.",
    "MARS111": "A delivery mode is unknown, or has a wrong argument.",
    "MARS112": "`NotifyAtFrequency` has no frequency.",
    "MARS113": "A frequency is invalid or superfluous.",
    "MARS114": "A function is invalid.",
    "MARS115": "A cost or a bound is invalid.",
    "MARS116": "A vertex is invalid.",
    "MARS117": "A function or vertex is stated twice in a module.",
    "MARS118": "A number is out of range.",
    "MARS119": "There were 500 errors before, and the rest was not read.",
    "MARS120": "A sensor has a motion function.",
    "MARS121": "A module is annotated twice.",
    "MARS122": "After 500 unknown words with `@`, misspelt annotations are no longer found.",
    "MARS123": "`@Guard` is in a module that sends no commands.",
    "MARS124": "Something follows `@Guard`.",
    "MARS125": "`@Tag` or `@Property` has no name, or no value.",
    "MARS201": "Nothing follows an annotation.",
    "MARS202": "The declaration after an annotation is not a function.",
    "MARS203": "An override belongs to no function annotation.",
    "MARS208": "A converter does not have exactly one input.",
    "MARS209": "An annotation names a parameter that is not there.",
    "MARS210": "An override is stated twice.",
    "MARS211": "A name is not a representation.",
    "MARS212": "A declaration has no end.",
    "MARS213": "A declaration has too many annotations.",
    "MARS214": "A declaration is too long.",
    "MARS300": "A source cannot be read.",
    "MARS301": "A source is too large.",
    "MARS303": "A source is read as Latin-1.",
    "MARS304": "A source is read as UTF-16.",
    "MARS305": "A path is not a regular file.",
    "MARS306": "A source is in a language that is not read.",
    "MARS307": "More files and folders are to be searched than are allowed.",
}


@dataclass(frozen=True, slots=True)
class InputCode:
    """The meaning of a code that messages on reading have, and whether `--ignore` takes it."""

    meaning: str
    can_be_ignored: bool


#: All of these codes.
INPUT_CODES: Mapping[str, InputCode] = {
    **{name: InputCode(meaning, False) for name, meaning in INPUT_ERRORS.items()},
    **{name: InputCode(meaning, True) for name, meaning in INPUT_WARNINGS.items()},
}
#: Longer than any name or path that a person reads, and how much of both ends tells it apart.
_LONG = re.compile(r"\S{301,}")
_KEPT = 100
#: The length of the text in the `repr` of an error.
_MOST_SHOWN = 150


class Span(NamedTuple):
    """A location: a range of characters in one file; spans sort by file, then by line and column.

    Lines and columns count from 1 in code points, without a byte order mark; the end column is
    the first one after the range. `path` is shown to users unchanged. Line and column are 0 for a
    whole file, a folder or an option of the command.

    >>> Span("robot.mars", 3, 1, 3, 9).location
    'robot.mars:3:1'
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return self.location

    @property
    def location(self) -> str:
        """The location as `path:line:column`, or the path alone if it has no line."""
        return f"{self.path}:{self.line}:{self.column}" if self.line else self.path


def point(path: str, line: int, column: int) -> Span:
    """Return the empty span at a line and column."""
    return Span(path, line, column, line, column)


def beginning(span: Span) -> Span:
    """Return the empty span where a span begins."""
    return point(span.path, span.line, span.column)


def whole_file(path: str) -> Span:
    """Return the span of a whole file or folder, or of an option of the command."""
    return Span(path, 0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    `code` is a rule id or a fixed id such as `syntax`; `message` is one lower-case clause with
    names in backticks and no full stop, stating a fact; `effect` is a sentence on the consequence
    in a run; `help` is the instruction to fix it; `labels` are related locations, each with a text,
    which may be empty; `excerpt` is the line of the file at `span`, empty if it adds nothing.
    `kind` is the kind of a finding, `launch_files` are the launch trees in which it holds.

    >>> try:
    ...     load("nope.mars")
    ... except MarsError as error:
    ...     print(error.diagnostics[0].code)
    unreadable
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

    @property
    def named_location(self) -> str:
        """The location, empty if it has no line and the message names the path."""
        is_named = not self.span.line and f"`{self.span.path}`" in self.message
        return "" if is_named else self.span.location

    def __str__(self) -> str:
        """Return the location and the message, with the help in parentheses."""
        parts = filter(None, (self.named_location, self.message))
        return f"{': '.join(parts)}{f' ({self.help})' if self.help else ''}"


def brief(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic with very long words cut, as names in foreign files have any length."""
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
    code = INPUT_CODES.get(name)
    return code is not None and not code.can_be_ignored


def by_place(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return diagnostics in the order of their locations."""
    return tuple(sorted(diagnostics, key=lambda d: (d.span, d.code, d.message)))


class MarsError(Exception):
    """Raised once per stage, with all errors of that stage, sorted by location.

    `status` is the exit status of the command: 2 for bad input, 1 for errors in its meaning.

    >>> try:
    ...     load("nope.mars")
    ... except MarsError as error:
    ...     print(error)
    nope.mars: no such file
    """

    status = 2

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Keep the diagnostics for the command line to render."""
        self.diagnostics = by_place(diagnostics)
        super().__init__("\n".join(map(str, self.diagnostics)))

    def __repr__(self) -> str:
        """Return one line of at most 200 characters."""
        message = " ".join(str(self).split())
        shown = message if len(message) <= _MOST_SHOWN else f"{message[:_MOST_SHOWN]}..."
        return f"{type(self).__name__}({shown!r})"


def refusal(code: str, message: str, place: str, help_text: str | None = None) -> MarsError:
    """Return an error about a word of the command or a whole file, of which no line is shown."""
    return MarsError([Diagnostic(code, "error", message, whole_file(place), help=help_text)])
