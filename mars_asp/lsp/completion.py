"""Completion items: keywords, modules, ports, modes, functions, predicates."""

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.lsp.keyword_docs import ANNOTATIONS, METADATA, MODES, STATEMENTS
from mars_asp.lsp.occurrences import is_configuration
from mars_asp.lsp.places import Position, Range, Text
from mars_asp.lsp.robot import DocumentContext, prefixed_name
from mars_asp.lsp.rule_text import RuleText
from mars_asp.lsp.rules import Rules
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS, STRATEGIES, VERBS
from mars_asp.model.names import BARE, QUOTED, plain, written

Sort: TypeAlias = Literal[
    "keyword", "module", "port", "mode", "function", "predicate", "annotation"
]
_NAME = f"(?:{BARE}|{QUOTED})"
#: A module whose port is being typed.
_PORT = re.compile(rf"(?:^|[\s,])(?P<module>{_NAME})\.(?P<port>[\w/-]*)$")
_ANNOTATION = re.compile(r"@(?P<word>[A-Za-z]\w*)[ \t]+(?P<rest>.*)$")
_WITH_MODES = ("Sense", "DataOut")
#: The word before the cursor, in a reversed line.
_BACKWARDS = re.compile(r"[\w/-]*+@?")
#: Maximal number of items: sending more would take too long.
_MOST = 200
_FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)


class Completion(NamedTuple):
    """A completion item: its label, kind and documentation; `text` replaces the typed prefix."""

    label: str
    sort: Sort
    detail: str
    text: str


class Completions(NamedTuple):
    """The completion items at a position, and the range of the prefix that is typed already.

    `is_whole` is False if items are left out because there are too many.
    """

    items: tuple[Completion, ...]
    typed: Range
    is_whole: bool = True


def completion(scene: DocumentContext, position: Position) -> Completions:
    """Return the completion items at a location of a `.mars` file or a source."""
    text = scene.here.text
    before = text.line_before(position)
    number = position.line + 1
    inside = any(first <= number <= last for first, last in scene.here.blocks)
    if not is_configuration(scene.here.text.path):
        return _typed(_annotations(before, in_source=True), text, position)
    if inside:
        return _typed(_annotations(before, in_source=False), text, position)
    return _typed(_statement(scene, before), text, position)


def rule_completion(here: RuleText, rules: Rules, position: Position) -> Completions:
    """Return the predicates, or after `%!` the metadata keys, that complete a file of rules."""
    before = here.text.line_before(position)
    if re.match(r"\s*%!\s*[a-z]*$", before):
        keys = (Completion(k, "keyword", w.meaning, f"{k}: ") for k, w in METADATA.items())
        return _typed(keys, here.text, position)
    if here.is_blank(position):
        return Completions((), Range(position, position))
    documented = {key: found[0] for key, found in rules.predicates.items()}
    named = {each.key for each in here.mentions if not each.range.holds(position)}
    named |= {each.key for mentions in rules.files.values() for each in mentions if each.is_head}
    return _typed(_predicates(documented, named), here.text, position)


def _predicates(
    documented: Mapping[tuple[str, int], object], named: Iterable[tuple[str, int]]
) -> Iterator[Completion]:
    for name, arity in sorted(documented.keys() | set(named)):
        found = documented.get((name, arity))
        shown = getattr(found, "written", f"{name}/{arity}")
        detail = " ".join(filter(None, (shown, getattr(found, "words", ""))))
        yield Completion(name, "predicate", detail, f"{name}(" if arity else name)


def _typed(items: Iterable[Completion], text: Text, position: Position) -> Completions:
    line, column = text.column(position)
    before = text.line_before(position)
    # From the end: a line may be very long.
    match = _BACKWARDS.match(before[::-1])
    begin = column - 1 - (0 if match is None else match.end())
    if before.count('"') % 2:
        begin = before.rindex('"')
    place = text.within(line, begin, column - 1)
    found = tuple(items)
    if len(found) <= _MOST:
        return Completions(found, place)
    start = text.lines[line - 1][begin : column - 1].lower()
    fit = (each for each in found if start in each.text.lower())
    return Completions(tuple(islice(fit, _MOST)), place, False)


# ---- Annotations ---------------------------------------------------------------------------------


def _annotations(before: str, in_source: bool) -> Iterator[Completion]:
    """Yield completions in an annotation after `before`, its line's text up to the cursor."""
    match = _ANNOTATION.search(before)
    if match is None:
        if not in_source or "@" in before:
            for name, word in ANNOTATIONS.items():
                yield Completion(f"@{name}", "annotation", word.meaning, f"@{name}")
    elif match["word"] in _WITH_MODES:
        yield from _modes()
    elif match["word"] == "ControlOut":
        for name in _FUNCTIONS:
            yield Completion(name, "function", ANNOTATIONS[name].meaning, name)


