"""The settings in `mars.toml`, or in `[tool.mars-asp]` of `pyproject.toml`.

The nearest file counts, from a folder upwards; `mars.toml` precedes in the same folder.
"""

import argparse
import os
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, Span, refusal
from mars_asp.language.parse import decode, read_bytes
from mars_asp.reading import WallError, check_walls
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from mars_asp.language.toml_text import Places

_OWN, _SHARED = "mars.toml", "pyproject.toml"
#: The names of files with settings.
SETTINGS = (_OWN, _SHARED)
#: The table with the settings in the shared file.
_TABLE = ("tool", "mars-asp")
#: A key or a header with the name of this program.
_NAMED = r"(?m)^[^=#\n]*mars-asp"
_KEYS = ("select", "ignore", "baseline", "rules", "exclude")
#: The entries of the keys whose values are lists.
_LISTED = {
    "select": "kinds of findings or rules",
    "ignore": "kinds of findings or rules",
    "rules": "folders of rule packs",
    "exclude": "patterns of paths",
}
_MOST_BYTES = 1024 * 1024


class Settings(NamedTuple):
    """Settings; a missing key has its default. Paths are relative to the current folder.

    `text` is the content of the file, and `table` the keys of the table with the settings.
    """

    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] | None = None
    baseline: str | None = None
    rules: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    path: str = ""
    text: str = ""
    table: tuple[str, ...] = ()

    def place(self, *key: str | int) -> Span:
        """Return the location in the file of a key, or of an entry (by index) of its list."""
        return _positions_in_toml(self.text, self.path).of(*self.table, *key)

    def check_named(self, named: str, *key: str | int) -> None:
        """Raise MarsError if a path in the settings is outside of the permitted folders.

        Raises:
            MarsError: the path lies outside.
        """
        try:
            check_walls(named, self.path)
        except WallError as error:
            message = f"`{named}`: {error.strerror}"
            problem = _settings_error(self, message, *key, help_text=error.advice)
            raise MarsError([problem]) from None

    def packs(self) -> list[Path]:
        """Return the paths of the rule packs, also of installed ones.

        Raises:
            MarsError: a path lies outside, or paths do not exist.
        """
        folder = Path(self.path).parent
        found: list[Path] = []
        missing: list[Diagnostic] = []
        for number, each in enumerate(self.rules):
            self.check_named(each, "rules", number)
            path = Path(each)
            # The name of an installed pack was read as a path in the folder of the settings.
            installed = None
            if path.parent == folder and not os.path.exists(path):  # noqa: PTH110 -- never raises
                from mars_asp.reasoning.packs import installed_pack

                installed = installed_pack(path.name)
            found.append(installed or path)
            if installed is None and not os.path.lexists(path):
                from mars_asp.reasoning.packs import known_packs

                advice = known_packs(path.name) or "name the folder of a rule pack"
                message = f"`{each}`: no such file or folder"
                missing.append(_settings_error(self, message, "rules", number, help_text=advice))
        if missing:
            raise MarsError(missing)
        return found


NO_SETTINGS = Settings()


@lru_cache(maxsize=1)
def _positions_in_toml(text: str, path: str) -> "Places":
    from mars_asp.language.toml_text import Places

    return Places(text, path)


def settings_of(arguments: argparse.Namespace, folder: Path) -> Settings:
    """Return the settings of a command for a folder: those of `--config`, else the nearest.

    Raises:
        MarsError: the options contradict each other, or the settings have errors.
    """
    if arguments.isolated and vars(arguments).get("config") is not None:
        message = "--isolated takes no settings, and --config names some"
        raise refusal("usage", message, "--config", "leave out one")
    if arguments.isolated:
        return NO_SETTINGS
    if arguments.config is None:
        return settings_for(folder)
    file = Path(arguments.config)
    table = _TABLE if file.name == _SHARED else ()
    return _read_settings(os.path.relpath(file), _settings_text(file), table)


def packs_for(arguments: argparse.Namespace, folder: Path) -> list[Path]:
    """Return the packs for robots in a folder: those of the settings, and the pack around it.

    Raises:
        MarsError: the settings have errors, or name a path outside.
    """
    from mars_asp.reasoning.packs import packs_around

    around = () if arguments.isolated else packs_around(folder)
    return [*settings_of(arguments, folder).packs(), *around]


def check_settings(arguments: argparse.Namespace) -> None:
    """Check the file of `--config` in commands that need no settings.

    Raises:
        MarsError: the file does not exist, or has errors.
    """
    if arguments.config is not None:
        settings_of(arguments, Path())


def settings_for(folder: Path) -> Settings:
    """Return the settings for files in a folder.

    Raises:
        MarsError: the file with the settings has errors.
    """
    here = folder.resolve()
    for place in (here, *here.parents):
        own, shared = place / _OWN, place / _SHARED
        if os.path.isfile(own):  # noqa: PTH113 -- false where a folder may not be entered
            return _read_settings(os.path.relpath(own), _settings_text(own), ())
        # Most projects have this file, and few have settings for robots in it.
        if os.path.isfile(shared) and re.search(_NAMED, text := _settings_text(shared)):  # noqa: PTH113
            found = _read_settings(os.path.relpath(shared), text, _TABLE)
            if found is not NO_SETTINGS:
                return found
    return NO_SETTINGS


def _settings_text(path: Path) -> str:
    shown = os.path.relpath(path)
    return decode(read_bytes(Path(shown), _MOST_BYTES), shown, _MOST_BYTES).replace("\r\n", "\n")


@lru_cache(maxsize=8)
def _read_settings(path: str, text: str, table: tuple[str, ...]) -> Settings:
    """Return the settings of a text; messages show `path`, which is relative."""
    from mars_asp.language.toml_text import read_tables

    values: Any = read_tables(text, path, "settings")
    for name in table:
        values = values.get(name) if isinstance(values, Mapping) else None
    if values is None:
        return NO_SETTINGS
    where = Settings(path=path, text=text, table=table)
    if not isinstance(values, Mapping):
        raise MarsError([_settings_error(where, "`tool.mars-asp` must be a table")])
    problems = list(_problems(where, values))
    if problems:
        raise MarsError(problems)
    select, ignore, baseline, rules, exclude = (values.get(key) for key in _KEYS)
    return Settings(
        None if select is None else tuple(select),
        None if ignore is None else tuple(ignore),
        None if baseline is None else str(Path(path).parent / baseline),
        tuple(str(Path(path).parent / each) for each in rules or ()),
        tuple(exclude or ()),
        where.path,
        text,
        table,
    )


def _problems(where: Settings, values: Mapping[str, Any]) -> Iterator[Diagnostic]:
    for key, value in values.items():
        if key not in _KEYS:
            near = nearest(key, _KEYS)
            known = f"did you mean `{near}`?" if near else f"one of {', '.join(_KEYS)}"
            yield _settings_error(
                where, f"`{key}` is not a key of the settings", key, help_text=known
            )
        elif key == "baseline":
            if not isinstance(value, str) or not value or "\0" in value:
                yield _settings_error(where, "`baseline` must be the path of a file", key)
        elif not isinstance(value, list):
            yield _settings_error(where, f"`{key}` must be a list of {_LISTED[key]}", key)
        else:
            for number, each in enumerate(value):
                if not isinstance(each, str) or "\0" in each:
                    yield _settings_error(
                        where, f"`{key}` lists {_LISTED[key]} as texts", key, number
                    )


def _settings_error(
    where: Settings, message: str, *key: str | int, help_text: str | None = None
) -> Diagnostic:
    return Diagnostic("settings", "error", message, where.place(*key), help=help_text)
