"""Rule files: their texts, gated, and the metadata that stands above their rules.

Comments `%! key: text` directly above a rule give it an `id`, a `because` (its message, with
`{Variable}` holes), a `help`, and `fits`: why what it computes fits into 32 bits.
`%*! predicate(Arguments) ... *%` documents a predicate.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from itertools import repeat
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

from mars_asp.asp.cache import keep, recall, version_of
from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules import checks, gate
from mars_asp.asp.rules import statements as reader
from mars_asp.asp.rules.arithmetic import Asked, overflows
from mars_asp.asp.rules.checks import (
    CONSEQUENCE,
    Seal,
    called_functions,
    misplaced_statements,
    misused_heads,
    refused_rules,
    repeated_constants,
    reserved_heads,
    unknown_predicates,
)
from mars_asp.asp.rules.computed import computations
from mars_asp.asp.rules.statements import (
    Piece,
    RuleSyntaxError,
    Signature,
    Statement,
    Tree,
    bound_variables,
    constant_names,
    declared,
    pieces,
    replaced,
    statements,
    statements_of,
    tree,
    unsigned,
)
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.reasoning.facts import compile
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.spelling import nearest

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

    @cached_property
    def written(self) -> tuple[str, str]:
        """Return the head and the body as clingo writes them."""
        return str(self.ast.head), "; ".join(map(str, self.ast.body))

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
        names = ["heads", "reads", "is_choice", "kinds"]
        # Of a rule with a message every question makes another.
        names += ["written"] if self.because is not None else []
        return {**written, **{name: getattr(self, name) for name in names}}

    @property
    def holes(self) -> tuple[str, ...]:
        """Return the variables that `because` and `help` name, each once."""
        return tuple(dict.fromkeys(_HOLE.findall(f"{self.because or ''}{self.help or ''}")))


#: A stage, and a text of it.
_Text: TypeAlias = tuple[str, str]


@dataclass(frozen=True)
class Rulebook:
    """All rules, in the order of their files, and the texts that clingo is given.

    The stage of a file in `rules/` is `base`, in a folder below it the folder's name. The last
    `packs` texts and `pack_rules` rules, all of the base, are from elsewhere. `paths` are those of
    the texts, as they are shown.
    """

    rules: tuple[Rule, ...]
    texts: tuple[_Text, ...]
    packs: int = 0
    pack_rules: int = 0
    paths: tuple[str, ...] = ()

    def text(self, stage: str) -> str:
        """Return the rules of one stage as clingo reads them."""
        return "\n".join(text for at, text in self.texts if at == stage)

    def fragments(self, stage: str) -> tuple[Fragment, ...]:
        """Return the texts of one stage with their files."""
        paths = (*self.paths, *repeat("rules", len(self.texts) - len(self.paths)))
        found = zip(self.texts, paths, strict=True)
        return tuple(Fragment(text, path) for (at, text), path in found if at == stage)

    @cached_property
    def built_in(self) -> "Rulebook":
        """Return the rulebook without packs."""
        if not self.packs:
            return self
        rules = self.rules[: len(self.rules) - self.pack_rules]
        return Rulebook(rules, self.texts[: -self.packs], paths=self.paths[: -self.packs])

    @cached_property
    def asked(self) -> tuple[Asked, ...]:
        """Return what the rules of packs compute that may leave 32 bits."""
        rules = self.rules[len(self.rules) - self.pack_rules :]
        found = computations(rule.text for rule in rules)
        return tuple(Asked(r.span, each) for r in rules for each in found.get(r.text, ()))

    @cached_property
    def replaced(self) -> frozenset[str]:
        """Return the constants that packs replace by other values."""
        packs = self.texts[len(self.texts) - self.packs :]
        return frozenset().union(*(replaced(text) for _, text in packs))

    @cached_property
    def by_id(self) -> dict[str, Rule]:
        """Return the rules by their ids."""
        return {rule.id: rule for rule in self.rules}


class _File(NamedTuple):
    """A file of rules: its path as it is shown, its stage, text, what that is made of and rules."""

    shown: str
    stage: str
    text: str
    written: tuple[Piece, ...]
    rules: tuple[Rule, ...]


def consequence_kinds(rulebook: Rulebook) -> frozenset[str]:
    """Return the kinds of consequence that rules name in their heads."""
    return frozenset().union(*(rule.kinds or () for rule in rulebook.rules))


def rules_directory() -> Path:
    """Return where the built-in rules are: beside the source tree, else in the package."""
    here = Path(__file__).resolve().parents[2]
    beside = here.parent / "rules"
    return beside if (beside / "vocabulary.lp").is_file() else here / "rules"


def load_rulebook(
    extra: Sequence[Path] = (), stages: Sequence[str] = ("resolve",), strict: bool = False
) -> Rulebook:
    """Read the built-in rules of the base and of `stages`, and rule packs from elsewhere.

    The holes of the built-in messages are checked only when `strict`: the tests have done so.

    Raises:
        MarsError: files that cannot be read, that the gate refuses, or whose metadata is wrong, and
            packs that derive or mean what is not theirs.
    """
    problems: list[Diagnostic] = []
    own = _built_in(stages, strict, problems)
    packs: list[_File] = []
    for path in _pack_files(extra, problems):
        found = _read_file(path, str(path), "base", problems, True)
        if found is not None:
            packs.append(found)
    if packs:
        problems += _wrong_packs(packs)
    if strict:
        problems += _repeated(own.rules)
    if problems:
        raise MarsError(problems)
    if not packs:
        return own
    rules = tuple(rule for pack in packs for rule in pack.rules)
    return Rulebook(
        (*own.rules, *rules),
        (*own.texts, *((pack.stage, pack.text) for pack in packs)),
        len(packs),
        len(rules),
        (*own.paths, *(pack.shown for pack in packs)),
    )


def read_case(path: Path) -> tuple[str, tuple[Piece, ...]]:
    """Return the text of a case for the rules, and what it is made of.

    Raises:
        MarsError: it may not be given to clingo.
    """
    text = gate.gate_text(path, str(path))
    written, problems = _case(text, str(path))
    if problems:
        raise MarsError(problems)
    return text, written


@lru_cache(maxsize=1000)
def _case(text: str, shown: str) -> tuple[tuple[Piece, ...], tuple[Diagnostic, ...]]:
    """Return what a case is made of, and all that is wrong with it; many are read again."""
    problems: list[Diagnostic] = []
    written = _pieces(text, shown, problems)
    for piece in written:
        if piece.sort == "rule":
            problems += called_functions(piece.text, Span(shown, *piece.begin, *piece.end))
    if not problems:
        problems += overflows(text, shown)
    # Of some numbers that do not fit clingo itself ends the process.
    if not problems:
        problems += refused_rules(text, shown)
    return written, tuple(problems)


def _built_in(stages: Sequence[str], strict: bool, problems: list[Diagnostic]) -> Rulebook:
    """Return the built-in rules, as they were kept while no file has changed."""
    found = _files(stages)
    name = "-".join(("rules", *stages))
    version = _version(found)
    kept: Rulebook | None = None if strict else recall(name, version)
    if kept is not None:
        return kept
    files = []
    for path, shown, stage in found:
        file = _read_file(path, shown, stage, problems, strict)
        if file is not None:
            files.append(file)
    rules = tuple(rule for file in files for rule in file.rules)
    texts = tuple((file.stage, file.text) for file in files)
    made = Rulebook(rules, texts, paths=tuple(file.shown for file in files))
    if not problems:
        keep(name, version, made)
    return made


def seal() -> Seal:
    """Return what the built-in rules of all stages have for themselves, kept between commands."""
    found = _files(
        [folder.name for folder in sorted(rules_directory().iterdir()) if folder.is_dir()]
    )
    version = _version(found)
    kept: Seal | None = recall("seal", version)
    if kept is not None:
        return kept
    problems: list[Diagnostic] = []
    derived: dict[Signature, str] = {}
    given: dict[Signature, str] = {}
    ids: dict[str, Span] = {}
    constants = set(CONSTANTS)
    for path, shown, stage in found:
        file = _read_file(path, shown, stage, problems, False)
        if file is not None:
            for rule in file.rules:
                derived.update((head, stage) for head in rule.heads if head not in derived)
                ids[rule.id] = rule.span
            given.update((each, stage) for each in declared(file.text) if each not in given)
            constants |= constant_names(file.text)
    made = Seal(derived, given, frozenset(constants), ids)
    if not problems:
        keep("seal", version, made)
    return made


def _files(stages: Iterable[str]) -> list[tuple[Path, str, str]]:
    """Return the built-in files of the base and of stages: path, how it is shown, and stage."""
    root = rules_directory()
    folders = [(root, "base"), *((root / name, name) for name in stages)]
    found = [(path, stage) for folder, stage in folders for path in sorted(folder.glob("*.lp"))]
    return [(path, f"rules/{path.relative_to(root).as_posix()}", stage) for path, stage in found]


def _version(files: Iterable[tuple[Path, str, str]]) -> str:
    makers = map(
        Path, (__file__, compile.__file__, gate.__file__, checks.__file__, reader.__file__)
    )
    return version_of((*makers, *(path for path, _, _ in files)))


def _pieces(text: str, shown: str, problems: list[Diagnostic]) -> tuple[Piece, ...]:
    """Return what a text is made of; nothing where clingo cannot parse it."""
    try:
        return tuple(pieces(text))
    except RuleSyntaxError as error:
        problems += (_syntax(note, shown) for note in error.notes[:20])
    return ()


def _read_file(
    path: Path, shown: str, stage: str, problems: list[Diagnostic], strict: bool
) -> _File | None:
    """Return a file; `None` where it cannot be read as rules, and `problems` say why."""
    before = len(problems)
    try:
        text = gate.gate_text(path, shown)
    except MarsError as error:
        problems += error.diagnostics
        return None
    written = _pieces(text, shown, problems)
    if len(problems) > before:
        return None
    if strict:
        problems += overflows(text, shown)
    rules = tuple(_rules_of(written, shown, stage, path.stem, problems))
    if strict:
        problems += [problem for rule in rules for problem in _wrong_holes(rule)]
    return _File(shown, stage, text, written, rules)


def _wrong_packs(packs: Sequence[_File]) -> Iterator[Diagnostic]:
    """Yield all that packs may not do, and what would make nothing of their rules."""
    sealed = seal()
    rules = [rule for file in packs for rule in file.rules]
    read = statements_of(rule.text for rule in rules)
    known = {each for file in packs for each in declared(file.text)} - sealed.later.keys()
    known |= sealed.early | {signature for rule in rules for signature in rule.heads}
    for file in packs:
        yield from misplaced_statements(file.written, sealed, file.shown)
        overflowing = tuple(overflows(file.text, file.shown))
        # Of some numbers that do not fit clingo itself ends the process.
        yield from () if overflowing else refused_rules(file.text, file.shown)
    yield from repeated_constants((file.shown, piece) for file in packs for piece in file.written)
    for rule in rules:
        yield from reserved_heads(read[rule.text], sealed, rule.span)
        yield from misused_heads(read[rule.text], rule.text, rule.span)
        yield from called_functions(rule.text, rule.span)
        yield from unknown_predicates(read[rule.text], known, sealed, rule.span)
    yield from _repeated(rules, sealed.ids)


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
        if piece.sort != "rule":
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


def _repeated(
    rules: Iterable[Rule], known: Mapping[str, Span] = MappingProxyType({})
) -> Iterator[Diagnostic]:
    first = dict(known)
    for rule in rules:
        earlier = first.setdefault(rule.id, rule.span)
        if earlier is not rule.span and "/" in rule.id:
            yield Diagnostic(
                "rule-metadata",
                "error",
                f"rule id `{rule.id}` is used twice",
                rule.span,
                ((earlier, "first used here"),),
            )


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
