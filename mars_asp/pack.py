"""What clingo would say of a rule pack too late, or without the place, or not at all."""

import re
from collections.abc import Iterator, Set

import clingo
from clingo import ast

from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.source import Span, point
from mars_asp.spelling import nearest

_PLACE = re.compile(r"<block>:(\d+):(\d+)(?:-[\d:]+)?: error: (.*)", re.DOTALL)
_UNSAFE = re.compile(r"note: '(\w+)' is unsafe")
_DEFINED = re.compile(r"^#defined\s+([a-z_]\w*)\s*/\s*(\d+)\s*\.", re.MULTILINE)

SEVERITIES: tuple[Severity, ...] = ("note", "warning", "error")

Signature = tuple[str, int]
#: Statements that leave the answers of rules as they are.
_HARMLESS = (
    ast.ASTType.Rule,
    ast.ASTType.Program,
    ast.ASTType.Comment,
    ast.ASTType.Defined,
    ast.ASTType.ShowSignature,
)
#: What a rule pack from elsewhere may derive besides predicates of its own.
EXTENSIBLE: frozenset[Signature] = frozenset(
    {("consequence", 4), ("participant", 5), ("concerns", 4), ("edit", 5)}
)


def refused_rules(text: str, shown: str) -> Iterator[Diagnostic]:
    """Yield what clingo says against the rules of a text; none of them is grounded here."""
    notes: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: notes.append(note))
    try:
        control.add("base", [], text)
        control.ground([("nothing", [])])
    except RuntimeError:
        for match in filter(None, map(_PLACE.match, notes)):
            place = point(shown, int(match[1]), int(match[2]))
            unsafe = [f"`{name}`" for name in _UNSAFE.findall(match[3])]
            if unsafe:
                message = f"nothing in the body binds {' and '.join(dict.fromkeys(unsafe))}"
                advice = "name it in a literal of the body that is not negated"
                yield Diagnostic("rule-unsafe", "error", message, place, help=advice)
            else:
                yield Diagnostic("rule-syntax", "error", " ".join(match[3].split()), place)


def has_rules_alone(text: str) -> bool:
    """Say whether a text holds nothing but rules, and what says nothing of answers."""
    found: list[ast.AST] = []
    ast.parse_string(text, found.append)
    return all(statement.ast_type in _HARMLESS for statement in found)


def declared(text: str) -> set[Signature]:
    """Return the predicates that a text declares as given, by `#defined`."""
    return {(name, int(arity)) for name, arity in _DEFINED.findall(text)}


def unknown_predicates(rule: ast.AST, known: Set[Signature], span: Span) -> Iterator[Diagnostic]:
    """Yield the predicates of a rule that nobody gives or derives: a misspelt rule never fires.

    `span` is where the rule stands, for the places of its tree count from its beginning.
    """
    for name, arity, node in predicates(rule):
        if (name, arity) not in known:
            near = nearest(name, sorted({other for other, _ in known}))
            others = sorted(f"`{other}/{n}`" for other, n in known if other == near)
            yield Diagnostic(
                "rule-unknown",
                "error",
                f"nothing gives or derives `{name}/{arity}`",
                _place(span, node),
                help=f"did you mean {' or '.join(others)}?"
                if others
                else f"`rules/vocabulary.lp` says what is given; write `#defined {name}/{arity}.` "
                "where only some facts hold it",
            )


def misused_heads(rule: ast.AST, heads: Set[Signature], span: Span) -> Iterator[Diagnostic]:
    """Yield what is wrong with a head that tells of a consequence: a choice, or no severity.

    `span` is where the rule stands, for the places of its tree count from its beginning.
    """
    told = sorted(heads & EXTENSIBLE)
    if told and rule.head.ast_type != ast.ASTType.Literal:
        name, arity = told[0]
        yield Diagnostic(
            "rule-head",
            "error",
            f"`{name}/{arity}` stands in a choice, disjunction or condition",
            _place(span, rule.head),
            help="what is found follows from the facts: write a rule with this head alone",
        )
    elif ("consequence", 4) in heads:
        for kind in rule.unpool():
            yield from _wrong_severity(kind.head.atom.symbol.arguments[1], span)


def _wrong_severity(term: ast.AST, span: Span) -> Iterator[Diagnostic]:
    if term.ast_type != ast.ASTType.Variable and str(term) not in SEVERITIES:
        yield no_severity(str(term), _place(span, term))


def no_severity(written: str, place: Span, excerpt: str | None = None) -> Diagnostic:
    """Return what is said of a severity that is none."""
    near = nearest(written, SEVERITIES)
    advice = f"did you mean `{near}`?" if near else f"one of {', '.join(SEVERITIES)}"
    message = f"`{written}` is no severity"
    return Diagnostic("rule-severity", "error", message, place, help=advice, excerpt=excerpt)


def severity_place(rule: ast.AST, span: Span) -> Span:
    """Return where the head of a rule that stands at `span` says how severe a consequence is."""
    return _place(span, rule.head.atom.symbol.arguments[1])


def named_kinds(rule: ast.AST) -> frozenset[str] | None:
    """Return the kinds of consequence that a rule's head names; `None` where a variable does."""
    kinds = [one.head.atom.symbol.arguments[0] for one in rule.unpool()]
    if any(kind.ast_type == ast.ASTType.Variable for kind in kinds):
        return None
    return frozenset(map(str, kinds))


def _place(span: Span, node: ast.AST) -> Span:
    begin = node.location.begin
    column = begin.column + (span.column - 1) * (begin.line == 1)
    return point(span.path, span.line + begin.line - 1, column)


def predicates(node: ast.AST) -> Iterator[tuple[str, int, ast.AST]]:
    """Yield the predicate of each atom in a syntax tree, with the node that names it."""
    if node.ast_type == ast.ASTType.SymbolicAtom:
        symbol = node.symbol
        while symbol.ast_type == ast.ASTType.UnaryOperation:
            symbol = symbol.argument
        variants = symbol.arguments if symbol.ast_type == ast.ASTType.Pool else (symbol,)
        for variant in variants:
            if variant.ast_type == ast.ASTType.Function:
                yield variant.name, len(variant.arguments), variant
        return
    for child in children(node):
        yield from predicates(child)


def unsigned(symbol: ast.AST) -> tuple[str, ast.AST]:
    """Return the sign of classical negation, or nothing, and an atom without it."""
    if symbol.ast_type == ast.ASTType.UnaryOperation:
        return "-", symbol.argument
    return "", symbol


def children(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of clingo's syntax tree directly below one, in order of its keys."""
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, ast.ASTSequence):
            yield from child
        elif child is not None:
            yield child
