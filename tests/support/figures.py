"""The figures of words and size that `tests/test_ratchet.py` compares with `tests/ratchet.toml`.

Each figure of each package is a list of places, and has a goal.
"""

import ast
import re
from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import accumulate, chain
from pathlib import Path
from typing import NamedTuple

#: Wording that reads like a translation, with the correction.
PATTERNS = {
    r"\b(?<![Tt]here )(?:is|are) no (?!longer\b)": "is not a ..., expected a ..., must be ...",
    r"[,;] for (?!example\b|instance\b)": "because, as, so",
    r"\bstand(?:s|ing)?\b": "is, occurs, means, takes the place of",
    r"\b(?:is|are|was|were|be|been|being) (?:told|said)\b": "is reported, is stated",
    r"\b(?<!to )say(?:s|ing)?\b": "states, means, shows, explains",
    r"(?<!splitter )\bbehind\b": "after",
    r"\bjust\b": "only, exactly",
    r"\b(?:no|some)body\b|\bwhoever\b": "a plain subject",
    r"\bwhich so\b": "so it",
    r"\bmends?\b": "fix",
    r"\bha(?:s|ve) not (?:`|a\b)": "does not have",
    r"\btoo,|, too\b": "also",
    r"\(s\)": "a plural that agrees",
}
CODE = re.compile(r"`[^`]*`")
#: Allowed in code: these wordings, and a key before a colon, such as `says:`.
_ALLOWED = re.compile(
    r"\bstand(?:s|ing)? still\b|\bbehind the robot\b|, for (?:each|every|all|any)\b"
    r"|(?m:^\s*\w+(?:\([^)\n]*\))?:(?=\s|$))"
)
_WORDING = re.compile("|".join(f"(?:{pattern})" for pattern in PATTERNS), re.IGNORECASE)
_WORD = re.compile(r"[A-Za-z][\w'-]*")
_WHAT = re.compile(r"\bwhat\b", re.IGNORECASE)
#: Verbs and pronouns of persons, and two places, that prose of code does without.
_SPEECH = re.compile(
    r"\b(?:told|tells?|said|says?|stands?|behind|ask(?:s|ed)?|hears|who|(?:some|no)body)\b",
    re.IGNORECASE,
)
_RETURN_WHAT = re.compile(r"\A(?:Return|Yield) what\b")
_IN_TEST_NAME = re.compile(rf"{_WORDING.pattern}|\b(?:what|who|told|said|asked)\b")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_IDENTIFIER_PART = re.compile(r"[A-Z]?[a-z]+|[A-Z]+")
_PARTS_TO_AVOID = {"told", "said", "asked", "behind", "stated"}

_PYTHON_TOKEN = re.compile(
    r"(?s:(?P<quotes>\"\"\"|''')(?:\\.|(?!(?P=quotes)).)*(?P=quotes))"
    r"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|(?P<comment>\#[^\n]*)"
)
_RULE_TOKEN = re.compile(
    r"(?s:%\*(?P<block>.*?)\*%)|(?P<comment>%[^\n]*)|(?s:\"(?:\\.|[^\"\\])*\")"
)
_PREDICATE = re.compile(r"\b[a-z_]\w*(?=\()")
_CLINGO = (
    r"(?m)^[ \t]*(?:import clingo\.{0}\b|from clingo\.{0} import|from clingo import [^\n]*\b{0}\b)"
    r"|\bimport_module\([\"']clingo\.{0}\b"
)
_CLINGO_AST = re.compile(_CLINGO.replace("{0}", "ast"))
_CLINGO_INTERNAL = re.compile(_CLINGO.replace("{0}", "_internal"))
_PROCESS = re.compile(
    r"\b(?:subprocess\.(?:Popen|run|call|check_\w+)|create_subprocess_\w+|LocalCluster"
    r"|ProcessPoolExecutor|os\.(?:fork|forkpty|spawn\w+|posix_spawnp?|system|popen))\("
    r"|\bmultiprocessing\b"
)


class Place(NamedTuple):
    """An occurrence that a figure counts."""

    path: Path
    line: int
    text: str


class Figure(NamedTuple):
    """A count or size, its goal, and the places that it counts."""

    value: int
    goal: int
    places: tuple[Place, ...] = ()


class Text(NamedTuple):
    """A docstring, or a comment of one or more lines, with its first line in the file."""

    line: int
    text: str


class Function(NamedTuple):
    """A function or method; `short` if its body, without docstring, has at most three lines."""

    name: str
    line: int
    short: bool


