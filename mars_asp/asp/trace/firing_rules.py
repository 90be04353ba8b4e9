"""Explanation rules: each rule rewritten into rules that find its firings, from the head down.

For a rule `h(X) :- b(X,Y), not c(Y)` with number 14, and question 2:

    _s2_14(14,h(X),p(b(X,Y)),a(c(Y)),v(n("X","Y"),X,Y)) :- _ask2_h(X), b(X,Y), not c(Y).
    _ask2_b(X,Y) :- _s2_14(14,h(X),p(b(X,Y)),a(c(Y)),v(n("X","Y"),X,Y)).

An aggregate or conditional literal is a group; a firing states how many of its elements it rests
on. Elements depend only on the literal and on its global variables, so firings that differ in other
variables share them: for `d(X) :- b(X,Y), 2 <= #count { Z : c(X,Z) }` with number 15,

    _s2_15(15,d(X),p(b(X,Y)),a(),v(n("X","Y"),X,Y),g(count,ge,2,k(15,"...",X))) :- ...
    _g2_15(k(15,"...",X)) :- _s2_15(15,d(X),p(b(X,Y)),a(),v(n("X","Y"),X,Y),_).
    _e2_15(k(15,"...",X),t(Z),p(c(X,Z)),o(),a()) :- _g2_15(k(15,"...",X)), c(X,Z).

clingo counts anew for each instance of the other literals; anonymous variables make no instances. A
firing names its variables. So with `b(X,_)` in the body, a separate rule `_b2_15("...",X) :- ...`
tests the body as it is written, and the rule that finds firings holds only the named literals.

A predicate that is decided only by solving, `open`, is read from copies `_t_h` of its true atoms.
clingo itself evaluates the terms of the firing atom, so arithmetic needs no second implementation.
Each rule has its own predicates: with common ones, every firing would be matched against the
queries of every rule.
"""

import re
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import FILES, sign_and_function, term_of, variants
from mars_asp.asp.rules.trees import (
    AGGREGATES,
    Kind,
    Sign,
    SyntaxNode,
    Tree,
    changed,
    elements_of,
    global_names,
    guards_of,
    names_of,
    with_variables,
)
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve import atoms
from mars_asp.asp.solve.atoms import function_text, term_text
from mars_asp.asp.trace import counting_rules
from mars_asp.asp.trace.counting_rules import counted_elements, group_key, needed_of

_HEADS = (Kind.Literal, Kind.Aggregate, Kind.HeadAggregate, Kind.Disjunction)
#: The prefix of renamed variables that are local to an element of a head; no instance shows them.
_OWN = "_Own_"
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")
_ANONYMOUS = re.compile(r"(?<![\w'])_(?![\w'])")
#: An operator, in the text of a term without its strings.
OPERATOR = re.compile(r"[-+*/\\&?^~|]|\.\.")
#: Placeholders for the numbers of a rule and of a question in stored explanation rules; no rule can
#: contain them.
_NUMBER = "\0r"
QUESTION = "\0q"
_ASKING = re.compile(rf"_ask{QUESTION}_\w+")
_ANSWERING = re.compile(rf"(?<= :- )_ask{QUESTION}_\w+")
#: A rule's text, and the open predicates that occur in it.
_Key: TypeAlias = tuple[str, frozenset[Signature]]
#: Explanation rules, and the name of the construct that cannot be traced, if any.
_Written: TypeAlias = tuple[str, str | None]


