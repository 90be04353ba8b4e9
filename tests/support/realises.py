"""Whether a specification realises a configuration: clauses 0 to 5 of section 6, from the text.

Nothing here uses clingo or reads `rules/`. It is for small specifications: for transformers without
a comment it tries every conversion.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from mars_asp.model.declarations import (
    Configuration,
    Control,
    Conversion,
    Data,
    Hold,
    Module,
    Service,
    Transformation,
    node_kind,
)
from mars_asp.model.transformation import normalized
from tests.support.exhaustive import PERIODIC, Offer, inheritance, reach, serve

#: Relationships of a specification that follow each other, from a module to a module.
DataPath: TypeAlias = tuple[Data, ...]
#: From a module or an InheritanceNode to a module or an InheritanceNode.
ControlPath: TypeAlias = tuple[Control, ...]
DATA_NODES = ("data_splitter", "data_transformer")


class UnsaidError(Exception):
    """The text does not decide."""


class ViolationError(Exception):
    """A clause that fails, and how."""


def violation(specification: Configuration, configuration: Configuration) -> str | None:
    """Return why a specification does not realise a configuration, `None` where it does.

    Raises:
        UnsaidError: the text does not decide.
        UnclearError: floating point cannot decide which modules provide a function.
    """
    if len(set(specification.relationships)) < len(specification.relationships):
        raise UnsaidError("a line that stands twice")
    try:
        _Judge(specification, configuration).judge()
    except ViolationError as error:
        return str(error)
    return None


def refuse(clause: int, message: str) -> None:
    raise ViolationError(f"{clause}: {message}")


class _Judge:
    def __init__(self, specification: Configuration, configuration: Configuration) -> None:
        self.specification, self.configuration = specification, configuration
        self.known: dict[str, Module] = {m.name: m for m in configuration.declared}
        self.own: dict[str, Module] = {m.name: m for m in specification.declared}
        self.names = {name.text for name in configuration.modules}
        self.data = list(
            dict.fromkeys(line for line in specification.relationships if isinstance(line, Data))
        )
        self.control = list(
            dict.fromkeys(k for k in specification.relationships if isinstance(k, Control))
        )
        self.hierarchical = configuration.architecture == "hierarchical"

    def kind(self, name: str) -> str | None:
        return None if name in self.names else node_kind(name)

    def judge(self) -> None:
        self.clause_0()
        self.kinds()
        self.clause_1()
        used = _DataJudge(self).judge() | _ControlJudge(self).judge()
        ends = {end for line in self.data for end in (line.client, line.source)}
        ends |= {end for line in self.control for end in (line.controlled, line.controller)}
        named = {name.text for name in self.specification.modules}
        if idle := {end for end in ends | named if self.kind(end)} - used:
            raise UnsaidError(f"{sorted(idle)} on no way")

    def clause_0(self) -> None:
        """Compare the descriptions of each module that both describe, and stated instances."""
        for name in self.known.keys() & self.own.keys():
            here, there = description(self.own[name]), description(self.known[name])
            if here != there:
                refuse(0, f"{name} is {here}, not {there}")
        classes = {n.text: n.described for n in self.configuration.modules}
        for each in self.specification.modules:
            own = each.text if each.text in self.known else None
            declared = classes.get(each.text) or own
            if None not in (each.described, declared) and each.described != declared:
                refuse(0, f"{each.text} is an instance of {each.described}, not {declared}")

    def kinds(self) -> None:
        """Refuse data through nodes for control and the reverse."""
        for line in self.data:
            for name in (line.client, line.source):
                if self.kind(name) not in (None, *DATA_NODES):
                    refuse(2, f"data through {name}")
        for control in self.control:
            for name in (control.controlled, control.controller):
                if self.kind(name) in DATA_NODES:
                    refuse(2, f"control through {name}")

    def clause_1(self) -> None:
        fed = [line.source for line in self.data]
        for name in set(fed):
            if self.kind(name) != "data_splitter" and fed.count(name) > 1:
                refuse(1, f"{name} feeds several with data")
        led = [line.controller for line in self.control]
        for name in set(led):
            many = ("control_splitter", "inheritance_node")
            if self.kind(name) not in many and led.count(name) > 1:
                refuse(1, f"{name} feeds several with control")
        heard = [line.controlled for line in self.control]
        for name in set(heard):
            if self.kind(name) != "arbitration_node" and heard.count(name) > 1:
                refuse(1, f"{name} has several controllers")
        taken = [line.client for line in self.data]
        for name in set(taken):
            if self.kind(name) in DATA_NODES and taken.count(name) > 1:
                refuse(1, f"{name} has several inputs")


def description(module: Module) -> dict[str, object]:
    """Return the meaning of a module's block, whatever the order of its annotations is."""
    poses = {v.number: normalized(v.transformation) for v in module.vertices}
    identity = normalized(Transformation())
    return {
        "guard": module.guard is not None,
        "motions": {f.name: (f.min, f.max, f.rate) for f in module.functions},
        "vertices": {n: pose for n, pose in poses.items() if n or pose != identity},
        "services": sorted(map(repr, map(_meaning, module.services))),
    }


