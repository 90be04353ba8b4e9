"""Names of ROS: relative, private and absolute ones, and renamings."""

from collections.abc import Iterable, Sequence

#: An old and a new name, both as they are written.
Renaming = tuple[str, str]


def absolute(name: str, namespace: str, node: str) -> str:
    """Return the full name of a topic that a node of a namespace knows by a name."""
    if name.startswith("~"):
        return joined(joined(namespace, node), name[1:].lstrip("/"))
    return joined(namespace, name)


def joined(namespace: str, name: str) -> str:
    """Return the full name of a name in a namespace; one that begins with a slash is full."""
    if name.startswith("/"):
        return "/" + "/".join(filter(None, name.split("/")))
    parts = [part for part in (*namespace.split("/"), *name.split("/")) if part]
    return "/" + "/".join(parts)


def renamed(name: str, namespace: str, node: str, rules: Sequence[Renaming]) -> str:
    """Return the full name of a topic after a node's remappings, of which the first fits."""
    full = absolute(name, namespace, node)
    for source, target in _of(rules, node):
        if absolute(source, namespace, node) == full:
            return absolute(target, namespace, node)
    return full


def _of(rules: Iterable[Renaming], node: str) -> Iterable[Renaming]:
    """Yield the rules that are for a node, without its name before them."""
    for source, target in rules:
        prefix, colon, rest = source.partition(":")
        if not colon or prefix in ("rostopic",):
            yield (rest if colon else source), target
        elif prefix == node:
            yield rest, target