class Source:
    """The docstrings, comments and names of a file of Python."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.text = text
        self.lines = len(text.splitlines())
        self.docstrings: list[Text] = []
        self.functions: list[Function] = []
        self.classes: list[Text] = []
        self._read(ast.parse(text))
        #: Strings and comments are blanked, lines kept.
        self.code, self.comments = _without_comments(text)
        self.identifiers = {path.stem: 1, **_identifiers(self.code, _IDENTIFIER)}
        self.occurrences = Counter(re.findall(r"\w+", text))

    def _read(self, node: ast.AST) -> None:
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            docstring = ast.get_docstring(node)
            if docstring is not None:
                self.docstrings.append(Text(node.body[0].lineno, docstring))
            if isinstance(node, ast.ClassDef):
                self.classes.append(Text(node.lineno, node.name))
            elif not isinstance(node, ast.Module):
                body = node.body if docstring is None else node.body[1:]
                lines = (body[-1].end_lineno or 0) - body[0].lineno + 1 if body else 0
                # A decorated function, such as a property, cannot be written in place.
                short = lines <= 3 and not node.decorator_list
                self.functions.append(Function(node.name, node.lineno, short))
        for field in ("body", "orelse", "finalbody", "handlers", "cases"):
            statements = getattr(node, field, ())
            for statement in statements if isinstance(statements, list) else ():
                self._read(statement)


@cache
def prose(text: str) -> str:
    """Return a text with code as `x`, without markers of comments, keys and allowed wordings."""
    plain = CODE.sub(lambda code: "`x`" + "\n" * code[0].count("\n"), text)
    plain = re.sub(r"(?m)^[ \t]*(?:#[:!]?|%[!#]?)[ \t]?", "", plain)
    # `behind(Q, X)` is a literal.
    plain = re.sub(r"\b[a-z_]\w*\([^()\n]*\)", lambda literal: _literal(literal[0]), plain)
    return _ALLOWED.sub(lambda allowed: "\n" * allowed[0].count("\n"), plain)


def _literal(text: str) -> str:
    """Return `x` for a literal; a word before `(s)` is kept."""
    return text if text.endswith("(s)") else "x"


def matches(pattern: re.Pattern[str], text: Text) -> Iterator[tuple[int, str]]:
    """Yield the line and the words of each match in the prose of a text, also across lines."""
    lines = [line.strip() for line in prose(text.text).split("\n")]
    starts = [0, *accumulate(len(line) + 1 for line in lines)]
    for match in pattern.finditer(" ".join(lines)):
        yield text.line + bisect_right(starts, match.start()) - 1, match[0].strip()


def words(texts: Iterable[Text]) -> int:
    """Return how many words the prose of texts has."""
    return sum(len(_WORD.findall(prose(text.text))) for text in texts)


def _without_comments(text: str) -> tuple[str, list[Text]]:
    """Return Python code with blank strings and comments, and the comments."""
    comments: list[Text] = []

    def blank(token: re.Match[str]) -> str:
        if token["comment"]:
            _add_comment(comments, token)
        return "\n" * token[0].count("\n")

    code = _PYTHON_TOKEN.sub(blank, text)
    return code, comments


def _add_comment(comments: list[Text], token: re.Match[str]) -> None:
    """Add a comment; join it to the one of the line before if both have a line of their own."""
    source = token.string
    line = source.count("\n", 0, token.start()) + 1
    start = source.rfind("\n", 0, token.start()) + 1
    alone = not source[start : token.start()].strip()
    if comments and alone and comments[-1].line + comments[-1].text.count("\n") == line - 1:
        comments[-1] = Text(comments[-1].line, f"{comments[-1].text}\n{token[0]}")
    else:
        comments.append(Text(line, token[0]))


def _identifiers(code: str, pattern: re.Pattern[str]) -> dict[str, int]:
    """Return the identifiers with a part such as `told`, each with its first line."""
    names = set(filter(names_speech, {*pattern.findall(code)}))
    if not names:
        return {}
    first = {match[0]: match.start() for match in reversed([*pattern.finditer(code)])}
    return {name: code.count("\n", 0, first[name]) + 1 for name in sorted(names)}


def names_speech(name: str) -> bool:
    """Whether a part of an identifier is one of the words in `_PARTS_TO_AVOID`."""
    return not _PARTS_TO_AVOID.isdisjoint(map(str.lower, _IDENTIFIER_PART.findall(name)))


def _found(pattern: re.Pattern[str], path: Path, texts: Iterable[Text]) -> Iterator[Place]:
    for text in texts:
        yield from (Place(path, line, match) for line, match in matches(pattern, text))


def figures_of_words(sources: Iterable[Source]) -> dict[str, Figure]:
    """Return the figures of docstrings, comments and identifiers of a package."""
    counted: defaultdict[str, list[Place]] = defaultdict(list)
    size = 0
    for source in sources:
        path, docstrings = source.path, source.docstrings
        size += words(docstrings)
        counted["docstrings"] += _found(_WORDING, path, docstrings)
        counted["comments"] += _found(_WORDING, path, source.comments)
        counted["return_what"] += _found(_RETURN_WHAT, path, docstrings)
        counted["what"] += _found(_WHAT, path, docstrings)
        counted["told"] += _found(_SPEECH, path, docstrings)
        counted["identifiers"] += _speech(path, source.identifiers)
    goals = {"what": size * 15 // 10_000, "told": size * 5 // 10_000}
    return {
        name: Figure(len(places), goals.get(name, 0), tuple(places))
        for name, places in counted.items()
    }


def _speech(path: Path, identifiers: Mapping[str, int]) -> list[Place]:
    """Return the identifiers of a file to avoid; each counts once, however often it occurs."""
    return [Place(path, line, name) for name, line in identifiers.items() if names_speech(name)]


def figure_of_test_names(sources: Iterable[Source]) -> Figure:
    """Return the figure of wording in names of tests."""
    places = [
        place
        for source in sources
        for function in source.functions
        if function.name.startswith("test_")
        for place in _found(
            _IN_TEST_NAME, source.path, [Text(function.line, function.name.replace("_", " "))]
        )
    ]
    return Figure(len(places), 0, tuple(places))


def figure_of_lines(sources: Iterable[Source], target: int) -> Figure:
    """Return the lines of a package, rounded up to the next 100 while they exceed the target."""
    lines = sum(source.lines for source in sources)
    return Figure(lines if lines <= target else -(-lines // 100) * 100, target)


def figures_of_structure(sources: Iterable[Source]) -> dict[str, Figure]:
    """Return the figures of a whole program: common names, short functions, special files."""
    sources = list(sources)
    classes: defaultdict[str, list[Place]] = defaultdict(list)
    functions: defaultdict[str, list[Place]] = defaultdict(list)
    short: list[Place] = []
    for source in sources:
        for line, name in source.classes:
            classes[name].append(Place(source.path, line, name))
        for function in source.functions:
            name = function.name
            place = Place(source.path, function.line, name)
            dunder = name.startswith("__")
            if not dunder:
                functions[name].append(place)
            if name.startswith("_") and not dunder and function.short:
                # The definition, and one use.
                if source.occurrences[name] == 2:
                    short.append(place)
    twice = [places[-1] for places in classes.values() if len(places) > 1]
    common = [places for places in functions.values() if len({place.path for place in places}) >= 4]

    def files(pattern: re.Pattern[str], goal: int, strings: bool = False) -> Figure:
        found = (
            (source.path, pattern.search(source.text if strings else source.code))
            for source in sources
        )
        places = [
            Place(path, match.string.count("\n", 0, match.start()) + 1, match[0])
            for path, match in found
            if match
        ]
        return Figure(len(places), goal, tuple(places))

    return {
        "class_names": Figure(len(twice), 10, tuple(twice)),
        "common_functions": Figure(sum(map(len, common)), 420, tuple(chain(*common))),
        "short_functions": Figure(len(short), 140, tuple(short)),
        "clingo_ast_files": files(_CLINGO_AST, 2, strings=True),
        "clingo_internal_files": files(_CLINGO_INTERNAL, 2, strings=True),
        "process_files": files(_PROCESS, 1),
    }


def figures_of_rules(files: Iterable[tuple[Path, str]]) -> dict[str, Figure]:
    """Return the figures of files of rules, given as paths and texts."""
    blocks: list[Place] = []
    comments: list[Place] = []
    identifiers: list[Place] = []
    for path, text in files:
        rows: list[Text] = []
        code: list[str] = []
        end = 0
        for token in _RULE_TOKEN.finditer(text):
            code += [text[end : token.start()], "\n" * token[0].count("\n")]
            end = token.end()
            if token["block"] is not None:
                line = text.count("\n", 0, token.start()) + 1
                blocks += _found(_WORDING, path, [Text(line, token["block"].lstrip("!"))])
            elif token["comment"]:
                _add_comment(rows, token)
        comments += _found(_WORDING, path, rows)
        predicates = _identifiers("".join([*code, text[end:]]), _PREDICATE)
        identifiers += _speech(path, {path.stem: 1, **predicates})
    found = {"blocks": blocks, "comments": comments, "identifiers": identifiers}
    return {name: Figure(len(places), 0, tuple(places)) for name, places in found.items()}
