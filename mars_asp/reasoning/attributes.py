"""Attributes of modules as facts: `@Tag safety_critical`, `@Property latency_ms 60`.

Rule packs declare the attributes; each declaration restricts the values.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import NamedTuple

from mars_asp.asp.rules.checks import Seal
from mars_asp.asp.rules.declarations import Declaration, PredicateArgument
from mars_asp.asp.rules.namespaces import spaced
from mars_asp.asp.rules.read import NameSpace
from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.asp.units import NUMBERS, units_of, usual
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.model.attributes import TAG, Attribute, read_measure
from mars_asp.model.declarations import Configuration, Module, ends_of
from mars_asp.model.described import described_modules
from mars_asp.model.names import plain, read_name
from mars_asp.model.ranges import MOST
from mars_asp.reasoning.includes import module_named
from mars_asp.spelling import suggestion

_CODE = "attribute"
#: Suffix of the name of an attribute that has the name of a predicate of the built-in rules.
_SPACE = "attribute"
_LEAST = -(2**31)
#: A number with more digits never fits in 32 bits, and is not computed with.
_MOST_DIGITS = 30
#: Sorts of values that only the program itself numbers.
_UNSTATED = frozenset({"relationship", "annotation"})
_WHOLE = re.compile(r"-?[0-9]+")


class AttributeKind(NamedTuple):
    """An attribute that a pack declares; `predicate` is its name in the rules."""

    pack: str
    declaration: Declaration
    predicate: str

    @property
    def name(self) -> str:
        """Return the word by which configurations and annotations state the attribute."""
        return self.declaration.name

    @property
    def value(self) -> PredicateArgument | None:
        """Return the type of the values, or None for a tag."""
        return None if self.declaration.attribution == "tag" else self.declaration.arguments[1]

    def __str__(self) -> str:
        """Return the attribute as messages name it."""
        return f"the {self.declaration.attribution} `{self.name}`"


def attribute_kinds(
    spaces: Iterable[NameSpace], sealed: Seal, problems: list[Diagnostic]
) -> tuple[AttributeKind, ...]:
    """Return the attributes that packs declare; note the unusable and the contradictory ones.

    An attribute with the name of a built-in predicate gets another predicate, which the built-in
    rules do not read.
    """
    taken = {each.name for each in sealed.named}
    first: dict[str, AttributeKind] = {}
    for space in spaces:
        for file in space.files:
            for each in file.documented.declarations:
                if each.attribution is None:
                    continue
                if wrong := _unfit(each):
                    problems.append(wrong)
                    continue
                signature = each.signature
                name = spaced(signature, _SPACE) if each.name in taken else each.name
                kind = AttributeKind(space.name, each, name)
                earlier = first.setdefault(each.name, kind)
                if _meaning(earlier) != _meaning(kind):
                    problems.append(_contrary(kind, earlier))
    return tuple(first.values())


def _unfit(declared: Declaration) -> Diagnostic | None:
    """Return the error if a predicate cannot be an attribute of modules, else None."""
    arguments, kind = declared.arguments, declared.attribution
    wanted = 1 if kind == "tag" else 2
    no_value = sorted(arguments[-1].sorts & _UNSTATED) if arguments else []
    if declared.name.startswith(("-", "_")) or "'" in declared.name:
        wrong = "its name is more than letters, digits and `_`"
    elif len(arguments) != wanted:
        wrong = f"it has {len(arguments)} arguments, not {wanted}"
    elif arguments[0].sorts != frozenset({"module"}):
        wrong = "its first argument is not of the sort `module`"
    elif no_value:
        wrong = f"no annotation states a value of the sort `{no_value[0]}`"
    elif not arguments[-1].sorts and not arguments[-1].constants:
        wrong = "its value has no sort"
    else:
        return None
    form = "name(M: module)" if kind == "tag" else "name(M: module, V: sort)"
    message = f"`{declared.name}` cannot be a {kind}: {wrong}"
    advice = f"write `%*! {form}`"
    return Diagnostic("rule-declaration", "error", message, declared.span, help=advice)


def wrong_kinds(
    kinds: Iterable[AttributeKind], spaces: Iterable[NameSpace], sealed: Seal
) -> Iterator[Diagnostic]:
    """Yield errors for attributes with reserved names and for rules that derive attributes."""
    for kind in kinds:
        if kind.declaration.signature in sealed.reserved or kind.name in sealed.arities:
            message = f"`{kind.name}` means something else already, so it cannot be {kind}"
            advice = "choose another name"
            yield Diagnostic("rule-reserved", "error", message, kind.declaration.span, help=advice)
    for space in spaces:
        declared = (each for file in space.files for each in file.documented.declarations)
        own = {each.name for each in declared if each.attribution is not None}
        for rule in space.rules if own else ():
            for head in sorted({head.name for head in rule.heads} & own):
                message = f"`{head}` is stated by annotations, and nothing derives it"
                advice = "derive a predicate of your own from it"
                yield Diagnostic("rule-reserved", "error", message, rule.span, help=advice)


def attribute_facts(
    configuration: Configuration,
    modules: Mapping[str, Module],
    kinds: Iterable[AttributeKind],
) -> tuple[Fact, ...]:
    """Return the facts of all attributes with their locations.

    `modules` are those that sources describe, by name; `kinds` are the declared attributes.

    Raises:
        MarsError: attributes that no pack declares, values of the wrong sort, and two values of one
            property.
    """
    return _AttributeReader(configuration, modules, kinds).facts()


class _AttributeEntry(NamedTuple):
    """An attribute, with the module to which the configuration or a description attaches it."""

    module: str
    attribute: Attribute


class _AttributeReader:
    """Reads the attributes of one configuration, and notes the errors in them."""

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        kinds: Iterable[AttributeKind],
    ) -> None:
        self._configuration = configuration
        declared = {module.name: module for module in configuration.declared}
        self._described = {**modules, **declared}
        self._kinds = {kind.name: kind for kind in kinds}
        named = {name.text for name in configuration.modules}
        ends = (ends_of(each) for each in configuration.relationships)
        self._named = named.union(*ends)
        self._known = named | self._described.keys()
        self._problems: dict[Diagnostic, None] = {}

    def facts(self) -> tuple[Fact, ...]:
        """Return the facts of the attributes, without duplicates, by module and name."""
        first: dict[tuple[str, str], Fact] = {}
        described = described_modules(self._configuration, self._described).values()
        entries = [
            _AttributeEntry(module.name, each) for module in described for each in module.attributes
        ]
        for module, attribute in (*entries, *self._of_lines()):
            atom = self._attribute_atom(module, attribute)
            if atom is None:
                continue
            fact = Fact(atom, attribute.span)
            earlier = first.setdefault((atom.name, module), fact)
            if earlier.atom != atom:
                message = f"the property `{attribute.name}` of `{module}` has two values"
                labels = ((earlier.span, "the first value"),)
                self._note_attribute(message, attribute.span, "keep one of the two", labels)
        if self._problems:
            raise MarsError(self._problems)
        return tuple(first[key] for key in sorted(first))

    def _of_lines(self) -> Iterator[_AttributeEntry]:
        named = {name.text for name in self._configuration.modules}
        instances: dict[str, list[str]] = {}
        for name in self._configuration.modules:
            if name.described is not None and name.described != name.text:
                instances.setdefault(name.described, []).append(name.text)
        for line in self._configuration.attributed:
            if line.module not in self._known and line.module not in instances:
                advice = suggestion(line.module, self._known, "name it in `@modules`")
                message = f"`{line.module}` is not a module of the configuration"
                self._note_attribute(message, line.attribute.span, advice)
            described = () if line.module in named else instances.get(line.module, ())
            for module in (line.module, *described):
                yield _AttributeEntry(module, line.attribute)

    def _attribute_atom(self, module: str, attribute: Attribute) -> Atom | None:
        kind = self._kinds.get(attribute.name)
        if kind is None or (kind.value is None) != (attribute.value is None):
            self._undeclared(attribute, kind)
            return None
        if kind.value is None or attribute.value is None:
            return Atom(kind.predicate, (module,))
        value = self._read_value(attribute.value, kind.value, module)
        if isinstance(value, _Wrong):
            # Several modules share a description; the error in it is reported once.
            self._note_attribute(f"`{attribute.name}`: {value.message}", attribute.span, value.help)
            return None
        return Atom(kind.predicate, (module, value))

    def _read_value(
        self, written: str, argument: PredicateArgument, module: str
    ) -> "Term | _Wrong":
        if argument.constants:
            return _constant(written, argument.constants)
        reads: list[Term | _Wrong] = [
            _number(written, sort) for sort in sorted(argument.sorts & NUMBERS)
        ]
        if "module" in argument.sorts:
            reads.append(self._configured_module(written, module))
        for read in reads:
            if not isinstance(read, _Wrong):
                return read
        wrong = next(iter(reads), None)
        others = argument.sorts - NUMBERS - {"module"}
        # A number that does not fit its sort is an error, and is not read as a word.
        if wrong is None or (others and read_measure(written) is None):
            return plain(written)
        return wrong

    def _configured_module(self, written: str, beside: str) -> "str | _Wrong":
        name = read_name(written)
        found = None if name is None else module_named(name, beside, self._named)
        if found is not None:
            return found
        return _Wrong(
            f"`{written}` is not a module of the configuration",
            suggestion(name or "", self._named, "name a module of `@modules`"),
        )

    def _undeclared(self, attribute: Attribute, kind: AttributeKind | None) -> None:
        word = "tag" if attribute.word == TAG else "property"
        if kind is not None:
            form = f"@Tag {kind.name}" if kind.value is None else f"@Property {kind.name} VALUE"
            other = "a tag" if kind.value is None else "a property"
            message = f"`{attribute.name}` is {other}, not a {word}"
            self._note_attribute(message, attribute.span, f"write `{form}`")
            return
        known = ", ".join(f"`{name}`" for name in sorted(self._kinds))
        advice = "give the pack that declares it with `--rules`"
        if known:
            advice = suggestion(attribute.name, self._kinds, f"{advice}; declared so far: {known}")
        message = f"no rule pack declares the {word} `{attribute.name}`"
        self._note_attribute(message, attribute.span, advice)

    def _note_attribute(
        self,
        message: str,
        span: Span,
        advice: str,
        labels: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        self._problems[Diagnostic(_CODE, "error", message, span, labels, advice)] = None


class _Wrong(NamedTuple):
    """The error in a value, and the advice to the user."""

    message: str
    help: str


def _number(written: str, sort: str) -> "int | _Wrong":
    """Return the whole number in a text, in the unit of `sort`, or the error in the text."""
    units = units_of(sort)
    shown = f" of {', '.join(usual(units))}" if units else ""
    read = read_measure(written)
    if read is None:
        help_text = f"write a whole number of {sort}" if units else "write a whole number"
        return _Wrong(f"expected a number, found `{written}`", help_text)
    number, unit = read
    if unit and unit not in units:
        advice = (
            f"write a number{shown}, or one without a unit: {sort}"
            if units
            else ("write the number alone")
        )
        return _Wrong(f"`{unit}` is not a unit of {sort}", advice)
    fits = len(number) <= _MOST_DIGITS
    value = Decimal(number) * units.get(unit, 1) if fits else Decimal(0)
    if not fits or not _LEAST <= value <= MOST:
        return _Wrong(f"`{written}` does not fit 32 bits", f"write one from {_LEAST} to {MOST}")
    if value != int(value):
        advice = (
            f"write a whole number of {sort}, or of a unit in which it is one"
            if units
            else ("write a whole number")
        )
        return _Wrong(f"`{written}` is not a whole number of {sort}", advice)
    return int(value)


def _constant(written: str, constants: Sequence[str]) -> "Term | _Wrong":
    if written in constants:
        return int(written) if _WHOLE.fullmatch(written) else Atom(written)
    known = ", ".join(f"`{each}`" for each in constants)
    advice = suggestion(written, constants, f"write one of {known}")
    return _Wrong(f"expected one of {known}, found `{written}`", advice)


def _meaning(kind: AttributeKind) -> tuple[object, ...]:
    value = kind.value
    return (kind.declaration.attribution, value and value.sorts, value and set(value.constants))


def _contrary(kind: AttributeKind, earlier: AttributeKind) -> Diagnostic:
    """Return the error that packs declare an attribute in two different ways."""
    packs = f"the packs `{earlier.pack}` and `{kind.pack}` declare"
    if kind.pack == earlier.pack:
        packs = f"the pack `{kind.pack}` declares"
    message = f"{packs} `{kind.name}` in two ways"
    labels = ((earlier.declaration.span, f"`{earlier.declaration.written}`, {earlier}"),)
    advice = f"this one is `{kind.declaration.written}`, {kind}: declare the same in both"
    return Diagnostic(_CODE, "error", message, kind.declaration.span, labels, advice)
