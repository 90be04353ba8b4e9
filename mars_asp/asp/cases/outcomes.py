"""The results of cases: the unmet expectations, each with the result of the rules."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import clingo

from mars_asp.asp.cases.expectations import ANY, ANYTHING, Block, Expectation, ExpectedAtom
from mars_asp.asp.signature import plain
from mars_asp.diagnostic import Span
from mars_asp.spelling import nearest

#: The kinds of expectations, in words.
_WORDS = {"only": "only", "has": "at least", "not": "none of", ">": "the message", "~": "the cost"}
_NONE_EXPECTED = (
    "  nothing is expected, so no answer set may be found; rules of your own go with --rules"
)


@dataclass(frozen=True, slots=True)
class Failure:
    """An expectation that is not met, with its location.

    `expected` describes the expectation, `found` are the results instead, and `nearest` is the most
    similar result. `lines` show the difference.
    """

    span: Span
    expected: str
    found: tuple[str, ...] = ()
    nearest: str | None = None
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Check:
    """A case: its title if it has one, its location, and its unmet expectations."""

    title: str | None
    span: Span
    failures: tuple[Failure, ...]

    @property
    def passed(self) -> bool:
        """Whether all expectations are met."""
        return not self.failures


@dataclass(frozen=True, slots=True)
class Outcome:
    """The results of the cases of a file, and its text with updated expectations.

    `updated` is None if the text would not change.
    """

    path: Path
    checks: tuple[Check, ...]
    updated: str | None = None

    @property
    def passed(self) -> bool:
        """Whether all cases of the file passed."""
        return all(check.passed for check in self.checks)

    def difference(self) -> Iterator[str]:
        """Yield lines with the missing and the surplus results."""
        for check in self.checks:
            yield from difference(check)


@dataclass(frozen=True, slots=True)
class FoundAnswer:
    """An answer set: the texts that `%=` compares, all its atoms, its messages, and its cost."""

    compared: tuple[str, ...]
    atoms: tuple[clingo.Symbol, ...]
    messages: frozenset[str]
    cost: str


def difference(check: Check) -> Iterator[str]:
    """Yield lines with the missing and the surplus results of a case."""
    for failure in check.failures:
        if not any(line.startswith("  - ") for line in failure.lines):
            yield f"  - {failure.expected}"
        yield from failure.lines


def judged(block: Block, answers: Sequence[FoundAnswer]) -> tuple[Failure, ...]:
    """Return the expectations of a case that its answer sets do not meet."""
    exact, others = block.of("="), block.of("only", "has", "not")
    failures: list[Failure] = []
    if exact or not block.expectations:
        failures += _exactly(block, exact, answers)
    else:
        others = block.expectations
    for each in others:
        if not answers:
            failures.append(
                Failure(each.span, f"{_expectation_text(each)}, and there is no answer set")
            )
        for answer in answers:
            found = tuple(_unmet(each, answer))
            failures += found
            if found:
                break
    return tuple(failures)


def _exactly(
    block: Block, exact: Sequence[Expectation], answers: Sequence[FoundAnswer]
) -> Iterator[Failure]:
    rest = [f"%{each.kind} {each.text}" for each in block.of(">", "~")]
    expected = {tuple(sorted([*map(_even, each.atoms), *rest])): each for each in exact}
    given = sorted(tuple(sorted([*map(_even, each.atoms), *rest])) for each in exact)
    found = sorted({answer.compared for answer in answers})
    if given == found:
        return
    missing = [answer for answer in given if answer not in found]
    extra = [answer for answer in found if answer not in given]
    lines = [] if exact else [_NONE_EXPECTED]
    if len(missing) == len(extra) == 1:
        lost, new = set(missing[0]), set(extra[0])
        lines += [f"  - {atom}" for atom in sorted(lost - new)]
        lines += [f"  + {atom}" for atom in sorted(new - lost)]
    else:
        lines += [f"  - answer set: {' '.join(answer)}" for answer in missing]
        lines += [f"  + answer set: {' '.join(answer)}" for answer in extra]
    span = expected[missing[0]].span if missing else exact[0].span if exact else block.span
    what = "this answer set" if len(given) == 1 else f"these {len(given)} answer sets"
    what = f"exactly {what}" if given else "no answer set"
    yield Failure(span, what, tuple(" ".join(answer) for answer in extra), None, tuple(lines))


def _even(expected: ExpectedAtom) -> str:
    """Return an atom as clingo formats it, or as written if it is not a term."""
    if " " not in expected.text:
        return expected.text
    try:
        return str(clingo.parse_term(expected.text))
    except RuntimeError:
        return expected.text


def _expectation_text(expectation: Expectation) -> str:
    return f"{_WORDS[expectation.kind]} `{expectation.text}`"


def _unmet(expectation: Expectation, answer: FoundAnswer) -> Iterator[Failure]:
    """Yield the parts of an expectation that an answer set does not meet."""
    match expectation.kind:
        case ">":
            yield from _unsaid(expectation, answer)
        case "~":
            if f"%~ {expectation.text}".strip() != answer.cost:
                found = answer.cost.removeprefix("%~").strip() or "nothing"
                yield _failure(expectation.span, _expectation_text(expectation), (found,))
        case "has":
            for each in expectation.atoms:
                if not any(matches(each.pattern, atom) for atom in answer.atoms):
                    yield _missing(each, answer.atoms)
        case "not":
            for each in expectation.atoms:
                found_here = _atom_texts(a for a in answer.atoms if matches(each.pattern, a))
                if found_here:
                    yield _failure(each.span, f"no `{each.text}`", found_here)
        case _:
            yield from _beyond(expectation, answer)


def _unsaid(expectation: Expectation, answer: FoundAnswer) -> Iterator[Failure]:
    wanted = f"%> {expectation.text}"
    if wanted not in answer.messages:
        name = expectation.text.partition(":")[0]
        of_rule = tuple(sorted(each for each in answer.messages if each.startswith(f"%> {name}:")))
        near = of_rule[0] if of_rule else nearest(wanted, answer.messages)
        shown = None if near is None else near.removeprefix("%> ")
        yield _failure(expectation.span, _expectation_text(expectation), (), shown)


def _beyond(expectation: Expectation, answer: FoundAnswer) -> Iterator[Failure]:
    """Yield the expected atoms that are missing, and surplus atoms of the sorts in `only`."""
    patterns = [each.pattern for each in expectation.atoms]
    for each, pattern in zip(expectation.atoms, patterns, strict=True):
        if not any(matches(pattern, atom) for atom in answer.atoms):
            yield _missing(each, answer.atoms)
    extra = [
        atom
        for atom in answer.atoms
        if any(_same_sort(pattern, atom) for pattern in patterns)
        and not any(matches(pattern, atom) for pattern in patterns)
    ]
    if extra:
        yield _failure(expectation.span, f"nothing but `{expectation.text}`", _atom_texts(extra))


def _missing(expected: ExpectedAtom, atoms: Sequence[clingo.Symbol]) -> Failure:
    near = _nearest(expected.pattern, atoms)
    return _failure(expected.span, f"`{expected.text}`", (), near)


def _failure(span: Span, expected: str, found: tuple[str, ...], near: str | None = None) -> Failure:
    return Failure(span, expected, found, near, shown_beside(found, near))


def shown_beside(found: Iterable[str], near: str | None) -> tuple[str, ...]:
    """Return lines with the actual results and the nearest one, to print below an expectation."""
    nearest_one = () if near is None else (f"    nearest: {near}",)
    return (*(f"  + {each}" for each in found), *nearest_one)


def _atom_texts(atoms: Iterable[clingo.Symbol]) -> tuple[str, ...]:
    return tuple(sorted(plain(str(atom)) for atom in atoms))


def matches(pattern: clingo.Symbol, found: clingo.Symbol) -> bool:
    """Whether a term matches a pattern; `_any` matches any value."""
    if pattern in (found, ANY):
        return True
    if clingo.SymbolType.Function not in (pattern.type, found.type) or pattern.type != found.type:
        return False
    if len(pattern.arguments) != len(found.arguments) or pattern.positive != found.positive:
        return False
    if pattern.name != plain(found.name):
        return False
    return all(map(matches, pattern.arguments, found.arguments))


def _same_sort(pattern: clingo.Symbol, found: clingo.Symbol) -> bool:
    """Whether two atoms have one predicate, and one first argument if this is a constant."""
    if plain(found.name) != pattern.name or found.positive != pattern.positive:
        return False
    if len(found.arguments) != len(pattern.arguments):
        return False
    first = pattern.arguments[0] if pattern.arguments else ANY
    is_constant = first.type == clingo.SymbolType.Function and first.name and not first.arguments
    return not is_constant or first in (ANY, found.arguments[0])


def _nearest(pattern: clingo.Symbol, atoms: Sequence[clingo.Symbol]) -> str | None:
    """Return the atom most similar to a pattern, of its predicate or a similar name, or None."""
    same = [atom for atom in atoms if plain(atom.name) == pattern.name]
    if same:
        best = max(sorted(same), key=lambda atom: _agreement(pattern, atom))
        return plain(str(best))
    name = nearest(pattern.name, {plain(atom.name) for atom in atoms})
    return next((plain(str(a)) for a in sorted(atoms) if plain(a.name) == name), None)


def _agreement(pattern: clingo.Symbol, found: clingo.Symbol) -> int:
    if len(pattern.arguments) != len(found.arguments):
        return -1
    return sum(map(matches, pattern.arguments, found.arguments))


def rewritten(
    text: str,
    blocks: Sequence[Block],
    answers: Mapping[Block, Sequence[FoundAnswer]],
    own: Sequence[str] | None,
) -> str:
    """Return a text of cases with expectations replaced by the actual results.

    Facts, `%has:` and `%not:` stay unchanged. A case without expectations gets the atoms that match
    the patterns `own` of a pack; if `own` is None, an exact answer set.
    """
    lines = text.split("\n")
    edits: list[tuple[int, int, list[str]]] = []
    for block in blocks:
        given = answers[block]
        if own is not None and not block.expectations and len(given) == 1:
            place = _last_line(block, len(lines))
            edits.append((place, place, list(_closed(given[0], own, "#show" in block.text))))
        else:
            edits += _edits(block, given, len(lines))
    # New lines have the same line ending as the others.
    mark = "\r" if "\r\n" in text else ""
    for begin, end, new in sorted(edits, reverse=True):
        lines[begin:end] = [f"{line}{mark}" for line in new]
    return "\n".join(lines)


def _edits(
    block: Block, answers: Sequence[FoundAnswer], count: int
) -> Iterator[tuple[int, int, list[str]]]:
    """Yield (first line, end, new lines) to replace in a block, whose text has `count` lines."""
    exact = block.of("=")
    for each in block.of("only") if answers else ():
        patterns = [declared.pattern for declared in each.atoms]
        found = [a for a in answers[0].atoms if any(_same_sort(p, a) for p in patterns)]
        if found and tuple(_unmet(each, answers[0])):
            yield each.span.line - 1, each.last, _expectation_lines("%only:", _atom_texts(found))
    if not exact and block.expectations:
        if answers:
            for each in block.of("~"):
                yield each.span.line - 1, each.last, [answers[0].cost]
        return
    if not tuple(_exactly(block, exact, answers)):
        return
    place = exact[0].span.line - 1 if exact else _last_line(block, count)
    new: list[str] = []
    for answer in sorted(answers, key=lambda each: each.compared):
        atoms = [atom for atom in answer.compared if not atom.startswith("%")]
        new += _expectation_lines("%=", _as_expected_order(atoms, exact))
    for each in (*exact, *block.of(">", "~")):
        if each.span.line - 1 != place:
            yield each.span.line - 1, each.last, []
    if answers:
        rest = Counter(atom for atom in answers[0].compared if atom.startswith("%"))
        new += sorted(rest)
    yield place, exact[0].last if exact else place, new


def _closed(answer: FoundAnswer, own: Sequence[str], shows: bool) -> Iterator[str]:
    """Yield lines `%only:` or `%not:` for the patterns `own` of a pack, by the answer.

    The absence of atoms is certain only for findings, and only if the case has no `#show` lines.
    """
    compared = [clingo.parse_term(atom) for atom in answer.compared if not atom.startswith("%")]
    for pattern in own:
        wanted = clingo.parse_term(ANYTHING.sub(lambda match: match[1] or "_any", pattern))
        found = [each for each in compared if _same_sort(wanted, each)]
        if found:
            yield from _expectation_lines("%only:", _atom_texts(found))
        elif not shows and wanted.arguments and wanted.arguments[0] != ANY:
            yield f"%not: {pattern}"


def _as_expected_order(atoms: Sequence[str], exact: Sequence[Expectation]) -> list[str]:
    """Return atoms sorted as in the expectations; others come last."""
    order = {_even(each): at for at, each in enumerate(e for one in exact for e in one.atoms)}
    return sorted(atoms, key=lambda atom: (order.get(atom, len(order)), atom))


def _last_line(block: Block, count: int) -> int:
    """Return the number of the last line with text in a block, `count` if it has none."""
    lines = block.text.split("\n")
    last = max((n for n, line in enumerate(lines, 1) if line.strip()), default=count)
    return max(last, block.span.line)


def _expectation_lines(sign: str, atoms: Sequence[str]) -> list[str]:
    first, *rest = atoms or ("",)
    return [f"{sign} {first}".rstrip(), *(f"%+ {atom}" for atom in rest)]
