"""What no output shows people: the encoding, and words that only its author understands."""

import re
from collections.abc import Iterator, Mapping

HEADING = "a heading as a reason"
#: By what is wrong, what shows it. Of quoted lines only that they are headings is wrong.
FORBIDDEN: Mapping[str, str] = {
    "an atom or term of the encoding": r"\b[a-z]\w*\((?![A-Z][\w.]*\))",
    "an open value": r"(?<![\w`@.])_(?![\w`])",
    "a variable": r"\b[A-Z]'* = ",
    "an absence by an atom": r"\bno -?[a-z_]+\(|\bnot: ",
    "a number of a relationship or mode": r"\b(?:relationship|mode number|annotation) \d",
    "a unit of the encoding": r"\d mHz\b|milli(?:hertz|onths?)|micromet|thousandths?\b",
    HEADING: r"@module_(?:start|end)",
    "a module of ours": r"\bmars_asp[./]",
    "a path of this machine": r"(?:^|[\s`\"'])/(?:tmp|work|home|root|usr)/",
    "a line that is only a reference": r"^ *(?:\[[\w/.-]+\]|,? ?as in \(\d+\))$",
}
#: A quoted line behind its place.
_QUOTED = re.compile(r"^( +\S+:\d+  ).*$")


def forbidden_in(text: str) -> Iterator[str]:
    """Yield what is forbidden in a text, each with the line where it stands."""
    for line in text.split("\n"):
        own = _QUOTED.sub(r"\1", line)
        for what, pattern in FORBIDDEN.items():
            if re.search(pattern, line if what == HEADING else own):
                yield f"{what}: {line.strip()}"
