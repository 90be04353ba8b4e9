"""Text that no output may show: internal encoding, and words that only its author understands."""

import re
from collections.abc import Iterator, Mapping

from mars_asp.cli.wrapping import cells
from mars_asp.model.declarations import NODE_NAMES
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.rules import load_rulebook

HEADING = "a heading as a reason"
_NOUNS = (
    "annotation|arbiter|client|collision|command|consequence|controller|converter|diagnostic|edit|"
    "error|file|finding|function|input|joint|line|message|module|motion|need|node|note|output|path|"
    "reading|receiver|relationship|repair|representation|rule|run|service|set|source|splitter|step|"
    "transformer|type|unit|warning|way"
)
#: By what is wrong, what shows it. Of quoted evidence only that it is a heading is wrong.
FORBIDDEN: Mapping[str, str] = {
    "an atom or term of the encoding": r"\b[a-z]\w*\((?![A-Z][\w.]*\))",
    "an open value": r"(?<![\w`@.])_(?![\w`])",
    "an open place": r"\{[A-Z]'*(?::\w+)?\}",
    "a variable": r"\b[A-Z]'* = ",
    "an absence by an atom": r"\bno -?[a-z_]+\(|\bnot: ",
    "a number of a relationship or mode": r"\b(?:relationship|mode number|annotation) \d",
    "a unit of the encoding": r"\d mHz\b|milli(?:hertz|onths?)|micromet|thousandths?\b",
    "a bound of the encoding": r"#(?:inf|sup)\b|\bnan\b|\d[eE][+-]?\d{2}\b",
    HEADING: r"@module_(?:start|end)",
    "a module of ours": r"\bmars_asp[./]",
    "a value of Python": r"\b(?:None|True|False)\b|==SUPPRESS==|\b[A-Z]\w*\(\w+=|<\w+ object|\('",
    "a path of this machine": r"(?:^|[\s`\"'])/(?:tmp|work|home|root|usr)/",
    "a line that is only a reference": r"^ *(?:\[[\w/.-]+\]|,? ?as in \(\d+\))$",
    "a number that does not agree": (
        rf"(?<![\w.,:/-])(?:1 (?:{_NOUNS})s|(?:0|[2-9]|[1-9]\d+) (?:{_NOUNS}))\b(?! \d)"
    ),
    "a word to be rid of": (
        r"\bstands\b|\bis told\b|(?<![Tt]here )\bis no\b(?! longer)|\bjust\b|\bwhich so\b"
    ),
}
#: A quoted line: after its location, its number or the mark of an edit.
_QUOTED = re.compile(r"^( +\S+:\d+  | *\d+ \| | +[-+] (?:(?:after|before|behind) )?\S+:\d+: ).*$")
#: An edit, which may add headings.
_EDIT = re.compile(r" +[-+] ")
#: What users write themselves: how modules are mounted.
_MOUNTED = re.compile(r"\((?:[xyz_]|-?[\d.]+)(?:,(?:[xyz_]|-?[\d.]+)){2,6}\)")
#: A consequence or node of a module, which may be named as files of others name theirs.
_SUBJECT = re.compile(
    rf"\b(?:{'|'.join([*consequence_kinds(load_rulebook()), *NODE_NAMES.values()])})\([\w ./#-]+\)"
)
#: A word, and what is written between backticks.
_WORD = re.compile(r"(?:`[^`]*`|\S)+")


def forbidden_in(text: str) -> Iterator[str]:
    """Yield each forbidden pattern of a text, with its line."""
    for line in text.split("\n"):
        own = _MOUNTED.sub("", _SUBJECT.sub("", _QUOTED.sub(r"\1", line)))
        shown = own if _EDIT.match(line) else line
        for what, pattern in FORBIDDEN.items():
            if re.search(pattern, shown if what == HEADING else own):
                yield f"{what}: {line.strip()}"


def wider_than(width: int, text: str) -> Iterator[str]:
    """Yield lines of a text that are wider, but for quoted lines, commands and single words.

    The id of a rule belongs to the word before it.
    """
    for line in text.split("\n"):
        quoted = _QUOTED.match(line) or re.match(r" *\| |.*: mars-asp ", line)
        words = _WORD.findall(re.sub(r" +\[\S+\]$", "", line))
        if cells(line) > width and not quoted and len(words) > 1:
            yield f"{cells(line)} columns: {line.strip()}"
