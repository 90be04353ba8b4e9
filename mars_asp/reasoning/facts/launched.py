"""Facts of launch trees, as `rules/launch/vocabulary.lp` documents them."""

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count

from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.diagnostic import Span, point
from mars_asp.model.declarations import FOREVER
from mars_asp.model.graph import Endpoint, GivenFile, GraphNode, LaunchTree, Mux, Relay
from mars_asp.model.ranges import MOST
from mars_asp.output import encodable
from mars_asp.reasoning.facts.topic_names import are_alike, is_in_namespace, is_misspelt

#: By whether a condition has to hold.
_WANTED = ("unless", "if")
#: What a variable or a parameter of a template is called, in place of a type of messages.
_VARIABLE = re.compile(r"[a-z_].*|(?:.*[a-z_])?T")
#: Names of mux inputs that show from where the commands come.
_SPELLINGS = {
    "hand": re.compile(
        r"(?i)joy|teleop|keyboard|gamepad|manual|remote|tablet|(?:^|[/_ ])(?:key|rc|web)(?:$|[/_ ])"
    ),
    "machine": re.compile(
        r"(?i)nav|auto|follow|track|dock|explor|plann|patrol|mission|move_base|ai(?:$|[/_ ])"
    ),
    "safety": re.compile(r"(?i)stop|safe|collision|bumper|obstacle|brake|emergency|zero|halt"),
}
#: By whether a parameter file has a section for a node, or none at all.
_FITS = {True: "own", False: "other", None: "none"}
#: The facts of the sorts of things that a package lacks.
_ABSENT = {
    "file": "lacks_file",
    "program": "lacks_program",
    "not installed": "leaves_out",
    "function": "calls_missing",
    "argument": "passes_in_vain",
    "refused argument": "passes_in_vain",
    "undeclared argument": "reads_undeclared",
    "parameter": "sets_in_vain",
    "programs": "hides_programs",
}
#: The type of the messages at a lock.
_TRUTH = "std_msgs/msg/Bool"
_TRUTHS = {"true": "true", "1": "true", "false": "false", "0": "false"}


def launch_facts(trees: Iterable[LaunchTree]) -> tuple[Fact, ...]:
    """Return the facts of launch trees with their places.

    Nodes, the ends of topics, inputs of muxes and renamings are integers, counted over all trees.
    """
    numbers = count(1)
    trees = tuple(trees)
    found = chain.from_iterable(_TreeFacts(tree, numbers).of_tree() for tree in trees)
    return (*found, *_similar_names(trees))


def _similar_names(trees: Sequence[LaunchTree]) -> Iterator[Fact]:
    """Yield each subscribed topic without a publisher, with the topics and nodes of similar names.

    Only topics without a subscriber are compared, and nodes whose program could not be read wholly.
    """
    nodes = [node for tree in trees for node in tree.nodes]
    heard = {end.topic: end.span for node in nodes for end in node.subscribed}
    muxes = [mux for tree in trees for mux in tree.muxes]
    heard |= {each.topic: each.span for mux in muxes for each in (*mux.inputs, *mux.locks)}
    sent = {end.topic for node in nodes for end in node.published} | {mux.output for mux in muxes}
    free = sorted(sent - heard.keys())
    unread = sorted({node.name for node in nodes if node.unread})
    for topic, span in heard.items():
        if topic not in sent:
            for other in free:
                if are_alike(topic, other):
                    yield _fact_at(span, "like_named", topic, other)
                if is_in_namespace(topic, other):
                    yield _fact_at(span, "in_namespace", topic, other)
                if is_misspelt(topic, other):
                    yield _fact_at(span, "misspelt_topic", topic, other)
            for name in unread:
                if topic.split("/")[1] in name.split("/"):
                    yield _fact_at(span, "near_node", topic, name)


