"""Contents of a file that were not read or exported: grouped and counted, with their locations."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from mars_asp.diagnostic import NOT_READ, Diagnostic, Span

#: Launch files that nothing can launch.
CIRCLES = "launch files that include themselves"
#: Manifests of packages that no build reads.
MANIFESTS = "manifests of packages with errors"
#: Sorts of files that no parser takes, or that cannot be launched.
BROKEN = frozenset(
    {
        CIRCLES,
        MANIFESTS,
        "launch files with errors",
        "included launch files with errors",
        "parameter files with errors",
    }
)
#: Files that are findings of launch trees as well.
ABSENT = "files that their packages lack"
ABSENT_PARAMETERS = "parameter files that their packages lack"
#: Sorts of files without which nodes lack parameters, and none lacks a node.
OF_PARAMETERS = frozenset(
    {
        ABSENT_PARAMETERS,
        "parameter files that are not in the workspace",
        "parameter files with errors",
    }
)
#: Containers, of which the components are read.
CONTAINERS = "containers, apart from their components,"
#: Actions of launch files that functions or classes of other files make.
IMPORTED = "actions made by imported functions"
_KINDS = {
    **dict.fromkeys(BROKEN, "broken_file"),
    **dict.fromkeys((ABSENT, ABSENT_PARAMETERS), "missing_file"),
}
_MOST_NAMED = 5
_MOST_PLACES = 100


class Unread(NamedTuple):
    """Skipped contents of a file: their sort (in the plural), name and location."""

    sort: str
    name: str
    span: Span


def notes(unread: Iterable[Unread], code: str = NOT_READ) -> Iterator[Diagnostic]:
    """Yield one note for each sort of skipped contents, with their number and locations."""
    for sort, group in groupby(sorted(unread, key=attrgetter("sort", "span")), attrgetter("sort")):
        first, *others = group
        names = list(dict.fromkeys(f"`{each.name}`" for each in (first, *others)))
        named = ", ".join((*names[:_MOST_NAMED], *["..."] * (len(names) > _MOST_NAMED)))
        yield Diagnostic(
            code,
            "note",
            f"{sort} {code.replace('-', ' ')}: {1 + len(others)} ({named})",
            first.span,
            tuple((other.span, f"`{other.name}`") for other in others[:_MOST_PLACES]),
            kind=_KINDS.get(sort, code.replace("-", "_")),
        )
