"""Files that the description of a robot names: meshes, and the descriptions that it includes."""

import re
from collections.abc import Iterator

from mars_asp.diagnostic import Span

#: Endings of descriptions in URDF, with or without xacro.
DESCRIPTIONS = (".urdf", ".xacro")
#: A comment that does not end goes on to the end of the file.
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
#: A file in a package. Other parts with a dollar sign are of xacro, and not known.
_NAMED = re.compile(
    r"<(?P<element>[\w:]+)\s[^<>$]*?\bfilename\s*=\s*(?P<quote>[\"'])"
    r"(?:package://(?P<package>[\w-]+)|(?:file://)?\$\(find\s+(?P<found>[\w-]+)\))"
    r"(?P<inside>/[^\"'$<>]*)(?P=quote)"
)


def files_named(text: str, path: str) -> Iterator[tuple[str, Span, bool]]:
    """Yield path, location and whether it is included, for each file that a description names.

    Paths begin with `$(find-pkg-share PACKAGE)`, as those of launch files do.
    """
    readable = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text)
    line, begin, counted = 1, -1, 0
    for match in _NAMED.finditer(readable):
        at = match.start("quote") + 1
        line += readable.count("\n", counted, at)
        begin, counted = max(begin, readable.rfind("\n", counted, at)), at
        column = at - begin
        package = match["package"] or match["found"]
        span = Span(path, line, column, line, column + match.end("inside") - at)
        is_included = match["element"].rpartition(":")[2] == "include"
        yield f"$(find-pkg-share {package}){match['inside']}", span, is_included
