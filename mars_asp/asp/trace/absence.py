"""The reason why an atom is absent, built from near misses."""

from collections.abc import Mapping, Sequence, Set
from typing import TypeAlias

import clingo

from mars_asp.asp.messages import fill, shown
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.term_ids import TermId, as_symbol, as_term
from mars_asp.asp.trace.explainer import Explainer
from mars_asp.asp.trace.firings import Firing
from mars_asp.asp.trace.given import is_cited
from mars_asp.asp.trace.near_misses import IN_QUESTION, LACKING, NEAR, Candidate, NearMisses
from mars_asp.asp.trace.patterns import can_be_followed, fixed_parts, shown_pattern
from mars_asp.asp.trace.tree import Absent, NearMiss, Trace, Underivable, bindings_of

Found: TypeAlias = Mapping[clingo.Symbol, Sequence[tuple[Candidate, Firing]]]


def explain_absence(
    explainer: Explainer, pattern: clingo.Symbol, depth: int
) -> Underivable | Absent:
    """Return why no atom matches a pattern, in which holes are any value.

    Each level of the trace takes one or two more groundings; `depth` limits the levels.
    """
    derived = frozenset[Signature]().union(*(rule.heads for rule in explainer.rules))
    near = NearMisses(explainer.rewriter, derived)
    found: dict[clingo.Symbol, list[tuple[Candidate, Firing]]] = {}
    pending = [pattern]
    for _ in range(depth):
        if not pending:
            break
        attempts = _come_near(explainer, near, pending)
        found |= attempts
        lacking = (f.lacks.arguments[1] for a in attempts.values() for _, f in a if f.lacks)
        parts = dict.fromkeys(lack.arguments[0] for lack in lacking if lack.name == "no")
        pending = [part for part in parts if part not in found and can_be_followed(part)]
    true = {atom for a in found.values() for _, firing in a for atom in _believed(firing)}
    return _absence(pattern, found, explainer, explainer.why(sorted(true)))


def _come_near(
    explainer: Explainer, near: NearMisses, patterns: Sequence[clingo.Symbol]
) -> dict[clingo.Symbol, list[tuple[Candidate, Firing]]]:
    """Return for each pattern the nearest instance of each rule that could derive it."""
    lines = []
    queries: dict[str, list[TermId]] = {}
    for index, pattern in enumerate(patterns):
        kind = signature_of(pattern).unsigned
        parts = clingo.Function("w", fixed_parts(pattern))
        queries.setdefault(NEAR, []).append(as_term(clingo.Tuple_([clingo.Number(index), parts])))
        for number, rule in enumerate(explainer.rules):
            if kind in rule.heads:
                lines.append(near.text(rule, number, pattern, index))
    best: dict[tuple[int, int], tuple[Candidate, Firing]] = {}
    for firing in explainer.firings("\n".join(lines), queries):
        candidate = near.candidates[firing.rule]
        key = (candidate.pattern, candidate.rule)
        if key not in best or _nearness(candidate, firing) < _nearness(*best[key]):
            best[key] = (candidate, firing)
    lacking = _lacking(explainer, near, [firing for _, firing in best.values()])
    found: dict[clingo.Symbol, list[tuple[Candidate, Firing]]] = {p: [] for p in patterns}
    for (index, _), (candidate, firing) in sorted(best.items(), key=lambda item: item[0]):
        lacks = lacking.get(firing.rule, firing.lacks)
        found[patterns[index]].append((candidate, firing._replace(lacks=lacks)))
    return found


def _lacking(
    explainer: Explainer, near: NearMisses, firings: Sequence[Firing]
) -> dict[int, clingo.Symbol]:
    """Return the missing term of firings whose first query left it open, by candidate number.

    A candidate can lack any of several terms. A query about all candidates would have as many
    instances as candidates times the elements of a conditional literal.
    """
    queries = {f.rule: _lack(f) for f in firings if _lack(f).name == IN_QUESTION}
    if not queries:
        return {}
    questions = [as_term(clingo.Tuple_([clingo.Number(n), lack])) for n, lack in queries.items()]
    text = "\n".join(map(near.lacking.__getitem__, queries))
    return {f.rule: f.lacks for f in explainer.firings(text, {LACKING: questions}) if f.lacks}


def _nearness(candidate: Candidate, firing: Firing) -> tuple[bool, bool, int, str, int]:
    """Return a sort key: choices, then instances with one failing literal, then most true ones.

    Among variants of a rule that differ in a pool, the first one is the nearest.
    """
    return (
        candidate.fails is not None,
        not candidate.alone,
        -candidate.kept,
        str(as_symbol(firing.values)),
        firing.rule,
    )


def _believed(firing: Firing) -> tuple[clingo.Symbol, ...]:
    """Return the true atoms of a near miss that its trace shows."""
    lack = _lack(firing)
    if lack.name == "holds":
        return (lack.arguments[0],)
    if lack.name == "no":
        return ()
    elements = [element for group in firing.groups for element in group.counted.elements]
    counted = {as_symbol(p) for e in elements for p in (*e.premises, *e.conditions)}
    premises = () if lack.name == "value" and counted else map(as_symbol, firing.premises)
    return tuple(dict.fromkeys((*premises, *sorted(counted))))


def _absence(
    pattern: clingo.Symbol,
    found: Found,
    explainer: Explainer,
    true: Mapping[clingo.Symbol, Trace],
    above: Set[clingo.Symbol] = frozenset(),
    known: dict[clingo.Symbol, Underivable | Absent] | None = None,
) -> Underivable | Absent:
    """Return why no atom matches a pattern.

    `found` are the near misses by pattern, `true` the traces of true atoms. A reason that is needed
    twice is one object (`known`); a pattern in `above`, which depends on itself, becomes a leaf.
    """
    known = {} if known is None else known
    written, words = shown_pattern(pattern), explainer.given.words_of_absence(as_term(pattern))
    leaf = Absent(written, words, explainer.given.external(written))
    if pattern in above:
        return leaf
    if pattern in known:
        return known[pattern]
    if pattern not in found:
        return Underivable(written, (), False, words)
    if not found[pattern]:
        return leaf
    attempts = []
    for candidate, firing in sorted(found[pattern], key=lambda attempt: _nearness(*attempt)[:3]):
        lack = _lack(firing)
        cause: Trace | None = None
        held: tuple[Trace, ...] = ()
        if lack.name == "no":
            cause = _absence(lack.arguments[0], found, explainer, true, {*above, pattern}, known)
        elif lack.name == "holds":
            cause = true[lack.arguments[0]]
        else:
            held = tuple(filter(is_cited, map(true.__getitem__, _believed(firing))))
        rule, bindings = explainer.rules[candidate.rule], bindings_of(firing.values)
        attempts.append(
            NearMiss(
                written,
                rule,
                fill(rule.because, bindings, shown),
                bindings,
                candidate.fails,
                lack.arguments[0] if lack.name == "value" else None,
                cause,
                held,
            )
        )
    known[pattern] = Underivable(written, tuple(attempts), words=words)
    return known[pattern]


def _lack(firing: Firing) -> clingo.Symbol:
    assert firing.lacks is not None
    return firing.lacks.arguments[1]
