"""Edits of a project, as the rules of `rules/repair` propose them, written into its texts.

An edit is a term such as `drop(3)` or `rename("Sonr","Sonar")`; `docs/how-to/what-if.md` lists
them.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from clingo import Symbol, SymbolType

from mars_asp.annotations.blocks import block_source, read_blocks
from mars_asp.annotations.files import read_source
from mars_asp.diagnostic import FileText, Span
from mars_asp.language.layout import lay_out
from mars_asp.language.print import WIDTH
from mars_asp.language.statement_edits import ListEdit, Member
from mars_asp.language.text_edits import ConflictError, Draft, LineEdit, apply_lines
from mars_asp.language.tokens import Token, statements
from mars_asp.model.declarations import (
    VERBS,
    Control,
    Data,
    Function,
    Gating,
    Module,
    Mount,
    Name,
    Relationship,
    Service,
    ends_of,
)
from mars_asp.model.names import end, read_end, written
from mars_asp.model.rates import as_written
from mars_asp.reasoning.facts.identifiers import mode_of, numbered, numbered_annotations
from mars_asp.reasoning.includes import name_within, prefix_of
from mars_asp.reasoning.project import Project, port_names
from mars_asp.reasoning.questions.annotation_edits import Annotations, NoPlaceError, Read, read

_PLAIN_TYPE = re.compile(r"[A-Za-z_]\w*(?:::\w+)*")


class UnknownEditError(Exception):
    """A rule proposes an edit that is none of those listed."""


class ImpossibleEditError(Exception):
    """An edit has no place in the text, or two edits exclude each other."""


class MarsFile(FileText):
    """The configuration or a file that it includes, before any edit."""

    @cached_property
    def blocks(self) -> tuple[tuple[int, int], ...]:
        """Return the first and last lines of the module blocks."""
        return read_blocks(self.path, self.text).lines

    @cached_property
    def token_rows(self) -> list[tuple[Token, ...]]:
        """Return the tokens of each statement."""
        return list(statements(lay_out(self.path, self.text, self.blocks)))

    def statement_at(self, span: Span) -> tuple[Token, ...]:
        """Return the tokens of the statement at a span."""
        return self.token_rows[bisect_right(self._begins, self.offset(span.line, span.column)) - 1]

    def headed(self, *words: str) -> tuple[Token, ...]:
        """Return the tokens of the first statement that begins with one of some words."""
        return next(each for each in self.token_rows if each[0].text in words)

    @cached_property
    def _begins(self) -> list[int]:
        return [tokens[0].begin for tokens in self.token_rows]


class EditedTexts:
    """The texts of a project before any edit, read once for however many edits are tried."""

    def __init__(self, project: Project) -> None:
        """Take a project that was loaded from its texts."""
        self.project = project
        self.path = project.configuration.path
        self._read: dict[str, Read] = {}

    @cached_property
    def mars_files(self) -> Mapping[str, MarsFile]:
        """Return the configuration and the files that it includes, by path."""
        texts = {**self.project.included, self.path: self.project.text}
        return {path: MarsFile(path, text) for path, text in texts.items()}

    def hertz(self, rate: Symbol) -> Fraction | None:
        """Return the rate of a term, or None if it represents none."""
        is_rate = rate.type == SymbolType.Number
        return self.project.rates.hertz(rate.number) if is_rate else None

    @cached_property
    def _ports_by_name(self) -> Mapping[str, tuple[str, str]]:
        return port_names(self.project)

    def end(self, name: Symbol, prefix: str) -> str:
        """Return a module or port as it is written in a file that is included as `prefix`.

        Raises:
            NoPlaceError: the module has no name in that file.
        """
        module, port = self._ports_by_name.get(name.string, (name.string, None))
        return end(_within(prefix, module), port)

    def module_of(self, name: Symbol) -> str:
        """Return the name of a module, or of the module of a port."""
        return self._ports_by_name.get(name.string, (name.string, None))[0]

    @cached_property
    def ranked(self) -> Set[tuple[str, Token]]:
        """Return the control statements of modules with several such statements.

        Each is the path of its file with its first token. If edited, their lists keep their ranks.
        """
        found: dict[str, set[tuple[str, Token]]] = {}
        for each in self.project.configuration.relationships:
            if isinstance(each, Control):
                head = self.mars_files[each.span.path].statement_at(each.span)[0]
                found.setdefault(each.controlled, set()).add((each.span.path, head))
        return {head for heads in found.values() if len(heads) > 1 for head in heads}

    @cached_property
    def relationships(self) -> Mapping[int, Relationship]:
        """Return the relationships of the configuration by their numbers in facts."""
        return dict(numbered(self.project.configuration.relationships))

    @cached_property
    def modules(self) -> Mapping[str, Module]:
        """Return the described modules by name."""
        declared = {m.name: m for m in self.project.configuration.declared}
        return {**self.project.modules, **declared}

    @cached_property
    def annotations(self) -> Mapping[int, Service | Function]:
        """Return the annotations of modules by their numbers in facts."""
        found = numbered_annotations(self.project.configuration, self.project.described)
        return {number: annotation for number, _, annotation in found}

    def annotated(self, path: str) -> Read:
        """Return the annotations of a file."""
        if path not in self._read:
            file = self.mars_files.get(path)
            if file is not None:
                source = block_source(path, file.text, file.blocks)
            else:
                source = read_source(Path(path))
            self._read[path] = read(source)
        return self._read[path]

    def text(self, path: str) -> str:
        """Return the unedited text of a `.mars` file or annotated source, by its path."""
        return (
            self.mars_files[path].text
            if path in self.mars_files
            else self.annotated(path).source.text
        )


def apply_edits(
    texts: EditedTexts, edits: Iterable[Symbol]
) -> tuple[tuple[LineEdit, ...], dict[str, str]]:
    """Return the changed lines, file by file, and the edited texts by path.

    Identifiers in all edits are those of the project that `texts` was made for.

    Raises:
        UnknownEditError: an edit is none of those listed.
        ImpossibleEditError: an edit cannot be written, alone or beside the others.
    """
    drafts = _Drafts(texts)
    try:
        for edit in edits:
            apply = _EDITS.get((edit.name, len(edit.arguments)))
            if apply is None:
                raise UnknownEditError(str(edit))
            apply(drafts, *edit.arguments)
        return drafts.finished()
    except (ConflictError, NoPlaceError, OSError, StopIteration, ValueError) as error:
        raise ImpossibleEditError from error


@dataclass(frozen=True, slots=True)
class _Statement:
    """A statement of a file included as `prefix`, and the draft of that file."""

    draft: Draft
    tokens: tuple[Token, ...]
    prefix: str

    @property
    def end_tokens(self) -> tuple[Token, ...]:
        """Return the tokens of the two modules of a relationship; that of a strategy has one."""
        verb = next(n for n, token in enumerate(self.tokens) if token.text in VERBS)
        if self.tokens[verb].text == "is_arbitrated_by":
            return self.tokens[:1]
        return self.tokens[0], self.tokens[verb + 1]

    @property
    def indent(self) -> str:
        """Return the blanks before the statement on its line."""
        return self.draft.blanks(self.draft.line_at(self.tokens[0].begin))

    def local_name(self, name: str) -> str:
        """Return a module's name as the file writes it.

        Raises:
            NoPlaceError: it has none there.
        """
        return written(_within(self.prefix, name))

    def add_after(self, text: str) -> None:
        """Write a statement on a line of its own after this one."""
        last = self.draft.line_at(self.tokens[-1].begin)
        self.draft.insert(last, "behind", [self.indent + text])

    def rewrite(self, token: Token, text: str) -> None:
        self.draft.put(token.begin, token.end, text)

    def add_word(self, token: Token, text: str) -> None:
        """Write a word after a token."""
        self.draft.put(token.end, token.end, f" {text}")

    def delete(self) -> None:
        """Delete the statement, with all lines that it is on."""
        for token in self.tokens:
            self.draft.delete(self.draft.line_at(token.begin))

    def cut(self, first: Token, last: Token) -> None:
        """Delete tokens, and the blanks before them."""
        begin = len(self.draft.text[: first.begin].rstrip(" \t"))
        self.draft.put(begin, last.end, "")


def _within(prefix: str, name: str) -> str:
    """Return the name of a module in a file included as `prefix`.

    Raises:
        NoPlaceError: the module is outside of that file.
    """
    inner = name_within(prefix, name)
    if inner is None:
        raise NoPlaceError
    return inner


class _Drafts:
    """The texts of a project while they are edited.

    A statement of a file that is included several times is written once, and so changes all
    relationships of its line.
    """

    def __init__(self, texts: EditedTexts) -> None:
        self.texts = texts
        self._drafts: dict[str, Draft] = {}
        self._lists: dict[tuple[str, Token], ListEdit] = {}
        #: The names of converters that edits declare.
        self.converters: list[str] = []

    def finished(self) -> tuple[tuple[LineEdit, ...], dict[str, str]]:
        ranked = self.texts.project.configuration.architecture == "hierarchical"
        for place, edit in self._lists.items():
            edit.write(self.file(place[0]), ranked and place in self.texts.ranked)
        lines: list[LineEdit] = []
        changed = {}
        for path, draft in sorted(self._drafts.items()):
            found = draft.lines()
            lines += found
            if found:
                changed[path] = apply_lines(draft.text, found)
        return tuple(lines), changed

    def file(self, path: str) -> Draft:
        if path not in self._drafts:
            self._drafts[path] = Draft(path, self.texts.text(path))
        return self._drafts[path]

    @property
    def main(self) -> Draft:
        """Return the draft of the configuration file itself, not of an included one."""
        return self.file(self.texts.path)

    def annotations(self, span: Span) -> Annotations:
        return Annotations(self.texts.annotated(span.path), self.file(span.path))

    def statement_with(self, number: Symbol) -> _Statement:
        """Return the statement of the relationship with an identifier."""
        return self.statement_of(self.texts.relationships[number.number])

    def statement_of(self, relationship: Relationship) -> _Statement:
        """Return the statement that states a relationship, with its file's draft and prefix."""
        tokens = self.texts.mars_files[relationship.span.path].statement_at(relationship.span)
        prefix = prefix_of(ends_of(relationship)[0], tokens[0].name)
        return _Statement(self.file(relationship.span.path), tokens, prefix)

    def naming(self, name: Name) -> tuple[_Statement, Member]:
        """Return the `@modules` statement that lists a module, and the module's entry in it."""
        draft = self.file(name.span.path)
        tokens = self.texts.mars_files[name.span.path].statement_at(name.span)
        members = self.members(_Statement(draft, tokens, "")).members
        member = next(each for each in members if each.name.begin == draft.begin(name.span))
        return _Statement(draft, tokens, prefix_of(name.text, member.name.name)), member

    def headed(self, path: str, prefix: str, *words: str) -> _Statement:
        """Return the statement of a file that begins with one of some words."""
        return _Statement(self.file(path), self.texts.mars_files[path].headed(*words), prefix)

    def members(self, statement: _Statement) -> ListEdit:
        """Return the list of names in a statement, to be edited; one object for each statement."""
        place = statement.draft.path, statement.tokens[0]
        if place not in self._lists:
            self._lists[place] = ListEdit(statement.tokens, statement.indent)
        return self._lists[place]

    def member(self, control: Control) -> tuple[_Statement, ListEdit, Member]:
        """Return the statement of a control relationship, its list, and its own entry there."""
        statement = self.statement_of(control)
        listed = self.members(statement)
        offset = statement.draft.begin(control.span)
        named = (each for each in listed.members if each.name.begin == offset)
        return statement, listed, next(named, listed.members[0])

    def common(self, *modules: str) -> tuple[str, str]:
        """Return the path and the prefix of the innermost file in which all modules have names."""
        names = {name.text: name for name in self.texts.project.configuration.modules}
        found = [self.naming(names[each])[0] for each in modules if each in names]
        scopes = {(each.draft.path, each.prefix) for each in found}
        if len(scopes) == 1 and len(found) == len(modules):
            return scopes.pop()
        main = self.texts.path
        return max(
            (
                scope
                for scope in {*scopes, (main, "")}
                if all(name_within(scope[1], each) is not None for each in modules)
            ),
            key=lambda scope: (len(scope[1]), scope[0] == main, scope),
        )

    def free_name(self) -> str:
        """Return a name for a converter that no module has."""
        project = self.texts.project
        taken = {*self.texts.modules, *self.converters}
        taken |= {name.text for name in project.configuration.modules}
        number = 1
        while f"Converter{number}" in taken:
            number += 1
        return f"Converter{number}"


