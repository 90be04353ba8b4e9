"""Files of rules and of cases, read with all their errors."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from mars_asp.asp.rules.arithmetic import overflows
from mars_asp.asp.rules.checks import (
    Contract,
    Reader,
    Seal,
    called_functions,
    costs_too_high,
    misplaced_statements,
    misused_heads,
    refused_rules,
    repeated_constants,
    reserved_heads,
    unknown_predicates,
)
from mars_asp.asp.rules.declarations import Documented, docstrings
from mars_asp.asp.rules.expansions import Expansions
from mars_asp.asp.rules.gate import check_text, gate_text
from mars_asp.asp.rules.metadata import file_name, repeated_ids, rules_of, wrong_holes
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import (
    Piece,
    Place,
    ProgramPart,
    RuleSyntaxError,
    costs,
    defined,
    pieces,
    statements_of,
)
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point


class RuleFile(NamedTuple):
    """A file of rules: its path as it is shown, its stage, and its text.

    `written` are its statements; `rules` and `docstrings` are made from them.
    """

    shown: str
    stage: str
    text: str
    written: tuple[Piece, ...]
    rules: tuple[Rule, ...]
    docstrings: tuple[Piece, ...] = ()
    #: The parts of a caller's own program, each with the location of its begin.
    begins: tuple[tuple[Place, ProgramPart], ...] = ()

    @property
    def documented(self) -> Documented:
        """Return the file's comments that declare predicates, with its stage and path."""
        return Documented(self.stage, self.shown, self.docstrings)

    @property
    def name(self) -> str:
        """Return the common prefix of the ids of the file's rules."""
        return file_name(self.shown, self.stage)


def read_case(path: Path) -> tuple[str, tuple[Piece, ...]]:
    """Return the text of a case for the rules, and its statements.

    Raises:
        MarsError: clingo must not read it.
    """
    text = gate_text(path, str(path))
    written, problems = _case(text, str(path))
    if problems:
        raise MarsError(problems)
    return text, written


@lru_cache(maxsize=5000)
def _case(text: str, shown: str) -> tuple[tuple[Piece, ...], tuple[Diagnostic, ...]]:
    """Return the statements of a case, and all its errors; cached, because many are read again."""
    problems: list[Diagnostic] = []
    written = _pieces(text, shown, problems)
    for piece in written:
        if piece.sort == "rule":
            problems += called_functions(piece.text, Span(shown, *piece.begin, *piece.end))
    if not problems:
        problems += overflows(text, shown)
    # At some numbers that do not fit, clingo ends the process.
    if not problems:
        problems += refused_rules(text, shown)
    return written, tuple(problems)


