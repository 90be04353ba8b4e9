"""Ask a logic program why an atom is in its answer, why it is not, or why there is no answer.

python ask.py FILE why|why_not ATOM [CONSTANT=VALUE ...] [--external ATOM] [--part PART]
python ask.py FILE why_unsatisfiable [CONSTANT=VALUE ...]
"""

import argparse
import sys

from mars_asp import MarsError, asp


def main() -> int:
    """Print the reason; return 2 where there is none to be had."""
    parser = argparse.ArgumentParser()
    parser.add_argument("path")
    parser.add_argument("question", choices=["why", "why_not", "why_unsatisfiable"])
    parser.add_argument("rest", nargs="*")
    parser.add_argument("--external", action="append", default=[])
    parser.add_argument("--part", action="append", default=["base"])
    given = parser.parse_args()
    atoms = [each for each in given.rest if "=" not in each]
    pairs = (each.split("=") for each in given.rest if "=" in each)
    constants = {name: int(value) for name, value in pairs}
    externals = dict.fromkeys(given.external, True)
    try:
        program = asp.Program.from_files(given.path)
        if given.question == "why_unsatisfiable":
            found = program.why_unsatisfiable(constants, externals=externals, parts=given.part)
            print(found.text())
        else:
            answer = program.solve(constants, externals=externals, parts=given.part)
            print(getattr(answer, given.question)(*atoms).text())
    except MarsError as error:
        for problem in error.diagnostics:
            print(f"{problem.span.path}:{problem.span.line}: {problem.message}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
