"""List, show or check rules, begin a pack of them, or compare what one changes."""

import argparse
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from mars_asp.asp.lint.catalogue import CODES, Page, page_text
from mars_asp.asp.lint.found import fixed, titled
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.metadata import file_name
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.arguments import add_flags, misuse
from mars_asp.cli.diagnostic_text import Suggestion, report
from mars_asp.cli.encode import encoded
from mars_asp.cli.fmt import unified_diff
from mars_asp.cli.input_codes import InputCode, input_codes
from mars_asp.cli.inputs import package_named, rulebook_for
from mars_asp.cli.rules_document import (
    PURPOSES,
    documents,
    file_document,
    open_predicates,
    predicate_document,
    predicate_json,
    predicate_lines,
    predicates_of,
    rule_json,
    rule_source,
    rule_summary,
    safe,
    speaking,
    with_names,
    write_pages,
)
from mars_asp.cli.rules_example import rule_example, tabled_example
from mars_asp.cli.rules_kinds import Kind, kind_document, kind_json, kinds
from mars_asp.diagnostic import Diagnostic, refusal
from mars_asp.language.text_edits import Draft, LineEdit
from mars_asp.output import fenced, replace_together, visible
from mars_asp.reasoning.findings import kinds_of
from mars_asp.reasoning.lint import LintResult, lint_files
from mars_asp.reasoning.packs import MANIFEST, installed_packs, with_companions
from mars_asp.reasoning.rules import STAGES, is_rule_base
from mars_asp.spelling import nearest

#: The minimal similarity of a name; of short names, less would mean another thing.
_ALIKE = 0.8
_REPEATED = re.compile(r"^([^/]+/)\1")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    actions = ("list", "show", "lint", "doc", "new", "diff")
    help_text = "what to do (default: list)"
    parser.add_argument("action", nargs="?", default="list", choices=actions, help=help_text)
    parser.add_argument("what", nargs="?", metavar="ID|PREDICATE|KIND|PATH|NAME")
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("-o", "--output", dest="folder", metavar="DIR")
    add_flags(parser, "--fix", "--predicates", "--source")
    parser.add_argument(
        "--stage",
        metavar="STAGE",
        choices=tuple(PURPOSES),
        help=f"list or document the rules of one stage alone: {', '.join(PURPOSES)}",
    )


def run(arguments: argparse.Namespace) -> int:
    """Carry out the action; return the exit status."""
    action, what = arguments.action, arguments.what
    # The current folder is the default, as for `check` and `test`.
    if action == "lint" and not (what or arguments.rules) and Path(MANIFEST).is_file():
        what = "."
    wrong = _misused(action, what, arguments)
    if wrong:
        return misuse("rules", wrong)
    if action == "lint":
        named = [*arguments.rules, *([what] if what else []), *arguments.files]
        # The built-in rules must not be linted as a pack beside themselves.
        packs = [path for path in map(Path, named) if not is_rule_base(path)]
        return _lint(packs, arguments)
    if action == "diff":
        from mars_asp.cli.rules_diff import print_changes

        return print_changes(what, arguments.files, arguments)
    if action == "doc" and what:
        arguments.rules = [*arguments.rules, *map(str, with_companions(Path(what)))]
    rulebook = rulebook_for(arguments, STAGES)
    if action == "new":
        from mars_asp.cli.rules_new import new_pack

        _report((f"wrote {visible(path)}" for path in new_pack(what, rulebook)), arguments)
        return 0
    as_json = arguments.format == "json"
    stages = (arguments.stage,) if arguments.stage else tuple(PURPOSES)
    if action == "show":
        text = encoded(shown_json(rulebook, what)) if as_json else None
        print(text or safe(shown(rulebook, what, with_source=arguments.source)))
    elif action == "doc" and arguments.folder:
        _report([write_pages(rulebook, stages, what, arguments.folder)], arguments)
    elif action == "doc":
        print("# Rules\n")
        print(safe("\n".join(documents(rulebook, stages, what))))
    elif arguments.predicates and as_json:
        listed = [
            {**predicate_json(each), "stage": stage}
            for stage in stages
            for each in open_predicates(rulebook, stage)
        ]
        print(encoded(listed))
    elif arguments.predicates:
        parts = [(stage, list(predicate_lines(rulebook, stage))) for stage in stages]
        print(
            safe(
                "\n\n".join(
                    "\n".join([f"{stage}: {PURPOSES[stage]}", *lines])
                    for stage, lines in parts
                    if lines
                )
            )
        )
    elif as_json:
        found_rules = (rule for stage in stages for rule in speaking(rulebook, stage))
        print(encoded([rule_json(rule) for rule in found_rules]))
    else:
        installed = () if arguments.stage else _listed_packs()
        print("\n\n".join([*(_stage_list(rulebook, stage) for stage in stages), *installed]))
    return 0