def _meaning(service: Service) -> tuple[object, ...]:
    modes = [(mode.name, mode.arguments, mode.of) for mode in service.modes]
    rate = None if service.hz is None else str(Fraction(service.hz))
    name = service.port or service.function or service.output
    # No line names an input of a converter.
    inputs = (service.inputs, () if service.kind == "Converts" else service.parameters)
    declared = (modes, rate, sorted(set(service.commands)), service.cost)
    return (service.kind, name, service.output, *inputs, *declared)


# ---- Data ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Applied:
    """The conversion of a transformer from `given` to `made`; `declared`: by a converter."""

    given: str
    made: str
    declared: bool


class _DataJudge:
    def __init__(self, whole: _Judge) -> None:
        self.whole, self.known = whole, whole.known
        self.wanted = list(
            dict.fromkeys(
                (line.client, line.source, line.mode, line.hz)
                for line in whole.configuration.relationships
                if isinstance(line, Data)
            )
        )
        self.converters = [
            (str(s.inputs[0]), str(s.output), s.cost, (module.name, index))
            for module in self.known.values()
            for index, s in enumerate(module.services)
            if s.kind == "Converts"
        ]
        self.conversions = {c.transformer: c for c in whole.specification.conversions}

    def judge(self) -> set[str]:
        """Judge clauses 2 and 3; return the nodes that something passes."""
        paths: dict[tuple[str, str], list[DataPath]] = {}
        for line in self.whole.data:
            if self.whole.kind(line.source) is None:
                for path in self.paths((line,)):
                    paths.setdefault((path[-1].client, line.source), []).append(path)
        pairs = {(client, source) for client, source, _, _ in self.wanted}
        for pair in pairs | paths.keys():
            needs = [each for each in self.wanted if each[:2] == pair]
            if len(paths.get(pair, [])) != len(needs):
                refuse(2, f"{len(paths.get(pair, []))} ways for {len(needs)} {pair}")
        for source in sorted({source for _, source in pairs}):
            mine = [path for (_, s), some in paths.items() if s == source for path in some]
            self.clause_3(source, mine)
        return {line.source for some in paths.values() for path in some for line in path}

    def paths(self, begun: DataPath) -> Iterator[DataPath]:
        """Yield the ways on to modules."""
        here = begun[-1].client
        if self.whole.kind(here) is None:
            yield begun
            return
        if any(here == line.source for line in begun):
            refuse(2, f"a circle through {here}")
        for line in self.whole.data:
            if line.source == here:
                yield from self.paths((*begun, line))

    def clause_3(self, source: str, paths: Sequence[DataPath]) -> None:
        """Try every mode of the source and every conversion that no comment states."""
        # The block of a source that only the specification describes counts.
        speaker = self.known.get(source) or self.whole.own.get(source)
        voices = [s for s in speaker.services if s.kind in ("Sense", "DataOut")] if speaker else []
        voice = voices[0] if len(voices) == 1 else None
        offers: list[Offer | None] = [None]
        if voice:
            offers = [(m, voice.hz if m.name == PERIODIC else None) for m in voice.modes]
        delivered = voice.output if voice else None
        first = offers[0] if source in self.known else None
        transformers = sorted(
            {
                line.client
                for path in paths
                for line in path
                if self.whole.kind(line.client) == "data_transformer"
            }
        )
        choices = [list(self.applied(name, delivered, paths)) for name in transformers]
        reasons: list[str] = []
        unsaid: list[str] = []
        for offer in offers:
            for some in itertools.product(*choices):
                does = dict(zip(transformers, some, strict=True))
                try:
                    self.serves(paths, source, offer, first, delivered, does)
                    return
                except ViolationError as error:
                    reasons.append(str(error))
                except UnsaidError as error:
                    unsaid.append(str(error))
        if unsaid:
            raise UnsaidError(unsaid[0])
        refuse(3, reasons[0] if reasons else f"nothing that {transformers} could do")

    def applied(
        self, name: str, delivered: str | None, paths: Sequence[DataPath]
    ) -> Iterator[Applied]:
        """Yield the possible conversions of a transformer."""
        result: Conversion | None = self.conversions.get(name)
        turns = {(given, made) for given, made, _, _ in self.converters}
        if result is not None and result.converter is not None:
            of = {(g, m) for g, m, _, (module, _) in self.converters if module == result.converter}
            if (result.source, result.target) in of:
                yield Applied(result.source, result.target, True)
            return
        if result is not None and (result.source, result.target) not in turns:
            yield Applied(result.source, result.target, False)
            return
        for given, made in sorted(turns):
            yield Applied(given, made, True)
        if delivered is None:
            yield Applied("", "", False)
        else:
            after = {p[-1].client for p in paths if any(line.client == name for line in p)}
            for made in sorted(set().union(*(self.accepts(client) or set() for client in after))):
                yield Applied(delivered, made, False)

    def accepts(self, client: str) -> frozenset[str] | None:
        taker = self.known.get(client)
        services = [s for s in taker.services if s.kind != "Converts"] if taker else []
        inputs = [i for s in services for i in s.inputs]
        return None if not inputs or None in inputs else frozenset(map(str, inputs))

    def serves(
        self,
        paths: Sequence[DataPath],
        source: str,
        offer: Offer | None,
        first: Offer | None,
        delivered: str | None,
        does: Mapping[str, Applied],
    ) -> None:
        """Refuse paths that do not deliver the data that their clients need."""
        by_client: dict[str, list[DataPath]] = {}
        for path in paths:
            by_client.setdefault(path[-1].client, []).append(path)
        for client, mine in by_client.items():
            needs = [each for each in self.wanted if each[:2] == (client, source)]
            faults: list[str] = []
            unsaid: list[str] = []
            for order in itertools.permutations(needs):
                try:
                    for path, need in zip(mine, order, strict=True):
                        declared = None if need[2] is None else (need[2], need[3])
                        self.brings(path, declared, offer, first)
                        self.carries(path, client, delivered, does)
                    break
                except ViolationError as error:
                    faults.append(str(error))
                except UnsaidError as error:
                    unsaid.append(str(error))
            else:
                if unsaid:
                    raise UnsaidError(unsaid[0])
                raise ViolationError(faults[0])

    def carries(
        self, path: DataPath, client: str, delivered: str | None, does: Mapping[str, Applied]
    ) -> None:
        """Follow the representation."""
        passed = [does[line.client] for line in path if line.client in does]
        accepts = self.accepts(client)
        if delivered is None or accepts is None:
            if passed:
                raise UnsaidError(f"a conversion between what is unknown, to {client}")
            return
        here = delivered
        for number, each in enumerate(passed):
            if each.given != here:
                refuse(3, f"{each} takes no {here}")
            if not each.declared:
                if number:
                    refuse(3, f"{each} is not of the source's own representation")
                if len(passed) > 1:
                    raise UnsaidError(f"a conversion behind {each}")
                if accepts & reach(delivered, self.converters):
                    refuse(3, f"{client} is reached without {each}")
            here = each.made
        if here not in accepts:
            refuse(3, f"{client} gets {here}")

    def brings(
        self, path: DataPath, declared: Offer | None, offer: Offer | None, first: Offer | None
    ) -> None:
        """Follow the service."""
        need = first if declared is None else declared
        if offer is None and need is not None and path[0].mode is not None:
            # The line of a source that nothing describes is taken at its word.
            offer = (path[0].mode, path[0].hz)
        carried = offer
        doubt = None
        filtered = False
        for number, line in enumerate(path):
            requested = None if line.mode is None else (line.mode, line.hz)
            if number and self.whole.kind(line.source) == "data_splitter":
                if requested is not None:
                    how = None if carried is None else table(requested, carried)
                    if carried is not None and how is None:
                        doubt = f"{requested} is not made of {carried}"
                    if how == "filter":
                        filtered = True
                    if how != "direct":
                        carried = requested
            elif requested is not None:
                if carried is None:
                    carried = requested
                elif not same(requested, carried):
                    refuse(3, f"{line.source} does not hand on {requested}")
            if self.whole.kind(line.client) == "data_transformer" and filtered:
                refuse(3, f"a condition before {line.client}")
            if offer is not None and need is not None and line is not path[-1] and carried:
                self.starves(need, carried, offer)
        self.arrives(path[-1].client, need, offer, carried)
        if doubt is not None and offer is not None:
            raise UnsaidError(doubt)

    def arrives(
        self, client: str, need: Offer | None, offer: Offer | None, carried: Offer | None
    ) -> None:
        """Judge the service that a client gets at the end of its path."""
        if offer is None:
            if need is None and carried is not None:
                raise UnsaidError(f"{carried} of an unknown source")
            if need is not None and carried is not None and not same(need, carried):
                refuse(3, f"{client} gets {carried}, not {need}")
            if need is not None and carried is None:
                raise UnsaidError(f"{client} needs {need} of an unknown source")
            return
        assert carried is not None
        if need is None:
            return
        if table(need, offer) is None:
            refuse(3, f"{need} is not made of {offer}")
        if not same(need, carried):
            refuse(3, f"{client} gets {carried}, not {need}")

    def starves(self, need: Offer, carried: Offer, offer: Offer) -> None:
        """Refuse a rate on a path that is lower than the rate needed downstream."""
        (mode, hz), (on, rate), (own, most) = need, carried, offer
        if on.name != PERIODIC or rate is None:
            return
        if mode.name == PERIODIC:
            if hz is not None and hz > rate:
                refuse(3, f"{need} behind {carried}")
        elif own.name != PERIODIC:
            raise UnsaidError(f"{need} behind {carried} of {offer}")
        elif most is not None and rate < most:
            refuse(3, f"{need} behind {carried}")


