"""What launch trees start, as facts; with `rules/launch/vocabulary.lp` all that knows of them."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count

from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import FOREVER
from mars_asp.model.graph import Endpoint, Mux, Node, Relay, Tree
from mars_asp.model.ranges import MOST
from mars_asp.output import encodable
from mars_asp.spelling import nearest

#: How it is told whether a condition has to hold.
_WANTED = ("unless", "if")


def launch_facts(trees: Iterable[Tree]) -> tuple[Fact, ...]:
    """Return the facts of launch trees with their places.

    Nodes, the ends of topics, inputs of muxes and renamings are integers, counted over all trees.
    """
    numbers = count(1)
    trees = tuple(trees)
    told = chain.from_iterable(_Compiler(tree, numbers).facts() for tree in trees)
    return (*told, *_alike([node for tree in trees for node in tree.nodes]))


def _alike(nodes: Sequence[Node]) -> Iterator[Fact]:
    """Yield which topics that nobody publishes are called like some that nobody hears."""
    heard = {end.topic: end.span for node in nodes for end in node.subscribed}
    sent = {end.topic for node in nodes for end in node.published}
    free = sorted(sent - heard.keys())
    for topic, span in heard.items():
        if topic not in sent:
            last = topic.rpartition("/")[2]
            near = nearest(topic, free)
            for other in free:
                if other == near or other.rpartition("/")[2] == last:
                    yield _fact(span, "like_named", topic, other)


class _Compiler:
    """Makes the facts of one tree."""

    def __init__(self, tree: Tree, numbers: Iterator[int]) -> None:
        self.tree = tree
        self.numbers = numbers

    def facts(self) -> Iterator[Fact]:
        """Yield all facts."""
        path = self.tree.path
        for node in self.tree.nodes:
            yield from self.node(node)
        for mux in self.tree.muxes:
            yield from self.mux(mux)
        for relay in self.tree.relays:
            yield from self.relay(relay)
        for span in self.tree.unread:
            yield _fact(span, "open_tree", path)
        for text, span in self.tree.broken:
            yield from self.placed(span, "unreadable", text)

    def placed(self, span: Span, name: str, *arguments: Term) -> Iterator[Fact]:
        """Yield a fact about something new, and the place of that."""
        number = next(self.numbers)
        yield _fact(span, name, number, *arguments)
        yield _fact(span, "place", number, encodable(span.path), span.line, span.column)

    def start(self, started: Node | Mux | Relay, package: str) -> tuple[int, list[Fact]]:
        """Return a node of the tree, and what is known of each."""
        found = list(self.placed(started.span, "launched", self.tree.path, started.name))
        number = found[0].atom.arguments[0]
        assert isinstance(number, int)
        found.append(_fact(started.span, "package_of", number, package))
        for each in started.conditions:
            asked = (each.variable, each.value, Atom(_WANTED[each.wanted]))
            found.append(_fact(each.span, "starts_if", number, *asked))
            found += (_fact(each.span, "test_reads", each.variable, of) for of in each.reads)
        return number, found

    def node(self, node: Node) -> Iterator[Fact]:
        """Yield the facts of a node."""
        number, facts = self.start(node, node.package)
        yield from facts
        said = {
            "may_be_renamed": not node.is_named,
            "partly_read": node.unread,
            "wholly_read": node.is_whole,
            "republishes": node.relays,
        }
        for name, holds in said.items():
            if holds:
                yield _fact(node.span, name, number)
        if node.guard is not None:
            yield _fact(node.guard, "guarding", number)
        for end in node.published:
            yield from self.end("sends_on", number, end)
        for end in node.subscribed:
            yield from self.end("hears_on", number, end)
        for each in node.renamed:
            yield from self.placed(each.span, "renames", number, each.source, each.target)
        for managed, span in node.manages:
            yield from self.placed(span, "manages", number, managed)

    def end(self, name: str, node: int, end: Endpoint) -> Iterator[Fact]:
        """Yield the facts of an end of a topic."""
        first, *others = self.placed(end.span, name, node, end.topic)
        yield from (first, *others)
        number = first.atom.arguments[0]
        if end.type is not None:
            kind = end.type.replace("::", "/").replace(".", "/").rpartition("/")[2]
            yield _fact(end.span, "message_type", number, kind)
        if end.optional:
            yield _fact(end.span, "works_without", number)
        if end.measured:
            yield _fact(end.span, "reports", number)

    def mux(self, mux: Mux) -> Iterator[Fact]:
        """Yield the facts of a mux."""
        number, facts = self.start(mux, mux.engine)
        yield from facts
        yield _fact(mux.span, "selects_for", number, Atom(mux.engine), mux.output)
        for each in mux.inputs:
            first, *others = self.placed(
                each.span, "selects", number, each.name, each.topic, min(each.priority, MOST)
            )
            yield from (first, *others)
            if each.hold_ms in {FOREVER, 0}:
                yield _fact(each.span, "holds_forever", first.atom.arguments[0])

    def relay(self, relay: Relay) -> Iterator[Fact]:
        """Yield the facts of a relay."""
        number, facts = self.start(relay, "")
        yield from facts
        yield _fact(relay.span, "relays", number, relay.source, relay.target)


def _fact(span: Span, name: str, *arguments: Term) -> Fact:
    return Fact(Atom(name, arguments), span)
