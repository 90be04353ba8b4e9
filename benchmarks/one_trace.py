"""What one trace costs beyond reading the file: seconds of CPU, and as a share of reading.

`python benchmarks/one_trace.py [MODULES]`: robots of ten modules each, one question of each kind
that no choice decides, three times.
"""

import gc
import random
import statistics
import sys
import time

from growth import robot_lines

from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner

ASKED = (
    "data_divergence(M7_0)",
    "control_divergence(M1_1)",
    "control_convergence(M2_6)",
    "representation_dependency(M1_4)",
    "service_dependency(M6_4)",
    "unused_module(M5_7)",
)


#: Objects between two looks for cycles, as in a command's worker.
COLLECT_AFTER = 50_000


def main() -> None:
    modules = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    gc.set_threshold(COLLECT_AFTER)
    text = "\n".join(robot_lines(modules, random.Random(1))) + "\n"
    start = time.process_time()
    project = load_project("robots.mars", text=text)
    reading = time.process_time() - start
    print(f"reading {modules} modules: {reading:.2f} s")
    for asked in ASKED:
        seconds = []
        for _ in range(3):
            start = time.process_time()
            answer = explain(Reasoner(project, load_rulebook()), asked)
            seconds.append(time.process_time() - start)
            assert answer.topics
            assert answer.synthesis is None
        middle = statistics.median(seconds)
        print(f"{asked}: {middle:.2f} s, {middle / reading:.3f} of reading")


if __name__ == "__main__":
    main()
