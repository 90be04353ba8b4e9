"""Values of parameters for one node, in YAML files and in launch files themselves."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar

#: The key of parameters in files of ROS 2.
PARAMETERS = "ros__parameters"


class GivenParameter(NamedTuple):
    """The value of a parameter, its path of keys, and whether it is known before a run.

    `is_for_all` is whether it is set for all nodes.
    """

    keys: tuple[Scalar, ...]
    value: Scalar | Items
    is_known: bool = True
    is_for_all: bool = False

    @property
    def text(self) -> str:
        """The value, or an empty text if it is not a scalar."""
        return self.value.text if isinstance(self.value, Scalar) else ""

    @property
    def texts(self) -> tuple[str, ...]:
        """The text of a scalar, or the texts of the scalars in a list."""
        nodes = self.value.nodes if isinstance(self.value, Items) else (self.value,)
        return tuple(node.text for node in nodes if isinstance(node, Scalar))


def document_of(given: Iterable[GivenParameter], span: Span) -> Pairs:
    """Return parameters as nested maps, as a file would write them."""
    found: dict[str, tuple[Scalar, list[GivenParameter]]] = {}
    leaves: dict[str, tuple[Scalar, Node]] = {}
    for each in given:
        first, *others = each.keys
        if others:
            inner = GivenParameter(tuple(others), each.value)
            found.setdefault(first.text, (first, []))[1].append(inner)
        else:
            leaves[first.text] = first, each.value
    maps = {text: (key, document_of(inner, key.span)) for text, (key, inner) in found.items()}
    return Pairs(tuple({**leaves, **maps}.values()), span)


def values_for(document: Node, name: str) -> dict[str, GivenParameter]:
    """Return the parameters that a YAML document sets for a node, by their dotted names.

    `name` is the node's full name. A later part of the document wins. A file without
    `ros__parameters` is one of ROS 1, which is loaded for the whole node.
    """
    found: dict[str, GivenParameter] = {}
    parts = list(_steps_in(name))
    if not any(_sections(document, ())):
        return dict(_dotted_values(document, ()))
    for keys, section in _sections(document, ()):
        if _fits(keys, parts):
            found |= _dotted_values(section, ())
    return found


def section_for(document: Node, name: str, is_component: bool) -> tuple[Scalar | None, bool | None]:
    """Return the first key of a parameter file, and whether a section of it is for the node `name`.

    A component's section need not state the namespaces, as the launch file selects it; other nodes
    search their full names (rcl_yaml_param_parser). The second result is None in a file without
    sections, the first None in an empty one.
    """
    parts = list(_steps_in(name))
    sections = [keys for keys, _ in _sections(document, ())]
    if not isinstance(document, Pairs) or not document.pairs:
        return None, None
    if not sections:
        return document.pairs[0][0], None
    depth = 1 if is_component else len(parts)
    is_for_it = any(
        _fits(keys, parts) and ("**" in keys or len(keys) >= depth) for keys in sections
    )
    return document.pairs[0][0], is_for_it


def is_for(written: str, name: str) -> bool:
    """Whether a key of a parameter file, which may have wildcards, matches a node's full name."""
    return _fits(_steps_in(written), list(_steps_in(name)))


def _steps_in(name: str) -> tuple[str, ...]:
    return tuple(part for part in name.split("/") if part)


def _sections(node: Node, keys: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Node]]:
    """Yield each map under `ros__parameters`, with the steps of the node name above it."""
    if not isinstance(node, Pairs):
        return
    for key, value in node.pairs:
        if key.text == PARAMETERS:
            yield keys, value
        else:
            yield from _sections(value, (*keys, *_steps_in(key.text)))


def _fits(keys: tuple[str, ...], parts: list[str]) -> bool:
    """Whether the steps of a name with wildcards match a node's name; namespaces are optional."""
    if not keys:
        return True
    if keys[0] == "**":
        return any(_fits(keys[1:], parts[at:]) for at in range(len(parts) + 1))
    same = len(keys) <= len(parts) and all(
        key in ("*", part) for key, part in zip(keys, parts[-len(keys) :], strict=True)
    )
    return same and "**" not in keys


def _dotted_values(node: Node, keys: tuple[Scalar, ...]) -> Iterator[tuple[str, GivenParameter]]:
    """Yield the values in a map with dotted names; `keys` are the steps of the outer ones."""
    if isinstance(node, Pairs):
        for key, value in node.pairs:
            yield from _dotted_values(value, (*keys, key))
    elif keys:
        yield ".".join(key.text for key in keys), GivenParameter(keys, node)
