"""Declarations of predicates, `%*! predicate(Arguments) ... *%`, in machine-readable form.

    %*! length(E: edge, L: metres)
    Edge E is L long.
    says:   the edge from `{edge.X}` is {L} long
    unless: the edge from `{edge.X}` has no length
    from:   stated
    *%

The sort after an argument defines its values: one word or several (`edge | node`), a list of all
constants (`{flat, hierarchical}`), or both. Names of arguments and a text for readers are enough,
as for predicates that rules derive. After the text, there can be lines `key: value`:

- `from` is the source of the predicate's facts; with `tag` and `property` they are from annotations
  of modules with the same name.
- `packs: extend` lets packs derive it, and `packs: read` lets named packs read it.
- `joins: nothing` means that its facts do not connect their arguments.
- `says` is the sentence of an atom in traces, `unless` that of its absence. A hole `{L}` is an
  argument, in the unit of its sort. `{edge.X}` is the argument X of the given fact that agrees in
  all arguments with the same name in both declarations. Among several sentences, the first is used
  whose holes all have a value: an absence leaves arguments open.
- `cited: never` means that the facts are never reasons, such as those about notation.
- `orders: P` means that things are sorted by the numbers P, the highest first.
- `key: E, F` means at most one fact for each value of these arguments, `key: nothing` at most one.

A line is continued by lines that begin with white space.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import accumulate
from typing import Literal, NamedTuple, TypeAlias, get_args

from mars_asp.asp.rules.expansions import split
from mars_asp.asp.rules.statements import Piece
from mars_asp.asp.signature import Signature, plain
from mars_asp.diagnostic import Diagnostic, Span, point
from mars_asp.spelling import nearest

#: The source of a fact: the user, a method outside of the rules, or a run.
Origin: TypeAlias = Literal["stated", "computed", "observed"]
#: How the user states an attribute of a module: by an annotation without a value, or with one.
Attribution: TypeAlias = Literal["tag", "property"]

# Most commands use no declarations, so these are compiled at the first use.
_MARK = r"(?s)%\*!(.*)\*%"
_HEADER = r"(-?[a-z_][A-Za-z0-9_']*) ?(?:\((.*)\))?"
#: A variable, or a term with variables inside, and its sort.
_ARGUMENT = r"(?s)([A-Z_][A-Za-z0-9_]*'*|[a-z_]*\(.*\))\s*(?::\s*(.+))?"
_SORT = r"[a-z][a-z_]*"
_CONSTANTS = r"\{([^{}]*)\}"
_LINE = r"([a-z]+):\s*(.*)"
#: The similarity of a misspelt sort to the intended one.
_LIKENESS = 0.8
#: The maximal number of characters that are shown of a comment that cannot be read.
_MOST_SHOWN = 60
#: The keys of lines with fixed values, and these values.
_FIXED_VALUES: Mapping[str, tuple[str, ...]] = {
    "from": (*get_args(Origin), *get_args(Attribution)),
    "packs": ("extend", "read"),
    "joins": ("nothing",),
    "cited": ("never",),
}
#: The keys of lines that hold a sentence, which can be repeated.
_SENTENCES = ("says", "unless")
_ORDERS = "orders"
_KEY = "key"
#: The value for a predicate with one fact at most.
_NO_KEY = "nothing"
_KEYS = (*_FIXED_VALUES, *_SENTENCES, _ORDERS, _KEY)
_CONTINUED = r"\n[ \t]+(?![a-z]+:)"
#: A hole of a sentence: an argument, of the predicate itself or of another predicate's fact.
SENTENCE_HOLE = r"\{(?:([a-z_]\w*)\.)?([A-Z_]\w*'*)\}"
_BRACES = r"\{[^{}]*\}"


class PredicateArgument(NamedTuple):
    """An argument: its name, and the sorts or constants of its values; without both, any value."""

    name: str
    sorts: frozenset[str] = frozenset()
    constants: tuple[str, ...] = ()


class Documented(NamedTuple):
    """The comments of a file that declare predicates, its stage, and its path as it is shown."""

    stage: str
    path: str
    docstrings: tuple[Piece, ...]

    @property
    def declarations(self) -> "Sequence[Declaration]":
        """Return the declarations; unreadable comments are skipped, and lint reports them."""
        return _declared(self)


@dataclass(frozen=True, slots=True)
class Declaration:
    """The declaration of a predicate; `origin` is None if it is not stated.

    `orders` is the position from 0 of the argument that orders things, `keys` the positions of the
    arguments of each key, `attribution` the form of the annotation for an attribute of modules.
    """

    name: str
    arguments: tuple[PredicateArgument, ...]
    words: str
    span: Span
    origin: Origin | None = None
    extensible: bool = False
    public: bool = False
    joins: bool = True
    says: tuple[str, ...] = ()
    unless: tuple[str, ...] = ()
    cited: bool = True
    orders: int | None = None
    keys: tuple[tuple[int, ...], ...] = ()
    attribution: Attribution | None = None

    @property
    def signature(self) -> Signature:
        """Return the predicate."""
        positive = not self.name.startswith("-")
        return Signature(self.name.removeprefix("-"), len(self.arguments), positive)

    @property
    def ordering(self) -> str | None:
        """Return the name of the argument that orders things, or None."""
        return None if self.orders is None else self.arguments[self.orders].name

    @property
    def named_keys(self) -> Iterator[tuple[str, ...]]:
        """Yield the names of the arguments of each key."""
        for key in self.keys:
            yield tuple(self.arguments[at].name for at in key)

    @property
    def written(self) -> str:
        """Return the predicate with the names and sorts of its arguments, as text."""
        inside = ", ".join(map(_argument_text, self.arguments))
        name = plain(self.name)
        return f"{name}({inside})" if inside else name

    def with_constants(self, known: str, more: tuple[str, ...]) -> "Declaration":
        """Return the declaration where arguments that list `known` also list `more` constants."""
        if not any(known in each.constants for each in self.arguments):
            return self
        arguments = tuple(
            each._replace(constants=(*each.constants, *more)) if known in each.constants else each
            for each in self.arguments
        )
        return replace(self, arguments=arguments)

    def places(self, *sorts: str) -> tuple[int, ...]:
        """Return the positions from 0 of the arguments of some sorts."""
        wanted = frozenset(sorts)
        return tuple(at for at, each in enumerate(self.arguments) if each.sorts & wanted)


@lru_cache(maxsize=1000)
def _declared(documented: Documented) -> tuple[Declaration, ...]:
    """Return the declarations of a file, cached for the rulebooks and slices that read them."""
    return tuple(declarations(documented.docstrings, documented.path, []))


def docstrings(written: Iterable[Piece]) -> Iterator[Piece]:
    """Yield the comments `%*! ... *%` of a file, which declare predicates."""
    return (each for each in written if each.sort == "comment" and re.fullmatch(_MARK, each.text))


def declarations(
    found_in: Iterable[Piece], shown: str, problems: list[Diagnostic]
) -> Iterator[Declaration]:
    """Yield the declarations in a file's comments, each predicate once; extend `problems`."""
    first: dict[Signature, Span] = {}
    for comment in found_in:
        place = point(shown, *comment.begin)
        found = _declaration(comment.text.removeprefix("%*!").removesuffix("*%"), place, problems)
        if found is None:
            continue
        earlier = first.setdefault(found.signature, place)
        if earlier is not place:
            message = f"`{found.signature}` is documented twice"
            labels = ((earlier, "first documented here"),)
            problems.append(_problem(message, place, "leave out one of them", labels))
            continue
        yield found


