"""The catalogue of interfaces: topics of nodes whose source is not in the workspace."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib import resources

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, whole_file
from mars_asp.exchange.ros2.interface import Interface, InterfaceTopic
from mars_asp.output import listing
from mars_asp.spelling import suggestion

#: The name of a user's file that adds to the catalogue.
OWN = "mars-catalogue.toml"
_BY_PARAMETER = re.compile(r"\{(?P<parameter>[^=#}]+)(?P<numbered>#)?(?:=(?P<default>[^}]*))?\}")
_PLACE = re.compile(r"^(?P<message>.*?) \(at line (?P<line>\d+), column (?P<column>\d+)\)$")
_TOPICS = ("publishes", "measures", "subscribes", "optional")
#: `read` is the source of an entry and has no effect.
_TEXTS = ("plugin", "node", "namespace", "camera", "observes", "read")
_FLAGS = ("guard", "clients", "listens", "spread", "sure")


class Catalogue:
    """The interfaces of programs without source; a later entry replaces one of the same name."""

    def __init__(self, other: "Catalogue | None" = None) -> None:
        """Begin with the programs of another catalogue, else with none."""
        self._programs: dict[tuple[str, str], Interface] = {}
        self._plugins: dict[str, Interface] = {}
        #: The package of a program whose node has a usual name, by that name and a private topic.
        self._private: dict[tuple[str | None, str], str] = {}
        if other is not None:
            self._programs |= other._programs
            self._plugins |= other._plugins
            self._private |= other._private

    def add(self, package: str, executable: str, plugin: object, interface: Interface) -> None:
        """Add a program by its package and executable, and by its component's class, if any."""
        self._programs[package, executable] = interface
        if isinstance(plugin, str) and plugin:
            self._plugins[plugin] = interface
        for topic in interface.published:
            if topic.name.startswith("~/"):
                self._private[interface.node, topic.name.removeprefix("~/")] = package

    def package_of_topic(self, topic: str) -> str | None:
        """Return the package whose node publishes a topic like `/uav/mavros/state`, or None."""
        words = topic.split("/")
        for at, name in enumerate(words):
            package = self._private.get((name, "/".join(words[at + 1 :])))
            if package is not None:
                return package
        return None

    def interface(self, package: str, executable: str, plugin: bool) -> Interface | None:
        """Return the interface of a program, or of a component class if `plugin`, or None."""
        if plugin:
            return self._plugins.get(executable)
        return self._programs.get((package, executable))


def load_catalogue(own: tuple[tuple[str, str], ...] = ()) -> Catalogue:
    """Return the built-in catalogue, extended by those of the user: pairs of text and path.

    Raises:
        MarsError: a catalogue of the user has an error.
    """
    catalogue = Catalogue(_ours())
    for text, path in own:
        _read_catalogue(text, path, catalogue)
    return catalogue


@cache
def _ours() -> Catalogue:
    text = resources.files(__package__).joinpath("catalogue.toml").read_text(encoding="utf-8")
    catalogue = Catalogue()
    _read_catalogue(text, "catalogue.toml", catalogue)
    return catalogue


def _read_catalogue(text: str, path: str, catalogue: Catalogue) -> None:
    """Add the programs in the TOML `text` to a catalogue."""
    try:
        document = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        match = _PLACE.match(str(error))
        place = point(path, int(match["line"]), int(match["column"])) if match else whole_file(path)
        result = match["message"] if match else str(error)
        raise _catalogue_error(path, f"this is not TOML: {result}", place=place) from None
    for package, programs in document.items():
        if not isinstance(programs, dict):
            raise _catalogue_error(path, f"`{package}` is not a table of executables")
        for executable, program in programs.items():
            if not isinstance(program, dict):
                raise _catalogue_error(path, f"`{package}.{executable}` is not a table")
            interface = _interface_of(f"{package}.{executable}", program, text, path)
            catalogue.add(package, executable, program.get("plugin"), interface)


def _interface_of(called: str, program: Mapping[str, object], text: str, path: str) -> Interface:
    """Return the interface of a program in the TOML `text` of a catalogue at `path`.

    Raises:
        MarsError: a key or a value is wrong.
    """
    known = (*_TOPICS, *_TEXTS, *_FLAGS)
    for key, value in program.items():
        if key in _TOPICS:
            fits = isinstance(value, dict) and all(isinstance(v, str) for v in value.values())
            expected = "a table of topics and message types"
        elif key in _TEXTS:
            fits, expected = isinstance(value, str), "a text"
        elif key in _FLAGS:
            fits, expected = isinstance(value, bool), "true or false"
        else:
            fits, expected = False, "a key of the catalogue"
        if not fits:
            written = re.search(rf"(?m)^[ \t]*[\"']?{re.escape(key)}[\"']?[ \t]*=", text)
            line = text.count("\n", 0, written.start()) + 1 if written else 0
            place = point(path, line, 1) if line else None
            help_text = None if key in known else suggestion(key, known, f"one of {listing(known)}")
            message = f"`{key}` of `{called}` is not {expected}"
            raise _catalogue_error(path, message, place, help_text)
    node, namespace, camera, observes = map(
        program.get, ("node", "namespace", "camera", "observes")
    )
    subscribed = (
        replace(each, image=str(camera)) if each.name == "camera_info" and camera else each
        for each in _topics(program.get("subscribes"))
    )
    return Interface(
        (
            *_topics(program.get("publishes")),
            *(replace(each, measured=True) for each in _topics(program.get("measures"))),
        ),
        (
            *subscribed,
            *(replace(each, optional=True) for each in _topics(program.get("optional"))),
        ),
        node if isinstance(node, str) else None,
        guard=program.get("guard") is True,
        clients=program.get("clients") is True,
        listens=program.get("listens") is True,
        spread=program.get("spread") is True,
        is_name_sure=program.get("sure") is True,
        namespace=namespace if isinstance(namespace, str) else "",
        observes=observes if isinstance(observes, str) else "",
    )


def _topics(listed: object) -> Iterator[InterfaceTopic]:
    """Yield the topics of a table; `#` in a parameter's name matches any number."""
    for name, kind in (listed if isinstance(listed, dict) else {}).items():
        match = _BY_PARAMETER.fullmatch(name)
        if match:
            parameter = match["parameter"] + (match["numbered"] or "")
            yield InterfaceTopic(match["default"] or "", kind, parameter=parameter)
        else:
            yield InterfaceTopic(name, kind)


def _catalogue_error(
    path: str, message: str, place: Span | None = None, help_text: str | None = None
) -> MarsError:
    span = whole_file(path) if place is None else place
    form = '"Nodes without source" in `docs/how-to/ros2.md` shows the form'
    return MarsError((Diagnostic("catalogue", "error", message, span, help=help_text or form),))
