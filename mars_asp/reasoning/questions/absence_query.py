"""Parses questions about absences, and reports errors in them."""

import re
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import NamedTuple

import clingo

from mars_asp.asp.rules.statements import constants_of, defined
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.trace.patterns import hole, is_hole, pattern_in, subterms
from mars_asp.diagnostic import MarsError
from mars_asp.model.declarations import STRATEGIES, VERBS, ends_of, node_names
from mars_asp.output import counted
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.reasoning.findings import consequence_kinds, kinds_of
from mars_asp.reasoning.project import port_names
from mars_asp.reasoning.questions.subject import wrong_question
from mars_asp.reasoning.session import Reasoner
from mars_asp.spelling import nearest, suggestion

#: The atoms of `rules/resolve` that represent a node at a module, by its kind.
_AT_MODULE: dict[str, Callable[[clingo.Symbol], tuple[clingo.Symbol, ...]]] = {
    "data_splitter": lambda name: (clingo.Function("splitter", [name, hole()]),),
    "data_transformer": lambda name: (clingo.Function("transformer", [name, hole()]),),
    "arbitration_node": lambda name: (
        _receives(name),
        _receives(clingo.Function("inherited", [name])),
    ),
    "control_splitter": lambda name: (
        clingo.Function(
            "control_splitter", [hole() if is_hole(name) else clingo.Function("base", [name])]
        ),
    ),
    "inheritance_node": lambda name: (clingo.Function("inheritance_node", [name]),),
    "gate_node": lambda name: tuple(
        clingo.Function("gate", [clingo.Function(of, [name]), hole()])
        for of in ("data", "command", "entry")
    ),
}
#: Which arguments of the facts of a relationship are its two modules.
RELATIONSHIPS = {
    "uses_data_from": (False, True, True),
    "is_controlled_by": (False, True, True),
    "is_mounted_on": (False, True, False, True, False),
    **dict.fromkeys(VERBS[3:], (False, True, True)),
}
#: `KIND`, `KIND(NAME)` or `KIND("NAME")`.
CALL = re.compile(r'\s*(\w+)\s*(?:\(\s*(?:"([^"]*)"|([^",()]*?))\s*\))?\s*')


def at_module(kind: str, name: clingo.Symbol) -> tuple[clingo.Symbol, ...]:
    """Return the atoms that represent a node of `kind` at a module; kinds may be of packs."""
    if kind in _AT_MODULE:
        return _AT_MODULE[kind](name)
    return (clingo.Function("inserted_at", [clingo.Function(kind), name, hole()]),)


class AbsenceQuestion(NamedTuple):
    """A question why something is absent: a node or consequence of a `kind`, or an atom.

    `module` is None for any module. `patterns` are the atoms that would be an answer, with holes;
    `shown` is the question in messages.
    """

    shown: str
    patterns: tuple[clingo.Symbol, ...]
    kind: str | None = None
    module: str | None = None

    @property
    def is_node(self) -> bool:
        """Whether the question is about a node."""
        return any(pattern.name != "consequence" for pattern in self.patterns) and bool(self.kind)


