"""The command `ros2 mars`, which passes its words to `mars-asp`.

`ros2` loads the class by the entry point `ros2cli.command`; nothing of ROS is imported.
"""

import argparse

#: No command line contains this character, so `ros2` takes no word as an option.
_NO_PREFIX = "\0"


class MarsCommand:
    """Check robot architectures, and explain and fix the findings."""

    NAME = "mars"
    EXTENSION_POINT_VERSION = "0.1"

    def add_arguments(
        self, parser: argparse.ArgumentParser, cli_name: str, *, argv: list[str] | None = None
    ) -> None:
        """Pass all words after `ros2 mars` on, including `--help`."""
        parser.prefix_chars = _NO_PREFIX
        parser.add_argument("words", nargs=argparse.REMAINDER, metavar="COMMAND ...")

    def main(self, *, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        """Run the command line; return the exit status."""
        from mars_asp.__main__ import main

        return main(args.words)
