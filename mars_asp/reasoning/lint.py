"""Lint of rule packs and of the built-in rules."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.lint import Host
from mars_asp.asp.lint import lint as lint_rules
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.lint.recursion import RECURSION
from mars_asp.asp.lint.sorts import VALUE
from mars_asp.asp.rules.consistency import INCONSISTENT
from mars_asp.asp.rules.declarations import declarations, misspelt_sorts, wrong_references
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.units import NUMBERS, OF_UNITS
from mars_asp.diagnostic import Diagnostic, MarsError, Span, by_place
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.vocabulary import FORMS, THINGS, unbounded
from mars_asp.reasoning.findings import CONSEQUENCE
from mars_asp.reasoning.packs import pack_of, with_companions
from mars_asp.reasoning.rules import STAGES, load_rulebook, rules_directory
from mars_asp.reasoning.sample import sampled

INSERTED = Signature("inserted", 2)
#: Errors of files that then lack in their pack, so that others seem to be wrong.
_OF_READING = ("rule-syntax", "pack")
#: Larger packs are tried on one sample only, as grounding them takes most of the time.
_MOST_RULES = 2_000


class LintResult(NamedTuple):
    """The findings of lint: `errors` would stop an analysis, `others` and `lints` would not."""

    errors: tuple[Diagnostic, ...]
    others: tuple[Diagnostic, ...]
    lints: tuple[LintFinding, ...]

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Return all diagnostics, sorted by location."""
        return by_place((*self.errors, *self.others, *(each.diagnostic for each in self.lints)))


def lint(packs: Sequence[Path], grounded: bool = True) -> LintResult:
    """Return the findings about rule packs; about the built-in rules if there are none.

    Packs next to these that they need are read as well, but not checked. With `grounded`, packs
    without errors are also grounded over sample robots, unless a recursion may grow without end.
    """
    errors: list[Diagnostic] = []
    needed = {each.resolve(): each for pack in packs for each in with_companions(pack)}
    paths = {pack.resolve() for pack in packs}
    beside = [needed[place] for place in needed if place not in paths]
    rulebook = load_rulebook([*beside, *packs], STAGES, strict=not packs, noted=errors)
    others: list[Diagnostic] = []
    misread: list[Diagnostic] = []
    own = rulebook.documented[-rulebook.packs :] if rulebook.packs else rulebook.documented
    for file in own:
        tuple(declarations(file.docstrings, file.path, misread))
    misread += wrong_references(rulebook.declarations.values())
    documented = [each for file in own for each in file.declarations]
    if rulebook.packs:
        given = rulebook.built_in.declarations.values()
        sorts = {sort for each in given for argument in each.arguments for sort in argument.sorts}
        misread += misspelt_sorts(documented, {*sorts, *FORMS, *NUMBERS}, OF_UNITS)
    others += (replace(each, severity="warning") for each in misread)
    host = Host(
        CONSEQUENCE,
        FORMS,
        THINGS,
        unbounded(rulebook.declarations.values()),
        {"kind": (CONSEQUENCE, 0)},
        _has_example,
        frozenset({"verify"} if rulebook.packs else ()),
        frozenset({"resolve"}),
        {INSERTED: frozenset({Signature("placed_before", 2), Signature("placed_after", 2)})},
    )
    # If packs were given and none could be read, there is nothing else to check.
    lints: list[LintFinding] = [*lint_rules(rulebook, host)] if rulebook.packs or not packs else []
    # An unknown severity is an error already, and no further value.
    wrong = {each.span[:3] for each in errors if each.code == "rule-severity"}
    lints = [e for e in lints if e.diagnostic.code != VALUE or e.diagnostic.span[:3] not in wrong]
    # Grounding a recursion that grows without end would not end.
    grows = any(each.diagnostic.code == RECURSION for each in lints)
    if grounded and rulebook.packs and not errors and not grows:
        tried = _tried(rulebook)
        errors += (each for each in tried if each.severity == "error")
        others += (each for each in tried if each.severity != "error")
    if beside:
        others = [each for each in others if not _is_in(each.span, beside)]
        lints = [each for each in lints if not _is_in(each.diagnostic.span, beside)]
    return LintResult(tuple(errors), tuple(others), tuple(lints))


def lint_files(paths: Sequence[Path]) -> LintResult:
    """Return the findings about packs and files of rules; about the built-in rules for no path.

    A file of a pack is checked with the pack, but of its other files only errors of reading are
    reported.
    """
    packs = {path: path.suffix == ".lp" and path.is_file() and pack_of(path) for path in paths}
    around = [pack for pack in packs.values() if pack]
    found = lint(list(dict.fromkeys(packs[path] or path for path in paths)))

    def is_shown(each: Diagnostic) -> bool:
        is_other = _is_in(each.span, around) and not _is_in(each.span, paths)
        return not is_other or each.code in _OF_READING

    lints = (each for each in found.lints if is_shown(each.diagnostic))
    errors, others = filter(is_shown, found.errors), filter(is_shown, found.others)
    return LintResult(tuple(errors), tuple(others), tuple(lints))


def _is_in(span: Span, folders: Sequence[Path]) -> bool:
    path = Path(span.path).resolve()
    return any(path.is_relative_to(each.resolve()) for each in folders)


def _tried(rulebook: Rulebook) -> list[Diagnostic]:
    """Return the errors of grounding the rules over sample robots."""
    found: dict[tuple[str, Span], Diagnostic] = {}
    most = 1 if rulebook.pack_rules > _MOST_RULES else None
    for facts, span in islice(sampled(), most):
        try:
            analyse(facts, rulebook, span)
        except MarsError as error:
            for each in map(_of_sample, error.diagnostics):
                found.setdefault((each.code, each.span), each)
    return list(found.values())


def _of_sample(found: Diagnostic) -> Diagnostic:
    """Return a diagnostic of a sample robot; the lack of an answer is a warning only."""
    if found.code != INCONSISTENT:
        return found
    message = found.message.replace("this configuration", "a sample robot")
    return replace(found, severity="warning", message=message)


def _has_example(rule: Rule) -> bool:
    """Whether the example of a rule is a file; built-in examples are only in the source tree."""
    example = rule.example or ""
    path = Path(rule.span.path)
    if path.is_file():
        return any((folder / example).is_file() for folder in (Path(), *path.parents))
    tree = rules_directory().parent
    return (tree / example).is_file() or not (tree / "tests").is_dir()
