"""Values of parameters in YAML files, for one node."""

from collections.abc import Iterator

from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar

_PARAMETERS = "ros__parameters"


def values_for(document: Node, name: str) -> dict[str, str]:
    """Return the parameters that a document gives the node of a full name, dotted where nested.

    A later part of the document wins. A file without `ros__parameters` is one of ROS 1, which is
    loaded for the node as a whole.
    """
    found: dict[str, str] = {}
    parts = [part for part in name.split("/") if part]
    if not any(_sections(document, ())):
        return dict(_flat(document, ""))
    for keys, section in _sections(document, ()):
        if _fits(keys, parts):
            found |= _flat(section, "")
    return found


def _sections(node: Node, keys: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Node]]:
    """Yield what stands under each `ros__parameters`, with the parts of the names above it."""
    if not isinstance(node, Pairs):
        return
    for key, value in node.pairs:
        if key.text == _PARAMETERS:
            yield keys, value
        else:
            inner = tuple(part for part in key.text.split("/") if part)
            yield from _sections(value, (*keys, *inner))


def _fits(keys: tuple[str, ...], parts: list[str]) -> bool:
    """Whether names with wildcards mean a node; a file may leave out the namespaces before."""
    if not keys:
        return True
    if keys[0] == "**":
        return any(_fits(keys[1:], parts[at:]) for at in range(len(parts) + 1))
    same = len(keys) <= len(parts) and all(
        key in ("*", part) for key, part in zip(keys, parts[-len(keys) :], strict=True)
    )
    return same and "**" not in keys


def _flat(node: Node, before: str) -> Iterator[tuple[str, str]]:
    """Yield the values of a map, the names of nested ones dotted; lists are left out."""
    match node:
        case Pairs(pairs):
            for key, value in pairs:
                yield from _flat(value, f"{before}.{key.text}" if before else key.text)
        case Scalar(text) if before:
            yield before, text
        case Items():
            return