@dataclass
class Rewriter:
    """Writes the explanation rules of one rulebook."""

    open: Set[Signature]
    #: The name of a construct that cannot be traced, by rule number.
    unsupported: dict[int, str] = field(default_factory=dict)

    def text(self, rules: Sequence[Rule], numbers: Iterable[int]) -> str:
        """Return the explanation rules of the rules with these numbers, for any question.

        They depend only on the text of a rule and on its open predicates, so those of the built-in
        rules are made when the package is built.
        """
        keys = {
            number: (
                rules[number].text,
                frozenset(s for s in self.open if s[0] in rules[number].text),
            )
            for number in numbers
        }
        first = {key: number for number, key in reversed(keys.items())}
        makers = map(Path, (__file__, counting_rules.__file__, atoms.__file__))
        made = memoized(
            "firings",
            (*makers, *FILES),
            first,
            lambda key: self._explanation_rules(first[key], key[0]),
        )
        parts: list[str] = []
        for number, key in keys.items():
            text, unsupported = made[key]
            parts.append(text.replace(_NUMBER, str(number)))
            if unsupported is not None:
                self.unsupported[number] = unsupported
        return _answered("\n".join(parts))

    def _explanation_rules(self, number: int, text: str) -> "_Written":
        """Return the explanation rules of a rule, and its untraceable construct or None."""
        # Variants of a statement that differ in a pool share their groups.
        lines = dict.fromkeys(
            line for each in variants(text) for line in self._firing_rule(number, each)
        )
        return "\n".join(lines), self.unsupported.get(number)

    def _firing_rule(self, number: int, statement: SyntaxNode) -> Iterator[str]:
        if statement.head.ast_type not in _HEADS:
            self.unsupported[number] = str(statement.head.ast_type)
            return
        for head, condition in atoms_of_head(statement):
            terms, literals = Terms(), (*statement.body, *condition)
            shown = terms.atom(head.atom.symbol, fresh_complex=True)
            found = names_of((head, *Terms.definitions_of(literals)))
            names = {name for name in found if not name.startswith(_OWN)}
            query = [asking(shown)]
            yield from self.instance(number, _NUMBER, shown, query, literals, terms, names)

    def instance(
        self,
        number: int,
        tag: str,
        shown: str,
        conditions: Iterable[str],
        literals: Sequence[SyntaxNode],
        terms: "Terms",
        names: Iterable[str],
        ask: bool = True,
        tests: Sequence[str] | None = None,
    ) -> Iterator[str]:
        """Yield rules for the instances of literals of rule `number` where `conditions` hold too.

        `shown` is the head, and `names` are the variables that distinguish instances. With `ask`
        the premises are queried in turn. `tests` replace the aggregates and conditional literals;
        None tests them here.
        """
        rule = _NUMBER if ask else str(number)
        place = f"{QUESTION}_{rule}"
        before, terms.equations = (*conditions, *terms.equations), []
        premises: list[tuple[str, str]] = []
        absent: list[str] = []
        rest: list[str] = []
        counting: list[str] = []
        counted: list[SyntaxNode] = []
        for literal in literals:
            if literal.ast_type == Kind.ConditionalLiteral:
                counting.append(self.renamed(literal))
                counted.append(literal)
            elif literal.ast_type != Kind.Literal:
                self.unsupported[number] = str(literal.ast_type)
            elif literal.atom.ast_type == Kind.SymbolicAtom:
                self._symbolic(literal, terms, premises, absent, rest)
            elif literal.atom.ast_type in AGGREGATES:
                counting.append(self.renamed(literal))
                if literal.sign == Sign.NoSign:
                    counted.append(literal.atom)
            else:
                rest.append(self.renamed(literal))
                if literal.atom.ast_type == Kind.TheoryAtom:
                    self.unsupported[number] = "a theory atom"
        if tests is not None:
            counting = list(tests)
        elif counting and any(_is_projected(literal) for literal in literals):
            body = "; ".join((*before, *map(self.renamed, literals)))
            shared = sorted(global_names(literals).union(*map(variables_in, before)))
            holds = f"_b{place}({','.join((term_text(body), *shared))})"
            yield f"{holds} :- {body}."
            counting = [holds]
        message = (
            tag,
            shown,
            f"p({','.join(term for _, term in premises)})",
            f"a({','.join(absent)})",
            _values_term(sorted(names)),
        )
        outside = frozenset[str]().union(*map(variables_in, message))
        keys = [group_key(rule, group, outside) for group in counted]
        needed = [
            f"g({','.join(needed_of(group, terms.named))},{key})"
            for group, key in zip(counted, keys, strict=True)
        ]
        wanted = [*before, *(text for text, _ in premises), *rest, *counting, *terms.equations]
        yield f"_s{place}({','.join((*message, *needed))}) :- {'; '.join(wanted)}."
        firing = f"_s{place}({','.join((*message, *('_' for _ in counted)))})"
        if ask:
            yield from (f"{asking(term)} :- {firing}." for _, term in premises)
        for group, key in zip(counted, keys, strict=True):
            yield f"_g{place}({key}) :- {firing}."
            for element in counted_elements(group):
                yield from self._element(place, key, ask, *element)

    def _symbolic(
        self,
        literal: SyntaxNode,
        terms: "Terms",
        premises: list[tuple[str, str]],
        absent: list[str],
        rest: list[str],
    ) -> None:
        symbol = literal.atom.symbol
        if literal.sign == Sign.NoSign:
            shown = terms.atom(symbol)
            premises.append((self.source(shown, symbol), shown))
            return
        shown, pattern = terms.negated(symbol)
        sign = "not" if literal.sign == Sign.Negation else "not not"
        rest.append(f"{sign} {self.source(shown, symbol)}")
        absent.append(pattern if sign == "not" else f"_not({pattern})")

    def _element(
        self,
        place: str,
        key: str,
        ask: bool,
        element_key: str,
        required: Sequence[SyntaxNode],
        optional: Sequence[SyntaxNode],
    ) -> Iterator[str]:
        terms = Terms("E")
        premises: list[tuple[str, str]] = []
        others: list[tuple[str, str]] = []
        absent: list[str] = []
        rest: list[str] = []
        for literals, found in ((required, premises), (optional, others)):
            for literal in literals:
                if literal.atom.ast_type == Kind.SymbolicAtom:
                    self._symbolic(literal, terms, found, absent, rest)
                else:
                    rest.append(str(literal))
        if not element_key:
            first = (premises[0][1],) if premises else ("absent", *absent)[:2]
            element_key = f"t({','.join(first)})"
        needed, more = (",".join(term for _, term in found) for found in (premises, others))
        element = f"_e{place}({key},{element_key},p({needed}),o({more}),a({','.join(absent)}))"
        sources = (text for text, _ in (*premises, *others))
        wanted = [f"_g{place}({key})", *sources, *rest, *terms.equations]
        yield f"{element} :- {'; '.join(wanted)}."
        if ask:
            yield from (f"{asking(term)} :- {element}." for _, term in (*premises, *others))

    def source(self, shown: str, symbol: SyntaxNode) -> str:
        """Return the atom to read for a premise: its copy if the predicate is open."""
        if _signature(symbol) not in self.open:
            return shown
        return f"-_t_{shown[1:]}" if shown.startswith("-") else f"_t_{shown}"

    def renamed(self, literal: SyntaxNode) -> str:
        """Return the text of a literal, with each open predicate `h` renamed to `_t_h`."""
        if not self.open:
            return str(literal)

        def rename(tree: Tree) -> Tree:
            if tree.ast_type != Kind.SymbolicAtom or tree.symbol.ast_type != Kind.Function:
                return tree
            if _signature(tree.symbol) not in self.open:
                return tree
            return tree.update(symbol=tree.symbol.update(name=f"_t_{tree.symbol.name}"))

        return str(changed(literal, rename))


