"""Names of ROS: relative, private and absolute ones, and renamings."""

from collections.abc import Iterable, Sequence

#: An old and a new name, both as they are written.
Renaming = tuple[str, str]


def absolute(name: str, namespace: str, node: str) -> str:
    """Return the full name of a topic; `name` is relative, private (`~`) or full already."""
    if name.startswith("~"):
        return joined(joined(namespace, node), name[1:].lstrip("/"))
    return joined(namespace, name)


def joined(namespace: str, name: str) -> str:
    """Return `name` in a namespace; a name that begins with a slash is unchanged."""
    if name.startswith("/"):
        return "/" + "/".join(filter(None, name.split("/")))
    parts = [part for part in (*namespace.split("/"), *name.split("/")) if part]
    return "/" + "/".join(parts)


def renamed(name: str, namespace: str, node: str, rules: Sequence[Renaming]) -> str:
    """Return the full name of a topic after the first remapping of `rules` that matches."""
    full = absolute(name, namespace, node)
    for source, target in _of(rules, node):
        if absolute(source, namespace, node) == full:
            return absolute(target, namespace, node)
    return full


def _of(rules: Iterable[Renaming], node: str) -> Iterable[Renaming]:
    """Yield the remappings that apply to a node, without a leading `node:`."""
    for source, target in rules:
        prefix, colon, rest = source.partition(":")
        if not colon or prefix in ("rostopic",):
            yield (rest if colon else source), target
        elif prefix == node:
            yield rest, target
