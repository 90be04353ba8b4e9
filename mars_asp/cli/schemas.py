"""The schemas of the formats that programs read, and the option that prints them."""

import argparse
from collections.abc import Callable
from typing import Any

#: The formats of an explanation that have a schema each.
FORMATS = ("json", "jsonl")


def add_schema(
    parser: argparse.ArgumentParser, told: str, text: Callable[..., str], *formats: str
) -> None:
    """Add the option that prints a schema, and `told` to the help.

    `text` returns it; where there are formats, it is given the one that was chosen.
    """
    parser.add_argument(
        "--schema",
        action=_Schema,
        nargs=None if formats else 0,
        choices=formats or None,
        const=text,
        help=f"print the JSON Schema of {told}, and do nothing else",
    )


class _Schema(argparse.Action):
    """Prints a schema in the place of what a verb does, as `--help` does."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, values: Any, *__: object
    ) -> None:
        print(self.const(values) if values else self.const(), end="")
        parser.exit()


def explain_schema(written: str) -> str:
    """Return the JSON Schema of one of the `FORMATS`."""
    return _schema_text(f"explain.{written}")


def check_schema() -> str:
    """Return the JSON Schema of the document of `check`."""
    return _schema_text("check")


def campaign_schema() -> str:
    """Return the JSON Schema of a line of a campaign."""
    return _schema_text("campaign")


def _schema_text(name: str) -> str:
    from importlib.resources import files

    schema = files("mars_asp.cli") / f"{name}.schema.json"
    return schema.read_text(encoding="utf-8")