def _declaration(text: str, place: Span, problems: list[Diagnostic]) -> Declaration | None:
    lines = text.split("\n")
    # Arguments may continue in further lines.
    opened = accumulate(line.count("(") - line.count(")") for line in lines)
    end = next((number for number, each in enumerate(opened, 1) if each <= 0), len(lines))
    header, rest = " ".join(" ".join(lines[:end]).split()), "\n".join(lines[end:])
    match = re.fullmatch(_HEADER, header)
    if match is None:
        shown = header if len(header) <= _MOST_SHOWN else f"{header[:_MOST_SHOWN]}..."
        message = f"`{shown}` is not a predicate with its arguments"
        problems.append(_problem(message, place, "write `%*! name(First: sort, Second)`"))
        return None
    arguments = [] if match[2] is None else split(match[2], ",")
    read = tuple(filter(None, (_read_argument(each, place, problems) for each in arguments)))
    if len(read) < len(arguments):
        return None
    words, result = _split_docstring(rest, place, problems)
    first = {key: values[0] for key, values in result.items()}
    attribution = next((each for each in get_args(Attribution) if each == first.get("from")), None)
    origin = next((each for each in get_args(Origin) if each == first.get("from")), None)
    names = [argument.name for argument in read]
    for sentence in (*result.get("says", ()), *result.get("unless", ())):
        problems += _wrong_holes(sentence, names, place)
    if _ORDERS in first and first[_ORDERS] not in names:
        message = f"`{_ORDERS}: {first[_ORDERS]}` names no argument"
        problems.append(_problem(message, place, f"name one of {', '.join(names)}"))
    keys = []
    for written in result.get(_KEY, ()):
        key = [] if written == _NO_KEY else [each.strip() for each in written.split(",")]
        if set(key) <= set(names):
            keys.append(tuple(map(names.index, key)))
        else:
            advice = f"name some of {', '.join(names)}, or `{_NO_KEY}`"
            problems.append(_problem(f"`{_KEY}: {written}` names no argument", place, advice))
    if attribution == "property" and len(read) > 1 and not keys:
        # Two values of one property of a module are an error.
        keys = [(0,)]
    return Declaration(
        match[1],
        read,
        words,
        place,
        "stated" if attribution else origin,
        extensible=first.get("packs") == "extend",
        public="packs" in result,
        joins="joins" not in result,
        says=tuple(result.get("says", ())),
        unless=tuple(result.get("unless", ())),
        cited="cited" not in result,
        orders=names.index(first[_ORDERS]) if first.get(_ORDERS) in names else None,
        keys=tuple(keys),
        attribution=attribution,
    )


