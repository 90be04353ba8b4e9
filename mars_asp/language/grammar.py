"""Statements parsed by Lark with the grammar of the language."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias, cast

import lark
from lark import Lark, Token, Transformer, Tree, UnexpectedInput
from lark.grammar import Rule
from lark.lexer import TerminalDef

from mars_asp.asp.cache import memoized
from mars_asp.language.statements import Raw, Word
from mars_asp.model.names import plain

#: The tables of a parser: lists, dicts, words and numbers.
_Tables: TypeAlias = tuple[dict[str, Any], dict[str, Any]]


def parsed(text: str) -> list[Raw] | UnexpectedInput:
    """Return the statements of a text as raw tuples (rule, children), or the first syntax error."""
    try:
        return cast("list[Raw]", _parser().parse(text))
    except UnexpectedInput as error:
        return error


class _Statements(Transformer[Token, list[Raw]]):
    """Transforms Lark's trees into raw tuples: the name of the rule, and the children."""

    def start(self, children: list[Raw]) -> list[Raw]:
        """Return the statements of a text."""
        return children

    def __default__(self, data: str, children: list[Any], meta: object) -> Any:
        """Return the raw tuple of a rule, or a tree for a repetition, which Lark expands."""
        if data.startswith("_"):
            return Tree(data, children)
        return data, [_word(child) for child in children]


def _word(child: Token | Raw | None) -> Word | Raw | None:
    if not isinstance(child, Token):
        return child
    assert child.start_pos is not None
    assert child.end_pos is not None
    text, begin = str(child), child.start_pos
    if child.type == "PORT":
        text, begin = text[1:], begin + 1
    if child.type in ("NAME", "PORT"):
        text = plain(text)
    return Word(text, begin, child.end_pos)


@cache
def _parser() -> Lark:
    grammar = Path(__file__).with_name("grammar.lark")
    version = f"{lark.__version__} {grammar.read_text(encoding='utf-8')}"
    tables = memoized("grammar", (Path(__file__),), [version], lambda _: _tables(grammar))[version]
    # Lark's standalone parsers begin in the same way; the tables do not contain the transformer.
    begin: Callable[..., Lark] = Lark._load_from_dict
    return begin(*tables, transformer=_Statements())


def _tables(grammar: Path) -> _Tables:
    """Return the parse tables of a grammar, from which Lark's parser is built."""
    made = Lark(grammar.read_text(encoding="utf-8"), parser="lalr", maybe_placeholders=True)
    tables: _Tables = made.memo_serialize([TerminalDef, Rule])
    return tables
