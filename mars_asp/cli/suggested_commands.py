"""Commands that messages suggest: further questions about the same robot, and missing extras."""

import argparse
import shlex
import sys
from pathlib import Path

from mars_asp.output import visible
from mars_asp.reading import SHOWN_INPUT

#: The files by which uv and pipx mark an environment of theirs, and how they install into it.
_TOOLS = {
    "uv-receipt.toml": ("uv", "tool", "install"),
    "pipx_metadata.json": ("pipx", "install", "--force"),
}


def command(verb: str, arguments: argparse.Namespace, *words: str) -> str:
    """Return a command line about the files that were read, quoted for a shell.

    `words` follow the files; the options for reading the robot follow the words.
    """
    return visible(shlex.join(["mars-asp", verb, *arguments.files, *words, *_readings(arguments)]))


def command_on_one(verb: str, arguments: argparse.Namespace, *words: str) -> str | None:
    """Return a command line whose words precede its only file; None for several files.

    None as well for chosen launch files, as not every command can choose them.
    """
    if len(arguments.files) > 1 or _chosen(arguments):
        return None
    lines = ["mars-asp", verb, *words, *arguments.files, *_readings(arguments)]
    return visible(shlex.join(lines))


def command_on(path: str, verb: str, arguments: argparse.Namespace, *words: str) -> str:
    """Return a command line about one file, where `-` is standard input."""
    name = "-" if path == SHOWN_INPUT else path
    return command(verb, argparse.Namespace(**vars(arguments) | {"files": [name]}), *words)


def way_to_install(extra: str) -> str:
    """Return the command that adds an extra of this package to this installation.

    A clone or a wheel from which it was installed is recorded in `direct_url.json` (PEP 610).

    >>> way_to_install("png").endswith("[png]'")
    True
    """
    import json
    from importlib.metadata import PackageNotFoundError, distribution
    from urllib.parse import unquote, urlsplit

    try:
        origin = json.loads(distribution("mars-asp").read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, ValueError):
        origin = {}
    url = urlsplit(origin.get("url", ""))
    source = unquote(url.path) if url.scheme == "file" else "mars-asp"
    prefix = Path(sys.prefix)
    found = (words for mark, words in _TOOLS.items() if (prefix / mark).exists())
    words = next(found, (sys.executable, "-m", "pip", "install"))
    options = ("-e",) if origin.get("dir_info", {}).get("editable") and "pip" in words else ()
    return shlex.join([*words, *options, f"{source}[{extra}]"])


def _readings(arguments: argparse.Namespace) -> list[str]:
    """Return the options for reading the robot: launch files, sources, packs, format, settings."""
    given = (
        ("--launch", _chosen(arguments)),
        ("--sources", arguments.sources),
        ("--rules", arguments.rules),
        ("--from", [arguments.from_format] if arguments.from_format else []),
        ("--config", [arguments.config] if arguments.config else []),
    )
    words = [word for option, values in given for value in values for word in (option, value)]
    return [*words, "--isolated"] if arguments.isolated else words


def _chosen(arguments: argparse.Namespace) -> list[str]:
    """Return the chosen launch files; not every command can choose some."""
    return list(arguments.launch) if "launch" in arguments else []
