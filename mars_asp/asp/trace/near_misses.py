"""Rules that find the instances of each rule nearest to an absent atom, and the failing literals.

For a body `b1, b2, b3` in an order in which each literal can be tested, rules search the instances
of all literals except one, and of each prefix of the body. The nearest instance lacks a single
literal; otherwise it satisfies one of the longest prefixes, and the next literal fails for it. So
the reported literal is false for the shown instance. (Compare answers to why-not questions by the
frontier picky, Chapman and Jagadish 2009.)

The reason why a literal fails is therefore needed only for the nearest instance. Where several
terms can be missing, as of a conditional literal, a second query finds it for this instance alone:
for all instances there would be as many atoms as instances times elements. The minimal term is
reported, so that the result is independent of the order of grounding. For `p(X) :- q(X,Y), t(Z) :
s(Y,Z)` with number 14, candidate 2, question 3 and second question 4:

    _s3_14(near(2,in_question(Y)),none,p,a,v(n("X","Y"),X,Y)) :- _near3(0,w(X)); q(X,Y).
    _s4_14(near(2,_Lack),none,p,a,v(n)) :- _lacking4(2,in_question(Y));
        _Lack = #min { no(t(Z)) : s(Y,Z), not t(Z) }; _Lack < #sup.

For the same reason aggregates are tested once for the variables that they name, whatever other
literals the body has: see `_counted_apart`.
"""

import re
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass

import clingo

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import literal_of, sign_and_function, variants
from mars_asp.asp.rules.trees import (
    AGGREGATES,
    FUNCTIONS,
    Kind,
    Sign,
    SyntaxNode,
    global_names,
    names_in,
    names_of,
    with_variables,
)
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.atoms import function_text
from mars_asp.asp.trace.firing_rules import (
    OPERATOR,
    QUESTION,
    Rewriter,
    Terms,
    atoms_of_head,
    bare,
    variables_in,
)
from mars_asp.asp.trace.literal_order import in_order, needs, provided
from mars_asp.asp.trace.patterns import has_holes, is_hole, pattern_term

#: The query predicate for near misses: `NEAR(index, w(Parts))`.
NEAR = f"_near{QUESTION}"
#: The query predicate for the missing term of a candidate: `LACKING(number, values in question)`.
LACKING = f"_lacking{QUESTION}"
#: The function of a missing term that a second query has to find; its arguments decide the term.
IN_QUESTION = "in_question"
#: The variable for the value of an aggregate.
_VALUE = "_Value"
#: The variable for the missing term.
_LACK = "_Lack"
_MADE_UP = re.compile(r"(?<!\w)_H[0-9]+(?!\w)")


@dataclass(frozen=True, slots=True)
class Candidate:
    """A form of near miss of a rule, which is found by a rule of its own.

    `pattern` and `rule` are indices. `fails` is the failing literal, or None if a choice offers the
    atom and does not take it; `kept` is the number of literals before it that hold, and `alone` is
    true if all other literals hold.
    """

    pattern: int
    rule: int
    fails: str | None
    kept: int
    alone: bool