def _report(lines: Iterable[str], arguments: argparse.Namespace) -> None:
    """Print lines that report what was done, unless `--quiet`."""
    for line in lines:
        if not arguments.quiet:
            print(line)


def _lint(packs: Sequence[Path], arguments: argparse.Namespace) -> int:
    """Report the lints of packs; with `--fix`, first apply the safe fixes."""
    found = lint_files(packs)
    if arguments.fix and packs:
        mended = _mended(found)
        if mended:
            found = lint_files(packs)
            print(f"corrected: {mended}")
    report(found.diagnostics, arguments, _suggestions(found, arguments))
    if not found.diagnostics:
        print(f"no problems found{'' if packs else ' in the built-in rules'}")
    return 2 if found.errors else 0


def _suggestions(found: LintResult, arguments: argparse.Namespace) -> dict[Diagnostic, Suggestion]:
    """Return the edits of `--fix` as suggestions for JSON; text has them in the help."""
    if arguments.format != "json":
        return {}
    drafts: dict[str, str] = {}
    suggestions: dict[Diagnostic, Suggestion] = {}
    for each in found.lints:
        edits: list[LineEdit] = []
        for path in dict.fromkeys(fix.span.path for fix in each.fixes):
            text = drafts.setdefault(path, Path(path).read_text(encoding="utf-8"))
            draft = Draft(path, text)
            for at, new in each.fixes:
                if at.path == path:
                    end = draft.offset(at.end_line, at.end_column)
                    draft.put(draft.begin(at), end, new)
            edits += draft.lines()
        if edits:
            suggestions[each.diagnostic] = Suggestion(titled(each.fixes), tuple(edits))
    return suggestions


def _mended(found: LintResult) -> int:
    """Write the safe fixes of lints into the files and print them; return how many there are."""
    texts: dict[str, bytes] = {}
    count = 0
    for path in dict.fromkeys(fix.span.path for each in found.lints for fix in each.fixes):
        before = Path(path).read_text(encoding="utf-8")
        text, mended = fixed(before, path, found.lints)
        texts[path] = text.encode()
        count += mended
        print(safe(unified_diff(path, before, text)), end="")
    replace_together(texts)
    return count


def shown(rulebook: Rulebook, name: str, with_source: bool = False) -> str:
    """Return the text about a rule, predicate, file, kind or code; `with_source` adds rules' code.

    Raises:
        MarsError: nothing has that name.
    """
    found = _find_named(rulebook, name)
    if isinstance(found, InputCode):
        hint = "`--ignore` hides it." if found.can_be_ignored else "It cannot be ignored."
        return f"## {name}\n\n{found.meaning}\n\n{hint}"
    if isinstance(found, Page):
        return f"{page_text(found)}\n\n`%! allow: {name} REASON` above a rule hides it."
    if isinstance(found, Rule):
        example = rule_example(found, rulebook)
        text = rule_summary(found, "##", example)
        if with_source or found.because is None:
            # A rule without a message has nothing else to show.
            text = f"{text}\n\n{rule_source(found, rulebook)}"
        if example is None or not example.trace:
            return text
        return "\n\n".join([text, "In its example:", fenced("\n".join(example.trace), "text")])
    if isinstance(found, Kind):
        parts = list(kind_document(found))
        for rule in found.rules:
            parts.append(rule_summary(rule, "###", rule_example(rule, rulebook)))
            parts += [rule_source(rule, rulebook)] if with_source else []
        return "\n\n".join(parts)
    if isinstance(found, tuple):
        return "\n\n".join(map(predicate_document, found))
    stage, outline = rulebook.outlines[found]
    rules = [rule for rule in speaking(rulebook, stage) if rule.span.path == found]
    listed = "\n".join(f"- `{rule.id}`: {_sentence(rule)}" for rule in rules)
    return "\n\n".join(filter(None, (file_document(found, stage, outline), listed)))


def rule_or_kind_text(name: str, arguments: argparse.Namespace) -> str | None:
    """Return the output of `rules show` for a rule or kind, or None for another name."""
    rulebook = rulebook_for(arguments, STAGES)
    known = (*rulebook.by_id, *kinds(rulebook), *input_codes(), *CODES)
    if name not in known:
        if "." in name or package_named(name) is not None:
            return None
        # A rule without metadata has its place for an id, and nothing to say.
        near = nearest(name, (each for each in known if ":" not in each))
        advice = f"did you mean `{near}`? A" if near else "`mars-asp rules list` lists the rules; a"
        advice += f" module of a robot comes after its file: `mars-asp explain FILE {name}`"
        raise refusal("usage", f"there is no file, kind or rule `{name}`", name, advice)
    as_json = arguments.format == "json"
    return encoded(shown_json(rulebook, name)) if as_json else safe(shown(rulebook, name))


