"""Entry point: `mars-asp VERB ...` and `python -m mars_asp VERB ...`."""

import sys


def main() -> int:
    """Run the command line; return the exit status."""
    from mars_asp.cli import run_command

    return run_command(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
