"""List, show or check rules, begin a pack of them, or compare what one changes."""

import argparse
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path

from mars_asp.asp.lint.found import fixed
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.metadata import file_name
from mars_asp.asp.rules.outline import Outline
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, plain
from mars_asp.cli.deliver import write_file
from mars_asp.cli.encode import encoded
from mars_asp.cli.layout import columns
from mars_asp.cli.lines import line_at
from mars_asp.cli.reason import rulebook_for
from mars_asp.cli.report import report
from mars_asp.cli.rules_kinds import Kind, kind_document, kind_json, kinds
from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.output import replace_together, visible
from mars_asp.reasoning.findings import EXPANSIONS
from mars_asp.reasoning.lint import Linted, lint
from mars_asp.reasoning.rules import BASE, STAGES
from mars_asp.spelling import nearest

_PURPOSES = {"base": BASE, **STAGES}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    parser.add_argument("action", choices=("list", "show", "lint", "doc", "new", "diff"))
    parser.add_argument(
        "what",
        nargs="?",
        metavar="ID|PREDICATE|KIND|PATH|TOPIC",
        help="of `show`: a rule's id, a predicate, a kind of finding or node, or a file of rules;"
        " of `lint`: files to check; of `doc` and `diff`: a pack; of `new`: the name of a pack,"
        " which is written to a new folder here",
    )
    parser.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        help="of `diff`: configurations to compare, without any our examples",
    )
    parser.add_argument(
        "-o", "--output", metavar="DIR", help="of `doc`: write a page for each file of rules there"
    )
    parser.add_argument(
        "--fix",
        action="store_true",
        help="of `lint`: correct what has one safe fix, in the files of packs",
    )
    parser.add_argument(
        "--stage",
        metavar="STAGE",
        choices=tuple(_PURPOSES),
        help=f"list or document the rules of one stage alone: {', '.join(_PURPOSES)}",
    )


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked."""
    action, what = arguments.action, arguments.what
    wrong = _misused(action, what, arguments)
    if wrong:
        print(f"mars-asp rules: {wrong}", file=sys.stderr)
        return 2
    if action == "lint":
        packs = [Path(path) for path in [*arguments.rules, *([what] if what else [])]]
        return _lint(packs, arguments)
    if action == "diff":
        from mars_asp.cli.rules_diff import print_changes

        return print_changes(what, arguments.files, arguments)
    if action == "doc" and what:
        arguments.rules = [*arguments.rules, what]
    rulebook = rulebook_for(arguments, STAGES)
    if action == "new":
        from mars_asp.cli.rules_new import new_pack

        for path in new_pack(what, rulebook):
            print(f"wrote {visible(path)}")
        return 0
    as_json = arguments.format == "json"
    stages = (arguments.stage,) if arguments.stage else tuple(_PURPOSES)
    if action == "show":
        print(encoded(shown_json(rulebook, what)) if as_json else _safe(shown(rulebook, what)))
    elif action == "doc" and arguments.output:
        _write_pages(rulebook, stages, what, arguments.output)
    elif action == "doc":
        print("# Rules\n")
        print(_safe("\n".join(_documents(rulebook, stages, what))))
    elif as_json:
        found_rules = (rule for stage in stages for rule in _speaking(rulebook, stage))
        print(encoded([_rule_json(rule) for rule in found_rules]))
    else:
        print("\n\n".join(_listed(rulebook, stage) for stage in stages))
    return 0


def _lint(packs: Sequence[Path], arguments: argparse.Namespace) -> int:
    """Report what is noteworthy about packs, and with `--fix` correct what has one safe fix."""
    found = lint(packs)
    if arguments.fix and packs:
        mended = _mended(found)
        if mended:
            found = lint(packs)
            print(f"corrected: {mended}")
    if found.errors:
        raise MarsError(found.diagnostics)
    report(found.diagnostics, arguments)
    if not found.diagnostics:
        print("nothing wrong")
    return 0


def _mended(found: Linted) -> int:
    """Write the fixes of what was found, and return of how many findings they were."""
    texts: dict[str, bytes] = {}
    count = 0
    for path in dict.fromkeys(fix.span.path for each in found.lints for fix in each.fixes):
        text, mended = fixed(Path(path).read_text(encoding="utf-8"), path, found.lints)
        texts[path] = text.encode()
        count += mended
    replace_together(texts)
    return count


def shown(rulebook: Rulebook, name: str) -> str:
    """Return what there is to say of the rule of an id, a predicate, or a file of rules.

    Raises:
        MarsError: there is none of these.
    """
    found = _named(rulebook, name)
    if isinstance(found, Rule):
        return "\n\n".join([_document(found, "##"), *_example(found, rulebook)])
    if isinstance(found, Kind):
        named = (_document(rule, "###") for rule in found.rules)
        return "\n\n".join([*kind_document(found), *named])
    if isinstance(found, tuple):
        return "\n\n".join(map(_predicate_document, found))
    stage, outline = rulebook.outlines[found]
    rules = [rule for rule in _speaking(rulebook, stage) if rule.span.path == found]
    listed = "\n".join(f"- `{rule.id}`: {rule.because}" for rule in rules)
    return "\n\n".join(filter(None, (_file_document(found, stage, outline), listed)))


def shown_json(rulebook: Rulebook, name: str) -> dict[str, object]:
    """Return what `shown` tells, for programs.

    Raises:
        MarsError: there is no such rule, predicate or file.
    """
    found = _named(rulebook, name)
    if isinstance(found, Rule):
        return _rule_json(found)
    if isinstance(found, Kind):
        return kind_json(found)
    if isinstance(found, tuple):
        return {"predicates": list(map(_predicate_json, found))}
    stage, outline = rulebook.outlines[found]
    return {
        "path": found,
        "stage": stage,
        "title": outline.title,
        "purpose": outline.purpose,
        **{name: list(map(str, predicates)) for name, predicates in _predicates(outline)},
        "rules": [rule.id for rule in rulebook.rules if rule.span.path == found],
    }


def _misused(action: str, what: str | None, arguments: argparse.Namespace) -> str | None:
    """Return what is wrong with a call, if anything is."""
    if action == "show" and not what:
        return "`show` needs the ID of a rule, a predicate, a kind or a file; `list` names rules"
    if action in ("new", "diff") and not what:
        wanted = "the name of a TOPIC" if action == "new" else "the folder of a PACK"
        return f"`{action}` needs {wanted}"
    if arguments.fix and (action != "lint" or not (arguments.rules or what)):
        return "`--fix` has an effect only on `lint` with a pack"
    if arguments.stage and action not in ("list", "doc"):
        return f"--stage has no effect on `{action}`"
    if arguments.output and action != "doc":
        return f"--output has no effect on `{action}`"
    if arguments.files and action != "diff":
        return f"`{action}` takes one name, and `{visible(arguments.files[0])}` is another"
    return None


def _named(rulebook: Rulebook, name: str) -> Rule | Kind | tuple[Declaration, ...] | str:
    """Return the rule of an id, a kind, predicates, or the path of a file.

    A file is named by its path or by what its ids begin with, predicates by their name, with or
    without the number of arguments.
    """
    rule = rulebook.by_id.get(name)
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
    near = _near(name, (*rulebook.by_id, *files, *(each.name for each in declared), *known))
    hint = f"did you mean `{near}`?" if near else "`mars-asp rules list` names them all"
    where = point("rules", 1, 1)
    message = f"there is no rule, predicate or kind `{name}`"
    raise MarsError((Diagnostic("rule", "error", message, where, help=hint),))


def _near(name: str, known: Collection[str]) -> str | None:
    """Return the id that is meant by one that leaves out the stage, or is misspelt."""
    behind = (each for each in known if each.endswith(f"/{name}"))
    return next(behind, None) or nearest(name, known)


def _speaking(rulebook: Rulebook, stage: str) -> Iterator[Rule]:
    return (rule for rule in rulebook.rules if rule.stage == stage and rule.because is not None)


def _listed(rulebook: Rulebook, stage: str) -> str:
    rules = tuple(_speaking(rulebook, stage))
    width = max((len(rule.id) for rule in rules), default=0)
    lines = [
        visible(f"{rule.id:<{width}}  {rule.span.path}:{rule.span.line}  {rule.because}")
        for rule in rules
    ]
    return "\n".join([f"{stage}: {_PURPOSES[stage]}", *lines])


def _documents(rulebook: Rulebook, stages: Iterable[str], pack: str | None = None) -> Iterator[str]:
    for stage in stages:
        for path, (at, outline) in rulebook.outlines.items():
            if at == stage and _is_of(path, pack):
                yield _page(rulebook, path, stage, outline)


def _page(rulebook: Rulebook, path: str, stage: str, outline: Outline) -> str:
    of_file = (rule for rule in _speaking(rulebook, stage) if rule.span.path == path)
    rules = (f"{_document(rule, '###')}\n" for rule in of_file)
    return "\n".join([f"{_file_document(path, stage, outline)}\n", *rules])


def _is_of(path: str, pack: str | None) -> bool:
    """Whether a file of rules is to be documented: of a pack, where one is named."""
    return pack is None or (path.endswith(".lp") and Path(path).is_relative_to(pack))


def _write_pages(rulebook: Rulebook, stages: Iterable[str], pack: str | None, folder: str) -> None:
    """Write a page for each file of rules into a folder, and one that lists them."""
    listed = ["# Rules", ""]
    Path(folder).mkdir(parents=True, exist_ok=True)
    for stage in stages:
        named = ((path, of) for path, (at, of) in rulebook.outlines.items() if at == stage)
        files = [(path, of) for path, of in named if _is_of(path, pack)]
        listed += [f"## {stage}", "", f"{_PURPOSES[stage]}.", ""] if files else []
        for path, outline in files:
            name = f"{file_name(path, stage).replace('/', '-')}.md"
            listed.append(f"- [{file_name(path, stage)}]({name}): {visible(outline.title)}")
            page = _page(rulebook, path, stage, outline)
            write_file(str(Path(folder) / name), _safe(page.replace("## ", "# ", 1)))
        listed += [""] if files else []
    write_file(str(Path(folder) / "index.md"), "\n".join(listed))
    print(f"wrote {visible(str(Path(folder) / 'index.md'))}")


def _example(rule: Rule, rulebook: Rulebook) -> Iterator[str]:
    """Yield what explains a rule in the case that it names as its example."""
    from mars_asp.asp.trace.text import traces_text
    from mars_asp.reasoning.cases.examples import example_trace

    found = example_trace(rule, rulebook)
    if found is not None:
        told = traces_text([found], line_at, width=columns(sys.stdout))
        yield "\n".join(["In its example:", "", "```text", *map(visible, told), "```"])


def _file_document(path: str, stage: str, outline: Outline) -> str:
    parts = [f"## {file_name(path, stage)}", outline.title, path]
    lines = [f"Purpose: {outline.purpose}"] if outline.purpose else []
    for name, predicates in _predicates(outline):
        if predicates:
            lines.append(f"{name.capitalize()}: {', '.join(f'`{p}`' for p in predicates)}")
    return "\n\n".join(filter(None, [*parts, *lines]))


def _predicates(outline: Outline) -> Iterator[tuple[str, tuple[Signature, ...]]]:
    yield "given", outline.given
    yield "derives", outline.derives
    yield "decides", outline.decides
    yield "shows", outline.shows


def _safe(text: str) -> str:
    """Return what packs wrote with control characters escaped, but for tabs and line feeds."""
    lines = (map(visible, line.split("\t")) for line in text.split("\n"))
    return "\n".join(map("\t".join, lines))


def _document(rule: Rule, heading: str) -> str:
    parts = [f"{heading} {rule.id}", rule.because or "no message"]
    if rule.effect:
        parts.append(f"Effect: {rule.effect}")
    if rule.help:
        parts.append(f"Help: {rule.help}")
    if rule.why:
        parts.append(f"Why: {rule.why}")
    parts += [f"{key.capitalize()}: `{listed}`" for key, listed in rule.lists]
    if rule.example:
        parts.append(f"Example: {rule.example}")
    parts.append(f"{rule.span.path}:{rule.span.line}")
    return "\n\n".join([*parts, f"```clingo\n{plain(rule.text)}\n```"])


def _predicate_document(declaration: Declaration) -> str:
    sentences = {"says": declaration.says, "unless": declaration.unless}
    said = [f"{key}: {sentence}" for key, each in sentences.items() for sentence in each]
    origin = declaration.attribution or declaration.origin
    said += [f"from: {origin}"] if origin else []
    said += (f"key: {', '.join(key) or 'nothing'}" for key in declaration.named_keys)
    said += ["packs: extend"] if declaration.extensible else []
    said += ["packs: read"] if declaration.public else []
    said += [] if declaration.joins else ["joins: nothing"]
    said += [] if declaration.cited else ["cited: never"]
    said += [] if declaration.ordering is None else [f"orders: {declaration.ordering}"]
    place = f"{declaration.span.path}:{declaration.span.line}"
    parts = (f"## {declaration.written}", declaration.words, "\n".join(said), place)
    return "\n\n".join(filter(None, parts))


def _predicate_json(declaration: Declaration) -> dict[str, object]:
    return {
        "predicate": str(declaration.signature),
        "arguments": [
            {"name": name, "sorts": sorted(sorts), "constants": list(constants)}
            for name, sorts, constants in declaration.arguments
        ],
        "words": declaration.words,
        "says": list(declaration.says),
        "unless": list(declaration.unless),
        "cited": declaration.cited,
        "orders": declaration.ordering,
        "keys": list(map(list, declaration.named_keys)),
        "from": declaration.origin,
        "attribute": declaration.attribution,
        "packs": "extend" if declaration.extensible else "read",
        "path": declaration.span.path,
        "line": declaration.span.line,
    }


def _rule_json(rule: Rule) -> dict[str, object]:
    return {
        "id": rule.id,
        "stage": rule.stage,
        "because": rule.because,
        "help": rule.help,
        "effect": rule.effect,
        "why": rule.why,
        "example": rule.example,
        **{key: dict(rule.lists).get(key) for key in EXPANSIONS},
        "path": rule.span.path,
        "line": rule.span.line,
        "text": plain(rule.text),
    }
