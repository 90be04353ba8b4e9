"""The schemas of the formats in which programs read explanations."""

import argparse
from importlib.resources import files
from typing import Any

FORMATS = ("json", "jsonl")


def add_schema(parser: argparse.ArgumentParser) -> None:
    """Add the option that prints a schema."""
    parser.add_argument(
        "--schema",
        choices=FORMATS,
        action=_Schema,
        help="print the JSON Schema of that format, of `jsonl` of one line, and do nothing else",
    )


class _Schema(argparse.Action):
    """Prints a schema in the place of an explanation, as `--help` does."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, values: Any, *__: object
    ) -> None:
        print(schema_text(values), end="")
        parser.exit()


def schema_text(written: str) -> str:
    """Return the JSON Schema of one of the `FORMATS`."""
    schema = files("mars_asp.cli") / f"explain.{written}.schema.json"
    return schema.read_text(encoding="utf-8")
