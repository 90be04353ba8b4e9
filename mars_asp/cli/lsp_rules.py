"""A file of rules for an editor: the findings of lint in it, and the rules around it."""

import argparse
from contextlib import suppress
from pathlib import Path

from mars_asp.asp.lint.found import Fix
from mars_asp.cli.lsp_files import EditorFiles
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.lsp.places import START, Place
from mars_asp.lsp.questions import LintedFile, Question
from mars_asp.lsp.rule_text import PredicateMention, rule_text
from mars_asp.lsp.rules import Predicate, Rules
from mars_asp.reasoning.lint import lint
from mars_asp.reasoning.packs import pack_of
from mars_asp.reasoning.rules import STAGES, load_rulebook, rules_directory

#: At most so many files of rules in the same folder are read.
_MOST_RULES = 200
#: The start of an expectation; only rule cases have such lines.
_EXPECTED = "%="


def lint_answer(question: Question, options: argparse.Namespace) -> LintedFile:
    """Return the findings of `mars-asp rules lint` in a file, and the rules around it."""
    path = Path(question.path)
    files = EditorFiles(question.path)
    text = files.text(question.path)
    is_own = path.resolve().is_relative_to(rules_directory().resolve())
    found: tuple[Diagnostic, ...] = ()
    fixes: dict[Diagnostic, tuple[Fix, ...]] = {}
    if text is not None and not any(line.startswith(_EXPECTED) for line in text.lines):
        # The meaning of a file in a pack depends on the other files.
        packs = [] if is_own else [pack_of(path) or path]
        try:
            linted = lint([*map(Path, options.rules), *packs] if packs else [])
            found = linted.diagnostics
            fixes = {each.diagnostic: each.fixes for each in linted.lints}
        except MarsError as error:
            found = error.diagnostics
        if pack_of(path) is not None:
            found = tuple(each for each in found if Path(each.span.path) == path)
    findings = (files.finding(each, fixes=fixes.get(each, ())) for each in found)
    return LintedFile(tuple(findings), _rules(path, files, is_own))


def _rules(path: Path, files: EditorFiles, is_own: bool) -> Rules:
    """Return the rules around a file: the built-in ones and, unless `is_own`, those beside it."""
    beside = [] if is_own else sorted(path.parent.glob("*.lp"))[:_MOST_RULES]
    try:
        rulebook = load_rulebook(beside, STAGES)
    except MarsError:
        rulebook = load_rulebook((), STAGES)
    predicates: dict[tuple[str, int], tuple[Predicate, ...]] = {}
    for signature, each in rulebook.declarations.items():
        # A declaration begins with the name, after `%*! `.
        place = files.place(each.span) or Place(str(path), START)
        key = signature.name, signature.arity
        result = Predicate(signature.signed, each.written, each.words, place)
        predicates[key] = (*predicates.get(key, ()), result)
    mentions: dict[str, tuple[PredicateMention, ...]] = {}
    own = sorted(rules_directory().rglob("*.lp"))
    for file in (*beside, *own):
        with suppress(OSError):
            text = files.text(str(file))
            if text is not None:
                mentions[text.path] = rule_text(text.path, text.written).mentions
    return Rules(predicates, mentions)