class NearMisses:
    """Writes the rules that find near misses; their numbers are indices of `candidates`."""

    def __init__(self, rewriter: Rewriter, derived: Set[Signature]) -> None:
        """Prepare with the rewriter's open predicates; rules derive the predicates `derived`."""
        self._rewriter = rewriter
        self._derived = derived
        self.candidates: list[Candidate] = []
        #: Rules that find the missing term of a candidate that can lack several terms or none.
        self.lacking: dict[int, str] = {}

    def text(self, rule: Rule, number: int, pattern: clingo.Symbol, index: int) -> str:
        """Return rules that find near misses of a rule; `index` is that of the pattern."""
        lines: list[str] = []
        for statement in variants(rule.text):
            for head, condition in atoms_of_head(statement):
                symbol, literals = head.atom.symbol, (*statement.body, *condition)
                lines += self._misses(rule, number, symbol, literals, pattern, index)
        return "\n".join(lines)

    def _misses(
        self,
        rule: Rule,
        number: int,
        head: SyntaxNode,
        literals: Sequence[SyntaxNode],
        pattern: clingo.Symbol,
        index: int,
    ) -> Iterator[str]:
        match = _Match()
        if not match.atom(head, pattern):
            return
        tests = [literal_of(test) for test in match.tests]
        literals = (*tests, *literals)
        shared = names_in(head) | global_names(literals)
        query = f"{NEAR}({index},w({','.join(match.arguments)}))"
        # An absent fact ends the search, so facts come before derived atoms.
        literals = (
            *tests,
            *sorted(literals[len(tests) :], key=lambda each: not self._is_given(each)),
        )
        order = list(in_order(literals, match.bound, shared))
        matched = [test for test, _ in in_order(tests, match.bound, shared)]
        bound = match.bound.union(*(needs(test, shared) for test in matched))
        for before_it, literal in enumerate(literals):
            is_positive = self._is_given(literal) and literal.sign == Sign.NoSign
            if is_positive and OPERATOR.search(bare(literal)) is None:
                # No value at all satisfies the literal, whatever the other literals are.
                kept = 2 * len(literals) - before_it
                candidate = Candidate(index, number, match.shown(literal), kept, True)
                any_value = with_variables(literal, dict.fromkeys(names_in(literal) - bound, "_"))
                test = self._rewriter.renamed(any_value.updated(sign=Sign.Negation))
                yield from self._candidate(candidate, literal, query, matched, bound, shared, test)
        for place, (literal, before) in enumerate(order):
            first = [other for other, _ in order[:place]]
            fails = match.shown(literal)
            candidate = Candidate(index, number, fails, place, place == len(literals) - 1)
            yield from self._candidate(candidate, literal, query, first, before, shared)
            others = [other for other, _ in order if other is not literal]
            # A test alone does not explain an absence beside all premises of another atom.
            if candidate.alone or not others or any(literal is test for test in tests):
                continue
            around = list(in_order(others, match.bound, shared))
            bound = match.bound.union(*(needs(other, shared) for other in others))
            if len(around) == len(literals) - 1 and needs(literal, shared) <= bound:
                candidate = Candidate(index, number, fails, place, True)
                rest = [other for other, _ in around]
                yield from self._candidate(candidate, literal, query, rest, bound, shared)
        offers = rule.is_choice or rule.node.head.ast_type == Kind.Disjunction
        if offers and len(order) == len(literals):
            candidate = Candidate(index, number, None, len(order), True)
            every = [literal for literal, _ in order]
            bound = match.bound | shared
            yield from self._candidate(candidate, None, query, every, bound, shared)

    def _candidate(
        self,
        candidate: Candidate,
        left_out: SyntaxNode | None,
        query: str,
        kept: Sequence[SyntaxNode],
        bound: Set[str],
        shared: Set[str],
        *more: str,
    ) -> Iterator[str]:
        terms = Terms("N")
        joined, lack, tests = self._instead(left_out, terms, set(bound))
        tests = [*tests, *more]
        body, counting, rules = self._counted_apart(query, (*kept, *joined), shared)
        yield from rules
        several = variables_in(lack).union(*map(variables_in, tests)) - bound
        # A term such as `X + 1` can be undefined, and then there is no atom to read.
        if left_out is not None and not joined and (several or OPERATOR.search(bare(lack))):
            element = f"{lack} : {', '.join((*tests, *terms.equations))}"
            deciding = ",".join(sorted(needs(left_out, shared) & bound))
            lack, tests, terms = f"{IN_QUESTION}({deciding})", [], Terms("N")
            self.lacking[len(self.candidates)] = self._least_lacking(candidate.rule, element, lack)
        tag = f"near({len(self.candidates)},{lack})"
        self.candidates.append(candidate)
        names = {name for name in bound if not name.startswith("_")}
        # A missing term is reported alone, without the literals that hold.
        alone = left_out is not None and lack != "test" and not joined
        before, literals = ((*body, *tests), ()) if alone else ((query, *tests), (*kept, *joined))
        yield from self._rewriter.instance(
            candidate.rule, tag, "none", before, literals, terms, names, False, counting
        )

    def _is_given(self, literal: SyntaxNode) -> bool:
        """Whether a literal is of a predicate that only facts define."""
        if literal.ast_type != Kind.Literal or literal.atom.ast_type != Kind.SymbolicAtom:
            return False
        _, function = sign_and_function(literal.atom.symbol)
        signature = Signature(function.name, len(function.arguments))
        return signature not in self._derived

    def _counted_apart(
        self, query: str, literals: Sequence[SyntaxNode], shared: Set[str]
    ) -> tuple[list[str], list[str], list[str]]:
        """Return a body with separate tests for aggregates, these tests, and the rules for them.

        The literals are in an order in which each can be tested. clingo counts anew for each
        instance of the other literals of a body, even of variables that are not in the aggregate.
        """
        place = f"{QUESTION}_{len(self.candidates)}"
        body, counting, rules = [query], list[str](), list[str]()
        bound = variables_in(query)
        for number, literal in enumerate(literals):
            named = names_in(literal) & {*shared, _VALUE}
            text = self._rewriter.renamed(literal)
            if literal.ast_type == Kind.ConditionalLiteral or literal.atom.ast_type in AGGREGATES:
                before = f"_d{place}_{number}({','.join(sorted(named & bound))})"
                test = f"_c{place}_{number}({','.join(sorted(named))})"
                rules += (f"{before} :- {'; '.join(body)}.", f"{test} :- {before}; {text}.")
                counting.append(test)
                text = test
            body.append(text)
            bound |= named
        return body, counting, rules

    def _least_lacking(self, rule: int, element: str, values: str) -> str:
        """Return the text of a rule that finds the minimum of `element` for `values`."""
        number = len(self.candidates)
        query = f"{LACKING}({number},{values})"
        least = f"{_LACK} = #min {{ {element} }}; {_LACK} < #sup"
        return f"_s{QUESTION}_{rule}(near({number},{_LACK}),none,p,a,v(n)) :- {query}; {least}."

    def _instead(
        self, literal: SyntaxNode | None, terms: Terms, bound: set[str]
    ) -> tuple[tuple[SyntaxNode, ...], str, list[str]]:
        """Return the literals in place of a failing literal, its missing term, and further tests.

        The term is `no(P)` for an absent pattern P, `holds(A)` for an atom A that should not hold,
        the `value` of an aggregate, `test` if the bindings show the failure, and `taken` for a
        choice.
        """
        if literal is None:
            return (), "taken", []
        if literal.ast_type == Kind.ConditionalLiteral:
            inner, condition = literal.literal, literal.condition
            known = bound | names_of(condition)
            if inner.atom.ast_type != Kind.SymbolicAtom or names_in(inner) - known:
                return (), "test", []
            _, lack, tests = self._instead(inner, terms, known)
            if lack.startswith("no("):
                tests = [self._rewriter.renamed(inner.updated(sign=Sign.Negation))]
            return (), lack, [*map(self._rewriter.renamed, condition), *tests]
        if literal.atom.ast_type == Kind.SymbolicAtom:
            symbol = literal.atom.symbol
            if literal.sign == Sign.Negation:
                shown = terms.atom(symbol)
                return (), f"holds({shown})", [self._rewriter.source(shown, symbol)]
            sign, function = sign_and_function(symbol)
            named = [terms.named(argument) for argument in function.arguments]
            bound |= names_of(named) - names_in(function)
            parts = [pattern_term(argument, bound) for argument in named]
            return (), f"no({function_text(f'{sign}{function.name}', parts)})", []
        if literal.atom.ast_type not in AGGREGATES:
            return (), "test", []
        elements = "; ".join(map(str, literal.atom.elements))
        is_set = literal.atom.ast_type is Kind.Aggregate
        function = "" if is_set else f"#{FUNCTIONS[literal.atom.function].replace('plus', '+')} "
        valued = literal_of(f"{_VALUE} = {function}{{ {elements} }}")
        return (valued,), f"value({_VALUE})", []


