"""The rules of a program, and their texts for clingo."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import repeat
from typing import TypeAlias

from mars_asp.asp.fragments import Fragment, joined
from mars_asp.asp.rules.arithmetic import Arithmetic
from mars_asp.asp.rules.computed import computations
from mars_asp.asp.rules.declarations import Declaration, Documented
from mars_asp.asp.rules.outline import Outline, outline
from mars_asp.asp.rules.premises import fragment_of, premises_of
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import renamed, replaced
from mars_asp.asp.signature import SPACE, Signature, plain
from mars_asp.output import brief_repr

#: The stage of the rules that derive atoms from facts alone.
BASE = "base"
#: A stage, and a text of it.
_Text: TypeAlias = tuple[str, str]


@dataclass(frozen=True, repr=False, eq=False)
class Rulebook:
    """All rules, in the order of their files, and the texts for clingo.

    The stage of a file in `rules/` is `base`, in a folder below it the folder's name. The last
    `packs` texts and `pack_rules` rules are those of packs. `paths` are the shown paths of the
    texts. `documented` has the declarations of predicates of each text.

    >>> load_rulebook().by_id["data/divergence"].span.path
    'rules/data.lp'
    """

    __repr__ = brief_repr

    rules: tuple[Rule, ...]
    texts: tuple[_Text, ...]
    packs: int = 0
    pack_rules: int = 0
    paths: tuple[str, ...] = ()
    documented: tuple[Documented, ...] = ()
    #: Further content of packs, which the host reads.
    brought: tuple[object, ...] = ()
    #: Constants that packs add to the finite sorts with a certain constant.
    added: tuple[tuple[str, tuple[str, ...]], ...] = ()

    def text(self, stage: str) -> str:
        """Return the rules of one stage as text for clingo."""
        return joined(self.fragments(stage))

    def fragments(self, stage: str) -> tuple[Fragment, ...]:
        """Return the texts of one stage as fragments, and the rules made from metadata."""
        if stage not in self._fragments:
            self._fragments[stage] = self._read_fragments(stage)
        return self._fragments[stage]

    @cached_property
    def _fragments(self) -> dict[str, tuple[Fragment, ...]]:
        """Return the cache of `fragments`, by stage."""
        return {}

    def _read_fragments(self, stage: str) -> tuple[Fragment, ...]:
        paths = (*self.paths, *repeat("rules", len(self.texts) - len(self.paths)))
        found = zip(self.texts, paths, strict=True)
        rules = [rule for rule in self.rules if rule.stage == stage]
        # A text without a file is a rule of another rulebook.
        own, in_files = len(self.texts) - self.packs, len(self.paths)
        alone = {rule.text: rule for rule in rules} if in_files < own else {}
        files = (
            fragment_of(alone[text])
            if number >= in_files and text in alone
            else Fragment(text, path, premises=premises_of(text) if number < own else None)
            for number, ((at, text), path) in enumerate(found)
            if at == stage
        )
        return (*files, *(fragment_of(rule) for rule in rules if rule.listed is not None))

    @cached_property
    def outlines(self) -> Mapping[str, tuple[str, Outline]]:
        """Return the stage and the outline of each file, by its path."""
        rules: dict[str, list[Rule]] = {}
        for rule in self.rules:
            rules.setdefault(rule.span.path, []).append(rule)
        return {
            path: (stage, outline(text, rules.get(path, ())))
            for path, (stage, text) in zip(self.paths, self.texts, strict=True)
            # The text of a manifest is not a file of rules.
            if not path.endswith(".toml")
        }

    @cached_property
    def built_in(self) -> "Rulebook":
        """Return the rulebook without rules, texts and declarations of packs; the rest stays."""
        if not self.packs:
            return self
        rules = self.rules[: len(self.rules) - self.pack_rules]
        texts, paths = self.texts[: -self.packs], self.paths[: -self.packs]
        documented = self.documented[: -self.packs]
        return Rulebook(
            rules, texts, paths=paths, documented=documented, brought=self.brought, added=self.added
        )

    def pack_texts(self, stage: str) -> tuple[str, ...]:
        """Return the texts of packs in one stage."""
        packs = self.texts[len(self.texts) - self.packs :]
        return tuple(text for at, text in packs if at == stage)

    @property
    def of_packs(self) -> tuple[Rule, ...]:
        """Return the rules of packs."""
        return self.rules[len(self.rules) - self.pack_rules :]

    @cached_property
    def declarations(self) -> Mapping[Signature, Declaration]:
        """Return the declarations of predicates; packs declare only their own."""
        found: dict[Signature, Declaration] = {}
        for file in self.documented:
            for each in file.declarations:
                found.setdefault(each.signature, each)
        for known, more in self.added:
            found = {at: each.with_constants(known, more) for at, each in found.items()}
        return found

    def declared_in(self, stage: str) -> tuple[Declaration, ...]:
        """Return the declarations in the texts of one stage."""
        files = (file for file in self.documented if file.stage == stage)
        return tuple(each for file in files for each in file.declarations)

    def as_named(self, facts: str) -> str:
        """Return facts written for packs, with the program's names of their predicates."""
        return renamed(facts, self._spaced) if self._spaced else facts

    @cached_property
    def _spaced(self) -> Mapping[Signature, str]:
        """Return the names in name spaces of predicates of packs, by their plain signatures."""
        heads = [head for rule in self.of_packs for head in rule.heads]
        documented = self.documented[len(self.documented) - self.packs :]
        declared = [each.signature for file in documented for each in file.declarations]
        spaced = (each.unsigned for each in (*declared, *heads) if SPACE in each.name)
        return {each._replace(name=plain(each.name)): each.name for each in spaced}

    @cached_property
    def arithmetic(self) -> tuple[Arithmetic, ...]:
        """Return the operations in packs' rules that may exceed 32 bits."""
        own = self.of_packs
        # A rule made from metadata computes nothing except in the body of its original.
        rules = [rule for rule in own if rule.listed is None and rule.stage == BASE]
        found = computations(rule.text for rule in rules)
        return tuple(Arithmetic(r.span, each) for r in rules for each in found.get(r.text, ()))

    @cached_property
    def replaced(self) -> frozenset[str]:
        """Return the constants that packs redefine by `#const`."""
        packs = self.texts[len(self.texts) - self.packs :]
        return frozenset().union(*(replaced(text) for _, text in packs))

    @cached_property
    def by_id(self) -> dict[str, Rule]:
        """Return the rules by their ids."""
        return {rule.id: rule for rule in self.rules}