def table(need: Offer, carried: Offer) -> str | None:
    mode, hz = need
    line = Data("", "", None, mode, hz)  # type: ignore[arg-type]
    return serve(line, need, carried)


def same(need: Offer, carried: Offer) -> bool:
    (mode, hz), (on, rate) = need, carried
    return mode == on and (mode.name != PERIODIC or hz is None or hz == rate)


# ---- Control -------------------------------------------------------------------------------------


class _ControlJudge:
    def __init__(self, whole: _Judge) -> None:
        self.whole = whole
        control = [r for r in whole.configuration.relationships if isinstance(r, Control)]
        self.declared = {(line.controlled, line.controller): line for line in control}
        if len(self.declared) < len(control):
            raise UnsaidError("a pair is declared twice")
        self.standing = inheritance(whole.configuration, whole.known)
        self.segments: dict[tuple[str, str], list[ControlPath]] = {}
        for line in whole.control:
            if whole.kind(line.controller) in (None, "inheritance_node"):
                for path in self.paths((line,)):
                    ends = (line.controller, path[-1].controlled)
                    self.segments.setdefault(ends, []).append(path)

    def paths(self, begun: ControlPath) -> Iterator[ControlPath]:
        """Yield the ways on to modules and InheritanceNodes."""
        here = begun[-1].controlled
        if self.whole.kind(here) in (None, "inheritance_node"):
            yield begun
            return
        if any(here == line.controller for line in begun):
            refuse(2, f"a circle through {here}")
        for line in self.whole.control:
            if line.controller == here:
                yield from self.paths((*begun, line))

    def judge(self) -> set[str]:
        """Judge clauses 2, 4 and 5; return the nodes that something passes."""
        nodes = {n for ends in self.segments for n in ends if self.whole.kind(n) is not None}
        # A node without inputs or without outputs is on no path.
        while idle := {
            node
            for node in nodes
            if not any(b == node for _, b in self.segments)
            or not any(a == node for a, _ in self.segments)
        }:
            nodes -= idle
            kept = {e: p for e, p in self.segments.items() if not idle & set(e)}
            self.segments = kept
        if len(nodes) != len(self.standing):
            refuse(5, f"{sorted(nodes)} for {sorted(self.standing)}")
        reasons: list[str] = []
        unsaid: list[str] = []
        entries = {each.node: each.module for each in self.whole.specification.stand_ins}
        for order in itertools.permutations(sorted(nodes)):
            assigned = dict(zip(self.standing, order, strict=True))
            if any(entries.get(node, name) != name for name, node in assigned.items()):
                reasons.append(f"5: the comments of {entries}")
                continue
            try:
                self.assigned(assigned)
            except ViolationError as error:
                reasons.append(str(error))
            except UnsaidError as error:
                unsaid.append(str(error))
            else:
                ways = (way for ways in self.segments.values() for way in ways)
                return {line.controller for way in ways for line in way}
        if unsaid:
            raise UnsaidError(unsaid[0])
        raise ViolationError(reasons[0])

    def assigned(self, nodes: Mapping[str, str]) -> None:
        """Judge clauses 2, 4 and 5 for one assignment of nodes to modules."""
        wanted: dict[tuple[str, str], tuple[int, Hold | None]] = {}
        for (controlled, controller), line in self.declared.items():
            standing = self.standing.get(controlled)
            heard = (line.priority or 0, line.hold_ms)
            if standing is None or line not in standing.lines or line in standing.direct:
                wanted[controller, controlled] = heard
            if standing is not None and line in standing.lines:
                wanted[controller, nodes[controlled]] = heard
        for name, standing in self.standing.items():
            hold = standing.lines[0].hold_ms if len(standing.lines) == 1 else None
            for provider in standing.providers:
                wanted[nodes[name], provider] = (standing.rank, hold)
        for ends in wanted.keys() | self.segments.keys():
            count = len(self.segments.get(ends, []))
            if count != (ends in wanted):
                clause = 5 if any(self.whole.kind(end) for end in ends) else 2
                refuse(clause, f"{count} ways from {ends[0]} to {ends[1]}")
        for receiver in {controlled for _, controlled in wanted}:
            heard_here = {
                self.segments[ends][0]: rank for ends, rank in wanted.items() if ends[1] == receiver
            }
            if self.whole.hierarchical:
                self.in_order(receiver, heard_here)
            else:
                self.in_one(receiver, heard_here)

    def in_order(self, receiver: str, heard: Mapping[ControlPath, tuple[int, Hold | None]]) -> None:
        for one, other in itertools.combinations(heard, 2):
            entered = meeting(one, other)
            (a, _), (b, _) = heard[one], heard[other]
            declared, after = (line.priority or 0 for line in entered)
            if (a > b) - (a < b) != (declared > after) - (declared < after):
                refuse(4, f"{one[0].controller} and {other[0].controller} at {receiver}")
        for path, (_, hold) in heard.items():
            into = next((k for k in path if self.arbiter(k.controlled)), None)
            if any(self.arbiter(k.controller) and k.hold_ms is not None for k in path):
                raise UnsaidError(f"a hold behind an arbiter before {receiver}")
            moved = self.whole.kind(receiver) == "inheritance_node" and len(heard) == 1
            if into is None and {k.hold_ms for k in path} - {None} != {hold} - {None}:
                raise UnsaidError(f"a hold where nothing arbitrates for {receiver}")
            before = [k.hold_ms for k in self.whole.control if k.controlled == path[0].controller]
            if into is not None and into.hold_ms is None and before == [hold] != [None]:
                raise UnsaidError(f"a hold that {path[0].controller} hears, arbitrated behind it")
            if into is not None and into.hold_ms != hold and not moved:
                refuse(2, f"the hold of {path[0].controller} at {receiver}")

    def in_one(self, receiver: str, heard: Mapping[ControlPath, tuple[int, Hold | None]]) -> None:
        met = [tuple(k.controlled for k in path if self.arbiter(k.controlled)) for path in heard]
        if len(heard) > 1 and (len(set(met)) > 1 or len(met[0]) != 1):
            refuse(4, f"{met} at {receiver}")
        if len(heard) == 1 and len(met[0]) > 1:
            raise UnsaidError(f"{met} at {receiver}, which has one controller")
        for path, (_, hold) in heard.items():
            inside = [k for k in path if self.arbiter(k.controller) or self.arbiter(k.controlled)]
            if any(k.hold_ms != hold for k in inside if self.arbiter(k.controlled)) or any(
                k.hold_ms is not None for k in inside if self.arbiter(k.controller)
            ):
                raise UnsaidError(f"another hold under flat control at {receiver}")

    def arbiter(self, name: str) -> bool:
        return self.whole.kind(name) == "arbitration_node"


def meeting(one: ControlPath, other: ControlPath) -> tuple[Control, Control]:
    """Return the lines by which two ways to one end come to the node where they meet."""
    for line in one:
        for beside in other:
            if line.controlled == beside.controlled:
                return line, beside
    raise AssertionError("they have one end")
