"""Disjoint sets, joined one by one."""

from collections import defaultdict
from collections.abc import Hashable, Iterable, Sequence
from typing import Generic, TypeVar

_Member = TypeVar("_Member", bound=Hashable)


class DisjointSets(Generic[_Member]):
    """Disjoint sets with path halving (Tarjan and van Leeuwen 1984)."""

    def __init__(self) -> None:
        """Begin without any member."""
        self.parent: dict[_Member, _Member] = {}

    def find(self, member: _Member) -> _Member:
        """Return the root of a member's set; a new member is a set of its own."""
        parent = self.parent
        while parent.setdefault(member, member) != member:
            parent[member] = parent[parent[member]]
            member = parent[member]
        return member

    def join(self, members: Sequence[_Member]) -> None:
        """Merge the sets that contain the members."""
        if not members:
            return
        root, parent = self.find(members[0]), self.parent
        for member in members[1:]:
            # Most are new or joined already.
            if parent.setdefault(member, root) != root:
                parent[self.find(member)] = root

    def members(self, each: Iterable[_Member]) -> dict[_Member, list[_Member]]:
        """Return the members of `each`, in order, by the root of their set."""
        found: defaultdict[_Member, list[_Member]] = defaultdict(list)
        for member in each:
            found[self.find(member)].append(member)
        return found