class _TreeFacts:
    """The facts of one tree."""

    def __init__(self, tree: LaunchTree, numbers: Iterator[int]) -> None:
        self.tree = tree
        self.numbers = numbers
        #: The first node that starts under some conditions.
        self.first: dict[frozenset[tuple[Term, ...]], int] = {}

    def of_tree(self) -> Iterator[Fact]:
        """Yield all facts of the tree: of its nodes, muxes, relays, files and defaults."""
        path = self.tree.path
        for node in self.tree.nodes:
            yield from self.of_node(node)
        for mux in self.tree.muxes:
            yield from self.of_mux(mux)
        for relay in self.tree.relays:
            yield from self.of_relay(relay)
        if self.tree.is_of_programs:
            yield _fact_at(point(path, 1, 1), "is_of_programs", path)
        for span in self.tree.unread:
            yield _fact_at(span, "open_tree", path)
        for span in self.tree.unstarted:
            yield _fact_at(span, "starts_unread", path)
        for text, span in self.tree.broken:
            # The place has the path already.
            message = text.removeprefix(f"{span.path}: ")
            yield from self.with_place(span, "unreadable", message)
        yield from self.of_repeated_keys()
        for each in self.tree.missing:
            terms = (
                (path, each.package) if each.sort == "programs" else (path, each.package, each.name)
            )
            yield from self.with_place(each.span, _ABSENT[each.sort], *terms)
            if each.sort == "refused argument":
                yield _fact_at(each.span, "refuses_arguments", each.package)
        for file in self.tree.shared:
            yield _fact_at(point(path, 1, 1), "is_shared", file)
        for node in self.tree.by_hand:
            for end in node.published:
                yield _fact_at(end.span, "published_by_hand", end.topic)
            for end in node.subscribed:
                yield _fact_at(end.span, "subscribed_by_hand", end.topic)
        for variable, value in self.tree.defaults:
            # Conditions take these for truths.
            truth = _TRUTHS.get(value.lower(), value)
            yield _fact_at(point(path, 1, 1), "default_of", path, variable, truth)

    def of_repeated_keys(self) -> Iterator[Fact]:
        """Yield the facts of the keys that parameter files have twice."""
        path = self.tree.path
        for key in self.tree.repeated:
            file, sort = key.span.path, "lost"
            if key.is_merged or key.within:
                sort = "merged" if key.is_merged else "within_merged"
            yield from self.with_place(key.span, "has_twice", file, key.name, Atom(sort))
            yield _fact_at(key.span, "loads", path, file)
            if file in self.tree.rewritten:
                yield _fact_at(key.span, "rewrites", path, file)

    def with_place(self, span: Span, name: str, *arguments: Term) -> Iterator[Fact]:
        """Yield a fact `name(Number, ...)` with a new number, and the location of the number."""
        number = next(self.numbers)
        yield _fact_at(span, name, number, *arguments)
        yield _fact_at(span, "place", number, span.path, span.line, span.column)

    def of_start(
        self, started: GraphNode | Mux | Relay, package: str, span: Span
    ) -> tuple[int, list[Fact]]:
        """Return the number of a node, mux or relay of `package`, and the facts of its start.

        `span` is the place where it is started.
        """
        found = list(self.with_place(span, "launched", self.tree.path, started.name))
        number = found[0].atom.arguments[0]
        assert isinstance(number, int)
        found.append(_fact_at(span, "package_of", number, package))
        tests = [
            (each.variable, each.value, Atom(_WANTED[each.wanted])) for each in started.conditions
        ]
        alike = self.first.setdefault(frozenset(tests), number)
        found.append(_fact_at(span, "starts_like", number, alike))
        for each, test in zip(started.conditions, tests, strict=True):
            found.append(_fact_at(each.span, "starts_if", number, *test))
            found += (_fact_at(each.span, "test_reads", each.variable, of) for of in each.reads)
        return number, found

    def of_node(self, node: GraphNode) -> Iterator[Fact]:
        """Yield the facts of a node: its names, topics, remappings and parameter files."""
        number, facts = self.of_start(node, node.package, node.span)
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
        yield from self.of_renamings(number, node)
        is_unknown = node.unread and not (node.published or node.subscribed)
        for named in sorted(node.names if is_unknown else ()):
            yield _fact_at(node.span, "may_use", number, named)
        yield from self.of_files(number, node.given)
        for managed, span in node.manages:
            yield from self.with_place(span, "manages", number, managed)

    def of_renamings(self, number: int, node: GraphNode | Mux) -> Iterator[Fact]:
        """Yield the facts of renamed topics, and of the remapped names that the node has."""
        for each in node.renamed:
            name = "sets_topic" if each.is_by_parameter else "renames"
            yield from self.with_place(each.span, name, number, each.source, each.target)
        remapped = {each.source for each in node.renamed if not each.is_by_parameter}
        for named in sorted(remapped & (node.names or set())):
            yield _fact_at(node.span, "has_name", number, named)

    def of_files(self, number: int, files: Iterable[GivenFile]) -> Iterator[Fact]:
        """Yield the facts of the parameter files that the node or mux `number` is given."""
        for file in files:
            fits = Atom(_FITS[file.is_for_it])
            yield from self.with_place(file.span, "given", number, file.path, fits)

    def of_end(self, name: str, node: int, end: Endpoint) -> Iterator[Fact]:
        """Yield the facts of a publisher or subscriber of the node; `name` is the predicate."""
        first, *others = self.with_place(end.span, name, node, end.topic)
        yield from (first, *others)
        number = first.atom.arguments[0]
        if end.type is not None:
            kind = end.type.replace("::", "/").replace(".", "/").rpartition("/")[2]
            if _VARIABLE.fullmatch(kind) is None:
                yield _fact_at(end.span, "message_type", number, kind)
        if end.driver is not None:
            yield _fact_at(end.span, "usual_source", number, end.driver)
        if end.optional:
            yield _fact_at(end.span, "works_without", number)
        if end.measured:
            yield _fact_at(end.span, "reports", number)
        if end.last:
            yield _fact_at(end.span, "sent_last", number)

    def of_mux(self, mux: Mux) -> Iterator[Fact]:
        """Yield the facts of a mux: its output, parameter files and inputs."""
        span = mux.span if mux.started is None else mux.started
        number, facts = self.of_start(mux, mux.engine, span)
        yield from facts
        renamed = (each.span for each in mux.renamed if each.target == mux.output)
        yield _fact_at(next(renamed, span), "selects_for", number, Atom(mux.engine), mux.output)
        yield from self.of_files(number, mux.given)
        yield from self.of_renamings(number, mux)
        if mux.names is not None:
            yield _fact_at(span, "wholly_read", number)
        for each in mux.inputs:
            first, *others = self.with_place(
                each.span, "selects", number, each.name, each.topic, min(each.priority, MOST)
            )
            yield from (first, *others)
            for kind, spelling in _SPELLINGS.items():
                if spelling.search(f"{each.name} {each.topic}"):
                    yield _fact_at(each.span, "named_for", first.atom.arguments[0], Atom(kind))
            if each.hold_ms in {FOREVER, 0}:
                yield _fact_at(each.span, "holds_forever", first.atom.arguments[0])
        for lock in mux.locks:
            yield from self.of_end("hears_on", number, Endpoint(lock.topic, _TRUTH, lock.span))

    def of_relay(self, relay: Relay) -> Iterator[Fact]:
        """Yield the facts of a relay: its start, and the topics that it connects."""
        number, facts = self.of_start(relay, "", relay.span)
        yield from facts
        yield _fact_at(relay.span, "relays", number, relay.source, relay.target)


def _fact_at(span: Span, name: str, *arguments: Term) -> Fact:
    safe = tuple(encodable(each) if isinstance(each, str) else each for each in arguments)
    return Fact(Atom(name, safe), span)
