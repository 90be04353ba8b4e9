"""The predicates that a file of rules reads, derives, decides and shows."""

from mars_asp.asp import Program
from mars_asp.asp.rules.outline import outline

TEXT = """%# Tours: ways through a graph
%
% Purpose: choose a tour of all nodes,
%          as short as it can be.
% Given:   nothing/1
% Another remark.

% Purpose: no header stands here.
1 { next(X,Y) : edge(X,Y,_) } 1 :- node(X).
-far(X) :- node(X), not away(X), not next(X,_), 1 { near(X,Y) : side(Y) }.
seen(X) :- start(X), #count { Y : back(X,Y) } > 1.
seen(Y) :- seen(X), next(X,Y).
left | right :- fork.
:- node(X), not seen(X), wanted.
/* no comment */
#minimize { W,X : next(X,Y), edge(X,Y,W), dear(X) }.
#maximize { 1 : -cheap(X), node(X) }.
#defined start/1.
#show next/2.
#show -far/1.
""".replace("/* no comment */\n", "%* p(X) :- hidden(X). *%\n")


def test_an_outline_agrees_with_the_rules() -> None:
    program = Program.from_text(TEXT)
    found = outline(TEXT, program.rulebook.rules)
    assert found.title == "Tours: ways through a graph"
    assert found.purpose == "choose a tour of all nodes, as short as it can be."
    written = [" ".join(map(str, each)) for each in found[2:]]
    assert written == [
        "away/1 back/2 cheap/1 dear/1 edge/3 fork/0 near/2 node/1 side/1 start/1 wanted/0",
        "far/1 left/0 right/0 seen/1",
        "next/2",
        "-far/1 next/2",
    ]


def test_a_file_without_anything_has_an_empty_outline() -> None:
    assert outline("", ()) == ("", "", (), (), (), ())
