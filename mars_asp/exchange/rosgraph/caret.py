"""The architecture files of CARET: nodes with their callbacks, and the periods of timers.

https://tier4.github.io/caret_doc/main/design/configuration/architecture_file/; files of older
versions have `publish` for `publishes`, and subscriptions among the callbacks alone.
"""

import re
from fractions import Fraction

from mars_asp.diagnostic import beginning
from mars_asp.exchange.rosgraph.dump import Dump
from mars_asp.exchange.yaml_document import WHOLE, Items, Node, Pairs, Scalar, read_dump
from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, every

_UNDEFINED = "UNDEFINED"
_MESSAGE = re.compile(r"(\w+)::msg::(\w+)")
_NANOSECONDS = 1_000_000_000
_MOST_DIGITS = 18
#: The decimals of a rate whose period is not a whole number of milliseconds.
_DECIMALS = 4


def read_caret(text: str, path: str) -> Dump:
    """Return the graph of an architecture file.

    Raises:
        MarsError: the text is not YAML.
    """
    dump = Dump()
    root = read_dump(text, path)
    nodes = root.value("nodes") if isinstance(root, Pairs) else None
    if nodes is None:
        dump.wrong(beginning(root.span), "the file has no `nodes`", "write `nodes:` and a list")
    for node in dump.maps(nodes, "nodes"):
        named = node.word("node_name")
        if named is None:
            message = "a node has no `node_name`"
            dump.wrong(beginning(node.span), message, "add `node_name: /NODE`")
        else:
            dump.node(named.text, named.span)
            _read_node(dump, node, named.text)
    if isinstance(root, Pairs):
        for key in ("named_paths", "path_name_aliases"):
            for named_path in dump.maps(root.value(key), key):
                called = named_path.word("path_name")
                if called is not None:
                    dump.skip("paths", called.text, called.span)
    return dump


def _read_node(dump: Dump, node: Pairs, name: str) -> None:
    """Add the publications and subscriptions of a node."""
    rates: dict[str, Rate] = {}
    types: dict[str, str | None] = {}
    callbacks = list(dump.maps(node.value("callbacks"), "callbacks"))
    for callback in callbacks:
        called, sort = callback.word("callback_name"), callback.word("callback_type", "type")
        if sort is None:
            message = f"a callback of `{name}` has no `callback_type`"
            dump.wrong(beginning(callback.span), message, "add `callback_type: timer_callback`")
        elif sort.text == "timer_callback":
            rate = _timer_rate(dump, callback, name)
            if called is not None and rate is not None:
                rates[called.text] = rate
        elif sort.text == "service_callback":
            service = callback.word("service_name") or sort
            dump.skip("services", service.text, service.span)
        elif sort.text == "subscription_callback":
            topic, symbol = callback.word("topic_name"), callback.word("symbol")
            if topic is None:
                message = f"a subscription of `{name}` has no `topic_name`"
                dump.wrong(beginning(callback.span), message, "add `topic_name: /TOPIC`")
                continue
            # The type that the callback takes, by its C++ symbol.
            named = set(_MESSAGE.findall("" if symbol is None else symbol.text))
            types[topic.text] = "::".join(named.pop()) if len(named) == 1 else None
            dump.end(name, topic.text, False, types[topic.text], topic.span)
    for entry in dump.maps(node.value("subscribes"), "subscribes"):
        topic = entry.word("topic_name")
        if topic is not None and topic.text not in (*types, _UNDEFINED):
            dump.end(name, topic.text, False, None, topic.span)
    for entry in dump.maps(node.value("publishes", "publish"), "publishes"):
        topic = entry.word("topic_name")
        if topic is not None and topic.text != _UNDEFINED:
            by = _callback_names(entry.value("callback_names", "callback_name"))
            if not by and len(callbacks) == 1:
                # The only callback of a node has to be the one that publishes.
                by = tuple(rates)
            # The publisher has a rate if its callbacks are timers of one rate.
            found = {rates.get(callback) for callback in by}
            rate = found.pop() if len(found) == 1 else None
            dump.end(name, topic.text, True, None, topic.span, rate)


def _timer_rate(dump: Dump, callback: Pairs, name: str) -> Rate | None:
    """Return the rate of a timer; note where it has none."""
    period = callback.word("period_ns")
    if (
        period is None
        or not WHOLE.fullmatch(period.text)
        or len(period.text) > _MOST_DIGITS
        or int(period.text) <= 0
    ):
        at = beginning(callback.span) if period is None else period.span
        message = f"a timer of `{name}` has no period of whole nanoseconds above 0"
        dump.wrong(at, message, "write `period_ns: 100000000`")
        return None
    return rate_of(int(period.text))


def rate_of(period_ns: int) -> Rate | None:
    """Return the rate of a period, or None if `.mars` cannot express it.

    It has four decimals if the period is not a whole number of milliseconds.
    """
    milliseconds = Fraction(period_ns, 1_000_000)
    if milliseconds.denominator == 1 and milliseconds <= MOST:
        seconds, rest = divmod(int(milliseconds), 1000)
        return every(int(milliseconds), "ms") if rest else every(seconds, "s")
    hz = round(Fraction(_NANOSECONDS, period_ns), _DECIMALS)
    return Rate(hz) if 0 < hz <= Fraction(MOST, 1000) else None


def _callback_names(node: Node | None) -> tuple[str, ...]:
    """Return the names of callbacks, without the placeholder `UNDEFINED`."""
    scalars = node.nodes if isinstance(node, Items) else () if node is None else (node,)
    return tuple(
        each.text for each in scalars if isinstance(each, Scalar) and each.text != _UNDEFINED
    )
