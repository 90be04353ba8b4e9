"""Comments of a source text, and its code with comments and strings blanked.

Every pattern is total: an alternative that could match an unterminated comment or string does match
it, so lexing is linear whatever the file holds.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass

_BLOCK = r"/\*[\s\S]*?(?:\*/|\Z)"
_LINE = r"//(?:\\\n|[^\n])*+"
_STRING = r'"(?:\\[\s\S]|[^"\\\n])*+"?'
_CHARACTER = r"'(?:\\.|[^'\\\n])*+'?"
_NUMBER = r"(?<![\w])\d(?:'?\w)*+"
_TRIPLE = r'"""(?:\\[\s\S]|(?!""")[\s\S])*+(?:"""|\Z)'
_RAW = r'(?:u8|[uUL])?R"(?P<tag>[^()\\\s"]{0,16}+)\([\s\S]*?(?:\)(?P=tag)"|\Z)'
_PATTERNS = {
    "c": rf"(?P<comment>{_BLOCK}|{_LINE})|{_RAW}|{_STRING}|{_NUMBER}|{_CHARACTER}",
    "java": rf"(?P<comment>{_BLOCK}|{_LINE})|{_TRIPLE}|{_STRING}|{_CHARACTER}",
    "go": rf"(?P<comment>{_BLOCK}|{_LINE})|`[^`]*+`?|{_STRING}|{_CHARACTER}",
    "rust": (
        rf"(?P<comment>{_BLOCK}|{_LINE})|b?r(?P<hash>\#{{0,8}}+)\"[\s\S]*?(?:\"(?P=hash)|\Z)"
        rf"|b?{_STRING}|b?'(?:\\[^\n']*+'|[^'\\\n]')"
    ),
    "python": (
        r"(?P<comment>\#[^\n]*+)"
        r"|[A-Za-z]{0,2}+(?:'''(?:\\[\s\S]|(?!''')[\s\S])*+(?:'''|\Z)|" + _TRIPLE + ")"
        r"|'(?:\\[\s\S]|[^'\\\n])*+'?|" + _STRING
    ),
    "matlab": (
        r"(?P<comment>(?m:^)[ \t]*+%\{[ \t]*+\n[\s\S]*?(?:\n[ \t]*+%\}[ \t]*+(?=\n|\Z)|\Z)"
        r"|%[^\n]*+)|\.\.\.[^\n]*+|(?<=[\w)\]}.'])'|'(?:''|[^'\n])*+'?|\"(?:\"\"|[^\"\n])*+\"?"
    ),
}
_COMPILED = {language: re.compile(pattern) for language, pattern in _PATTERNS.items()}
_LEADING = {
    "c": re.compile(r"[ \t]*(?:/\*[*!]?|//[/!]?|\*(?!/))?[ \t]*"),
    "python": re.compile(r"[ \t]*#*[ \t]*"),
    "matlab": re.compile(r"[ \t]*%*\{?[ \t]*"),
}
LANGUAGES = {
    **dict.fromkeys(
        (".c", ".h", ".cc", ".cpp", ".cxx", ".c++", ".hh", ".hpp", ".hxx", ".h++"), "c"
    ),
    **dict.fromkeys((".ipp", ".inl", ".tpp", ".ino", ".cu", ".cuh"), "c"),
    **dict.fromkeys((".py", ".pyi"), "python"),
    ".java": "java",
    ".rs": "rust",
    ".go": "go",
    ".m": "matlab",
}


@dataclass(frozen=True, slots=True)
class CommentLine:
    """One line of a comment: the offset where its text begins behind the marks, and the text."""

    offset: int
    text: str


@dataclass(frozen=True)
class Lexed:
    """A source: its text, its code (comments and strings blanked), its comment lines."""

    path: str
    language: str
    text: str
    code: str
    comments: tuple[CommentLine, ...]
    starts: tuple[int, ...]

    def position(self, offset: int) -> tuple[int, int]:
        """Return the line and column, from 1, of an offset."""
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def line(self, number: int) -> str:
        """Return a line of the text."""
        end = self.starts[number] if number < len(self.starts) else len(self.text)
        return self.text[self.starts[number - 1] : end].rstrip("\n")


def lex(path: str, language: str, text: str) -> Lexed:
    r"""Split a text, whose lines end with `\n`, into code and comments."""
    comments: list[CommentLine] = []
    pieces: list[str] = []
    last = 0
    dead = tuple(_dead_stretches(text)) if language == "c" and "#if" in text else ()
    for match in _matches(language, text):
        begin, end = match
        comment = text.startswith(_MARKS[language], begin) or _is_block(language, text, begin)
        pieces.append(text[last:begin])
        blank = re.sub(r"[^\n]", " ", text[begin:end])
        if comment:
            if not any(low <= begin < high for low, high in dead):
                comments += _lines(language, text, begin, end)
            pieces.append(blank)
        elif text[begin].isdigit() or text[begin:end] == "'":
            pieces.append(text[begin:end])
        elif text[begin:end].startswith("..."):
            pieces.append(blank)
        else:
            # A string stays visible as a string, whatever it holds.
            pieces.append('"' + blank[1:-1] + '"' if end - begin > 1 else blank)
        last = end
    pieces.append(text[last:])
    code = "".join(pieces)
    for low, high in dead:
        code = code[:low] + re.sub(r"[^\n]", " ", code[low:high]) + code[high:]
    starts = (0, *(found.end() for found in re.finditer("\n", text)))
    return Lexed(path, language, text, code, tuple(comments), starts)


_MARKS = {
    "c": ("//", "/*"),
    "java": ("//", "/*"),
    "go": ("//", "/*"),
    "rust": ("//", "/*"),
    "python": ("#",),
    "matlab": ("%",),
}


def _is_block(language: str, text: str, begin: int) -> bool:
    return language == "matlab" and text[begin] in " \t"


def _matches(language: str, text: str) -> Iterator[tuple[int, int]]:
    pattern = _COMPILED[language]
    at = 0
    while match := pattern.search(text, at):
        begin, end = match.span()
        if language == "rust" and text.startswith("/*", begin):
            end = _nested_end(text, begin)
        yield begin, end
        at = max(end, begin + 1)


def _nested_end(text: str, begin: int) -> int:
    """Return where a block comment of Rust, in which others nest, ends."""
    depth = 0
    for match in re.compile(r"/\*|\*/").finditer(text, begin):
        depth += 1 if match[0] == "/*" else -1
        if not depth:
            return match.end()
    return len(text)


def _lines(language: str, text: str, begin: int, end: int) -> Iterator[CommentLine]:
    leading = _LEADING.get(language, _LEADING["c"])
    at = begin
    while at < end:
        stop = text.find("\n", at, end)
        stop = end if stop < 0 else stop
        match = leading.match(text, at, stop)
        first = match.end() if match else at
        content = text[first:stop]
        if content.rstrip().endswith("*/") and text.startswith("/*", begin):
            content = content.rstrip().removesuffix("*/")
        yield CommentLine(first, content.rstrip())
        at = stop + 1


def _dead_stretches(text: str) -> Iterator[tuple[int, int]]:
    """Yield what stands between `#if 0` and its `#else`, `#elif` or `#endif`."""
    directive = re.compile(r"(?m)^[ \t]*#[ \t]*(if|ifdef|ifndef|else|elif|endif)\b[ \t]*([^\n]*)")
    depth, start = 0, -1
    for match in directive.finditer(text):
        word = match[1]
        if start < 0:
            if word == "if" and match[2].split("//")[0].strip() in ("0", "false"):
                start, depth = match.end(), 1
            continue
        if word.startswith("if"):
            depth += 1
        elif word == "endif":
            depth -= 1
        if not depth or (depth == 1 and word in ("else", "elif")):
            yield start, match.start()
            start, depth = -1, 0
    if start >= 0:
        yield start, len(text)
