"""Name spaces: predicates of a pack never meet predicates of the same name elsewhere.

A predicate whose name is used once keeps it. Otherwise the name of the pack is appended after two
primes, `seen''rover`, which is never shown: `plain` removes it again.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import count

from mars_asp.asp.rules.checks import Seal
from mars_asp.asp.rules.expansions import with_conditions
from mars_asp.asp.rules.read import NameSpace, RuleFile
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import Piece, renamed
from mars_asp.asp.signature import SPACE, Signature

#: The head that makes a rule of a condition.
_HEAD = "x :- "
#: The text before the name of the predicate that a comment declares.
_HEADER = re.compile(r"(%\*!\s*-?)([a-z_]\w*'*)")


def spaced(signature: Signature, space: str) -> str:
    """Return the name of a predicate in the name space of a pack, such as `seen''rover`."""
    return f"{signature.name}{SPACE}{re.sub(r'[^A-Za-z0-9_]', '_', space)}"


def in_space(file: RuleFile, names: Mapping[Signature, str]) -> RuleFile:
    """Return a file in which the predicates in `names` have other names."""
    if not names:
        return file
    text = renamed(file.text, names)
    return file._replace(
        text=text,
        rules=tuple(_in_space(rule, names) for rule in file.rules),
        docstrings=tuple(_documented(each, names) for each in file.docstrings),
    )


def _in_space(rule: Rule, names: Mapping[Signature, str]) -> Rule:
    def condition(written: str) -> str:
        # A text that is not a condition is refused where lists are read, with its location.
        with suppress(RuntimeError):
            return renamed(f"{_HEAD}{written}.", names).removeprefix(_HEAD).removesuffix(".")
        return written

    lists = tuple((key, with_conditions(listed, condition)) for key, listed in rule.lists)
    return replace(rule, text=renamed(rule.text, names), lists=lists)


def _documented(docstring: Piece, names: Mapping[Signature, str]) -> Piece:
    """Return a comment that declares a predicate, with the predicate's name in `names`."""
    by_name = {signature.name: new for signature, new in names.items()}

    def header(match: re.Match[str]) -> str:
        return f"{match[1]}{by_name.get(match[2], match[2])}"

    return docstring._replace(text=_HEADER.sub(header, docstring.text, count=1))


def apart(
    spaces: Iterable[NameSpace], sealed: Seal, common: Mapping[Signature, str]
) -> Iterator[NameSpace]:
    """Yield packs whose private predicates have names that occur in no other pack.

    `common` are the names of predicates whose facts all packs get.
    """
    taken = {each.name for each in (*sealed.named, *common)}
    shared = {each: name for each, name in common.items() if each.name != name}
    for space in spaces:
        own = {head for rule in space.rules for head in rule.heads} - sealed.reserved
        names: dict[Signature, str] = {}
        for each in sorted(own):
            if each.name in taken:
                # Several packs can have folders of the same name.
                name = spaced(each, space.name)
                free = (f"{name}{number or ''}" for number in count())
                names[each] = next(one for one in free if one not in taken)
        taken |= {each.name for each in own} | set(names.values())
        yield space._replace(files=tuple(in_space(f, {**shared, **names}) for f in space.files))
        shared |= {each: name for each, name in names.items() if each in space.public}
