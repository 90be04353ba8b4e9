"""Edits of a project, as the rules of `rules/repair` propose them, written into its texts.

An edit is a term such as `drop(3)` or `rename("Sonr","Sonar")`; `docs/what-if.md` lists them.
"""

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from clingo import Symbol, SymbolType

from mars_asp.annotations.blocks import block_source, read_blocks
from mars_asp.annotations.files import read_source
from mars_asp.diagnostic import Span
from mars_asp.language.layout import Layout, lay_out
from mars_asp.language.print import WIDTH
from mars_asp.language.statement_edits import ListEdit, Member
from mars_asp.language.text_edits import ConflictError, Draft, LineEdit, apply_lines
from mars_asp.language.tokens import Token, statements
from mars_asp.model.declarations import (
    Control,
    Data,
    Function,
    Module,
    Mount,
    Relationship,
    Service,
)
from mars_asp.model.described import described_modules
from mars_asp.model.names import end, read_end, written
from mars_asp.model.rates import as_written
from mars_asp.reasoning.facts.identifiers import mode_of, numbered, numbered_annotations
from mars_asp.reasoning.facts.rates import Rates, rates_in
from mars_asp.reasoning.project import Project, port_names
from mars_asp.reasoning.questions.annotation_edits import Annotations, NoPlaceError, Read, read

_VERBS = ("uses_data_from", "is_mounted_on")
_PLAIN_TYPE = re.compile(r"[A-Za-z_]\w*(?:::\w+)*")


class UnknownEditError(Exception):
    """A rule proposes an edit that is none of those listed."""


class ImpossibleEditError(Exception):
    """An edit has no place in the text, or two edits exclude each other."""


class Texts:
    """The texts of a project before any edit, read once for however many edits are tried."""

    def __init__(self, project: Project) -> None:
        """Take a project that was loaded from its texts."""
        self.project = project
        self.path = project.configuration.path
        self._read: dict[str, Read] = {}

    @cached_property
    def blocks(self) -> tuple[tuple[int, int], ...]:
        """Return the first and last lines of the module blocks."""
        return read_blocks(self.path, self.project.text).lines

    @cached_property
    def layout(self) -> Layout:
        """Return the layout of the configuration."""
        return lay_out(self.path, self.project.text, self.blocks)

    @cached_property
    def statements(self) -> list[tuple[Token, ...]]:
        """Return the tokens of each statement of the configuration."""
        return list(statements(self.layout))

    def hertz(self, rate: Symbol) -> Fraction | None:
        """Return the rate of a term; `None` where it stands for none."""
        return self._rates.hertz(rate.number) if rate.type == SymbolType.Number else None

    @cached_property
    def _rates(self) -> Rates:
        configuration = self.project.configuration
        known = described_modules(configuration, self.project.modules)
        return rates_in(configuration, known)

    @cached_property
    def _ports(self) -> Mapping[str, tuple[str, str]]:
        return port_names(self.project)

    def end(self, name: Symbol) -> str:
        """Return a module or a port as a line writes it."""
        module, port = self._ports.get(name.string, (name.string, None))
        return end(module, port)

    def module_of(self, name: Symbol) -> str:
        """Return a module, or that of a port."""
        return self._ports.get(name.string, (name.string, None))[0]

    @cached_property
    def controlled(self) -> Counter[str]:
        """Return how many statements control each module."""
        return Counter(
            tokens[0].name
            for tokens in self.statements
            if any(token.text == "is_controlled_by" for token in tokens)
        )

    @cached_property
    def relationships(self) -> Mapping[int, Relationship]:
        """Return the relationships by identifier."""
        return dict(numbered(self.project.configuration.relationships))

    @cached_property
    def modules(self) -> Mapping[str, Module]:
        """Return the described modules by name."""
        declared = {m.name: m for m in self.project.configuration.declared}
        return {**self.project.modules, **declared}

    @cached_property
    def annotations(self) -> Mapping[int, Service | Function]:
        """Return the annotations by identifier."""
        project = self.project
        described = described_modules(project.configuration, project.modules)
        found = numbered_annotations(project.configuration, described)
        return {number: annotation for number, _, annotation in found}

    def annotated(self, path: str) -> Read:
        """Return the annotations of a file."""
        if path not in self._read:
            if path == self.path:
                source = block_source(path, self.project.text, self.blocks)
            else:
                source = read_source(Path(path))
            self._read[path] = read(source)
        return self._read[path]

    def text(self, path: str) -> str:
        """Return the text of a file."""
        return self.project.text if path == self.path else self.annotated(path).source.text