class _Match:
    """The result of matching a rule's head with a pattern: arguments, tests and bound variables."""

    def __init__(self) -> None:
        self.arguments: list[str] = []
        self.tests: list[str] = []
        self.bound: set[str] = set()
        self._holes: dict[str, str] = {}
        #: The text of the pattern for each new variable.
        self._meant: dict[str, str] = {}

    def atom(self, head: SyntaxNode, pattern: clingo.Symbol) -> bool:
        """Match the head with the pattern; return False if they cannot match."""
        sign, function = sign_and_function(head)
        kind = Signature(function.name, len(function.arguments), not sign)
        if kind != signature_of(pattern):
            return False
        return all(map(self._term, function.arguments, pattern.arguments))

    def shown(self, literal: SyntaxNode) -> str:
        """Return a literal as text, new variables written as in the pattern."""
        return _MADE_UP.sub(lambda name: self._meant[name[0]], str(literal))

    def _fresh(self, meant: str) -> str:
        name = f"_H{len(self._meant)}"
        self._meant[name] = meant
        return name

    def _term(self, term: SyntaxNode, pattern: clingo.Symbol) -> bool:
        if is_hole(pattern):
            name = pattern.arguments[0].string
            if name != "_" and self._holes.setdefault(name, str(term)) != str(term):
                self.tests.append(f"{self._holes[name]} = {term}")
            return True
        if not has_holes(pattern):
            self.arguments.append(self._fixed(term, pattern))
            return True
        if term.ast_type == Kind.Variable:
            self.tests.append(f"{term.name} = {self._skeleton(pattern)}")
            return True
        if term.ast_type != Kind.Function:
            return False
        same = (term.name, len(term.arguments)) == (pattern.name, len(pattern.arguments))
        return same and all(map(self._term, term.arguments, pattern.arguments))

    def _fixed(self, term: SyntaxNode, pattern: clingo.Symbol) -> str:
        """Return the variable or term for a subterm of the pattern without holes."""
        plain = term.ast_type in (Kind.Variable, Kind.SymbolicTerm, Kind.Function)
        names = names_in(term)
        if plain and provided(term) == names and ".." not in str(term):
            self.bound |= names
            return str(term)
        name = self._fresh(str(pattern))
        self.bound.add(name)
        self.tests.append(f"{name} = {term}")
        return name

    def _skeleton(self, pattern: clingo.Symbol) -> str:
        if is_hole(pattern):
            name = pattern.arguments[0].string
            fresh = self._fresh(name)
            return self._holes.setdefault(name if name != "_" else fresh, fresh)
        if not has_holes(pattern):
            name = self._fresh(str(pattern))
            self.arguments.append(name)
            self.bound.add(name)
            return name
        return function_text(pattern.name, list(map(self._skeleton, pattern.arguments)))
