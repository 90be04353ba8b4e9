"""Access to YAML lists of maps, which files of ROSDiscover and CARET consist of."""

from collections.abc import Iterator

from mars_asp.diagnostic import beginning
from mars_asp.exchange.rosgraph.dump import Dump
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar


def value(pairs: Pairs, *keys: str) -> Node | None:
    """Return the value of the first existing key of some, or None."""
    found = {key.text: node for key, node in pairs.pairs}
    return next((found[key] for key in keys if key in found), None)


def word(pairs: Pairs, *keys: str) -> Scalar | None:
    """Return the value of the first existing key of some, or None if it is not a scalar."""
    found = value(pairs, *keys)
    return found if isinstance(found, Scalar) and found.text else None


def maps(dump: Dump, node: Node | None, what: str) -> Iterator[Pairs]:
    """Yield the maps in a list, which may be missing; add errors for other entries to `dump`.

    `what` names the entries in messages.
    """
    if node is None or (isinstance(node, Scalar) and node.text in ("", "~", "null", "UNDEFINED")):
        return
    if not isinstance(node, Items):
        dump.wrong(beginning(node.span), f"`{what}` is not a list", f"write a list of {what}")
        return
    for each in node.nodes:
        if isinstance(each, Pairs):
            yield each
        else:
            message = f"an entry of `{what}` is not a map"
            dump.wrong(beginning(each.span), message, "write `- KEY: VALUE`")