def _wrong_holes(sentence: str, names: Sequence[str], place: Span) -> Iterator[Diagnostic]:
    """Yield the holes of a sentence that name no argument."""
    for hole in re.findall(_BRACES, sentence):
        match = re.fullmatch(SENTENCE_HOLE, hole)
        if match is None or (match[1] is None and match[2] not in names):
            near = nearest(hole[1:-1], names) if names else None
            advice = f"did you mean `{{{near}}}`?" if near else "name an argument of the predicate"
            yield _problem(f"`{hole}` names no argument", place, advice)


def wrong_references(declared: Iterable[Declaration]) -> Iterator[Diagnostic]:
    """Yield the holes of sentences that name no argument of another predicate.

    The other predicate's fact is found by arguments of the same name, so there has to be one.
    """
    declared = tuple(declared)
    arguments = {each.name: [argument.name for argument in each.arguments] for each in declared}
    for each in declared:
        for sentence in (*each.says, *each.unless):
            for match in re.finditer(SENTENCE_HOLE, sentence):
                if match[1] is None:
                    continue
                names = arguments.get(match[1], [])
                if match[2] not in names:
                    near = nearest(match[1], arguments)
                    advice = f"did you mean `{near}`?" if near else "name a documented predicate"
                    advice = f"name one of {', '.join(names)}" if names else advice
                    yield _problem(f"`{match[0]}` names no argument", each.span, advice)
                elif not set(names) & set(arguments[each.name]):
                    message = f"`{match[1]}` has no argument that `{each.name}` also has"
                    advice = "call the argument by which its fact is found the same"
                    yield _problem(message, each.span, advice)


