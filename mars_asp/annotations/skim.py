"""Annotated comments of a source, found without parsing other code.

For each language, one match of a pattern passes over code, strings and comments without annotation.
So Python takes a step only for a comment with an annotation, or for a construct that no pattern
describes: raw strings with a tag, nested comments. Every alternative is possessive and ends at the
end of the text at the latest, so skimming is linear for any file.

The text is bytes, in UTF-8 or Latin-1: the delimiters of code, strings and comments are ASCII in
all languages, and a file needs no more memory than its bytes.
"""

import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import AnyStr

_LETTER = rb"[\w\x80-\xff]"
#: Frequent words of documentation, which are never annotations.
_TAG = rb"(?!(?:param|returns?|brief|throws|see|since|note)\b)"
#: A word that may be an annotation word; a non-ASCII byte in it may also end it.
_WORD = _TAG + rb"[A-Za-z](?:\w{2,20}+(?![\w(.])|\w{0,20}+[\x80-\xff])"
_OTHER = rb"@(?!" + _WORD + rb")"
_STRING = rb'"(?:[^"\\\n]++|\\[\s\S])*+"?'
_CHARACTER = rb"'(?:[^'\\\n]++|\\.)*+'?"
_LINE = rb"//(?:[^\n@\\]++|\\\n?|" + _OTHER + rb")*+(?!@)"
_BLOCK = rb"/\*(?:[^*@]++|\*(?!/)|" + _OTHER + rb")*+\*/"
_SLASH = rb"/(?![/*])"


def _nested(depth: int) -> bytes:
    """Return a pattern of block comments that are nested up to a depth."""
    inside = rb"" if depth == 1 else rb"|" + _nested(depth - 1)
    return rb"/\*(?:[^*/@]++|\*(?!/)|/(?!\*)|" + _OTHER + inside + rb")*+\*/"


def _triple(quote: bytes) -> bytes:
    whole = quote * 3
    inside = rb"(?:[^\\" + quote + rb"]++|\\[\s\S]?|" + quote + rb"(?!" + quote * 2 + rb"))*+"
    return whole + inside + rb"(?:" + whole + rb"|\Z)"


_PASSED = {
    "c": (
        rb"""[^"'/0-9]++""",
        # A number may contain quotes; a string directly after it is never raw.
        rb"(?<!" + _LETTER + rb")[0-9](?:'?" + _LETTER + rb")*+(?:" + _STRING + rb")?+",
        rb"[0-9]++",
        rb"(?<!R)" + _STRING,
        _CHARACTER,
        _LINE,
        _BLOCK,
        _SLASH,
    ),
    "java": (rb"""[^"'/]++""", _triple(b'"'), _STRING, _CHARACTER, _LINE, _BLOCK, _SLASH),
    "go": (rb"""[^"'/`]++""", rb"`[^`]*+`?", _STRING, _CHARACTER, _LINE, _BLOCK, _SLASH),
    "rust": (
        rb"""[^"'/]++""",
        rb"(?<![r#])" + _STRING,
        rb"'(?:\\[^\n']*+'|[^'\\\n\x80-\xff]'|[\xc2-\xf4][\x80-\xbf]{1,3}')?",
        _LINE,
        _nested(3),
        _SLASH,
    ),
    "python": (
        rb"""[^"'#]++""",
        _triple(b'"'),
        _triple(b"'"),
        rb"'(?:[^'\\\n]++|\\[\s\S])*+'?",
        _STRING,
        rb"#(?:[^\n@]++|" + _OTHER + rb")*+(?!@)",
    ),
    "matlab": (
        rb"""[^"'%.]++""",
        rb"\.\.\.[^\n]*+",
        rb"\.",
        rb"(?<=[\w)\]}.'\x80-\xff])'",
        rb"'(?:[^'\n]++|'')*+'?",
        rb'"(?:[^"\n]++|"")*+"?',
        rb"%(?!\{[ \t]*+\n)(?:[^\n@]++|" + _OTHER + rb")*+(?!@)",
    ),
    "mars": (rb"[^@/#]++", rb"//[^\n]*+", rb"#[^\n]*+", rb"/", rb"(?<=[^ \t\n])@"),
}
_SLASHES = rb"//(?:[^\n\\]++|\\\n?)*+"
#: Comments to the end of their line, which most annotations are in.
_LINES = {
    **dict.fromkeys(("c", "java", "go", "rust"), _SLASHES),
    "python": rb"#[^\n]*+",
    "matlab": rb"%(?!\{[ \t]*+\n)[^\n]*+",
}
_RAW_C = re.compile(rb'"([^()\\\s"]{0,16}+)\(')
#: The marks of nested block comments; those that open a comment have a group.
_NEST = {
    "rust": re.compile(rb"(/\*)|\*/"),
    "matlab": re.compile(rb"(?m)^[ \t]*+(?:(%\{)|%\})[ \t]*+$"),
}
_STRING_HERE = re.compile(_STRING)
_LINE_HERE = re.compile(_SLASHES)
#: In quotes, `#` and `//` begin no comment.
_ANNOTATION_HERE = re.compile(rb'(?:[^\n/#"]++|"(?:[^"\\\n]|\\.)*+"|"|/(?!/))*+')
_MATLAB_OPENING = re.compile(rb"%\{[ \t]*+(?=\n)")


