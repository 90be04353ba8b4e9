"""Clingo's own numbers and those that are counted here stand for the same terms."""

import clingo

from mars_asp.term import Reader, Term, plain_reader, raw_reader

PROGRAM = 'p(1..3,"a",f(X,-2)) :- X = (1,("b",#inf,()),-g). -p(c,d,#sup). q. r(X) :- p(X,_,_).'


def shape(reader: Reader, term: Term) -> list[object]:
    symbol = reader.as_symbol(term)
    if symbol.type != clingo.SymbolType.Function:
        return [str(symbol)]
    return [str(symbol), [shape(reader, inside) for inside in reader.arguments(term)]]


def test_both_readers_read_the_same() -> None:
    raw, plain = raw_reader(), plain_reader()
    # Where this fails, another clingo was installed, and all works on, more slowly.
    assert raw is not None
    control = clingo.Control()
    control.add("base", [], PROGRAM)
    control.ground()
    kinds = control.symbolic_atoms.signatures
    assert len(kinds) == 4
    for kind in (*kinds, ("none", 0, True)):
        found = raw.atoms(control, *kind)
        assert [shape(raw, t) for t in found] == [
            shape(plain, t) for t in plain.atoms(control, *kind)
        ]
        assert [raw.as_term(raw.as_symbol(term)) for term in found] == found


def test_equal_terms_have_one_number() -> None:
    for reader in filter(None, (raw_reader(), plain_reader())):
        one, two, other = (clingo.parse_term(text) for text in ("f(1,g)", "f(1, g)", "f(1,h)"))
        assert reader.as_term(one) == reader.as_term(two) != reader.as_term(other)
