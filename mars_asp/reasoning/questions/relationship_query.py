"""Questions about lines: a relationship as a configuration states it, or a location."""

import re
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import (
    GATING,
    VERBS,
    Relationship,
    Strategy,
    ends_of,
    ports_of,
    verb_of,
)
from mars_asp.model.names import end, quoted, read_end, written
from mars_asp.reasoning.facts.identifiers import numbered_annotations
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.subject import wrong_subject
from mars_asp.spelling import nearest

_NAME = r'(?:"(?:[^"\\]|\\.)*"|[^\s"(),.]+)'
_END = rf"{_NAME}(?:\.{_NAME})?"
_RELATIONSHIP = re.compile(rf"({_END})\s+([a-z_]+)\s+({_END})(?:\s.*)?")
_ATOM = re.compile(rf"({'|'.join(VERBS)})\(\s*({_END})\s*,\s*({_END})\s*\)")
_WORD = re.compile(r"[^\W\d]\w*")
_PLACE = re.compile(r"(.*):([0-9]{1,18})")


class RelationshipQuery(NamedTuple):
    """A relationship as a configuration states it, each end with its port where one is named."""

    keyword: str
    left: str
    right: str

    @property
    def line(self) -> str:
        """Return the text of the line."""
        return f"{self.left} {self.keyword} {self.right}"

    @property
    def atom(self) -> str:
        """Return the atom of the relationship, without the input of the client."""
        client, port = read_end(self.left) or (self.left, None)
        if self.keyword in GATING.values():
            client = ".".join(filter(None, (client, port)))
        source = ".".join(filter(None, read_end(self.right) or (self.right, None)))
        return f"{self.keyword}({_quoted_name(client)},{_quoted_name(source)})"


def _quoted_name(name: str) -> str:
    return name if _WORD.fullmatch(name) else quoted(name)


def read_relationship(subject: str, project: Project) -> RelationshipQuery | None:
    """Return the relationship in a subject like `A uses_data_from B`, or None for another.

    Raises:
        MarsError: the word between two ends resembles a relationship, but is not one.
    """
    atom, words = _ATOM.fullmatch(subject), _RELATIONSHIP.fullmatch(subject)
    if atom is not None:
        return RelationshipQuery(atom[1], _end_text(atom[2]), _end_text(atom[3]))
    if words is None or subject in {name.text for name in project.configuration.modules}:
        return None
    if words[2] not in VERBS:
        near = nearest(words[2], VERBS)
        if near is None:
            return None
        message = f"`{words[2]}` is not a relationship"
        raise wrong_subject(project, message, f"did you mean `{near}`?")
    return RelationshipQuery(words[2], _end_text(words[1]), _end_text(words[3]))


def lines_meant(subject: str, project: Project) -> tuple[Span, ...]:
    """Return the locations of the lines that a subject names: a relationship, or `FILE:LINE`.

    They are empty if the subject has neither form.

    Raises:
        MarsError: no line states the relationship, or the location has no statement.
    """
    place = _PLACE.fullmatch(subject)
    if place is not None:
        found = tuple(
            span
            for span in _statement_spans(project)
            if span.line == int(place[2]) and f"/{span.path}".endswith(f"/{place[1]}")
        )
        if not found and any(
            f"/{s.path}".endswith(f"/{place[1]}") for s in _statement_spans(project)
        ):
            help_text = "name a line with a relationship or an annotation"
            raise wrong_subject(project, f"nothing is stated at {subject}", help_text)
        return found
    wanted = read_relationship(subject, project)
    if wanted is None:
        return ()
    lines = tuple(
        each.span for each in project.configuration.relationships if wanted in _forms(each)
    )
    if not lines:
        names = {name.text for name in project.configuration.modules}
        help_text = f"`--why-not '{wanted.line}'` shows what would give one"
        for name in wanted[1:]:
            module = (read_end(name) or (name, None))[0]
            near = None if module in names else nearest(module, names)
            help_text = f"did you mean `{written(near)}`?" if near else help_text
        raise wrong_subject(project, f"there is no line `{wanted.line}`", help_text)
    return lines


def _end_text(text: str) -> str:
    """Return an end as a configuration writes it."""
    read = read_end(text)
    return text if read is None else end(*read)


def _forms(line: Relationship) -> Iterator[RelationshipQuery]:
    """Yield a relationship with and without each of its ports, as a query may name it."""
    left, right = ends_of(line)
    if isinstance(line, Strategy):
        yield RelationshipQuery(verb_of(line), written(left), line.strategy)
        return
    for first, second in product(*({None, port} for port in ports_of(line))):
        yield RelationshipQuery(verb_of(line), end(left, first), end(right, second))


def _statement_spans(project: Project) -> Iterator[Span]:
    configuration = project.configuration
    yield configuration.span
    yield from (each.span for each in (*configuration.modules, *configuration.relationships))
    for _, _, annotation in numbered_annotations(configuration, project.described):
        yield annotation.span
