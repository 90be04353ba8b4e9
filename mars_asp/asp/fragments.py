"""Texts that clingo is given as one, and where in their files it finds something wrong."""

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from mars_asp.asp.signature import plain
from mars_asp.diagnostic import Diagnostic, Span, point

_UNDEFINED = "operation undefined: "
#: A string, which may hold anything, or what is between strings.
_TEXT = re.compile(r'"(?:\\.|[^"\\])*"?|[^"]+')
_NOTE = re.compile(r"<block>:(\d+):(\d+)(?:-[\d:]+)?: (?:error|info): (.*)", re.DOTALL)


class Fragment(NamedTuple):
    """A text, and the file it is from; what was made of a rule stands where that does."""

    text: str
    path: str
    rule: Span | None = None


class Note(NamedTuple):
    """What clingo says of a place; `is_copy` where that is in what was made of a rule."""

    place: Span
    said: str
    is_copy: bool


def joined(fragments: Iterable[Fragment]) -> str:
    """Return the fragments as one text."""
    return "\n".join(fragment.text for fragment in fragments)


def notes(said: Iterable[str], fragments: Sequence[Fragment]) -> Iterator[Note]:
    """Yield what clingo says of the text of some fragments, in the order in which it was said."""
    for match in filter(None, map(_NOTE.match, said)):
        line = int(match[1])
        for fragment in fragments:
            lines = fragment.text.count("\n") + 1
            if line <= lines:
                place = fragment.rule or point(
                    fragment.path, line, _column(fragment, line, int(match[2]))
                )
                yield Note(place, " ".join(match[3].split()), fragment.rule is not None)
                break
            line -= lines


def refusals(said: Iterable[str], fragments: Sequence[Fragment]) -> Iterator[Diagnostic]:
    """Yield why clingo cannot use the text of some fragments, once for each place."""
    found = dict.fromkeys(notes(dict.fromkeys(said), fragments))
    # What was made of a rule has no place of its own, and fails where the rule does.
    for place, told, _ in [note for note in found if not note.is_copy] or found:
        what, colon, term = told.partition(_UNDEFINED)
        if colon and not what:
            message = f"`{term}` has no value" if term.startswith("(") else f"{term}"
            advice = "bind what it is computed from in the body: numbers, and no divisor 0"
            yield Diagnostic("rule-undefined", "error", message, place, help=advice)
        else:
            yield Diagnostic("rules-refused", "error", told, place)


def _column(fragment: Fragment, line: int, column: int) -> int:
    """Return the column in characters of one that clingo counts in bytes, and with name spaces."""
    before = fragment.text.split("\n")[line - 1].encode()[: column - 1].decode(errors="ignore")
    return sum(len(text if text[0] == '"' else plain(text)) for text in _TEXT.findall(before)) + 1