def _require(drafts: _Drafts, number: Symbol, mode: Symbol, rate: Symbol) -> None:
    wanted = mode_of(mode)
    hz = drafts.texts.hertz(rate)
    words = " ".join([wanted.text, *([] if hz is None else [as_written(hz)])])
    statement = drafts.statement_with(number)
    tokens = statement.tokens
    if len(tokens) > 3:
        statement.draft.put(tokens[3].begin, tokens[-1].end, words)
    else:
        statement.add_word(tokens[2], words)


def _free(drafts: _Drafts, number: Symbol) -> None:
    statement = drafts.statement_with(number)
    if len(statement.tokens) > 3:
        statement.cut(statement.tokens[3], statement.tokens[-1])


def _offer(drafts: _Drafts, number: Symbol, mode: Symbol, rate: Symbol) -> None:
    service = drafts.texts.annotations[number.number]
    assert isinstance(service, Service)
    drafts.annotations(service.span).offer(service, mode_of(mode), drafts.texts.hertz(rate))


def _redirect(drafts: _Drafts, number: Symbol, side: Symbol, module: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    if isinstance(declared, Control):
        statement, listed, member = drafts.member(declared)
        name = statement.local_name(module.string)
        if side.name != "first":
            member.new = name
        elif len(listed.members) == 1:
            listed.head = name
        else:
            member.gone = True
            statement.add_after(f"{name} is_controlled_by {member.written()}")
        return
    statement = drafts.statement_of(declared)
    first, second = statement.end_tokens
    name = drafts.texts.end(module, statement.prefix)
    statement.rewrite(first if side.name == "first" else second, name)


def _swap(drafts: _Drafts, number: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    if isinstance(declared, Control):
        statement, listed, member = drafts.member(declared)
        controlled, controller = map(statement.local_name, ends_of(declared))
        if len(listed.members) == 1:
            listed.head = controller
            member.new = controlled
        else:
            member.gone = True
            statement.add_after(f"{controller} is_controlled_by {member.written(name=controlled)}")
        return
    statement = drafts.statement_of(declared)
    first, second = statement.end_tokens
    statement.rewrite(first, second.text)
    statement.rewrite(second, first.text)


def _drop(drafts: _Drafts, number: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    if isinstance(declared, Control):
        *_, member = drafts.member(declared)
        member.gone = True
    else:
        drafts.statement_of(declared).delete()


def _relate(drafts: _Drafts, client: Symbol, source: Symbol) -> None:
    texts = drafts.texts
    module = texts.module_of(client)
    path, prefix = drafts.common(module, texts.module_of(source))
    line = f"{texts.end(client, prefix)} uses_data_from {texts.end(source, prefix)}"
    _neighbour(drafts, path, module).add_after(line)


def _neighbour(drafts: _Drafts, path: str, client: str) -> _Statement:
    """Return the statement after which a new data relationship of a client is best written."""
    every = drafts.texts.project.configuration.relationships
    declared = [each for each in every if each.span.path == path]
    data = [each for each in declared if isinstance(each, Data)]
    near = [each for each in data if each.client == client] or data or declared
    if not near:
        return drafts.headed(path, "", "@modules")
    return drafts.statement_of(max(near, key=lambda each: each.span))


def _edit_priority(drafts: _Drafts, number: Symbol, priority: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    assert isinstance(declared, Control)
    *_, member = drafts.member(declared)
    # A position in a list with the same priority needs no number.
    if declared.priority != priority.number:
        member.rank = priority.number


def _unrank(drafts: _Drafts, number: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    assert isinstance(declared, Control)
    *_, member = drafts.member(declared)
    member.plain = True


def _vertex(drafts: _Drafts, number: Symbol, vertex: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    assert isinstance(declared, Mount)
    statement = drafts.statement_of(declared)
    words = [token.text for token in statement.tokens]
    mounted = words.index("is_mounted_on") + 1
    if declared.mounted_vertex is None:
        statement.add_word(statement.tokens[mounted], str(vertex.number))
    else:
        statement.rewrite(statement.tokens[mounted + 1], str(vertex.number))


def _close(drafts: _Drafts, number: Symbol, duration: Symbol) -> None:
    declared = drafts.texts.relationships[number.number]
    assert isinstance(declared, Gating)
    statement = drafts.statement_of(declared)
    statement.rewrite(statement.tokens[-1], str(duration.number))


def _architecture(drafts: _Drafts, kind: Symbol) -> None:
    """Write the architecture into the configuration, and into included files that state one."""
    for path in drafts.texts.mars_files:
        statement = drafts.headed(path, "", "@configuration", "@specification")
        head, *rest = statement.tokens
        if rest and rest[0].text in ("flat", "hierarchical"):
            statement.rewrite(rest.pop(0), kind.name)
        elif path == drafts.texts.path:
            statement.add_word(head, kind.name)
        if rest:
            statement.cut(rest[0], rest[-1])


def _add_name(drafts: _Drafts, module: Symbol) -> None:
    """Write a name into the `@modules` of the innermost file in which it can be used."""
    main = drafts.texts.path
    declared = drafts.texts.relationships.values()
    mentions = (drafts.statement_of(each) for each in declared if module.string in ends_of(each))
    scopes = {(main, ""), *((each.draft.path, each.prefix) for each in mentions)}
    path, prefix = max(scopes, key=lambda scope: (len(scope[1]), scope[0] == main))
    statement = drafts.headed(path, prefix, "@modules")
    drafts.members(statement).add(statement.local_name(module.string), WIDTH)


def _unname(drafts: _Drafts, module: Symbol) -> None:
    configuration = drafts.texts.project.configuration
    name = next(each for each in configuration.modules if each.text == module.string)
    _, member = drafts.naming(name)
    member.gone = True
    for each in configuration.attributed:
        path = each.attribute.span.path
        if each.module == module.string and path in drafts.texts.mars_files:
            tokens = drafts.texts.mars_files[path].statement_at(each.attribute.span)
            _Statement(drafts.file(path), tokens, "").delete()


def _rename(drafts: _Drafts, old: Symbol, new: Symbol) -> None:
    for declared in drafts.texts.relationships.values():
        ends = ends_of(declared)
        if old.string not in ends:
            continue
        if isinstance(declared, Control):
            statement, listed, member = drafts.member(declared)
            name = statement.local_name(new.string)
            if declared.controlled == old.string:
                listed.head = name
            if declared.controller == old.string:
                member.new = name
            continue
        statement = drafts.statement_of(declared)
        for module, token in zip(ends, statement.end_tokens, strict=False):
            if module == old.string:
                _, port = read_end(token.text) or (module, None)
                statement.rewrite(token, end(_within(statement.prefix, new.string), port))


def _annotate(drafts: _Drafts, module: Symbol, word: Symbol) -> None:
    described = drafts.texts.modules[module.string]
    drafts.annotations(described.span).give(described, word.string)


def _deliver(drafts: _Drafts, module: Symbol, output: Symbol) -> None:
    described = drafts.texts.modules[module.string]
    drafts.annotations(described.span).give(described, "DataOut", output.string)


def _remove(drafts: _Drafts, number: Symbol) -> None:
    annotation = drafts.texts.annotations[number.number]
    drafts.annotations(annotation.span).remove(annotation)


def _declare(drafts: _Drafts, source: Symbol, target: Symbol) -> None:
    """Write the module block of a converter from `source` to `target` after the last block."""
    ends = source.string, target.string
    name = drafts.free_name()
    block = ["@module_start", f"@module_name {name}", "@Converts"]
    if all(_PLAIN_TYPE.fullmatch(each) for each in ends):
        block.append(f"{target.string} convert({source.string} input);")
    else:
        block += [f"@Output {target.string}", f"@Input {source.string}", "void convert();"]
    after = max(
        (last for _, last in drafts.texts.mars_files[drafts.texts.path].blocks),
        default=drafts.main.last,
    )
    gap = [""] if drafts.converters or drafts.main.line(after).strip() else []
    drafts.converters.append(name)
    drafts.main.insert(after, "behind", [*gap, *block, "@module_end"])


_EDITS: dict[tuple[str, int], Callable[..., None]] = {
    ("require", 3): _require,
    ("free", 1): _free,
    ("offer", 3): _offer,
    ("redirect", 3): _redirect,
    ("swap", 1): _swap,
    ("drop", 1): _drop,
    ("relate", 2): _relate,
    ("rank", 2): _edit_priority,
    ("unrank", 1): _unrank,
    ("vertex", 2): _vertex,
    ("close", 2): _close,
    ("architecture", 1): _architecture,
    ("name", 1): _add_name,
    ("unname", 1): _unname,
    ("rename", 2): _rename,
    ("annotate", 2): _annotate,
    ("deliver", 2): _deliver,
    ("remove", 1): _remove,
    ("declare", 2): _declare,
}