class Vocabulary:
    """The names that can occur in a question about an absence."""

    def __init__(self, reasoner: Reasoner) -> None:
        self._reasoner, rulebook = reasoner, reasoner.rulebook
        configuration = reasoner.project.configuration
        self._path = configuration.path
        self._kinds = consequence_kinds(rulebook)
        self._nodes = node_names(configuration.kinds)
        self._any_kind = any(kinds_of(rule) is None for rule in rulebook.rules)
        self._modules = {name.text for name in configuration.modules}
        self._modules.update(end for r in configuration.relationships for end in ends_of(r))
        self._modules.update(port_names(reasoner.project))

    @cached_property
    def _predicates(self) -> set[Signature]:
        """Return the predicates of the rules and of their facts."""
        rulebook = self._reasoner.rulebook
        given = (defined(text) for _, text in rulebook.texts)
        return {head for rule in rulebook.rules for head in rule.heads}.union(*given)

    @cached_property
    def _in_rules(self) -> tuple[set[str], set[str]]:
        """Return the constants and strings of the rules."""
        constants, strings = set(CONSTANTS), set[str]()
        for found in constants_of(rule.text for rule in self._reasoner.rulebook.rules).values():
            constants |= found.names
            strings |= found.strings
        return constants, strings

    @cached_property
    def _known_terms(self) -> tuple[set[str], set[str]]:
        """Return the constants and strings of the rules and of all facts."""
        constants, strings = (set(each) for each in self._in_rules)
        for fact in self._reasoner.facts:
            for term in subterms(symbol_of(fact.atom)):
                if term.type == clingo.SymbolType.String:
                    strings.add(term.string)
                elif term.type == clingo.SymbolType.Function:
                    constants.add(term.name)
        return constants, strings | self._modules

    @cached_property
    def _other_names(self) -> set[str]:
        """Return the names of described modules, their representations and functions."""
        project = self._reasoner.project
        every = (*project.modules.values(), *project.configuration.declared)
        services = [service for module in every for service in module.services]
        named = {name for each in services for name in (each.output, *each.inputs) if name}
        functions = {each.name for module in every for each in module.functions}
        return named | functions | {module.name for module in every} | self._in_rules[1]

    @property
    def _constants(self) -> set[str]:
        return self._known_terms[0]

    @property
    def _strings(self) -> set[str]:
        return self._known_terms[1]

    def is_node(self, subject: str) -> bool:
        """Return whether a subject is the name of a node, and of no module."""
        return (
            self._reasoner.project.configuration.node_kind(subject) is not None
            and subject not in self._nodes.values()
            and subject not in self._modules
        )

    def question(self, subject: str) -> AbsenceQuestion:
        """Return the parsed question: `KIND(MODULE)` or an atom; MarsError for unknown names."""
        call = CALL.fullmatch(subject)
        if call is not None:
            name = call[2] if call[2] is not None else call[3]
            node = next(
                (kind for kind, word in self._nodes.items() if call[1] in (kind, word)), None
            )
            if node is not None and subject not in self._modules:
                about, title = self._module_term(name, self._nodes[node])
                return AbsenceQuestion(title, at_module(node, about), node, _module(about))
            if call[1] in self._kinds or self._is_kind(call[1]):
                about, title = self._module_term(name, call[1])
                kind_term = clingo.Function(call[1])
                pattern = clingo.Function("consequence", [kind_term, hole(), about, hole()])
                return AbsenceQuestion(title, (pattern,), call[1], _module(about))
            if not self._is_predicate(call[1]):
                raise self._unknown_predicate(call[1])
        return AbsenceQuestion(subject, (self._known_atom(subject),))

    def _module_term(self, name: str | None, word: str) -> tuple[clingo.Symbol, str]:
        """Return the term of a module and the text `word(name)`, which answers show.

        Without a name (None, "" or `_`) they are a term that matches any module, and `word` alone.
        """
        if name in (None, "", "_"):
            return hole(), word
        # The rules of the base are only about modules.
        names = self._strings if self._reasoner.rulebook.packs else self._modules
        return self._string(name or "", names), f"{word}({name})"

    def _is_kind(self, name: str) -> bool:
        """Whether a name may be a kind, as a rule with a variable for the kind could derive it."""
        return self._any_kind and name in self._constants and not self._is_predicate(name)

    def _is_predicate(self, name: str) -> bool:
        return any(name == known.name for known in self._predicates)

    def _known_atom(self, subject: str) -> clingo.Symbol:
        found = pattern_in(subject)
        if found is None:
            raise self._query_error(
                f"`{subject}` is not an atom", "write `KIND(NAME)`, `DataSplitter(NAME)` or an atom"
            )
        kind = signature_of(found).unsigned
        if kind not in self._predicates:
            found = self._relationship(found)
            if found is None:
                raise self._other_arity(kind)
        return clingo.Function(found.name, list(map(self._known, found.arguments)), found.positive)

    def _relationship(self, relationship: clingo.Symbol) -> clingo.Symbol | None:
        """Return the pattern of any relationship of its two modules; None for another atom."""
        shape = RELATIONSHIPS.get(relationship.name)
        if shape is None or len(relationship.arguments) != 2:
            return None
        ends = map(self._relationship_end, relationship.arguments)
        return clingo.Function(relationship.name, [next(ends) if end else hole() for end in shape])

    def _relationship_end(self, term: clingo.Symbol) -> clingo.Symbol:
        """Return the module at an end of a relationship, however its name is written."""
        if is_hole(term):
            name = term.arguments[0].string
            return term if name == "_" else self._string(name, self._modules)
        is_word = term.type == clingo.SymbolType.Function and not term.arguments
        if is_word and term.name in STRATEGIES and term.name not in self._modules:
            return term
        return self._string(term.name, self._modules) if is_word else term

    def _known(self, term: clingo.Symbol) -> clingo.Symbol:
        """Return a term with module names as strings; raise MarsError for an unknown constant."""
        if is_hole(term):
            name = term.arguments[0].string
            # Making all facts takes long, and most questions are about modules.
            is_name = name in self._modules or (name != "_" and name in self._other_names)
            return clingo.String(name) if is_name else term
        if term.type == clingo.SymbolType.String:
            is_known = term.string in self._modules
            return term if is_known else self._string(term.string, self._strings)
        if term.type != clingo.SymbolType.Function:
            return term
        known = self._in_rules[0]
        if not term.arguments and term.name in self._modules - known:
            return clingo.String(term.name)
        if term.name and term.name not in known and term.name not in self._constants:
            raise self._unknown_error("constant", term.name, self._constants)
        return clingo.Function(term.name, list(map(self._known, term.arguments)), term.positive)

    def _string(self, name: str, known: set[str]) -> clingo.Symbol:
        if name not in known:
            near = nearest(name, self._modules) or nearest(name, known)
            if near is None and name in self._other_names:
                message = f"`@modules` does not name `{name}`, so nothing follows from it by itself"
                raise self._query_error(
                    message, "ask about a module that takes part in a relationship"
                )
            help_text = f"did you mean `{near}`?" if near else "name a module, or write `_` for any"
            raise self._query_error(f"there is no name `{name}`", help_text)
        return clingo.String(name)

    def _other_arity(self, signature: Signature) -> MarsError:
        name, arity, _ = signature
        same = sorted(str(other) for other in self._predicates if other.name == name)
        if not same:
            return self._unknown_predicate(name)
        return self._query_error(
            f"no rule and no fact gives `{name}` with {counted(arity, 'argument')}",
            f"write `{name}(NAME, NAME)`"
            if name in RELATIONSHIPS
            else f"there is {' and '.join(f'`{kind}`' for kind in same)}",
        )

    def _unknown_predicate(self, name: str) -> MarsError:
        if name in self._strings:
            return self._query_error(
                f"`{name}` is a module, which is there", f"ask for `DataSplitter({name})`"
            )
        known = {known.name for known in self._predicates} | self._kinds | set(self._nodes.values())
        if name in known:
            about = "the node" if name in self._nodes.values() else "the finding"
            return self._query_error(
                f"`{name}` takes one name", f"write `{name}(NAME)`; NAME is what {about} is about"
            )
        return self._unknown_error("predicate, kind of consequence or kind of node", name, known)

    def _unknown_error(self, what: str, name: str, known: Iterable[str]) -> MarsError:
        help_text = suggestion(name, known, "see `mars-asp rules list`", 0.75)
        return self._query_error(f"there is no {what} `{name}`", help_text)

    def _query_error(self, message: str, help_text: str) -> MarsError:
        return wrong_question(self._path, message, help_text)


def _receives(name: clingo.Symbol) -> clingo.Symbol:
    return clingo.Function("receives", [name, clingo.Function("run", [hole()])])


def _module(term: clingo.Symbol) -> str | None:
    return None if is_hole(term) else term.string