def _modes() -> Iterator[Completion]:
    for name, word in MODES.items():
        yield Completion(name, "mode", word.meaning, name)


# ---- Statements ----------------------------------------------------------------------------------


def _statement(scene: DocumentContext, before: str) -> Iterator[Completion]:
    """Yield completions for a line of a configuration; `before` is its text up to the cursor."""
    code = re.sub(r"(?:^|\s)(?://|#).*", "", before)
    if code != before:
        return
    # A name in quotes may still be open.
    words = re.findall(rf'{QUOTED}|"[^"]*$|[^\s,]+|,', code)
    is_open = bool(words) and words[-1].count('"') == 1
    is_ended = not is_open and (not code or code[-1].isspace() or code.endswith(","))
    done = words if is_ended else words[:-1]
    port = _PORT.search(code)
    if port is not None:
        yield from _port_items(scene, plain(port["module"]), any(verb in done for verb in VERBS))
    elif not done:
        yield from _keywords("@configuration", "@specification", "@modules", "@sources", "@include")
        yield from _keywords(*ANNOTATED_BLOCK, of=ANNOTATIONS)
        yield from _modules(scene)
    elif done[0] in ("@configuration", "@specification"):
        yield from _keywords("flat", "hierarchical", "period")
    elif done[0] == "@modules":
        yield from _modules(scene)
    elif not done[0].startswith("@"):
        yield from _relationship(scene, done)


#: The annotations that begin a block in a configuration.
ANNOTATED_BLOCK = ("module_start",)


def _relationship(scene: DocumentContext, done: list[str]) -> Iterator[Completion]:
    at = next((number for number, word in enumerate(done) if word in VERBS), None)
    if at is None:
        yield from _keywords(*VERBS)
        return
    verb, rest = done[at], done[at + 1 :]
    if verb == "is_controlled_by" and rest and rest[-1] != ",":
        yield from _keywords("forever") if rest[-1] == "hold" else ()
        yield from _keywords("root", "split") if rest[-1] == "allocation" else ()
        yield from _keywords("hold", "allocation") if rest[-1] not in ("hold", "allocation") else ()
    elif verb == "is_arbitrated_by":
        yield from _keywords(*STRATEGIES) if not rest else ()
        yield from _keywords("period") if rest in (["flat"], ["weighted"]) else ()
    elif verb in ("is_locked_by", "is_limited_by") and rest:
        yield from _keywords("hold") if "hold" not in rest else ()
    elif not rest or (verb == "is_controlled_by" and rest[-1] == ","):
        yield from _modules(scene)
    elif verb == "uses_data_from":
        yield from _modes() if len(rest) == 1 else ()
        yield from _keywords("every")


def _keywords(*names: str, of: Mapping[str, object] = STATEMENTS) -> Iterator[Completion]:
    for name in names:
        word = of[name]
        shown = name if of is STATEMENTS else f"@{name}"
        yield Completion(shown, "keyword", getattr(word, "meaning", ""), shown)


def _modules(scene: DocumentContext) -> Iterator[Completion]:
    """Yield the modules that the file, its includes or its sources name."""
    names = {each.name: "" for each in scene.here.mentions if each.role != "line"}
    for robot in scene.robots:
        own = next(file for file in robot.files if file.path == scene.here.text.path)
        listed = {
            prefixed_name(file.prefix, each.name)
            for file in robot.files
            for each in file.mentions
            if each.role != "line" and file.path != own.path
        }
        for name in sorted(listed | robot.modules.keys()):
            known = _within(own.prefix, name)
            if known is not None:
                described = robot.modules.get(name)
                names[known] = described.lines[0] if described is not None else ""
    for name, detail in names.items():
        yield Completion(name, "module", detail, written(name))


def _within(prefix: str, name: str) -> str | None:
    """Return a module's name inside an include with a prefix, or None if it is outside."""
    if not prefix:
        return name
    for before, own in ((f"{prefix}/", ""), (f"/{prefix}/", "/")):
        if name.startswith(before):
            return f"{own}{name.removeprefix(before)}"
    return None


def _port_items(scene: DocumentContext, module: str, is_output: bool) -> Iterator[Completion]:
    """Yield a module's outputs; on the left, where these may be gated, its inputs first."""
    for robot, file in scene.own_files():
        described = robot.modules.get(prefixed_name(file.prefix, module))
        if described is not None:
            left = () if is_output else described.inputs
            for name in dict.fromkeys((*left, *described.outputs)):
                yield Completion(name, "port", f"of {module}", written(name))
            return
