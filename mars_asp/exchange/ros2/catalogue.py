"""The catalogue of interfaces: topics of nodes whose source is not in the workspace."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib import resources
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, whole_file
from mars_asp.exchange.ros2.interface import Interface, InterfaceTopic

#: The name of a user's file that adds to the catalogue.
OWN = "mars-catalogue.toml"
_BY_PARAMETER = re.compile(r"\{(?P<parameter>[^=#}]+)(?P<numbered>#)?(?:=(?P<default>[^}]*))?\}")
_PLACE = re.compile(r"^(?P<message>.*?) \(at line (?P<line>\d+), column (?P<column>\d+)\)$")
_TOPICS = ("publishes", "measures", "subscribes", "optional")
#: `read` is the source of an entry and has no effect.
_TEXTS = ("plugin", "node", "namespace", "camera", "read")
_FLAGS = ("guard", "clients", "listens", "spread", "sure")


class CatalogueEntry(NamedTuple):
    """A program of the catalogue, by its package, its executable and its component's class."""

    package: str
    executable: str
    plugin: str | None
    interface: Interface


class Catalogue:
    """Programs whose interfaces are known."""

    def __init__(self, entries: tuple[CatalogueEntry, ...]) -> None:
        """Take programs; of two with one name the later one holds."""
        self._programs = {(each.package, each.executable): each.interface for each in entries}
        self._plugins = {each.plugin: each.interface for each in entries if each.plugin}
        #: The package of a program whose node has a usual name, by that name and a private topic.
        self._private = {
            (each.interface.node, topic.name.removeprefix("~/")): each.package
            for each in entries
            for topic in each.interface.published
            if topic.name.startswith("~/")
        }

    def package_of_topic(self, topic: str) -> str | None:
        """Return the package whose node publishes a private topic, such as `/uav/mavros/state`."""
        words = topic.split("/")
        for at, name in enumerate(words):
            package = self._private.get((name, "/".join(words[at + 1 :])))
            if package is not None:
                return package
        return None

    def interface(self, package: str, executable: str, plugin: bool) -> Interface | None:
        """Return the interface of a program, or of a component by its class."""
        if plugin:
            return self._plugins.get(executable)
        return self._programs.get((package, executable))


def load_catalogue(own: tuple[tuple[str, str], ...] = ()) -> Catalogue:
    """Return the built-in catalogue with those of the user, each a text and its path.

    Raises:
        MarsError: a catalogue of the user has an error.
    """
    ours = resources.files(__package__).joinpath("catalogue.toml").read_text(encoding="utf-8")
    entries = list(_entries(ours, "catalogue.toml"))
    for text, path in own:
        entries += _entries(text, path)
    return Catalogue(tuple(entries))


def _entries(text: str, path: str) -> Iterator[CatalogueEntry]:
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
            yield _entry(package, executable, program, path)


def _entry(
    package: str, executable: str, program: Mapping[str, object], path: str
) -> CatalogueEntry:
    called = f"{package}.{executable}"
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
            raise _catalogue_error(path, f"`{key}` of `{called}` is not {expected}")
    plugin, node = program.get("plugin"), program.get("node")
    namespace, camera = program.get("namespace"), program.get("camera")
    subscribed = (
        replace(each, image=str(camera)) if each.name == "camera_info" and camera else each
        for each in _topics(program.get("subscribes"))
    )
    return CatalogueEntry(
        package,
        executable,
        plugin if isinstance(plugin, str) else None,
        Interface(
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
        ),
    )


def _topics(listed: object) -> Iterator[InterfaceTopic]:
    """Yield topics of a table; a number sign in the name of a parameter matches any number."""
    for name, kind in (listed if isinstance(listed, dict) else {}).items():
        match = _BY_PARAMETER.fullmatch(name)
        if match:
            parameter = match["parameter"] + (match["numbered"] or "")
            yield InterfaceTopic(match["default"] or "", kind, parameter=parameter)
        else:
            yield InterfaceTopic(name, kind)


def _catalogue_error(path: str, message: str, place: Span | None = None) -> MarsError:
    span = whole_file(path) if place is None else place
    help_text = "see `catalogue.toml` in the package for the form"
    return MarsError((Diagnostic("catalogue", "error", message, span, help=help_text),))