def misspelt_sorts(
    own: Iterable[Declaration], known: Iterable[str], units: Mapping[str, str]
) -> Iterator[Diagnostic]:
    """Yield errors for sorts that occur once and are spelt almost like a known one.

    `units` maps the sign of a unit, such as `ms`, to its sort.
    """
    own, known = tuple(own), frozenset(known)
    uses = Counter(sort for each in own for sort in {s for a in each.arguments for s in a.sorts})
    for each in own:
        for argument in each.arguments:
            for sort in sorted(s for s in argument.sorts - known if uses[s] == 1):
                near = units.get(sort) or nearest(sort, known, _LIKENESS)
                if near is not None:
                    message = f"`{argument.name}` of `{each.signature}` is of the sort `{sort}`, "
                    message += "which nothing else is"
                    yield _problem(message, each.span, f"did you mean `{near}`?")


def _read_argument(
    written: str, place: Span, problems: list[Diagnostic]
) -> PredicateArgument | None:
    text = " ".join(written.split())
    match = re.fullmatch(_ARGUMENT, text)
    if match is None:
        message = f"`{text}` is not an argument of a documented predicate"
        problems.append(_problem(message, place, "write a variable, or `Variable: sort`"))
        return None
    if match[2] is None:
        return PredicateArgument(match[1])
    sorts, named = set[str](), list[str]()
    for each in map(str.strip, match[2].split("|")):
        constants = re.fullmatch(_CONSTANTS, each)
        if constants:
            named += (constant.strip() for constant in constants[1].split(","))
        elif re.fullmatch(_SORT, each):
            sorts.add(each)
        else:
            advice = "write a word in small letters, `{constants}`, or several with `|`"
            problems.append(_problem(f"`{each}` is not a sort", place, advice))
            return None
    if not all(named):
        problems.append(
            _problem(f"`{match[2]}` is not a constant", place, "write `{first, second}`")
        )
        return None
    return PredicateArgument(match[1], frozenset(sorts), tuple(named))


def _split_docstring(
    text: str, place: Span, problems: list[Diagnostic]
) -> tuple[str, Mapping[str, Sequence[str]]]:
    """Return the prose of a declaration, and the values of its `key: value` lines by key."""
    lines = re.sub(_CONTINUED, " ", text.rstrip()).split("\n")
    entries: dict[str, list[str]] = {}
    while lines and (match := re.fullmatch(_LINE, lines[-1].strip())):
        key, value = match[1], " ".join(match[2].split())
        near_key = key if key in _KEYS else nearest(key, _KEYS)
        if near_key is None:
            break
        lines.pop()
        wrong = _wrong_line(key, value, near_key)
        if wrong is not None:
            problems.append(
                _problem(f"`{key}: {value}` is not a key of a documented predicate", place, wrong)
            )
        elif key in entries and key not in (*_SENTENCES, _KEY):
            problems.append(_problem(f"`{key}` occurs twice", place, "leave out one of them"))
        else:
            entries.setdefault(key, []).insert(0, value)
    return " ".join(" ".join(lines).split()), entries


def _wrong_line(key: str, value: str, near_key: str) -> str | None:
    """Return advice for a line with a wrong key or value, or None if it is correct."""
    choices = _FIXED_VALUES.get(near_key, ())
    if key == near_key and (value in choices if choices else value):
        return None
    near = (nearest(value, choices) or choices[0]) if choices else value or "..."
    return f"did you mean `{near_key}: {near}`?"


def _argument_text(argument: PredicateArgument) -> str:
    named = [f"{{{', '.join(argument.constants)}}}"] if argument.constants else []
    kinds = " | ".join((*sorted(argument.sorts), *named))
    return f"{argument.name}: {kinds}" if kinds else argument.name


def _problem(
    message: str, place: Span, advice: str, labels: tuple[tuple[Span, str], ...] = ()
) -> Diagnostic:
    return Diagnostic("rule-declaration", "error", message, place, labels, help=advice)