def apply_edits(
    texts: Texts, edits: Iterable[Symbol]
) -> tuple[tuple[LineEdit, ...], dict[str, str]]:
    """Return the lines that change, file by file, and the texts that come out, by path.

    Identifiers in all edits are those of the project that `texts` are of.

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


class _Drafts:
    """The texts of a project while they are edited."""

    def __init__(self, texts: Texts) -> None:
        self.texts = texts
        self._drafts: dict[str, Draft] = {}
        self._lists: dict[int, ListEdit] = {}
        #: The names of converters that edits declare.
        self.converters: list[str] = []

    def finished(self) -> tuple[tuple[LineEdit, ...], dict[str, str]]:
        ranked = self.texts.project.configuration.architecture == "hierarchical"
        for edit in self._lists.values():
            edit.write(
                self.file(self.texts.path),
                ranked and self.texts.controlled[edit.tokens[0].name] > 1,
            )
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
        """Return the draft of the configuration."""
        return self.file(self.texts.path)

    def annotations(self, span: Span) -> Annotations:
        return Annotations(self.texts.annotated(span.path), self.file(span.path))

    def statement(self, span: Span) -> int:
        """Return which statement stands at a span.

        Raises:
            NoPlaceError: it stands in a file that the configuration includes.
        """
        if span.path != self.texts.path:
            raise NoPlaceError
        offset = self.main.begin(span)
        begins = self._begins
        return bisect_right(begins, offset) - 1

    @cached_property
    def _begins(self) -> list[int]:
        return [tokens[0].begin for tokens in self.texts.statements]

    def headed(self, *words: str) -> int:
        """Return the statement that begins with one of some words."""
        found = (n for n, each in enumerate(self.texts.statements) if each[0].text in words)
        return next(found)

    def members(self, at: int) -> ListEdit:
        """Return the edit of a statement that lists names."""
        if at not in self._lists:
            self._lists[at] = ListEdit(self.texts.statements[at], self.indent(at))
        return self._lists[at]

    def member(self, control: Control) -> tuple[ListEdit, Member]:
        """Return the statement of a control relationship and its member that names it."""
        listed = self.members(self.statement(control.span))
        offset = self.main.begin(control.span)
        named = (each for each in listed.members if each.name.begin == offset)
        return listed, next(named, listed.members[0])

    def indent(self, at: int) -> str:
        """Return what stands before a statement on its line."""
        return self.main.blanks(self.main.line_at(self._begins[at]))

    def add(self, at: int, text: str) -> None:
        """Write a statement on a line of its own behind another."""
        last = self.main.line_at(self.texts.statements[at][-1].begin)
        self.main.insert(last, "behind", [self.indent(at) + text])

    def replace(self, token: Token, text: str) -> None:
        self.main.put(token.begin, token.end, text)

    def behind(self, token: Token, text: str) -> None:
        """Write a word behind a token."""
        self.main.put(token.end, token.end, f" {text}")

    def drop(self, at: int) -> None:
        """Leave a statement out, with all lines that it stands on."""
        for token in self.texts.statements[at]:
            self.main.delete(self.main.line_at(token.begin))

    def remove(self, first: Token, last: Token) -> None:
        """Leave out tokens, and the blanks before them."""
        text = self.main.text
        begin = len(text[: first.begin].rstrip(" \t"))
        self.main.put(begin, last.end, "")

    def names_of(self, at: int) -> tuple[Token, Token]:
        """Return the tokens of a data or mount relationship that name modules."""
        tokens = self.texts.statements[at]
        verbs = (n for n, token in enumerate(tokens) if token.text in _VERBS)
        return tokens[0], tokens[next(verbs) + 1]

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
    stated = drafts.texts.relationships[number.number]
    wanted = mode_of(mode)
    hz = drafts.texts.hertz(rate)
    words = [wanted.text, *([] if hz is None else [as_written(hz)])]
    at = drafts.statement(stated.span)
    tokens = drafts.texts.statements[at]
    if len(tokens) > 3:
        drafts.main.put(tokens[3].begin, tokens[-1].end, " ".join(words))
    else:
        drafts.behind(tokens[2], " ".join(words))


def _free(drafts: _Drafts, number: Symbol) -> None:
    tokens = drafts.texts.statements[
        drafts.statement(drafts.texts.relationships[number.number].span)
    ]
    if len(tokens) > 3:
        drafts.remove(tokens[3], tokens[-1])


def _offer(drafts: _Drafts, number: Symbol, mode: Symbol, rate: Symbol) -> None:
    service = drafts.texts.annotations[number.number]
    assert isinstance(service, Service)
    drafts.annotations(service.span).offer(service, mode_of(mode), drafts.texts.hertz(rate))


def _redirect(drafts: _Drafts, number: Symbol, side: Symbol, module: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    if isinstance(stated, Control):
        listed, member = drafts.member(stated)
        if side.name != "first":
            listed.rename(member, written(module.string))
        elif len(listed.members) == 1:
            listed.head = written(module.string)
        else:
            listed.drop(member)
            line = f"{written(module.string)} is_controlled_by {member.written()}"
            drafts.add(drafts.statement(stated.span), line)
        return
    first, second = drafts.names_of(drafts.statement(stated.span))
    drafts.replace(first if side.name == "first" else second, drafts.texts.end(module))


def _swap(drafts: _Drafts, number: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    if isinstance(stated, Control):
        listed, member = drafts.member(stated)
        if len(listed.members) == 1:
            listed.head = written(stated.controller)
            listed.rename(member, written(stated.controlled))
        else:
            listed.drop(member)
            rest = member.written(name=written(stated.controlled))
            line = f"{written(stated.controller)} is_controlled_by {rest}"
            drafts.add(drafts.statement(stated.span), line)
        return
    first, second = drafts.names_of(drafts.statement(stated.span))
    drafts.replace(first, second.text)
    drafts.replace(second, first.text)


def _drop(drafts: _Drafts, number: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    if isinstance(stated, Control):
        listed, member = drafts.member(stated)
        listed.drop(member)
    else:
        drafts.drop(drafts.statement(stated.span))


def _relate(drafts: _Drafts, client: Symbol, source: Symbol) -> None:
    line = f"{drafts.texts.end(client)} uses_data_from {drafts.texts.end(source)}"
    drafts.add(_neighbour(drafts, drafts.texts.module_of(client)), line)


def _neighbour(drafts: _Drafts, client: str) -> int:
    """Return the statement behind which a data relationship of a client stands best."""
    stated = drafts.texts.project.configuration.relationships
    data = [each for each in stated if isinstance(each, Data)]
    near = [each for each in data if each.client == client] or data or stated
    return max((drafts.statement(each.span) for each in near), default=drafts.headed("@modules"))


def _rank(drafts: _Drafts, number: Symbol, priority: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    assert isinstance(stated, Control)
    listed, member = drafts.member(stated)
    # What a place in a list says already needs no number.
    if stated.priority != priority.number:
        listed.rank(member, priority.number)


def _unrank(drafts: _Drafts, number: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    assert isinstance(stated, Control)
    listed, member = drafts.member(stated)
    listed.unrank(member)


def _vertex(drafts: _Drafts, number: Symbol, vertex: Symbol) -> None:
    stated = drafts.texts.relationships[number.number]
    assert isinstance(stated, Mount)
    tokens = drafts.texts.statements[drafts.statement(stated.span)]
    words = [token.text for token in tokens]
    mounted = words.index("is_mounted_on") + 1
    if stated.mounted_vertex is None:
        drafts.behind(tokens[mounted], str(vertex.number))
    else:
        drafts.replace(tokens[mounted + 1], str(vertex.number))


def _architecture(drafts: _Drafts, kind: Symbol) -> None:
    tokens = drafts.texts.statements[drafts.headed("@configuration", "@specification")]
    if len(tokens) > 1 and tokens[1].text in ("flat", "hierarchical"):
        drafts.replace(tokens[1], kind.name)
        rest = tokens[2:]
    else:
        drafts.behind(tokens[0], kind.name)
        rest = tokens[1:]
    if rest:
        drafts.remove(rest[0], rest[-1])


def _name(drafts: _Drafts, module: Symbol) -> None:
    drafts.members(drafts.headed("@modules")).add(written(module.string), WIDTH)


def _unname(drafts: _Drafts, module: Symbol) -> None:
    listed = drafts.members(drafts.headed("@modules"))
    listed.drop(next(each for each in listed.members if each.name.name == module.string))
    for each in drafts.texts.project.configuration.attributed:
        if each.module == module.string and each.attribute.span.path == drafts.texts.path:
            drafts.drop(drafts.statement(each.attribute.span))


def _rename(drafts: _Drafts, old: Symbol, new: Symbol) -> None:
    for stated in drafts.texts.relationships.values():
        if isinstance(stated, Control):
            if stated.controlled == old.string:
                listed, _ = drafts.member(stated)
                listed.head = written(new.string)
            if stated.controller == old.string:
                listed, member = drafts.member(stated)
                listed.rename(member, written(new.string))
        else:
            for token in drafts.names_of(drafts.statement(stated.span)):
                if token.name == old.string:
                    _, port = read_end(token.text) or (old.string, None)
                    drafts.replace(token, end(new.string, port))


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
    """Write a module block behind the last one, else at the end of the file."""
    ends = source.string, target.string
    name = drafts.free_name()
    block = ["@module_start", f"@module_name {name}", "@Converts"]
    if all(_PLAIN_TYPE.fullmatch(each) for each in ends):
        block.append(f"{target.string} convert({source.string} input);")
    else:
        block += [f"@Output {target.string}", f"@Input {source.string}", "void convert();"]
    behind = max((last for _, last in drafts.texts.blocks), default=drafts.main.last)
    gap = [""] if drafts.converters or drafts.main.line(behind).strip() else []
    drafts.converters.append(name)
    drafts.main.insert(behind, "behind", [*gap, *block, "@module_end"])


_EDITS: dict[tuple[str, int], Callable[..., None]] = {
    ("require", 3): _require,
    ("free", 1): _free,
    ("offer", 3): _offer,
    ("redirect", 3): _redirect,
    ("swap", 1): _swap,
    ("drop", 1): _drop,
    ("relate", 2): _relate,
    ("rank", 2): _rank,
    ("unrank", 1): _unrank,
    ("vertex", 2): _vertex,
    ("architecture", 1): _architecture,
    ("name", 1): _name,
    ("unname", 1): _unname,
    ("rename", 2): _rename,
    ("annotate", 2): _annotate,
    ("deliver", 2): _deliver,
    ("remove", 1): _remove,
    ("declare", 2): _declare,
}
