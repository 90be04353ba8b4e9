"""Rule files: their texts, gated, and the metadata that stands above their rules.

Comments `%! key: text` directly above a rule give it an `id`, a `because` (its message, with
`{Variable}` holes), a `help`, and `fits`: why what it computes fits into 32 bits.
`%*! predicate(Arguments) ... *%` documents a predicate.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TypeAlias

from mars_asp import gate, pack
from mars_asp import statements as reader
from mars_asp.arithmetic import overflows
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.kept import keep, recall, version_of
from mars_asp.pack import (
    CONSEQUENCE,
    EXTENSIBLE,
    misused_heads,
    refused_rules,
    unknown_predicates,
)
from mars_asp.source import Span, point
from mars_asp.spelling import nearest
from mars_asp.statements import (
    Piece,
    RuleSyntaxError,
    Signature,
    Statement,
    Tree,
    bound_variables,
    declared,
    pieces,
    replaced,
    statements,
    tree,
    unsigned,
)

KEYS = ("id", "because", "help", "fits")
_METADATA = re.compile(r"%!\s*([A-Za-z_-]+)\s*:\s*(.*)")
_HOLE = re.compile(r"\{([^{}]*)\}")


@dataclass(frozen=True)
class Rule:
    """One rule as it is written, with its metadata and what it says."""

    id: str
    because: str | None
    help: str | None
    span: Span
    text: str
    stage: str
    #: Why what the rule computes fits into 32 bits, where that does not show.
    fits: str | None = None

    @cached_property
    def ast(self) -> Tree:
        """Return clingo's syntax tree of the text, for further rules to be made of it."""
        return tree(self.text)

    @property
    def statements(self) -> tuple[Statement, ...]:
        """Return what the rule says, without pools."""
        return statements(self.text)

    @cached_property
    def heads(self) -> frozenset[Signature]:
        """Return the predicates that the head can derive, without signs of classical negation."""
        return frozenset(unsigned(each) for one in self.statements for each in one.derives)

    def derives(self, signature: Signature) -> bool:
        """Whether the head can derive a predicate, or its contrary."""
        # What does not name it need not be read.
        return signature[0] in self.text and signature in self.heads

    @cached_property
    def reads(self) -> frozenset[Signature]:
        """Return the predicates that the rule reads, without signs, and those that it offers."""
        read = frozenset(unsigned(each) for one in self.statements for each in one.reads)
        return read | self.heads if self.is_choice else read

    @cached_property
    def is_choice(self) -> bool:
        """Whether the rule offers atoms instead of forcing them."""
        return any(statement.offers for statement in self.statements)

    @cached_property
    def kinds(self) -> frozenset[str] | None:
        """Return the kinds of consequence that the rule names; `None` where it can derive any."""
        kinds = {
            head.literal.terms[0].constant
            for statement in self.statements
            for head in statement.heads
            if head.literal.signature == CONSEQUENCE
        }
        return None if None in kinds else frozenset(kind for kind in kinds if kind is not None)

    def __getstate__(self) -> dict[str, object]:
        """Keep what most questions need of what the rule says."""
        written = {field.name: getattr(self, field.name) for field in fields(self)}
        known = {name: getattr(self, name) for name in ("heads", "reads", "is_choice", "kinds")}
        return {**written, **known}

    @property
    def holes(self) -> tuple[str, ...]:
        """Return the variables that `because` and `help` name, each once."""
        return tuple(dict.fromkeys(_HOLE.findall(f"{self.because or ''}{self.help or ''}")))


#: Rules, and texts by their stage.
_BuiltIn: TypeAlias = tuple[tuple[Rule, ...], tuple[tuple[str, str], ...]]


@dataclass(frozen=True)
class Rulebook:
    """All rules, in the order of their files, and the texts that clingo is given.

    The stage of a file in `rules/` is `base`, in a folder below it the folder's name. The last
    `packs` texts, all of the base, are rule packs from elsewhere.
    """

    rules: tuple[Rule, ...]
    texts: tuple[tuple[str, str], ...]
    packs: int = 0

    def text(self, stage: str) -> str:
        """Return the rules of one stage as clingo reads them."""
        return "\n".join(text for at, text in self.texts if at == stage)

    @cached_property
    def replaced(self) -> frozenset[str]:
        """Return the constants that packs replace by other values."""
        packs = self.texts[len(self.texts) - self.packs :]
        return frozenset().union(*(replaced(text) for _, text in packs))

    @cached_property
    def by_id(self) -> dict[str, Rule]:
        """Return the rules by their ids."""
        return {rule.id: rule for rule in self.rules}


