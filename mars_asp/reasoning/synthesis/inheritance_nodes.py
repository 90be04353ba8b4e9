"""The module that an InheritanceNode of a specification represents.

A comment states it: `// InheritanceNode1: Camera`. Without one it is inferred from mounts and
control; it stays open if several modules fit that would be moved differently.
"""

import random
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

from mars_asp.model.declarations import (
    MOTION_FUNCTIONS,
    Allocation,
    Configuration,
    Control,
    Function,
    Module,
    Mount,
    Service,
)

if TYPE_CHECKING:
    from mars_asp.kinematics.sharing import Carrying

#: The share of each function that a provider has: provider, native function, share.
_Effect: TypeAlias = Mapping[str, frozenset[tuple[str, str, float]]]
_COPYING = ("arbitration_node", "control_splitter", "gate_node")


class InheritanceNodes:
    """The modules that the InheritanceNodes of a specification represent, and their providers."""

    def __init__(self, configuration: Configuration, modules: Mapping[str, Module]) -> None:
        """Index the control lines by their ends, and the mounts by the mounted module."""
        self.configuration, self.modules = configuration, modules
        self.mounts: dict[str, Mount] = {}
        self._into: defaultdict[str, list[Control]] = defaultdict(list)
        self._out_of: defaultdict[str, list[Control]] = defaultdict(list)
        for relationship in configuration.relationships:
            if isinstance(relationship, Mount):
                self.mounts.setdefault(relationship.mounting, relationship)
            elif isinstance(relationship, Control):
                self._into[relationship.controlled].append(relationship)
                self._out_of[relationship.controller].append(relationship)
        self.named = {each.node: each.module for each in configuration.stand_ins}
        self._given: dict[tuple[str, str, Allocation | None], frozenset[str]] = {}
        self._effects: dict[tuple[str, tuple[str, ...], Allocation | None], _Effect] = {}

    def hands_on(self, name: str) -> bool:
        """Whether a name is that of an arbiter, splitter or Gate, which forward commands."""
        if name in self.modules:
            return False
        brought = self.configuration.pack_kind(name)
        if brought is not None:
            return brought.carries == "control"
        return self.configuration.node_kind(name) in _COPYING

    def chain(self, name: str) -> list[str]:
        """Return a module followed by its carriers."""
        chain = [name]
        while chain[-1] in self.mounts and self.mounts[chain[-1]].mounted not in chain:
            chain.append(self.mounts[chain[-1]].mounted)
        return chain

    def reached(self, name: str) -> list[str]:
        """Return the modules that commands to a name reach through forwarding nodes."""
        return self._past_copies(name, lambda n: [line.controlled for line in self._out_of[n]])

    def commanders(self, node: str) -> list[str]:
        """Return the controllers of a module or node, upstream of forwarding nodes."""

        def heard(name: str) -> list[str]:
            return [line.controller for line in self._into[name]]

        return [speaker for each in heard(node) for speaker in self._past_copies(each, heard)]

    def _past_copies(
        self, name: str, onward: Callable[[str], list[str]], seen: frozenset[str] = frozenset()
    ) -> list[str]:
        """Return the nearest names on paths from a name that are not forwarding nodes.

        `onward` returns the next names; those in `seen` are skipped.
        """
        if name in seen:
            return []
        if not self.hands_on(name):
            return [name]
        seen |= {name}
        return [end for each in onward(name) for end in self._past_copies(each, onward, seen)]

    def allocation(self, node: str) -> Allocation | None:
        """Return the rule by which a node chooses between similar providers; None: the nearest."""
        declared = (line.allocation for line in self._into[node])
        return next((allocation for allocation in declared if allocation is not None), None)

    def fed(self, node: str) -> list[str]:
        """Return the modules that a node feeds, in the order of the specification."""
        ends = [end for line in self._out_of[node] for end in self.reached(line.controlled)]
        return list(dict.fromkeys(ends))

    def stands_for(self, node: str) -> tuple[str, ...]:
        """Return the module that a node represents; several if it cannot be inferred.

        Of modules that are moved in the same way, one is returned.
        """
        if node in self.named:
            return (self.named[node],)
        elsewhere = set(self.named.values())
        riders = [name for name in self.riders(node) if name not in elsewhere]
        fitting = self._fitting(node, riders)
        return self._different(node, fitting)

    def stands_alike(self, node: str, name: str) -> bool:
        """Whether `name`, represented by a node, could be inferred without a comment."""
        fitting = self._fitting(node, self.riders(node))
        if name not in fitting:
            return False
        # `all` ends at the first difference: many modules may be on one carrier.
        others = (other for other in fitting if other != name)
        return all(self._effect(node, other) == self._effect(node, name) for other in others)

    def _different(self, node: str, fitting: Sequence[str]) -> tuple[str, ...]:
        """Return one of `fitting` for each distinct effect, the one with the fewest mounts."""
        if len(fitting) < 2:
            return tuple(fitting)
        ways: list[tuple[str, _Effect]] = []
        for name in sorted(fitting, key=lambda name: len(self.chain(name))):
            effect = self._effect(node, name)
            if all(effect != other for _, other in ways):
                ways.append((name, effect))
        return tuple(name for name, _ in ways)

    def way_down(self, node: str) -> list[str]:
        """Return the module that a node represents, followed by its carriers."""
        for name in self.stands_for(node):
            return self.chain(name)
        # If no module on all controlled modules fits, these are moved directly.
        fed = self.fed(node)
        through = [chain for name in fed if set(fed) <= set(chain := self.chain(name))]
        return max(through, key=len, default=fed)

    def riders(self, node: str) -> list[str]:
        """Return the modules that are carried by all modules that a node controls."""
        fed = self.fed(node)
        if not fed:
            return []
        others = [self._carried.get(name, {}) for name in fed[1:]]
        return [n for n in self._carried.get(fed[0], {}) if all(n in other for other in others)]

    @cached_property
    def _carried(self) -> Mapping[str, Mapping[str, None]]:
        found: defaultdict[str, dict[str, None]] = defaultdict(dict)
        for name in self.mounts:
            for carrier in self.chain(name)[1:]:
                found[carrier][name] = None
        return found

    # ---- candidates ----

    def _fitting(self, node: str, riders: Sequence[str]) -> list[str]:
        """Return the riders whose ends fit the node's; else by controllers only; else all."""
        led = [name for name in riders if self._is_led_so(node, name)]
        fed = set(self.fed(node))
        exact = [name for name in led if self._providers(node, name) == fed]
        return exact or led or list(riders)

    def _is_led_so(self, node: str, name: str) -> bool:
        """Whether the node's and the module's own controllers use what each of them gives."""
        if any(service.kind == "ControlOut" for service in self._services(name)):
            return False
        native = self.functions(name)
        commanders, direct = set(self.commanders(node)), set(self.commanders(name))
        entries = {each: self._commanded_functions(each) for each in commanders | direct}
        own = {c for c in commanders | direct if (entries[c] & native if entries[c] else native)}
        borrows = all(entries[c] - native if entries[c] else not native for c in commanders)
        return borrows and direct & commanders == own & commanders and direct <= own

    def _providers(self, node: str, name: str) -> set[str]:
        """Return the carriers that provide a node's commanded functions to a module."""
        if name not in self.modules:
            return set()
        allocation = self.allocation(node)
        wanted = self._wanted(node) - self.functions(name)
        return {by for function in wanted for by in self._give(name, function, allocation)}

    def _give(self, name: str, function: str, allocation: Allocation | None) -> frozenset[str]:
        key = name, function, allocation
        if key not in self._given:
            carrying = self.carrying(name, self.chain(name)[1:], lambda _: {})
            shares = [] if carrying is None else carrying.shares(function, allocation)
            support = () if shares or carrying is None else carrying.support(function)
            together = {joint.module for joint in support}
            self._given[key] = frozenset(together or {by for by, _, _ in shares})
        return self._given[key]

    def _wanted(self, node: str) -> frozenset[str]:
        """Return the motions that a node's commanders command, all if one of them names none."""
        entries = [self._commanded_functions(name) for name in self.commanders(node)]
        return frozenset(MOTION_FUNCTIONS if not all(entries) else set().union(*entries))

    def _effect(self, node: str, name: str) -> _Effect:
        """Return the providers and their shares for each function that a module gets by a node."""
        fed = [carrier for carrier in self.chain(name) if carrier in set(self.fed(node))]
        key = name, tuple(fed), self.allocation(node)
        if key not in self._effects:
            carrying = self.carrying(name, fed, _somewhere)
            self._effects[key] = {
                function: frozenset(
                    (by, native, round(share, 6))
                    for by, native, share in carrying.shares(function, key[2])
                )
                for function in MOTION_FUNCTIONS
                if carrying is not None
            }
        wanted = self._wanted(node) - self.functions(name)
        return {function: self._effects[key].get(function, frozenset()) for function in wanted}

    def carrying(
        self,
        name: str,
        providers: Sequence[str],
        position: Callable[[str], Mapping[str, float]],
    ) -> "Carrying | None":
        """Return how the modules `providers` move the module `name`; None without mounts.

        `position` returns the present values of a module's motions in degrees and mm.
        """
        mounts = [self.mounts[each] for each in self.chain(name)[:-1]]
        if not mounts:
            return None
        from mars_asp.kinematics.frames import build_robot  # noqa: PLC0415 -- numpy
        from mars_asp.kinematics.sharing import Carrying  # noqa: PLC0415 -- numpy

        modules = dict(self.modules)
        for each in providers:
            if each not in modules and len(providers) == 1:
                # The only provider of an inherited motion has it, even if undescribed.
                span = self.configuration.span
                every = tuple(Function(function, span) for function in MOTION_FUNCTIONS)
                modules[each] = Module(each, span, functions=every)
        return Carrying(build_robot(mounts, modules), name, providers, position)

    def functions(self, name: str) -> frozenset[str]:
        """Return the native functions that a module states."""
        functions = self.modules[name].functions if name in self.modules else ()
        return frozenset(function.name for function in functions)

    def _commanded_functions(self, name: str) -> frozenset[str]:
        return frozenset(function for s in self._services(name) for function in s.commands)

    def _services(self, name: str) -> tuple[Service, ...]:
        return self.modules[name].services if name in self.modules else ()


def _somewhere(name: str) -> Mapping[str, float]:
    """Return random values of a module's motions, at which no axes align by chance."""
    rng = random.Random(name)
    return {function: rng.uniform(10, 80) for function in MOTION_FUNCTIONS}
