"""Import foreign files, of one or several formats, as one robot."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib import import_module
from typing import NamedTuple, TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.exchange.folders import IsExcluded, nothing_excluded
from mars_asp.exchange.unite import united
from mars_asp.language import Parsed
from mars_asp.language.print import print_module

_Reader: TypeAlias = Callable[..., Parsed]
#: Where what reads a format is, from texts and their paths. Only what is needed is loaded.
READERS: Mapping[str, tuple[str, str]] = {
    "urdf": ("mars_asp.exchange.urdf", "import_urdfs"),
    "twist_mux": ("mars_asp.exchange.twist_mux", "import_muxes"),
    "rosgraph": ("mars_asp.exchange.rosgraph", "import_rosgraph"),
    "dora": ("mars_asp.exchange.dora", "import_dora"),
    "ros2": ("mars_asp.exchange.ros2", "import_ros2"),
}
#: Formats whose files add to those of other formats: the first of these that is present reads both.
_READ_WITH: Mapping[str, tuple[str, ...]] = {"twist_mux": ("ros2", "rosgraph")}


class ForeignFile(NamedTuple):
    """A file that was read: its shown path, its text, and its format."""

    path: str
    text: str
    format: str


def read_foreign(
    files: Sequence[ForeignFile],
    launch: Sequence[str] = (),
    is_excluded: IsExcluded = nothing_excluded,
) -> Parsed:
    """Return the one configuration of a robot that is described by several files.

    Args:
        files: The files, at least one.
        launch: The launch files to read in a folder; if empty, all of them.
        is_excluded: Whether a path in a folder is passed over.

    Raises:
        MarsError: all errors of the files.
    """
    found: list[Parsed] = []
    problems: list[Diagnostic] = []
    formats = dict.fromkeys(file.format for file in files)
    for format in formats:
        if _with(format, formats) != format:
            continue
        read = {other for other in formats if _with(other, formats) == format}
        own = [(file.text, file.path) for file in files if file.format in read]
        module, function = READERS[format]
        reader: _Reader = getattr(import_module(module), function)
        try:
            if format == "ros2":
                reader = partial(reader, launch=launch, is_excluded=is_excluded)
            found.append(reader(own))
        except MarsError as error:
            problems += error.diagnostics
    if problems:
        raise MarsError(problems)
    # A robot of nodes and links is checked as one of nodes: URDF has no topics.
    # A file that the reader of another format takes does not count, wherever it is named.
    origins = (each for each in formats if each != "urdf" and _with(each, formats) == each)
    origin = next(origins, files[0].format)
    parsed = united(found)
    configuration = replace(parsed.configuration, origin=origin)
    blocks = tuple(map(print_module, configuration.declared))
    return parsed._replace(configuration=configuration, blocks=blocks)


def _with(format: str, formats: Collection[str]) -> str:
    """Return the format whose reader reads files of `format`, which may be another of `formats`."""
    return next((each for each in _READ_WITH.get(format, ()) if each in formats), format)