def consequence_kinds(rulebook: Rulebook) -> frozenset[str]:
    """Return the kinds of consequence that rules name in their heads."""
    return frozenset().union(*(rule.kinds or () for rule in rulebook.rules))


def rules_directory() -> Path:
    """Return where the built-in rules are: beside the source tree, else in the package."""
    here = Path(__file__).resolve().parent
    beside = here.parent / "rules"
    return beside if (beside / "vocabulary.lp").is_file() else here / "rules"


def load_rulebook(
    extra: Sequence[Path] = (), stages: Sequence[str] = ("resolve",), strict: bool = False
) -> Rulebook:
    """Read the built-in rules of the base and of `stages`, and rule packs from elsewhere.

    The holes of the built-in messages are checked only when `strict`: the tests have done so.

    Raises:
        MarsError: files that cannot be read, that the gate refuses, or whose metadata is wrong.
    """
    problems: list[Diagnostic] = []
    own, written = _built_in(stages, strict, problems)
    rules, texts = list(own), list(written)
    built_in = len(texts)
    for path in _pack_files(extra, problems):
        first, before = len(rules), len(texts)
        _load_file(path, str(path), "base", rules, texts, problems, True)
        problems += _reserved(rules[first:], own)
        problems += (p for r in rules[first:] for p in misused_heads(r.statements, r.text, r.span))
        problems += [
            found for _, text in texts[before:] for found in refused_rules(text, str(path))
        ]
    problems += _unknown(rules, len(own), texts)
    problems += _repeated(rules)
    if problems:
        raise MarsError(problems)
    return Rulebook(tuple(rules), tuple(texts), len(texts) - built_in)


def _built_in(stages: Sequence[str], strict: bool, problems: list[Diagnostic]) -> _BuiltIn:
    """Return the built-in rules and texts, as they were kept while no file has changed."""
    root = rules_directory()
    found = [
        (path, stage)
        for folder, stage in [(root, "base"), *((root / name, name) for name in stages)]
        for path in sorted(folder.glob("*.lp"))
    ]
    name = "-".join(("rules", *stages))
    makers = map(Path, (__file__, gate.__file__, pack.__file__, reader.__file__))
    version = version_of((*makers, *(path for path, _ in found)))
    kept: _BuiltIn | None = None if strict else recall(name, version)
    if kept is not None:
        return kept
    rules: list[Rule] = []
    texts: list[tuple[str, str]] = []
    for path, stage in found:
        shown = "rules/" + path.relative_to(root).as_posix()
        _load_file(path, shown, stage, rules, texts, problems, strict)
    if not problems:
        keep(name, version, (tuple(rules), tuple(texts)))
    return tuple(rules), tuple(texts)


def _load_file(
    path: Path,
    shown: str,
    stage: str,
    rules: list[Rule],
    texts: list[tuple[str, str]],
    problems: list[Diagnostic],
    strict: bool,
) -> None:
    try:
        text = gate.gate_text(path, shown)
        written = tuple(pieces(text))
    except MarsError as error:
        problems += error.diagnostics
        return
    except RuleSyntaxError as error:
        problems += (_syntax(note, shown) for note in error.notes[:20])
        return
    texts.append((stage, text))
    if strict:
        problems += overflows(text, shown)
    found = list(_rules_of(written, shown, stage, path.stem, problems))
    if strict:
        problems += [problem for rule in found for problem in _wrong_holes(rule)]
    rules += found


def _syntax(note: str, shown: str) -> Diagnostic:
    match = re.match(r"<string>:(\d+):(\d+)(?:-[\d:]+)?: (?:error|info): (.*)", note, re.DOTALL)
    line, column, text = (int(match[1]), int(match[2]), match[3]) if match else (1, 1, note)
    return Diagnostic("rule-syntax", "error", text.strip(), point(shown, line, column))


def _rules_of(
    written: Iterable[Piece],
    shown: str,
    stage: str,
    stem: str,
    problems: list[Diagnostic],
) -> Iterator[Rule]:
    pending: dict[str, tuple[str, Span]] = {}
    last_line = 0
    for piece in written:
        if piece.sort == "comment":
            match = _METADATA.match(piece.text)
            if match:
                _note_metadata(pending, match, point(shown, *piece.begin), problems)
                last_line = piece.begin[0]
            continue
        if piece.sort == "other":
            problems += _unbound(pending)
            pending = {}
            continue
        span = Span(shown, *piece.begin, *piece.end)
        if pending and span.line != last_line + 1:
            problems += _unbound(pending)
            pending = {}
        rule = _rule(pending, span, piece.text, stage, stem)
        problems += _wrong_id(rule, pending, stem)
        pending = {}
        yield rule
    problems += _unbound(pending)


