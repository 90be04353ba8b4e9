"""The schemas of the formats that programs read, and the option that prints them."""

import argparse
from collections.abc import Callable
from typing import Any

#: The formats of an explanation, each with its own schema.
FORMATS = ("json", "jsonl")


def add_schema(
    parser: argparse.ArgumentParser, document: str, text: Callable[..., str], *formats: str
) -> None:
    """Add the option that prints the schema of a document; the help names the document.

    `text` returns the schema; if there are formats, it is called with the chosen one.
    """
    parser.add_argument(
        "--schema",
        action=_Schema,
        nargs=None if formats else 0,
        choices=formats or None,
        const=text,
        help=f"print the JSON Schema of {document}, and do nothing else",
    )


class _Schema(argparse.Action):
    """Prints a schema instead of running the command, as `--help` does."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, values: Any, *__: object
    ) -> None:
        print(self.const(values) if values else self.const(), end="")
        parser.exit()


def schema_text(*names: str) -> str:
    """Return the JSON Schema of a command's document; `explain` also needs its format."""
    from importlib.resources import files

    schema = files("mars_asp.cli") / f"{'.'.join(names)}.schema.json"
    return schema.read_text(encoding="utf-8")
