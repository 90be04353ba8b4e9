"""Facts of launch trees, as `rules/launch/vocabulary.lp` documents them."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count

from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import FOREVER
from mars_asp.model.graph import Endpoint, LaunchTree, Mux, Node, Relay
from mars_asp.model.ranges import MOST
from mars_asp.output import encodable
from mars_asp.spelling import nearest

#: By whether a condition has to hold.
_WANTED = ("unless", "if")


def launch_facts(trees: Iterable[LaunchTree]) -> tuple[Fact, ...]:
    """Return the facts of launch trees with their places.

    Nodes, the ends of topics, inputs of muxes and renamings are integers, counted over all trees.
    """
    numbers = count(1)
    trees = tuple(trees)
    found = chain.from_iterable(_TreeFacts(tree, numbers).of_tree() for tree in trees)
    return (*found, *_similar_names([node for tree in trees for node in tree.nodes]))


def _similar_names(nodes: Sequence[Node]) -> Iterator[Fact]:
    """Yield the topics without a publisher that are named like topics without a subscriber."""
    heard = {end.topic: end.span for node in nodes for end in node.subscribed}
    sent = {end.topic for node in nodes for end in node.published}
    free = sorted(sent - heard.keys())
    for topic, span in heard.items():
        if topic not in sent:
            last = topic.rpartition("/")[2]
            near = nearest(topic, free)
            for other in free:
                if other == near or other.rpartition("/")[2] == last:
                    yield _fact_at(span, "like_named", topic, other)


class _TreeFacts:
    """The facts of one tree."""

    def __init__(self, tree: LaunchTree, numbers: Iterator[int]) -> None:
        self.tree = tree
        self.numbers = numbers

    def of_tree(self) -> Iterator[Fact]:
        """Yield all facts."""
        path = self.tree.path
        for node in self.tree.nodes:
            yield from self.of_node(node)
        for mux in self.tree.muxes:
            yield from self.of_mux(mux)
        for relay in self.tree.relays:
            yield from self.of_relay(relay)
        for span in self.tree.unread:
            yield _fact_at(span, "open_tree", path)
        for text, span in self.tree.broken:
            yield from self.with_place(span, "unreadable", text)

    def with_place(self, span: Span, name: str, *arguments: Term) -> Iterator[Fact]:
        """Yield a fact about something new, and the place of that."""
        number = next(self.numbers)
        yield _fact_at(span, name, number, *arguments)
        yield _fact_at(span, "place", number, encodable(span.path), span.line, span.column)

    def of_start(self, started: Node | Mux | Relay, package: str) -> tuple[int, list[Fact]]:
        """Return the number of a node, mux or relay, and its facts."""
        found = list(self.with_place(started.span, "launched", self.tree.path, started.name))
        number = found[0].atom.arguments[0]
        assert isinstance(number, int)
        found.append(_fact_at(started.span, "package_of", number, package))
        for each in started.conditions:
            test = (each.variable, each.value, Atom(_WANTED[each.wanted]))
            found.append(_fact_at(each.span, "starts_if", number, *test))
            found += (_fact_at(each.span, "test_reads", each.variable, of) for of in each.reads)
        return number, found

    def of_node(self, node: Node) -> Iterator[Fact]:
        """Yield the facts of a node."""
        number, facts = self.of_start(node, node.package)
        yield from facts
        flags = {
            "may_be_renamed": not node.is_named,
            "partly_read": node.unread,
            "wholly_read": node.is_whole,
            "republishes": node.relays,
        }
        for name, holds in flags.items():
            if holds:
                yield _fact_at(node.span, name, number)
        if node.guard is not None:
            yield _fact_at(node.guard, "guarding", number)
        for end in node.published:
            yield from self.of_end("sends_on", number, end)
        for end in node.subscribed:
            yield from self.of_end("hears_on", number, end)
        for each in node.renamed:
            yield from self.with_place(each.span, "renames", number, each.source, each.target)
        renamed = {each.source for each in node.renamed}
        for named in sorted(node.names & renamed):
            yield _fact_at(node.span, "has_name", number, named)
        for managed, span in node.manages:
            yield from self.with_place(span, "manages", number, managed)

    def of_end(self, name: str, node: int, end: Endpoint) -> Iterator[Fact]:
        """Yield the facts of an end of a topic."""
        first, *others = self.with_place(end.span, name, node, end.topic)
        yield from (first, *others)
        number = first.atom.arguments[0]
        if end.type is not None:
            kind = end.type.replace("::", "/").replace(".", "/").rpartition("/")[2]
            yield _fact_at(end.span, "message_type", number, kind)
        if end.optional:
            yield _fact_at(end.span, "works_without", number)
        if end.measured:
            yield _fact_at(end.span, "reports", number)

    def of_mux(self, mux: Mux) -> Iterator[Fact]:
        """Yield the facts of a mux."""
        number, facts = self.of_start(mux, mux.engine)
        yield from facts
        yield _fact_at(mux.span, "selects_for", number, Atom(mux.engine), mux.output)
        for each in mux.inputs:
            first, *others = self.with_place(
                each.span, "selects", number, each.name, each.topic, min(each.priority, MOST)
            )
            yield from (first, *others)
            if each.hold_ms in {FOREVER, 0}:
                yield _fact_at(each.span, "holds_forever", first.atom.arguments[0])

    def of_relay(self, relay: Relay) -> Iterator[Fact]:
        """Yield the facts of a relay."""
        number, facts = self.of_start(relay, "")
        yield from facts
        yield _fact_at(relay.span, "relays", number, relay.source, relay.target)


def _fact_at(span: Span, name: str, *arguments: Term) -> Fact:
    return Fact(Atom(name, arguments), span)