def _answered(text: str) -> str:
    """Return explanation rules without the queries that no rule among them answers."""
    answered = set(_ANSWERING.findall(text))
    lines = ((_ASKING.match(line), line) for line in text.split("\n"))
    return "\n".join(line for asks, line in lines if asks is None or asks[0] in answered)


class Terms:
    """Writes terms for explanation rules, with new variables for intervals and arithmetic."""

    def __init__(self, prefix: str = "F") -> None:
        """Begin; the names of new variables start with `_` and `prefix`."""
        self.prefix = prefix
        self.equations: list[str] = []
        self._count = 0

    def fresh(self) -> str:
        """Return the name of a new variable."""
        self._count += 1
        return f"_{self.prefix}{self._count}"

    def atom(self, symbol: SyntaxNode, fresh_complex: bool = False) -> str:
        """Return an atom as text to match; `fresh_complex`: computed arguments get variables."""
        sign, symbol = sign_and_function(symbol)
        found = [self._matching_term(argument, fresh_complex) for argument in symbol.arguments]
        return function_text(f"{sign}{symbol.name}", found)

    def negated(self, symbol: SyntaxNode) -> tuple[str, str]:
        """Return the text of a negated atom for a rule body, and its text as a pattern."""
        sign, symbol = sign_and_function(symbol)
        named = [self.named(argument) for argument in symbol.arguments]
        name, pattern = f"{sign}{symbol.name}", [_anonymous(argument) for argument in named]
        return function_text(name, list(map(str, named))), function_text(name, pattern)

    def named(self, term: SyntaxNode) -> SyntaxNode:
        """Return a term, or for an interval a new variable that is equal to it."""
        if ".." not in bare(term):
            return term
        name = self.fresh()
        self.equations.append(f"{name} = {term}")
        return term_of(name)

    def _matching_term(self, term: SyntaxNode, fresh_complex: bool) -> str:
        text = bare(term)
        if text == "_":
            return self.fresh()
        if ".." in text or (fresh_complex and OPERATOR.search(text)):
            name = self.fresh()
            self.equations.append(f"{name} = {term}")
            return name
        if _ANONYMOUS.search(text) and term.ast_type == Kind.Function:
            inner = [self._matching_term(argument, fresh_complex) for argument in term.arguments]
            return function_text(term.name, inner)
        return str(term)

    @staticmethod
    def definitions_of(literals: Iterable[SyntaxNode]) -> list[SyntaxNode]:
        """Return the literals and guards whose variables a firing records."""
        found: list[SyntaxNode] = []
        for literal in literals:
            if literal.ast_type != Kind.Literal or literal.sign != Sign.NoSign:
                continue
            atom = literal.atom
            found += guards_of(atom) if atom.ast_type in AGGREGATES else (literal,)
        return found


