"""What was not read of a file: grouped, counted, and with the places where it stands."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from mars_asp.diagnostic import NOT_READ, Diagnostic, Span

#: Launch files that nothing can launch.
CIRCLES = "launch files that include themselves"
#: Sorts of files that no parser takes, or that cannot be launched.
BROKEN = frozenset(
    {
        CIRCLES,
        "launch files with errors",
        "included launch files with errors",
        "parameter files with errors",
    }
)
#: Files that are findings of launch trees as well.
ABSENT = "files that their packages lack"
_KINDS = {**dict.fromkeys(BROKEN, "broken_file"), ABSENT: "missing_file"}
_MOST_NAMED = 5
_MOST_PLACES = 100


class Unread(NamedTuple):
    """Something that was not read: what sort of thing, in the plural, its name and place."""

    sort: str
    name: str
    span: Span


def notes(unread: Iterable[Unread]) -> Iterator[Diagnostic]:
    """Yield for each sort of thing how many were not read, and where they stand."""
    for sort, group in groupby(sorted(unread, key=attrgetter("sort", "span")), attrgetter("sort")):
        first, *others = group
        names = list(dict.fromkeys(f"`{each.name}`" for each in (first, *others)))
        named = ", ".join((*names[:_MOST_NAMED], *["..."] * (len(names) > _MOST_NAMED)))
        yield Diagnostic(
            NOT_READ,
            "note",
            f"{sort} not read: {1 + len(others)} ({named})",
            first.span,
            tuple((other.span, f"`{other.name}`") for other in others[:_MOST_PLACES]),
            kind=_KINDS.get(sort, "not_read"),
        )
