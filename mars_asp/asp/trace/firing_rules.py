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
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import clingo
from clingo import ast

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules import statements
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import sign_and_function
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve import atoms
from mars_asp.asp.solve.atoms import function_text, term_text
from mars_asp.asp.trace import counting_rules, scope
from mars_asp.asp.trace.counting_rules import elements_of, group_key, needed_of
from mars_asp.asp.trace.scope import (
    AGGREGATES,
    OWN,
    atoms_of_head,
    bare,
    global_variables,
    guards,
    variables_of,
)

_TYPE = ast.ASTType
_HEADS = (_TYPE.Literal, _TYPE.Aggregate, _TYPE.HeadAggregate, _TYPE.Disjunction)
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
        makers = (
            __file__,
            counting_rules.__file__,
            statements.__file__,
            scope.__file__,
            atoms.__file__,
            ast.__file__,
        )
        made = memoized(
            "firings",
            map(Path, makers),
            first,
            lambda key: self._explanation_rules(first[key], rules),
        )
        parts: list[str] = []
        for number, key in keys.items():
            text, unsupported = made[key]
            parts.append(text.replace(_NUMBER, str(number)))
            if unsupported is not None:
                self.unsupported[number] = unsupported
        return _answered("\n".join(parts))

    def _explanation_rules(self, number: int, rules: Sequence[Rule]) -> "_Written":
        """Return the explanation rules of a rule, and its unsupported construct or None."""
        # Variants of a statement that differ in a pool share their groups.
        lines = dict.fromkeys(
            line for s in rules[number].ast.unpool() for line in self._firing_rule(number, s)
        )
        return "\n".join(lines), self.unsupported.get(number)

    def _firing_rule(self, number: int, statement: ast.AST) -> Iterator[str]:
        if statement.head.ast_type not in _HEADS:
            self.unsupported[number] = str(statement.head.ast_type)
            return
        for head, condition in atoms_of_head(statement):
            terms, literals = Terms(), (*statement.body, *condition)
            shown = terms.atom(head.atom.symbol, fresh_complex=True)
            found = variables_of((head, *Terms.definitions_of(literals)))
            names = {name for name in found if not name.startswith(OWN)}
            query = [asking(shown)]
            yield from self.instance(number, _NUMBER, shown, query, literals, terms, names)

    def instance(
        self,
        number: int,
        tag: str,
        shown: str,
        conditions: Iterable[str],
        literals: Sequence[ast.AST],
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
        counted: list[ast.AST] = []
        for literal in literals:
            if literal.ast_type == _TYPE.ConditionalLiteral:
                counting.append(self.renamed(literal))
                counted.append(literal)
            elif literal.ast_type != _TYPE.Literal:
                self.unsupported[number] = str(literal.ast_type)
            elif literal.atom.ast_type == _TYPE.SymbolicAtom:
                self._symbolic(literal, terms, premises, absent, rest)
            elif literal.atom.ast_type in AGGREGATES:
                counting.append(self.renamed(literal))
                if literal.sign == ast.Sign.NoSign:
                    counted.append(literal.atom)
            else:
                rest.append(self.renamed(literal))
                if literal.atom.ast_type == _TYPE.TheoryAtom:
                    self.unsupported[number] = "a theory atom"
        if tests is not None:
            counting = list(tests)
        elif counting and any(_is_projected(literal) for literal in literals):
            body = "; ".join((*before, *map(self.renamed, literals)))
            shared = sorted(global_variables((), literals) | variables_of(before))
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
        keys = [group_key(rule, group, variables_of(message)) for group in counted]
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
            for element in elements_of(group):
                yield from self._element(place, key, ask, *element)

    def _symbolic(
        self,
        literal: ast.AST,
        terms: "Terms",
        premises: list[tuple[str, str]],
        absent: list[str],
        rest: list[str],
    ) -> None:
        symbol = literal.atom.symbol
        if literal.sign == ast.Sign.NoSign:
            shown = terms.atom(symbol)
            premises.append((self.source(shown, symbol), shown))
            return
        shown, pattern = terms.negated(symbol)
        sign = "not" if literal.sign == ast.Sign.Negation else "not not"
        rest.append(f"{sign} {self.source(shown, symbol)}")
        absent.append(pattern if sign == "not" else f"_not({pattern})")

    def _element(
        self,
        place: str,
        key: str,
        ask: bool,
        element_key: str,
        required: Sequence[ast.AST],
        optional: Sequence[ast.AST],
    ) -> Iterator[str]:
        terms = Terms("E")
        premises: list[tuple[str, str]] = []
        others: list[tuple[str, str]] = []
        absent: list[str] = []
        rest: list[str] = []
        for literals, found in ((required, premises), (optional, others)):
            for literal in literals:
                if literal.atom.ast_type == _TYPE.SymbolicAtom:
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

    def source(self, shown: str, symbol: ast.AST) -> str:
        """Return the atom to read for a premise: its copy if the predicate is open."""
        if _signature(symbol) not in self.open:
            return shown
        return f"-_t_{shown[1:]}" if shown.startswith("-") else f"_t_{shown}"

    def renamed(self, literal: ast.AST) -> str:
        """Return the text of a literal, with each open predicate `h` renamed to `_t_h`."""
        return str(_Renaming(self.open)(literal)) if self.open else str(literal)


def _answered(text: str) -> str:
    """Return explanation rules without the queries that no rule among them answers."""
    answered = set(_ANSWERING.findall(text))
    lines = ((_ASKING.match(line), line) for line in text.split("\n"))
    return "\n".join(line for asks, line in lines if asks is None or asks[0] in answered)


class _Renaming(ast.Transformer):
    """Replaces open predicates by their copies."""

    def __init__(self, opened: Set[Signature]) -> None:
        self.opened = opened

    def visit_SymbolicAtom(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        symbol = node.symbol
        if symbol.ast_type == _TYPE.Function and _signature(symbol) in self.opened:
            return node.update(symbol=symbol.update(name=f"_t_{symbol.name}"))
        return node


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

    def atom(self, symbol: ast.AST, fresh_complex: bool = False) -> str:
        """Return an atom as text, whose arguments can be matched with those of evaluated atoms."""
        sign, symbol = sign_and_function(symbol)
        found = [self._matching_term(argument, fresh_complex) for argument in symbol.arguments]
        return function_text(f"{sign}{symbol.name}", found)

    def negated(self, symbol: ast.AST) -> tuple[str, str]:
        """Return the text of a negated atom for a rule body, and its text as a pattern."""
        sign, symbol = sign_and_function(symbol)
        named = [self.named(argument) for argument in symbol.arguments]
        name, pattern = f"{sign}{symbol.name}", [_anonymous(argument) for argument in named]
        return function_text(name, list(map(str, named))), function_text(name, pattern)

    def named(self, term: ast.AST) -> ast.AST:
        """Return a term, or for an interval a new variable that is equal to it."""
        if ".." not in bare(term):
            return term
        name = self.fresh()
        self.equations.append(f"{name} = {term}")
        return ast.Variable(term.location, name)

    def _matching_term(self, term: ast.AST, fresh_complex: bool) -> str:
        text = bare(term)
        if text == "_":
            return self.fresh()
        if ".." in text or (fresh_complex and OPERATOR.search(text)):
            name = self.fresh()
            self.equations.append(f"{name} = {term}")
            return name
        if _ANONYMOUS.search(text) and term.ast_type == _TYPE.Function:
            inner = [self._matching_term(argument, fresh_complex) for argument in term.arguments]
            return function_text(term.name, inner)
        return str(term)

    @staticmethod
    def definitions_of(literals: Iterable[ast.AST]) -> list[ast.AST]:
        """Return the literals and guards whose variables a firing records."""
        found = []
        for literal in literals:
            if literal.ast_type != _TYPE.Literal or literal.sign != ast.Sign.NoSign:
                continue
            atom = literal.atom
            if atom.ast_type in AGGREGATES:
                found += guards(atom)
            else:
                found.append(literal)
        return found


def _signature(symbol: ast.AST) -> Signature:
    _, symbol = sign_and_function(symbol)
    return Signature(symbol.name, len(symbol.arguments))


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


_ANONYMOUS = re.compile(r"(?<![\w'])_(?![\w'])")
#: An operator, in the text of a term without its strings.
OPERATOR = re.compile(r"[-+*/\\&?^~|]|\.\.")


def _anonymous(term: ast.AST) -> str:
    text = bare(term)
    if text == "_":
        return "_any"
    if _ANONYMOUS.search(text) and term.ast_type == _TYPE.Function:
        return function_text(term.name, list(map(_anonymous, term.arguments)))
    return str(term)


def _is_projected(literal: ast.AST) -> bool:
    """Whether a literal contains `_`, which clingo projects out before it counts."""
    if literal.ast_type != _TYPE.Literal or literal.sign != ast.Sign.NoSign:
        return False
    symbolic = literal.atom.ast_type == _TYPE.SymbolicAtom
    return symbolic and _ANONYMOUS.search(bare(literal)) is not None


#: The predicate of instances that are not left open.
ON = "_conflict_on"


def instance_variables(statement: ast.AST) -> list[str]:
    """Return the global variables of a statement, sorted."""
    head = statement.head
    if head.ast_type in (_TYPE.Aggregate, _TYPE.HeadAggregate):
        return sorted(global_variables(guards(head), statement.body))
    own = [head] if head.ast_type == _TYPE.Literal else []
    return sorted(global_variables(own, statement.body))


def is_forced_atom(head: ast.AST) -> bool:
    """Whether a head is a single atom that the rule forces, not a choice."""
    is_literal = head.ast_type == _TYPE.Literal and head.sign == ast.Sign.NoSign
    return is_literal and head.atom.ast_type == _TYPE.SymbolicAtom


def open_rules(statement: ast.AST, number: int) -> Iterator[str]:
    """Yield rules that are equivalent to a statement but can be switched off by instance."""
    head, terms = statement.head, Terms()
    body = [*map(str, statement.body)]
    text, key, choice = str(head), "none", None
    if is_forced_atom(head):
        text = key = choice = terms.atom(head.atom.symbol, fresh_complex=True)
        body += terms.equations
    elif head.ast_type in (_TYPE.Aggregate, _TYPE.HeadAggregate):
        if head.left_guard is None and head.right_guard is None:
            yield str(statement)
            return
    if choice is None and head.ast_type != _TYPE.Literal:
        found = (
            f"{atom}{' : ' if condition else ''}{', '.join(map(str, condition))}"
            for atom, condition in atoms_of_head(statement)
        )
        choice = "; ".join(found)
    on = f"{ON}({number},{key},v({','.join(instance_variables(statement))}))"
    yield f"{text} :- {'; '.join([*body, on])}."
    if choice is not None:
        yield f"{{ {choice} }} :- {'; '.join([*body, f'not {on}'])}."
    yield f"#external {on} : {'; '.join(body)}." if body else f"#external {on}."


class _Valued(ast.Transformer):
    """Replaces global variables by values, and evaluates arithmetic."""

    def __init__(self, values: Mapping[str, clingo.Symbol]) -> None:
        self._values_term = values

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        """Return the value of a variable, or the variable if it has none."""
        value = self._values_term.get(node.name)
        return node if value is None else ast.SymbolicTerm(node.location, value)

    def visit_BinaryOperation(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return self._computed(node)

    def visit_UnaryOperation(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return self._computed(node)

    def _computed(self, node: ast.AST) -> ast.AST:
        inside = node.update(**self.visit_children(node))
        try:
            return ast.SymbolicTerm(node.location, clingo.parse_term(str(inside)))
        except RuntimeError:
            return inside


def ground_text(
    statement: ast.AST, head: clingo.Symbol, values: Mapping[str, clingo.Symbol]
) -> str:
    """Return the text of a ground instance of a statement, without true comparisons."""
    names = set(values)
    valued = _Valued(values)
    body = []
    for literal in statement.body:
        is_test = literal.ast_type == _TYPE.Literal and literal.atom.ast_type == _TYPE.Comparison
        if not is_test or global_variables((), (literal,)) - names:
            body.append(str(valued(literal)))
    shown_head = str(head) if is_forced_atom(statement.head) else str(valued(statement.head))
    shown_head = "" if shown_head == "#false" else shown_head
    after = f":- {', '.join(body)}" if body or not shown_head else ""
    return f"{' '.join(filter(None, (shown_head, after)))}."