@cache
def _pattern(language: str) -> re.Pattern[bytes]:
    """Return the pattern that passes over code; its group is the line comment at which it stops."""
    line = _LINES.get(language, rb"(?!)")
    return re.compile(rb"(?:" + rb"|".join(_PASSED[language]) + rb")*+(" + line + rb")?+")


def annotated_comments(language: str, data: bytes, at: int = 0) -> Iterator[tuple[int, int]]:
    """Yield the begin and end of each comment with a word that may be an annotation.

    Args:
        language: A key of the languages, or `mars` for module blocks of a configuration.
        data: The text, whose lines end with LF.
        at: The offset to begin at, outside of all strings and comments.
    """
    skip = _pattern(language).match
    last = data.rfind(b"@")
    while at <= last:
        found = skip(data, at)
        assert found is not None, "the pattern matches the empty string"
        begin, end = found.span(1)
        is_comment = begin >= 0
        if not is_comment:
            begin = found.end()
            if begin > last:
                return
            end, is_comment = _construct(language, data, begin)
        if is_comment:
            yield begin, end
        at = end


def _construct(language: str, data: bytes, at: int) -> tuple[int, bool]:
    """Return the end of the construct at an offset, and whether it is a comment."""
    first = data[at : at + 1]
    if first == b'"':
        return _string_end(language, data, at), False
    if first == b"%" and not _is_block(data, at):
        return _line_end(data, at), True
    if first == b"@":
        if data[data.rfind(b"\n", 0, at) + 1 : at].strip(b" \t"):
            return at + 1, False
        return annotation_end(data, at), True
    return comment_end(language, data, at), True


def annotation_end(data: bytes, at: int) -> int:
    """Return the end of an annotation without comment marks, or of a continuation line."""
    found = _ANNOTATION_HERE.match(data, at)
    return found.end() if found else at


def comment_end(language: str, data: bytes, at: int) -> int:
    """Return the end of the comment that begins at an offset."""
    if data.startswith(b"//", at):
        found = _LINE_HERE.match(data, at)
        return found.end() if found else at + 2
    if data.startswith(b"/*", at):
        if language == "rust":
            return nested_end(_NEST["rust"].finditer(data, at), len(data))
        end = data.find(b"*/", at + 2)
        return len(data) if end < 0 else end + 2
    if data.startswith(b"@", at):
        return annotation_end(data, at)
    if data.startswith(b"%", at) and _is_block(data, at):
        marks = _NEST["matlab"].finditer(data, data.rfind(b"\n", 0, at) + 1)
        return nested_end(marks, len(data))
    return _line_end(data, at)


def _line_end(data: bytes, at: int) -> int:
    end = data.find(b"\n", at)
    return len(data) if end < 0 else end


def _is_block(data: bytes, at: int) -> bool:
    """Whether `%{` of MATLAB is alone on its line."""
    start = data.rfind(b"\n", 0, at) + 1
    return _MATLAB_OPENING.match(data, at) is not None and not data[start:at].strip(b" \t")


def nested_end(marks: Iterable[re.Match[AnyStr]], last: int) -> int:
    """Return the end of a block comment of Rust or MATLAB, which can contain others.

    Args:
        marks: The marks of block comments from its own on; those that open have a group.
        last: The end of the text, which ends an unclosed comment.
    """
    depth = 0
    for mark in marks:
        depth += 1 if mark.lastindex else -1
        if not depth:
            return mark.end()
    return last


def inner_comments(language: str, data: bytes, begin: int, end: int) -> Iterator[tuple[int, int]]:
    """Yield the begin and end of each comment that is nested in a block comment, in order."""
    if language not in _NEST:
        return
    depth = opened = 0
    line = begin if language == "rust" else data.rfind(b"\n", 0, begin) + 1
    for mark in _NEST[language].finditer(data, line, end):
        depth += 1 if mark.lastindex else -1
        if depth == 2 and mark.lastindex:
            opened = mark.start()
        elif depth == 1 and not mark.lastindex:
            yield opened, mark.end()
    if depth > 1:
        yield opened, end


def _string_end(language: str, data: bytes, at: int) -> int:
    """Return the end of a string, which may be a raw one: `R"tag(...)tag"`, `r#"..."#`."""
    closing = None
    if language == "c":
        opening = _RAW_C.match(data, at)
        if opening is not None:
            closing, begin = b")" + opening[1] + b'"', opening.end()
    else:
        hashes = 0
        while hashes < 9 and data[at - hashes - 1 : at - hashes] == b"#":
            hashes += 1
        before = at - hashes - 1
        if hashes < 9 and before >= 0 and data[before : before + 1] == b"r":
            closing, begin = b'"' + b"#" * hashes, at + 1
    if closing is not None:
        end = data.find(closing, begin)
        return len(data) if end < 0 else end + len(closing)
    found = _STRING_HERE.match(data, at)
    return found.end() if found else at + 1