def shown_json(rulebook: Rulebook, name: str) -> dict[str, object]:
    """Return the JSON of `rules show` on a rule id, predicate or file.

    Raises:
        MarsError: there is no such rule, predicate or file.
    """
    found = _find_named(rulebook, name)
    if isinstance(found, InputCode):
        return {"code": name, **asdict(found)}
    if isinstance(found, Page):
        return asdict(found)
    if isinstance(found, Rule):
        return rule_json(found)
    if isinstance(found, Kind):
        return kind_json(found)
    if isinstance(found, tuple):
        return {"predicates": list(map(predicate_json, found))}
    stage, outline = rulebook.outlines[found]
    return {
        "path": found,
        "stage": stage,
        "title": outline.title,
        "purpose": outline.purpose,
        **{name: list(map(str, predicates)) for name, predicates in predicates_of(outline)},
        "rules": [rule.id for rule in rulebook.rules if rule.span.path == found],
    }


def _misused(action: str, what: str | None, arguments: argparse.Namespace) -> str | None:
    """Return the message that arguments do not suit the action, or None."""
    if action == "show" and not what:
        return "`show` needs the ID of a rule, a predicate, a kind or a file; `list` names rules"
    if action in ("new", "diff") and not what:
        wanted = "the name of the new pack" if action == "new" else "the folder of a PACK"
        return f"`{action}` needs {wanted}"
    if action == "list" and what:
        if Path(what).exists():
            return f"`list` takes no name; `rules list --rules {visible(what)}` adds a pack"
        return f"`list` takes no name; `rules show {visible(what)}` shows what has that name"
    if arguments.fix and (action != "lint" or not (arguments.rules or what)):
        return "`--fix` has an effect only on `lint` with a pack"
    if arguments.predicates and action != "list":
        return f"--predicates has no effect on `{action}`"
    if arguments.stage and action not in ("list", "doc"):
        return f"--stage has no effect on `{action}`"
    if arguments.folder and action != "doc":
        return f"--output has no effect on `{action}`"
    if arguments.files and action not in ("diff", "lint"):
        return f"`{action}` takes one name, and `{visible(arguments.files[0])}` is another"
    return None


def _find_named(
    rulebook: Rulebook, name: str
) -> Rule | Kind | InputCode | Page | tuple[Declaration, ...] | str:
    """Return the rule, kind, predicates, file path, code of the input or lint that has a name.

    A file is named by its path or by the common start of the ids in it, predicates by their name,
    with or without the number of arguments.
    """
    # Ids of older versions repeat the name of the file.
    rule = rulebook.by_id.get(name) or rulebook.by_id.get(_REPEATED.sub(r"\1", name))
    if rule is not None:
        return rule
    files = {file_name(path, stage): path for path, (stage, _) in rulebook.outlines.items()}
    if name in rulebook.outlines:
        return name
    if name in files:
        return files[name]
    declared = rulebook.declarations
    predicates = tuple(each for at, each in declared.items() if name in (at.name, str(at)))
    if predicates:
        return predicates
    known = kinds(rulebook)
    if name in known:
        return known[name]
    if name in input_codes():
        return input_codes()[name]
    if name in CODES:
        return CODES[name]
    # Predicates that packs may not read are internal, and as a suggestion would only mislead.
    opened = (
        each.signature.name for stage in PURPOSES for each in open_predicates(rulebook, stage)
    )
    names = (*rulebook.by_id, *files, *opened, *known, *input_codes(), *CODES)
    # An id may be written without the stage, or be misspelt.
    ends = (each for each in names if each.endswith(f"/{name}"))
    near = next(ends, None) or nearest(name, names, _ALIKE)
    hint = f"did you mean `{near}`?" if near else "`mars-asp rules list` names them all"
    raise refusal("rule", f"there is no rule, predicate or kind `{name}`", "rules", hint)


def _stage_list(rulebook: Rulebook, stage: str) -> str:
    rules = tuple(speaking(rulebook, stage))
    width = max((len(rule.id) for rule in rules), default=0)
    lines = [
        visible(
            f"{rule.id:<{width}}  {rule.span.path}:{rule.span.line}  {_sentence(rule)}"
            + "".join(f" [{kind}]" for kind in sorted(kinds_of(rule) or ()))
        )
        for rule in rules
    ]
    return "\n".join([f"{stage}: {PURPOSES[stage]}", *lines])


def _sentence(rule: Rule) -> str | None:
    """Return a rule's message with values of its example, else of variables; None without one."""
    example = tabled_example(rule)
    return with_names(rule.because) if example is None else example.because


def _listed_packs() -> Iterator[str]:
    """Yield the text that lists installed packs, nothing if there are none."""
    packs = installed_packs()
    width = max(map(len, packs), default=0)
    lines = [visible(f"{name:<{width}}  {folder}") for name, folder in packs.items()]
    if lines:
        yield "\n".join(["installed packs, which `--rules NAME` applies", *lines])
