"""How soon the language server answers after a keystroke: `python benchmarks/editor.py [MODULES]`.

A client edits a robot of so many modules (default 1,000) over stdio and, as soon as each edit is
sent, asks one question. Prints the middle and the longest of the times to each kind of answer, from
the keystroke on, with the server's processor time in them, which other work on the machine does not
lengthen; and how long diagnostics take beside `mars-asp check` of the same file.
"""

import random
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

KEYSTROKES = 100
#: Seconds between two keystrokes: some analyses begin, others are overtaken.
PAUSES = (0.05, 0.1, 0.5)
GOAL_MS = 100
QUESTIONS = ("completion", "hover", "definition", "references", "documentSymbol", "codeLens")


def main() -> None:
    from growth import robot_lines  # noqa: PLC0415 -- behind the paths

    from tests.support.wire import Wire  # noqa: PLC0415

    modules = int(sys.argv[1]) if sys.argv[1:] else 1000
    rng = random.Random(1)
    lines = list(robot_lines(modules, rng))
    related = [number for number, line in enumerate(lines) if "uses_data_from" in line]
    taken: dict[str, list[float]] = {}
    spent: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "robot.mars"
        path.write_text("\n".join(lines) + "\n")
        wire = Wire()
        uri = wire.open(path, path.read_text())
        wire.diagnostics(uri, 1)
        for stroke in range(KEYSTROKES):
            line = rng.choice(related)
            lines[line] += rng.choice(" .x1")
            question = QUESTIONS[stroke % len(QUESTIONS)]
            place = {"line": line, "character": rng.choice((1, 20, 60))}
            before, began = wire.spent(), time.perf_counter()
            wire.change(uri, "\n".join(lines) + "\n", stroke + 2)
            params: dict[str, object] = {"textDocument": {"uri": uri}, "position": place}
            if question == "references":
                params["context"] = {"includeDeclaration": True}
            wire.ask(f"textDocument/{question}", params)
            taken.setdefault(question, []).append(1000 * (time.perf_counter() - began))
            spent.setdefault(question, []).append(1000 * (wire.spent() - before))
            time.sleep(PAUSES[stroke % len(PAUSES)])
        began = time.perf_counter()
        wire.change(uri, path.read_text(), KEYSTROKES + 2)
        wire.diagnostics(uri, KEYSTROKES + 2)
        diagnosed = time.perf_counter() - began
        began = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "mars_asp", "check", str(path)],
            cwd=ROOT,
            capture_output=True,
            check=False,
        )
        checked = time.perf_counter() - began
        wire.end()
    for what, times in taken.items():
        used = spent[what]
        middle, most = statistics.median(times), statistics.median(used)
        ratio = f"{max(used) / GOAL_MS:.2f} of {GOAL_MS} ms"
        print(f"{what}: middle {middle:.0f} ms, longest {max(times):.0f} ms;", end=" ")
        print(f"processor: middle {most:.0f} ms, longest {max(used):.0f} ms ({ratio})")
    print(f"diagnostics: {diagnosed:.2f} s, {diagnosed / checked:.2f} of `check`, {checked:.2f} s")


if __name__ == "__main__":
    main()
