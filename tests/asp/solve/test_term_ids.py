"""Term ids of clingo and of `TermReader` represent the same terms."""

import clingo

from mars_asp.asp.solve.term_ids import TermId, TermReader, plain_reader, raw_reader

PROGRAM = 'p(1..3,"a",f(X,-2)) :- X = (1,("b",#inf,()),-g). -p(c,d,#sup). q. r(X) :- p(X,_,_).'


def shape(reader: TermReader, term: TermId) -> list[object]:
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
        literals = [each[1:] for each in raw.labelled(control, *kind)]
        assert literals == [each[1:] for each in plain.labelled(control, *kind)]
        assert [each[0] for each in raw.labelled(control, *kind)] == found
        assert [raw.as_term(raw.as_symbol(term)) for term in found] == found
        assert [raw.text(term) for term in found] == [str(raw.as_symbol(term)) for term in found]


def test_equal_terms_have_one_number() -> None:
    for reader in filter(None, (raw_reader(), plain_reader())):
        one, two, other = (clingo.parse_term(text) for text in ("f(1,g)", "f(1, g)", "f(1,h)"))
        assert reader.as_term(one) == reader.as_term(two) != reader.as_term(other)


def test_both_readers_state_the_same_facts() -> None:
    for reader in filter(None, (raw_reader(), plain_reader())):
        control = clingo.Control()
        control.add("base", [], 'p(1,f("a")). p((),-g). q.')
        control.ground()
        terms = [*reader.atoms(control, "p", 2, True), *reader.atoms(control, "q", 0, True)]
        reader.state(control, {("copy", False): terms})
        control.add("more", [], "seen(X) :- -copy(X,_). none :- not -copy.")
        control.ground([("more", [])])
        true = {str(atom.symbol) for atom in control.symbolic_atoms if atom.is_fact}
        assert true == {
            *('p(1,f("a"))', "p((),-g)", "q"),
            *('-copy(1,f("a"))', "-copy((),-g)", "-copy", "seen(1)", "seen(())"),
        }


def test_texts_are_whole_however_long() -> None:
    for reader in filter(None, (raw_reader(), plain_reader())):
        for name in ("a" * 5000, "\u00e9\n" * 3000, "b"):
            assert reader.text(reader.as_term(clingo.Function(name))) == name
