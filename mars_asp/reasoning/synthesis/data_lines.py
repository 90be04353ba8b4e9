"""The data lines of a specification: each source's tree, at its first relationship's place."""

from decimal import Decimal
from typing import NamedTuple

from clingo import String, Symbol, SymbolType

from mars_asp.model.declarations import Conversion, Data, Mode
from mars_asp.reasoning.facts.identifiers import PERIODIC, mode_of
from mars_asp.reasoning.synthesis.draft import Draft


class _Client(NamedTuple):
    """What a point feeds: the client of a relationship."""

    feeder: str
    number: int


class _Transformer(NamedTuple):
    """What a point feeds: the transformer to another point, by an annotation or by none."""

    feeder: str
    point: Symbol
    annotation: Symbol


class DataLines:
    """Writes the lines of each source once."""

    def __init__(self, draft: Draft) -> None:
        """Index the tree of each source by its points."""
        self._draft = draft
        self._splitters = {(s.string, t) for s, t in draft.rows("splitter", 2)}
        self._clients: dict[tuple[str, Symbol], list[int]] = {}
        for number, source, point in draft.rows("at", 3):
            self._clients.setdefault((source.string, point), []).append(number.number)
        self._edges: dict[tuple[str, Symbol], list[tuple[Symbol, Symbol]]] = {}
        for source, start, end, annotation in draft.rows("edge", 4):
            self._edges.setdefault((source.string, start), []).append((end, annotation))
        self._lowered = {(s.string, t): f.number for s, t, f in draft.rows("lowers", 3)}
        self._made = {(s.string, t): (d, f) for s, t, d, f in draft.rows("makes_for", 4)}
        self._needs = {n.number: (d, f) for n, d, f in draft.rows("states_need", 3)}
        self._own = {s.string: p.string for s, p in draft.rows("own", 2)}
        self._done: set[str] = set()

    def write(self, relationship: Data) -> None:
        """Write all lines of a relationship's source, unless they are written already."""
        source = relationship.source
        if source in self._done:
            return
        self._done.add(source)
        origin = _function("origin")
        first = self._first_places(source, origin)
        # A stack instead of recursion: chains of converters may be long.
        stack = self._outputs(source, origin, source, first)
        while stack:
            output = stack.pop()
            if isinstance(output, _Client):
                self._write_client(output)
            else:
                name = self._write_transformer(source, output)
                stack += self._outputs(source, output.point, name, first)

    def _outputs(
        self, source: str, point: Symbol, feeder: str, first: dict[Symbol, int]
    ) -> list[_Client | _Transformer]:
        """Return what a point feeds, last first, behind its splitter where it has one."""
        draft = self._draft
        if (source, point) in self._splitters:
            name = draft.node("data_splitter", f"splitter({String(source)},{point})")
            draft.lines.append(Data(name, feeder, draft.span))
            feeder = name
        placed: list[tuple[int, _Client | _Transformer]] = [
            (draft.place[number], _Client(feeder, number))
            for number in self._clients.get((source, point), ())
        ]
        placed += [
            (first[end], _Transformer(feeder, end, annotation))
            for end, annotation in self._edges.get((source, point), ())
        ]
        placed.sort(key=lambda item: item[0], reverse=True)
        return [output for _, output in placed]

    def _first_places(self, source: str, origin: Symbol) -> dict[Symbol, int]:
        """Return for each point the place in the file of the first client behind it."""
        order = [origin]
        for point in order:
            order += [end for end, _ in self._edges.get((source, point), ())]
        first: dict[Symbol, int] = {}
        for point in reversed(order):
            places = [self._draft.place[n] for n in self._clients.get((source, point), ())]
            places += [first[end] for end, _ in self._edges.get((source, point), ())]
            first[point] = min(places, default=0)
        return first

    def _write_client(self, client: _Client) -> None:
        stated = self._draft.relationships[client.number]
        assert isinstance(stated, Data)
        mode, hz = stated.mode, stated.hz
        if client.number in self._needs:
            term, rate = self._needs[client.number]
            mode, hz = mode_of(term), _hertz(rate)
        span = self._draft.span
        self._draft.lines.append(Data(stated.client, client.feeder, span, mode, hz))

    def _write_transformer(self, source: str, output: _Transformer) -> str:
        draft = self._draft
        term = f"transformer({String(source)},{output.point})"
        name = draft.node("data_transformer", term, self._conversion(source, output))
        rate = self._lowered.get((source, output.point))
        mode = None if rate is None else Mode(PERIODIC, text=PERIODIC)
        hz = None if rate is None else Decimal(rate) / 1000
        if (source, output.point) in self._made:
            made, made_rate = self._made[source, output.point]
            mode, hz = mode_of(made), _hertz(made_rate)
        draft.lines.append(Data(name, output.feeder, draft.span, mode, hz))
        return name

    def _conversion(self, source: str, output: _Transformer) -> Conversion:
        target = output.point.arguments[0].string
        if output.annotation.type != SymbolType.Number:
            return Conversion("", None, self._own.get(source, ""), target, self._draft.span)
        name, service = self._draft.services[output.annotation.number]
        given = next((i for i in service.inputs if i is not None), "")
        return Conversion("", name, given, service.output or target, self._draft.span)


def _function(name: str) -> Symbol:
    from clingo import Function  # noqa: PLC0415 -- the name is this project's own word elsewhere

    return Function(name, [])


def _hertz(rate: Symbol) -> Decimal | None:
    return Decimal(rate.number) / 1000 if rate.type == SymbolType.Number else None
