"""Ask a logic program why an atom is in its answer, or why it is not.

    python ask.py FILE why|why_not ATOM [CONSTANT=VALUE ...]
"""

import sys

from mars_asp import MarsError, asp


def main(path: str, question: str, atom: str, *defined: str) -> int:
    """Print the reason; return 2 where there is none to be had."""
    constants = {name: int(value) for name, value in (each.split("=") for each in defined)}
    try:
        answer = asp.Program.from_files(path).solve(constants)
        print(getattr(answer, question)(atom).text())
    except MarsError as error:
        for problem in error.diagnostics:
            print(f"{problem.span.path}:{problem.span.line}: {problem.message}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
