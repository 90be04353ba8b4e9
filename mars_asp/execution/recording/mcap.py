"""A run as an MCAP file that Foxglove shows: lengths in metres, z up, x forward, y to the left.

Messages are JSON in the well-known schemas FrameTransform, SceneUpdate and Log of Foxglove
(github.com/foxglove/foxglove-sdk, schemas). The messages of a link are a topic of its own.
"""

from collections.abc import Iterator, Mapping
from json import JSONEncoder
from math import cos, radians, sin
from typing import IO, Any, NamedTuple

from mcap.writer import Writer

from mars_asp import __version__
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import SECOND
from mars_asp.execution.recording.record import Event, plain
from mars_asp.execution.simulator import Pose
from mars_asp.execution.trial import Trial

_json = JSONEncoder(allow_nan=False).encode
_HEIGHT = 0.3  # of drawn obstacles, in metres; the plane has no heights
_NUMBER, _TEXT, _WHOLE = {"type": "number"}, {"type": "string"}, {"type": "integer"}


def _object(title: str, **properties: Any) -> dict[str, Any]:
    return {"type": "object", "title": title, "properties": properties}


def _list(items: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items}


_TIME = _object("time", sec=_WHOLE, nsec=_WHOLE)
_DURATION = _object("duration", sec=_WHOLE, nsec=_WHOLE)
_VECTOR = _object("foxglove.Vector3", x=_NUMBER, y=_NUMBER, z=_NUMBER)
_POINT = _object("foxglove.Point3", x=_NUMBER, y=_NUMBER, z=_NUMBER)
_TURN = _object("foxglove.Quaternion", x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_POSE = _object("foxglove.Pose", position=_VECTOR, orientation=_TURN)
_COLOUR = _object("foxglove.Color", r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_LINE = _object(
    "foxglove.LinePrimitive",
    type=_WHOLE,
    pose=_POSE,
    thickness=_NUMBER,
    scale_invariant={"type": "boolean"},
    points=_list(_POINT),
    color=_COLOUR,
    colors=_list(_COLOUR),
    indices=_list(_WHOLE),
)
_CYLINDER = _object(
    "foxglove.CylinderPrimitive",
    pose=_POSE,
    size=_VECTOR,
    bottom_scale=_NUMBER,
    top_scale=_NUMBER,
    color=_COLOUR,
)
_UNUSED = ("arrows", "cubes", "spheres", "triangles", "texts", "models")
_ENTITY = _object(
    "foxglove.SceneEntity",
    timestamp=_TIME,
    frame_id=_TEXT,
    id=_TEXT,
    lifetime=_DURATION,
    frame_locked={"type": "boolean"},
    metadata=_list(_object("foxglove.KeyValuePair", key=_TEXT, value=_TEXT)),
    **dict.fromkeys(_UNUSED, _list({"type": "object"})),
    cylinders=_list(_CYLINDER),
    lines=_list(_LINE),
)
SCHEMAS = {
    "foxglove.FrameTransform": _object(
        "foxglove.FrameTransform",
        timestamp=_TIME,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=_VECTOR,
        rotation=_TURN,
    ),
    "foxglove.SceneUpdate": _object(
        "foxglove.SceneUpdate", deletions=_list({"type": "object"}), entities=_list(_ENTITY)
    ),
    "foxglove.Log": _object(
        "foxglove.Log",
        timestamp=_TIME,
        level=_WHOLE,
        message=_TEXT,
        name=_TEXT,
        file=_TEXT,
        line=_WHOLE,
    ),
    "mars_asp.Message": _object("mars_asp.Message", value={}),
}
_WARNING, _INFO = 3, 2


class Entry(NamedTuple):
    """A message (JSON) for a topic at a time (ns)."""

    at: int
    topic: str
    schema: str
    message: dict[str, Any]


class Foxglove:
    """Writes each event as a message of an MCAP file, and at the end the motion of robot and world.

    The same run gives the same bytes. Readers put messages in order by an index. Topics and logs
    have the names of `plan`'s modules; messages between two of its nodes are left out.
    """

    def __init__(self, file: IO[bytes], plan: Plan) -> None:
        self._topics = {
            f"{each.source} -> {each.client}": plan.topic_of(each) for each in plan.links
        }
        self._names = {
            f"{each.source} -> {each.client}": plan.link_title(each) for each in plan.links
        }
        for each in plan.links:
            if plan.kind(each.source) == "arbitration_node":
                self._names[each.source] = " and ".join(plan.targets_of(each))
        self._writer = Writer(file)
        self._writer.start(library=f"mars-asp {__version__}")
        self._schemas = {
            name: self._writer.register_schema(name, "jsonschema", _json(schema).encode())
            for name, schema in SCHEMAS.items()
        }
        self._channels: dict[str, int] = {}

    def observe(self, at: int, what: str, where: str, value: object) -> None:
        """Write an event `what` (see `Event`) of the link or node `where` at a time in ns."""
        if where in self._topics and what != "failed":
            topic = self._topics[where]
            if topic is not None:
                self._add(Entry(at, topic, "mars_asp.Message", {"value": plain(value)}))
        else:
            self._add(_log_entry(Event(at, what, self._names.get(where, where), plain(value))))

    def end(self, trial: Trial) -> None:
        """Write the motion and the end of the file."""
        for entry in _motion(trial):
            self._add(entry)
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _add(self, entry: Entry) -> None:
        at, topic, schema, message = entry
        if topic not in self._channels:
            self._channels[topic] = self._writer.register_channel(
                topic, "json", self._schemas[schema]
            )
        self._writer.add_message(self._channels[topic], at, _json(message).encode(), at)


def _log_entry(event: Event) -> Entry:
    """Return a change of control or a dropped message as a log."""
    at, what, where, value = event
    if what == "holds":
        holder, why = value
        level, message = _INFO, f"{holder or 'no controller'} holds control: {why}"
    elif what == "gate":
        change, trigger, until = value
        does = "closes it until" if change == "closed" else "opens it at"
        level, message = _INFO, f"{trigger} {does} {until / SECOND:g} s"
    else:
        level, message = _WARNING, f"a message was dropped: {value}"
    log = {
        "timestamp": _time(at),
        "level": level,
        "message": message,
        "name": where,
        "file": "",
        "line": 0,
    }
    return Entry(at, "/log", "foxglove.Log", log)


def _motion(trial: Trial) -> Iterator[Entry]:
    world = trial.bodies[0].world
    fixed = [_cylinder(x, y, radius, _GREY) for x, y, radius in world.circles.tolist()]
    ends = [end for a, b, c, d in world.segments.tolist() for end in ((a, b), (c, d))]
    yield _scene(0, "/world", "world", cylinders=fixed, lines=[_line_entity(ends, 0.0)])
    for body in trial.bodies:
        rim = _cylinder(0.0, 0.0, body.radius, _BLUE)
        nose = _line_entity([(0.0, 0.0), (body.radius, 0.0)], _HEIGHT + 0.01)
        yield _scene(0, f"/{body.name}", body.name, cylinders=[rim], lines=[nose])
        for seconds, pose in body.way:
            at = round(seconds * SECOND)
            yield Entry(at, "/tf", "foxglove.FrameTransform", _transform(at, body.name, pose))
    for seconds, _ in trial.bodies[0].way:
        at = round(seconds * SECOND)
        moving = [_cylinder(*c.at(seconds), c.radius, _RED) for c in world.moving]
        if moving:
            yield _scene(at, "/moving", "world", cylinders=moving)


def _transform(at: int, frame: str, pose: Pose) -> dict[str, Any]:
    return {
        "timestamp": _time(at),
        "parent_frame_id": "world",
        "child_frame_id": frame,
        "translation": _vector(pose.forward, pose.side, 0.0),
        "rotation": _turn(pose.heading),
    }


def _scene(at: int, topic: str, frame: str, **primitives: Any) -> Entry:
    entity = {
        "timestamp": _time(at),
        "frame_id": frame,
        "id": topic,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": True,
        "metadata": [],
        **{name: [] for name in (*_UNUSED, "cylinders", "lines")},
        **primitives,
    }
    return Entry(at, topic, "foxglove.SceneUpdate", {"deletions": [], "entities": [entity]})


_GREY, _BLUE, _RED = (0.6, 0.6, 0.6), (0.0, 0.45, 0.7), (0.85, 0.6, 0.53)


def _cylinder(x: float, y: float, radius: float, colour: tuple[float, float, float]) -> Any:
    across = 2 * radius / 1000
    return {
        "pose": _pose(x, y, _HEIGHT / 2),
        "size": {"x": across, "y": across, "z": _HEIGHT},
        "bottom_scale": 1,
        "top_scale": 1,
        "color": _colour(*colour),
    }


def _line_entity(ends: list[tuple[float, float]], height: float) -> dict[str, Any]:
    """Return a Foxglove line through the points `ends` (mm) at a height (m)."""
    return {
        "type": 2,
        "pose": _pose(0.0, 0.0, 0.0),
        "thickness": 3,
        "scale_invariant": True,
        "points": [_vector(x, y, height) for x, y in ends],
        "color": _colour(0.2, 0.2, 0.2),
        "colors": [],
        "indices": [],
    }


def _pose(x: float, y: float, height: float) -> dict[str, Any]:
    return {"position": _vector(x, y, height), "orientation": _turn(0.0)}


def _vector(x: float, y: float, height: float) -> dict[str, float]:
    """Return a point in metres; x and y are in mm, the height in metres."""
    return {"x": x / 1000, "y": y / 1000, "z": height}


def _turn(heading: float) -> dict[str, float]:
    half = radians(heading) / 2
    return {"x": 0.0, "y": 0.0, "z": sin(half), "w": cos(half)}


def _colour(r: float, g: float, b: float) -> dict[str, float]:
    return {"r": r, "g": g, "b": b, "a": 1.0}


def _time(at: int) -> dict[str, int]:
    seconds, rest = divmod(at, SECOND)
    return {"sec": seconds, "nsec": rest}
