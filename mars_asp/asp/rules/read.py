"""Files of rules and of cases, read with everything that is wrong with them."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from mars_asp.asp.rules.arithmetic import overflows
from mars_asp.asp.rules.checks import (
    Contract,
    Seal,
    called_functions,
    misplaced_statements,
    misused_heads,
    refused_rules,
    repeated_constants,
    reserved_heads,
    unknown_predicates,
)
from mars_asp.asp.rules.declarations import Docstring, Documented, docstrings
from mars_asp.asp.rules.expansions import Expansions
from mars_asp.asp.rules.gate import check_text, gate_text
from mars_asp.asp.rules.metadata import file_name, repeated_ids, rules_of, wrong_holes
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import (
    Piece,
    RuleSyntaxError,
    defined,
    pieces,
    statements_of,
)
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point


class RuleFile(NamedTuple):
    """A file of rules: its path as it is shown, its stage, and its text.

    Besides them what the text is made of, its rules, and the comments that declare predicates.
    """

    shown: str
    stage: str
    text: str
    written: tuple[Piece, ...]
    rules: tuple[Rule, ...]
    docstrings: tuple[Docstring, ...] = ()

    @property
    def documented(self) -> Documented:
        """Return what it declares of predicates."""
        return Documented(self.stage, self.shown, self.docstrings)

    @property
    def name(self) -> str:
        """Return what the ids of its rules begin with."""
        return file_name(self.shown, self.stage)


def read_case(path: Path) -> tuple[str, tuple[Piece, ...]]:
    """Return the text of a case for the rules, and what it is made of.

    Raises:
        MarsError: it may not be given to clingo.
    """
    text = gate_text(path, str(path))
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


def _pieces(text: str, shown: str, problems: list[Diagnostic]) -> tuple[Piece, ...]:
    """Return what a text is made of; nothing where clingo cannot parse it."""
    try:
        return tuple(pieces(text))
    except RuleSyntaxError as error:
        problems += (_syntax(note, shown) for note in error.notes[:20])
    return ()


def read_file(
    path: Path,
    shown: str,
    stage: str,
    problems: list[Diagnostic],
    strict: bool,
    expansions: Expansions = MappingProxyType({}),
) -> RuleFile | None:
    """Return a file; `None` where it cannot be read as rules, and `problems` say why.

    When `strict`, numbers and the holes of messages are checked, too. `expansions` are what keys of
    metadata stand for besides.
    """
    try:
        text = gate_text(path, shown)
    except MarsError as error:
        problems += error.diagnostics
        return None
    return _rule_file(text, shown, stage, problems, strict, expansions)


def read_rules(
    text: str,
    shown: str,
    stage: str,
    problems: list[Diagnostic],
    expansions: Expansions = MappingProxyType({}),
) -> RuleFile | None:
    """Return a text as if it were a file of rules, all of it checked."""
    try:
        check_text(text, shown)
    except MarsError as error:
        problems += error.diagnostics
        return None
    return _rule_file(text, shown, stage, problems, True, expansions)


def _rule_file(
    text: str,
    shown: str,
    stage: str,
    problems: list[Diagnostic],
    strict: bool,
    expansions: Expansions,
) -> RuleFile | None:
    before = len(problems)
    written = _pieces(text, shown, problems)
    if len(problems) > before:
        return None
    if strict:
        problems += overflows(text, shown)
    rules = tuple(rules_of(written, shown, stage, problems, strict, expansions))
    if strict:
        problems += [problem for rule in rules for problem in wrong_holes(rule)]
        problems += _wrong_lists(rules)
    return RuleFile(shown, stage, text, written, rules, tuple(docstrings(written)))


def _wrong_lists(rules: Iterable[Rule]) -> Iterator[Diagnostic]:
    """Yield what clingo would say of rules that metadata stands for, at the place of that.

    What it says of the rule above which that stands, it is not asked again.
    """
    said: set[str] = set()
    for rule in rules:
        if rule.listed is None:
            said = {each.message for each in _refused(rule)} if rule.lists else set()
        else:
            found = (each for each in _refused(rule) if each.message not in said)
            yield from (replace(each, span=rule.listed) for each in found)


def _refused(rule: Rule) -> tuple[Diagnostic, ...]:
    # Of some numbers that do not fit clingo itself ends the process.
    found = tuple(overflows(rule.text, rule.span.path))
    return found or tuple(refused_rules(rule.text, rule.span.path))


def wrong_packs(
    packs: Sequence[RuleFile], sealed: Seal, contract: Contract
) -> Iterator[Diagnostic]:
    """Yield all that packs may not do, and what would make nothing of their rules."""
    rules = [rule for file in packs for rule in file.rules]
    read = statements_of(rule.text for rule in rules)
    known = {each for file in packs for each in defined(file.text)} - sealed.later.keys()
    known |= sealed.early | {signature for rule in rules for signature in rule.heads}
    for file in packs:
        yield from misplaced_statements(file.written, sealed, contract, file.shown)
        overflowing = tuple(overflows(file.text, file.shown))
        # Of some numbers that do not fit clingo itself ends the process.
        yield from () if overflowing else refused_rules(file.text, file.shown)
    yield from repeated_constants((file.shown, piece) for file in packs for piece in file.written)
    said: set[str] = set()
    for rule in rules:
        found = (
            *reserved_heads(read[rule.text], sealed, contract, rule.span),
            *misused_heads(read[rule.text], rule.text, sealed, contract, rule.span),
            *called_functions(rule.text, rule.span),
            *unknown_predicates(read[rule.text], known, sealed, contract, rule.span),
        )
        if rule.listed is None:
            said = {each.message for each in found}
            yield from found
        else:
            # The body is that of the rule before it, of which all has been said.
            yield from (
                replace(each, span=rule.listed) for each in found if each.message not in said
            )
    yield from repeated_ids(rules, sealed.ids)


def _syntax(note: str, shown: str) -> Diagnostic:
    match = re.match(r"<string>:(\d+):(\d+)(?:-[\d:]+)?: (?:error|info): (.*)", note, re.DOTALL)
    line, column, text = (int(match[1]), int(match[2]), match[3]) if match else (1, 1, note)
    return Diagnostic("rule-syntax", "error", text.strip(), point(shown, line, column))


def told_apart(files: Iterable[RuleFile], taken: Iterable[str] = ()) -> Iterator[RuleFile]:
    """Yield files of which no two name a rule without an id alike.

    Where the name of one is `taken`, or another's, its path stands before the lines of such rules:
    `mine/data.lp:17`.
    """
    names = set(taken)
    for file in files:
        if file.name in names:
            rules = tuple(_named_by_path(rule, file) for rule in file.rules)
            yield file._replace(rules=rules)
        else:
            yield file
        names.add(file.name)


def _named_by_path(rule: Rule, file: RuleFile) -> Rule:
    name = f"{file.name}:"
    if not rule.id.startswith(name):
        return rule
    return replace(rule, id=f"{file.shown}:{rule.id.removeprefix(name)}")


def pack_files(extra: Iterable[Path], problems: list[Diagnostic]) -> Iterator[Path]:
    """Yield the files of packs, each once, of folders those in them; note what is neither."""
    seen: set[Path] = set()
    for path in extra:
        if path.is_dir() or path.is_file():
            for file in sorted(path.glob("*.lp")) if path.is_dir() else [path]:
                if file.resolve() not in seen:
                    seen.add(file.resolve())
                    yield file
        else:
            problems.append(
                Diagnostic(
                    "rules-missing",
                    "error",
                    f"`{path}` is not a file or folder",
                    point(str(path), 1, 1),
                )
            )