def _signature(symbol: SyntaxNode) -> Signature:
    _, symbol = sign_and_function(symbol)
    return Signature(symbol.name, len(symbol.arguments))


def bare(node: SyntaxNode | str) -> str:
    """Return a node's text without its strings."""
    return _STRING.sub('""', str(node))


def variables_in(text: str) -> set[str]:
    """Return the names of the variables in the text of terms, except anonymous ones."""
    return set(_VARIABLE.findall(bare(text)))


def atoms_of_head(statement: SyntaxNode) -> Iterator[tuple[SyntaxNode, Sequence[SyntaxNode]]]:
    """Yield the literals of atoms that a rule's head can give, each with its own condition.

    Callers move the condition into the body. Its local variables that clash with local variables
    there are renamed, with the prefix `_OWN`.
    """
    head = statement.head
    found = [(entries[-1], condition) for entries, condition in elements_of(head)]
    shared = names_of(statement.body) - global_names((head, *statement.body))
    for literal, condition in found:
        if literal.atom.ast_type == Kind.SymbolicAtom:
            clashing = shared & names_of((literal, *condition))
            own = {name: f"{_OWN}{name}" for name in clashing}
            yield with_variables(literal, own), [with_variables(each, own) for each in condition]


def asking(shown: str) -> str:
    """Return the query atom for an atom."""
    name, bracket, inside = shown.partition("(")
    return f"{asking_name(name)}{bracket}{inside}"


def asking_name(name: str) -> str:
    """Return the name of the query predicate for a predicate with its sign."""
    unsigned_name = name.removeprefix("-")
    return f"_ask{QUESTION}{'_neg' if name != unsigned_name else ''}_{unsigned_name}"


def _values_term(names: Sequence[str]) -> str:
    """Return a term with the values of variables; its first argument lists their names."""
    quoted = ",".join(f'"{name}"' for name in names)
    return f"v({','.join((f'n({quoted})' if names else 'n', *names))})"


def _anonymous(term: SyntaxNode) -> str:
    text = bare(term)
    if text == "_":
        return "_any"
    if _ANONYMOUS.search(text) and term.ast_type == Kind.Function:
        return function_text(term.name, list(map(_anonymous, term.arguments)))
    return str(term)


def _is_projected(literal: SyntaxNode) -> bool:
    """Whether a literal contains `_`, which clingo projects out before it counts."""
    if literal.ast_type != Kind.Literal or literal.sign != Sign.NoSign:
        return False
    symbolic = literal.atom.ast_type == Kind.SymbolicAtom
    return symbolic and _ANONYMOUS.search(bare(literal)) is not None
