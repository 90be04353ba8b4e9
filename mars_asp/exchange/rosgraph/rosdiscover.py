"""The graphs that ROSDiscover recovers: a list of nodes with their topics.

https://github.com/rosqual/rosdiscover
"""

from mars_asp.diagnostic import beginning
from mars_asp.exchange.rosgraph.dump import Dump
from mars_asp.exchange.yaml_document import Items, Pairs, Scalar, read_dump

_CALLS = {
    "provides": "services",
    "uses": "services",
    "action-servers": "actions",
    "action-clients": "actions",
}
_PARAMETERS = ("reads", "writes")


def read_rosdiscover(text: str, path: str) -> Dump:
    """Return the graph of a dump of ROSDiscover.

    Raises:
        MarsError: the text is not YAML.
    """
    dump = Dump()
    root = read_dump(text, path)
    if not isinstance(root, Items):
        dump.wrong(beginning(root.span), "the dump is not a list of nodes", "write `- fullname:`")
    for node in dump.maps(root if isinstance(root, Items) else None, "nodes"):
        _read_node(dump, node)
    return dump


def _read_node(dump: Dump, node: Pairs) -> None:
    named = node.word("fullname") or node.word("name")
    if named is None:
        dump.wrong(beginning(node.span), "a node has no `fullname`", "add `fullname: /NODE`")
        return
    name = _full_name(node, named)
    dump.node(name, named.span)
    for key, out in (("pubs", True), ("subs", False)):
        for entry in dump.maps(node.value(key), key):
            topic, type_ = entry.word("name"), entry.word("format")
            if topic is None:
                message = f"an entry of `{key}` of `{name}` has no `name`"
                dump.wrong(beginning(entry.span), message, "add `name: /TOPIC`")
            else:
                written = None if type_ is None else type_.text
                dump.end(name, topic.text, out, written, topic.span)
    for key, sort in _CALLS.items():
        for entry in dump.maps(node.value(key), key):
            called = entry.word("name")
            if called is not None:
                dump.skip(sort, called.text, called.span)
    for key in _PARAMETERS:
        listed = node.value(key)
        for each in listed.nodes if isinstance(listed, Items) else ():
            parameter = each.word("name") if isinstance(each, Pairs) else each
            if isinstance(parameter, Scalar):
                dump.skip("parameters", parameter.text, parameter.span)


def _full_name(node: Pairs, named: Scalar) -> str:
    """Return the name of a node with its namespace, which `fullname` has already."""
    if named.text.startswith("/"):
        return named.text
    space = node.word("namespace")
    return f"{'/' if space is None else space.text.rstrip('/') + '/'}{named.text}"
