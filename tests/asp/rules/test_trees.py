"""Trees are read alike by clingo's library and by what clingo documents."""

from clingo import ast

from mars_asp.asp.rules.trees import SyntaxNode, below, extent_of, plain, public_reader, raw_reader

PROGRAM = """\
p(X+1, "a\\"b", f(_), (1,), (), 1..3; -2) :- not -q(X), X < Y <= 3, not not r(@g(X), |Y|).
{ a(X) : b(X), not c; d } 2 :- 1 < #sum+ { C, X : e(C, X); 1 : s } < 4, a(X) : b(X).
a; b : c :- #count { X } = Y, &t(X) { u : v } < 3.
:~ a(X). [X@2, X]
#minimize { 1@2, X : p(X) }. #show p/2. #show X : p(X). #const n = 3. #defined q/1.
#external e(X) : p(X). [true] % words
"""


def shape(node: SyntaxNode) -> list[object]:
    own = {
        key: value
        for key, value in vars(node).items()
        if key[0] != "_" and not isinstance(value, SyntaxNode | tuple | list)
    }
    extent = node.extent if "location" in node.tree.keys() else None  # noqa: SIM118
    return [node.ast_type, str(node), own, extent, list(map(shape, node.children))]


def test_both_readers_read_the_same() -> None:
    raw, public = raw_reader(), public_reader()
    # Where this fails, another clingo was installed, and all works on, more slowly.
    assert raw is not None
    found: list[ast.AST] = []
    ast.parse_string(PROGRAM, found.append)
    assert len(found) == 12
    for tree in found:
        assert shape(raw.read(tree)) == shape(public.read(tree)) == shape(plain(tree))
        assert raw.place(tree) == public.place(tree) == extent_of(tree)
        assert all(str(each) for each in below(plain(tree)) if each.children)