def _note_metadata(
    pending: dict[str, tuple[str, Span]],
    match: re.Match[str],
    span: Span,
    problems: list[Diagnostic],
) -> None:
    key, value = match[1], match[2].strip()
    if key not in KEYS:
        near = nearest(key, KEYS)
        help_text = f"did you mean `{near}`?" if near else f"one of {', '.join(KEYS)}"
        problems.append(
            Diagnostic(
                "rule-metadata", "error", f"`{key}` is no metadata key", span, help=help_text
            )
        )
    elif key in pending:
        problems.append(
            Diagnostic("rule-metadata", "error", f"`{key}` stands twice above one rule", span)
        )
    else:
        pending[key] = (value, span)


def _rule(
    metadata: dict[str, tuple[str, Span]], span: Span, text: str, stage: str, stem: str
) -> Rule:
    given = {key: value for key, (value, _) in metadata.items()}
    return Rule(
        given.get("id", f"{stem}:{span.line}"),
        given.get("because"),
        given.get("help"),
        span,
        text,
        stage,
        given.get("fits"),
    )


def _wrong_id(rule: Rule, metadata: dict[str, tuple[str, Span]], stem: str) -> Iterator[Diagnostic]:
    if "id" in metadata and not rule.id.startswith(f"{stem}/"):
        yield Diagnostic(
            "rule-metadata",
            "error",
            f"rule id `{rule.id}` does not start with its file's name",
            metadata["id"][1],
            help=f"write `{stem}/...`",
        )


def _wrong_holes(rule: Rule) -> Iterator[Diagnostic]:
    if not rule.holes:
        return
    bound = bound_variables(rule.text)
    for hole in rule.holes:
        if hole not in bound:
            near = nearest(hole, bound)
            yield Diagnostic(
                "rule-metadata",
                "error",
                f"`{{{hole}}}` in the message of `{rule.id}` is no variable of the rule's body",
                rule.span,
                help=f"did you mean `{{{near}}}`?" if near else None,
            )


def _unbound(metadata: dict[str, tuple[str, Span]]) -> list[Diagnostic]:
    return [
        Diagnostic(
            "rule-metadata",
            "error",
            f"`{key}` does not stand directly above a rule",
            span,
            help="put it on the line above the rule it belongs to",
        )
        for key, (_, span) in list(metadata.items())[:1]
    ]


def _repeated(rules: Iterable[Rule]) -> Iterator[Diagnostic]:
    first: dict[str, Rule] = {}
    for rule in rules:
        earlier = first.setdefault(rule.id, rule)
        if earlier is not rule and "/" in rule.id:
            yield Diagnostic(
                "rule-metadata",
                "error",
                f"rule id `{rule.id}` is used twice",
                rule.span,
                ((earlier.span, "first used here"),),
            )


def _reserved(rules: Iterable[Rule], own: Iterable[Rule]) -> Iterator[Diagnostic]:
    built_in = {signature for rule in own for signature in rule.heads}
    for rule in rules:
        for name, arity in sorted(rule.heads):
            if (name, arity) in built_in - EXTENSIBLE:
                yield Diagnostic(
                    "rule-reserved",
                    "error",
                    f"`{name}/{arity}` is derived by the built-in rules alone",
                    rule.span,
                    help="derive a predicate of your own, or `consequence/4`",
                )


def _unknown(
    rules: Sequence[Rule], built_in: int, texts: Iterable[tuple[str, str]]
) -> Iterator[Diagnostic]:
    """Yield the predicates that only the bodies of packs know."""
    if len(rules) > built_in:
        known = {signature for rule in rules for signature in rule.heads}
        known |= {signature for _, text in texts for signature in declared(text)}
        for rule in rules[built_in:]:
            yield from unknown_predicates(rule.statements, known, rule.span)


def _pack_files(extra: Iterable[Path], problems: list[Diagnostic]) -> Iterator[Path]:
    for path in extra:
        if path.is_dir():
            yield from sorted(path.glob("*.lp"))
        elif path.is_file():
            yield path
        else:
            problems.append(
                Diagnostic(
                    "rules-missing",
                    "error",
                    f"`{path}` is no file or folder",
                    point(str(path), 1, 1),
                )
            )
