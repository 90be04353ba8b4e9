"""Print the findings in a robot, why the first one is there, and the minimal specification.

    python check_robot.py PATH
"""

import sys

import mars_asp
from mars_asp import MarsError


def main(path: str) -> int:
    """Print the answers; return 2 where the robot cannot be read."""
    try:
        robot = mars_asp.load(path)
    except MarsError as error:
        for problem in error.diagnostics:
            print(problem, file=sys.stderr)
        return 2
    findings = robot.check(ignore=["unused_output"])
    for finding in findings:
        print(f"{finding.path}:{finding.line}: {finding.message} [{finding.kind}]")
    if findings:
        print(robot.explain(findings[0].kind).text)
    graph = robot.to_networkx()
    print(f"{len(graph)} modules, {graph.number_of_edges()} relationships")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