def _pieces(text: str, shown: str, problems: list[Diagnostic]) -> tuple[Piece, ...]:
    """Return the statements of a text; empty if clingo cannot parse it."""
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
    """Return a file, or None if it cannot be read as rules; reasons are added to `problems`.

    If `strict`, numbers and the holes of messages are checked as well. `expansions` are additional
    metadata keys.
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
    is_own: bool = False,
) -> RuleFile | None:
    """Return a text as a checked file of rules, or None if it cannot be read.

    Errors are added to `problems`; `is_own` is whether it is the caller's own text.
    """
    try:
        check_text(text, shown, is_own)
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
    """Yield clingo's errors in rules made from metadata, at the locations of the metadata.

    Errors that the rule below the metadata has as well are left out.
    """
    concerned = [rule for rule in rules if rule.lists or rule.listed is not None]
    whole = "\n".join(rule.text for rule in concerned)
    # One check of all takes less time than single ones, and hardly ever is there an error.
    if not concerned or not _refused_text(whole, concerned[0].span.path):
        return
    entries: set[str] = set()
    for rule in concerned:
        if rule.listed is None:
            entries = {each.message for each in _refused_text(rule.text, rule.span.path)}
        else:
            refused = _refused_text(rule.text, rule.span.path)
            found = (each for each in refused if each.message not in entries)
            yield from (replace(each, span=rule.listed) for each in found)


def _refused_text(text: str, path: str) -> tuple[Diagnostic, ...]:
    # At some numbers that do not fit, clingo ends the process.
    return tuple(overflows(text, path)) or tuple(refused_rules(text, path))


#: The maximal number of folders of one name that receive different names.
_MOST_SPACES = 1000


class NameSpace(NamedTuple):
    """The files of one pack; `needs` are the packs that its manifest names, or None without one.

    Without a manifest its rules can also read all predicates that rules of earlier stages derive.
    """

    name: str
    files: tuple[RuleFile, ...]
    needs: frozenset[str] | None = None

    @property
    def rules(self) -> tuple[Rule, ...]:
        """Return the rules of its files."""
        return tuple(rule for file in self.files for rule in file.rules)

    def derived(self, stages: Collection[str]) -> frozenset[Signature]:
        """Return the predicates that its rules in some stages derive or `#defined` declares."""
        found = (rule.heads for rule in self.rules if rule.stage in stages)
        facts = (defined(file.text) for file in self.files if file.stage in stages)
        return frozenset().union(*found, *facts)

    @property
    def attributes(self) -> frozenset[Signature]:
        """Return the attributes of modules that it declares, which rules of any stage read."""
        declared = (each for file in self.files for each in file.documented.declarations)
        return frozenset(each.signature for each in declared if each.attribution is not None)

    @property
    def public(self) -> frozenset[Signature]:
        """Return the predicates that other packs may read."""
        declared = (each for file in self.files for each in file.documented.declarations)
        return frozenset(each.signature.unsigned for each in declared if each.public)


def wrong_packs(
    spaces: Sequence[NameSpace], sealed: Seal, contract: Contract
) -> Iterator[Diagnostic]:
    """Yield errors for rules of packs that violate `contract`, or could never fire."""
    files = [file for space in spaces for file in space.files]
    # One call for all takes less time than single ones.
    statements_of(rule.text for file in files for rule in file.rules)
    for file in files:
        yield from misplaced_statements(file.written, file.stage, sealed, contract, file.shown)
        overflowing = tuple(overflows(file.text, file.shown))
        # At some numbers that do not fit, clingo ends the process.
        yield from () if overflowing else refused_rules(file.text, file.shown)
    yield from repeated_constants((file.shown, piece) for file in files for piece in file.written)
    for space in spaces:
        others = [each for each in spaces if each is not space]
        for stage in sorted({file.stage for file in space.files}):
            yield from _wrong_rules(space, _reader(space, stage, others, sealed), sealed, contract)
    yield from repeated_ids((rule for space in spaces for rule in space.rules), sealed.ids)


def _reader(space: NameSpace, stage: str, others: Sequence[NameSpace], sealed: Seal) -> Reader:
    """Return the predicates that rules of a pack in one stage may read."""
    seen = sealed.sees[stage]
    known = sealed.known(stage)
    if space.needs is not None:
        known &= sealed.reserved
    hidden: dict[Signature, str] = {}
    for other in others:
        derived, public = other.derived(seen), other.public
        is_needed = space.needs is None or other.name in space.needs
        known |= derived & public if is_needed else frozenset()
        hidden.update((each, other.name) for each in derived)
    return Reader(stage, known | space.derived(seen) | space.attributes, hidden)


def _wrong_rules(
    space: NameSpace, reader: Reader, sealed: Seal, contract: Contract
) -> Iterator[Diagnostic]:
    """Yield errors for the rules of a pack in the stage of `reader`."""
    rules = [rule for rule in space.rules if rule.stage == reader.stage]
    read = statements_of(rule.text for rule in rules)
    entries: set[str] = set()
    for rule in rules:
        statements = read[rule.text]
        found = (
            *reserved_heads(statements, reader.stage, sealed, contract, rule.span),
            *misused_heads(statements, rule.text, reader.stage, sealed, contract, rule.span),
            *called_functions(rule.text, rule.span),
            *unknown_predicates(statements, reader, sealed, contract, rule.span),
        )
        if rule.listed is None:
            entries = {each.message for each in found}
            yield from found
        else:
            # The rule repeats the body of the rule before it, whose errors are reported already.
            yield from (
                replace(each, span=rule.listed) for each in found if each.message not in entries
            )
    for file in space.files if reader.stage in contract.choosing else ():
        if file.stage == reader.stage:
            found_costs = costs(file.text)
            whole = point(file.shown, 1, 1)
            yield from costs_too_high(found_costs, contract, file.shown)
            yield from unknown_predicates(found_costs, reader, sealed, contract, whole)


def _syntax(note: str, shown: str) -> Diagnostic:
    match = re.match(r"<string>:(\d+):(\d+)(?:-[\d:]+)?: (?:error|info): (.*)", note, re.DOTALL)
    line, column, text = (int(match[1]), int(match[2]), match[3]) if match else (1, 1, note)
    return Diagnostic("rule-syntax", "error", text.strip(), point(shown, line, column))


def with_unique_ids(spaces: Iterable[NameSpace], taken: Iterable[str] = ()) -> Iterator[NameSpace]:
    """Yield packs whose rules have unique ids.

    In a pack with a manifest, ids begin with its name. In other packs, if the name of a file is
    `taken` or repeated, rules without an id are named by the path of the file and their line:
    `mine/data.lp:17`.
    """
    ours = frozenset(taken)
    names = set(ours)
    ids: set[str] = set()
    for space in spaces:
        files: list[RuleFile] = []
        for file in space.files:
            rules = file.rules
            if space.needs is not None:
                stays = "" if space.name in ours else f"{space.name}/"
                rules = tuple(_in_space(rule, space.name, stays) for rule in rules)
            elif file.name in names:
                rules = tuple(_named_by_path(rule, file) for rule in rules)
            names.add(file.name)
            files.append(file._replace(rules=rules))
        found = space._replace(files=tuple(files))
        if space.needs is None:
            # Many folders can have one name.
            called = (f"{space.name}{number}" for number in ("", *range(2, _MOST_SPACES)))
            named = chain((found,), (_named_by_space(found, name) for name in called))
            found = next(
                (each for each in named if ids.isdisjoint(rule.id for rule in each.rules)), found
            )
        ids |= {rule.id for rule in found.rules}
        yield found


def _named_by_space(space: NameSpace, name: str) -> NameSpace:
    return space._replace(
        files=tuple(
            file._replace(rules=tuple(_in_space(rule, name, file.shown) for rule in file.rules))
            for file in space.files
        )
    )


def _in_space(rule: Rule, name: str, stays: str) -> Rule:
    """Return a rule whose id begins with the pack's name; unchanged if it begins with `stays`."""
    is_named = bool(stays) and rule.id.startswith(stays)
    return rule if is_named else replace(rule, id=f"{name}/{rule.id}")


def _named_by_path(rule: Rule, file: RuleFile) -> Rule:
    name = f"{file.name}:"
    if not rule.id.startswith(name):
        return rule
    return replace(rule, id=f"{file.shown}:{rule.id.removeprefix(name)}")
