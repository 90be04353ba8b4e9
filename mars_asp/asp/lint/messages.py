"""Faults of metadata: messages that depend on the derivation, wrong holes, missing examples."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from functools import partial

from mars_asp.asp.lint.clauses import Clause, ClauseAtom, is_constant
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.lint.values import KnownValue, Value
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.rule import HOLE, Rule
from mars_asp.asp.rules.trees import names_in, names_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.units import UNITS

MESSAGE, HOLES, EXAMPLE = "rule-message", "rule-hole", "rule-example"
_VARIABLE = re.compile(r'"(?:\\.|[^"\\])*"|(?<!\w)_*[A-Z]\w*\'*')


def open_messages(
    clause: Clause, reported: frozenset[Signature], functions: "MessageFunctions"
) -> Iterator[LintFinding]:
    """Yield the holes of a message whose values the finding (in `reported`) does not determine."""
    rule = clause.rule
    if rule.because is None or clause.sort != "rule":
        return
    head = clause.heads[0][0]
    if head.signature.unsigned not in reported:
        return
    fixed = functions.closed(clause, names_in(head.node))
    for hole in rule.holes:
        if hole not in fixed and hole in names_in(clause.node):
            message = f"`{{{hole}}}` may be several things for one `{head.text}`"
            advice = f"put `{hole}` into the head, or choose one: `{hole} = #min {{ ... }}`"
            yield found(MESSAGE, message, rule.span, rule, advice)


def rival_messages(
    clauses: Sequence[Clause], judged: Set[int], reported: frozenset[Signature]
) -> Iterator[LintFinding]:
    """Yield the rules whose message for a finding differs from that of an earlier rule.

    Whether two bodies can hold together is unknown. They count as apart if their atoms of a
    predicate have different constants or signs, or if both compare. Rules with derived premises are
    left out.
    """
    derived = {head.signature for clause in clauses for head, _ in clause.heads}
    earlier: dict[str, list[Clause]] = {}
    for number, clause in enumerate(clauses):
        rule = clause.rule
        if rule.because is None or clause.sort != "rule" or not clause.heads:
            continue
        head = clause.heads[0][0]
        if head.signature.unsigned not in reported or not is_constant(head.terms[-1]):
            continue
        if any(atom.signature in derived for atom in clause.read):
            continue
        names: dict[str, str] = {}
        result = _VARIABLE.sub(partial(_numbered, names), head.text)
        same = earlier.setdefault(result, [])
        for other in same if number in judged else ():
            if other.rule.because != rule.because and not _are_apart(clause, other):
                message = f"`{head.text}` has another message where both rules hold"
                labels = ((other.rule.span, "this one"),)
                advice = "tell the two apart by the case, the last argument"
                yield found(MESSAGE, message, rule.span, rule, advice, labels=labels)
                break
        same.append(clause)


def _numbered(names: dict[str, str], match: re.Match[str]) -> str:
    """Return `V0`, `V1`, ... for a matched variable by first occurrence; a string unchanged."""
    text = match[0]
    return text if text.startswith('"') else names.setdefault(text, f"V{len(names)}")


def _are_apart(one: Clause, other: Clause) -> bool:
    """Whether two bodies probably exclude each other, by signs, constants or comparisons."""
    if one.body.comparisons and other.body.comparisons:
        return True
    return any(
        left.sign != right.sign or _constants(left) != _constants(right)
        for left in one.body.atoms
        for right in other.body.atoms
        if left.signature == right.signature
    )


def _constants(atom: ClauseAtom) -> list[str]:
    return [str(term) if is_constant(term) else "" for term in atom.terms]


class MessageFunctions:
    """Finds the arguments of a predicate whose values follow from other arguments."""

    def __init__(
        self, clauses: Sequence[Clause], declared: Mapping[Signature, Declaration]
    ) -> None:
        self._keys = {s: d.keys for s, d in declared.items() if d.keys}
        self._rules: dict[Signature, list[tuple[Clause, ClauseAtom]]] = {}
        for clause in clauses:
            for head, condition in clause.heads:
                whole = clause.sort == "rule" and not condition.atoms
                if whole:
                    self._rules.setdefault(head.signature, []).append((clause, head))
        self._settled: dict[tuple[Signature, frozenset[int]], frozenset[int]] = {}

    def closed(self, clause: Clause, names: frozenset[str]) -> frozenset[str]:
        """Return `names` and all variables of the body whose values they determine."""
        known = names
        while True:
            more = known
            for atom in clause.body.positive:
                more |= self._by_atom(atom, more)
            for each in clause.body.comparisons:
                for one, other in each.equal:
                    if names_in(other) <= more:
                        more |= names_in(one)
            for aggregate in clause.aggregates:
                inside = names_of(each.node for each in aggregate.elements)
                for sign, guard in aggregate.guards:
                    if sign == "=" and inside & clause.bound - names_in(guard) <= more:
                        more |= names_in(guard)
            if more == known:
                return known
            known = more

    def _by_atom(self, atom: ClauseAtom, known: frozenset[str]) -> frozenset[str]:
        terms = enumerate(atom.terms)
        given = frozenset(at for at, each in terms if str(each) != "_" and names_in(each) <= known)
        if len(given) == len(atom.terms):
            return frozenset()
        settled = self.settled(atom.signature, given)
        return names_of(atom.terms[at] for at in settled)

    def settled(self, signature: Signature, given: frozenset[int]) -> frozenset[int]:
        """Return the positions of arguments that those at `given` determine, `given` included."""
        keys = self._keys.get(signature.unsigned, ())
        every = frozenset(range(signature.arity))
        if any(given >= set(key) for key in keys):
            return every
        key = (signature, given)
        if key not in self._settled:
            # During its own computation, a recursive predicate determines no further argument.
            self._settled[key] = given
            rules = self._rules.get(signature, [])
            if len(rules) == 1:
                ((clause, head),) = rules
                names = names_of(head.terms[at] for at in given)
                fixed = self.closed(clause, names)
                self._settled[key] = frozenset(
                    at for at in every if names_in(head.terms[at]) <= fixed
                )
            elif rules and given and signature.unsigned not in self._keys:
                # Facts define the predicate as a table, without repeated `given` arguments.
                rows = {tuple(str(head.terms[at]) for at in sorted(given)) for _, head in rules}
                plain = all(not one.node.body and not names_in(head.node) for one, head in rules)
                if plain and len(rows) == len(rules):
                    self._settled[key] = every
        return self._settled[key]


def wrong_holes(clause: Clause, known: KnownValue, things: Set[str]) -> Iterator[LintFinding]:
    """Yield the holes in a unit that does not suit the sort of their value.

    Also yield unmatched braces, and holes with a number that identifies one of the `things`.
    """
    rule = clause.rule
    holes = [(key, *hole) for key, text in rule.sentences for hole in HOLE.findall(text)]
    environment = known.environment(clause, clause.body) if holes else {}
    for key, name, sort in holes:
        values, place = environment.get(name), rule.place_of(key)
        numbered = sorted({each.sort for each in values or ()})
        if sort in UNITS and values and not known.meet(values, frozenset({Value("number", sort)})):
            own = " or ".join(sorted({each.sort or each.text for each in values}))
            message = f"`{{{name}:{sort}}}` writes what is in {own} as {sort}"
            advice = f"write `{{{name}:{own}}}`" if own in UNITS else f"write `{{{name}}}`"
            yield found(HOLES, message, place, rule, advice)
        elif values and all(each.form == "number" and each.sort in things for each in values):
            message = f"`{{{name}}}` is the number of a {' or '.join(numbered)}"
            advice = "readers do not know these numbers: name what it is about"
            yield found(HOLES, message, place, rule, advice)
    for key, text in rule.sentences:
        rest = HOLE.sub("", text)
        if "{" in rest or "}" in rest:
            message = f"a brace in `{key}` has no counterpart, so it is written as it is"
            yield found(HOLES, message, rule.place_of(key), rule, "write `{Variable}`")


def missing_examples(rule: Rule, exists: Callable[[Rule], bool]) -> Iterator[LintFinding]:
    """Yield an example of a rule that is the path of no file."""
    if rule.example is not None and not exists(rule):
        message = f"the example `{rule.example}` is not a file"
        advice = "name a case by its path, from the folder of the rule or from here"
        yield found(EXAMPLE, message, rule.place_of("example"), rule, advice)
