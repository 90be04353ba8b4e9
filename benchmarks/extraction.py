"""Extraction of annotated sources: whole processes, as a ratio to reading the same bytes.

python benchmarks/extraction.py [tree] [annotated] [defined] [large] [hostile]

`tree` is a million lines in 1,000 files, 100 of them annotated; `annotated` are 1,000 annotated
files, whose functions are declared, `defined` the same with bodies of 40 lines; `large` is one file
of 100 MB, `hostile` are files of 1 MB made to be slow to read. What is printed is the processor
time beyond that of the same command on an empty folder, measured in turns and the least of several,
its ratio to reading the same bytes, and the most memory that a process used. Nothing here waits, so
that on an idle machine processor time is what a clock shows.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

MEGABYTE = 1_000_000
ROUNDS = 5
CODE = """\
/// Returns the pose of the robot, see `pose_at`.
static Pose pose_%d(const Map &map, double time) {
    if (time < 0.5e-3) { return Pose{"none", 'x', map.width() / 2}; }
    // Somewhere between two poses: e.g. don't trust "old" ones.
    for (int i = 0; i < 1'000; ++i) { /* follow */ log("at %%d of %%s\\n", i, map.name()); }
    return interpolate(map.before(time), map.after(time), time);  // linear
}

"""
MODULE = """\
// @module_start
// @module_name %(name)s
// @Rotn_Y -90 90 30
// @DataOut NotifyAtFrequency 25, RequestWhenReady
std::vector<Pose> %(name)s_plan(const nav::Map &map, const std::optional<Pose> &goal);
// @Converts
nav::Map %(name)s_map(const std::shared_ptr<const Scan> &scan);
// @module_end
"""
#: What a hostile file repeats, what stands before it and what behind, by the suffix of the file.
START = "// @module_start\n// @module_name A\n"
SENSE = START + "// @Sense RequestWhenReady\n"
HOSTILE: dict[str, tuple[str, str, str]] = {
    "raw.cpp": (SENSE, 'R"x(', ""),
    "raw_tags.cpp": (SENSE, 'R"aaaaaaaaaaaaaaaa( )aaaaaaaaaaaaaaa', ""),
    "raw_unclosed.rs": (SENSE, 'r#"', ""),
    "comment_openings.cpp": (SENSE, "/* ", ""),
    "comment_openings.rs": (SENSE, "/* ", ""),
    "comments_nested.rs": (SENSE, "/*/**/*/ ", ""),
    "comments_closed.cpp": (SENSE, "/**/", ""),
    "comments_signs.cpp": ("// @module_", "//@\n", ""),
    "comments_words.cpp": ("// @module_", "// @param x\n", ""),
    "comments_words.py": ("# @module_start\n", "# @Sensory x\n", ""),
    "comments_different_words.cpp": (START, "// @tenser%d\n", ""),
    "quotes.cpp": (SENSE, '"', ""),
    "quotes_single.cpp": (SENSE, "'", ""),
    "quotes_triple.py": ("# @module_start\n# @Sense RequestWhenReady\n", '"""', ""),
    "quotes_alternating.py": ("# @module_start\n# @Sense RequestWhenReady\n", "'\"", ""),
    "quotes.m": ("% @module_start\n% @Sense RequestWhenReady\n", "'", ""),
    "lifetimes.rs": (SENSE, "'a ", ""),
    "backslashes.cpp": (SENSE, "\\", ""),
    "backslashes_string.cpp": (SENSE + '"', "\\", ""),
    "backslashes_lines.cpp": (SENSE + "//", "\\\n", ""),
    "backticks.go": (SENSE, "`", ""),
    "blocks.m": ("% @module_start\n% @Sense RequestWhenReady\n", "%{\n", ""),
    "dots.m": ("% @module_start\n% @Sense RequestWhenReady\n", ".", ""),
    "numbers.cpp": (SENSE, "1'", ""),
    "digits.cpp": (SENSE, "1", ""),
    "word.cpp": (SENSE, "a", ""),
    "blanks.cpp": (SENSE, " ", ""),
    "lines.cpp": (SENSE, "\n", ""),
    "returns.cpp": (SENSE, "\r", ""),
    "signs.cpp": (START, "@", ""),
    "signs_commented.cpp": (START + "// ", "@", ""),
    "Sense.cpp": (START, "// @Sense\n", ""),
    "Sense_outside.cpp": ("// @module_end\n", "// @Sense\n", ""),
    "Sense_comma.cpp": (START, "// @Sense X,\n", ""),
    "Sense_right.cpp": (START, "// @Sense RequestWhenReady\n", "X f();\n"),
    "Sense_on_one_line.cpp": (START, "/* @Sense RequestWhenReady, */ ", ""),
    "Sense_in_one_comment.cpp": (START + "/*\n", " * @Sense RequestWhenReady\n", ""),
    "Sense_functions.cpp": (START, "// @Sense RequestWhenReady\nX f();\n", ""),
    "misspelt.cpp": (START, "// @Sence\n", ""),
    "misspelt_outside.cpp": ("// @module_\n", "// @Sence\n", ""),
    "module_start.cpp": ("", "// @module_start\n", ""),
    "module_name.cpp": (START, "// @module_name A\n", ""),
    "module_end.cpp": ("", "// @module_end\n", ""),
    "modules.cpp": ("", START + "// @module_end\n", ""),
    "Output.cpp": (SENSE, "// @Output X\n", ""),
    "Input_wrapped.cpp": (SENSE + "// @Input A,\n", "//   A,\n", ""),
    "Signature.cpp": (SENSE + "// @Signature X f(", "A,\n// ", "A)\n"),
    "Vertex.cpp": (SENSE, "// @Vertex 1\n", ""),
    "Rotn_X.cpp": (START, "// @Rotn_X 0 1\n", ""),
    "modes.cpp": (START + "// @Sense ", "NotifyWhenReady, ", "\n"),
    "conditions.cpp": (START, "#if 0\n", ""),
    "conditions_closed.cpp": (START, "#if 0\n#endif\n", ""),
    "angles.cpp": (SENSE + "template ", "<", ""),
    "angles_type.cpp": (SENSE + "X ", "A<", " f();"),
    "brackets.cpp": (SENSE + "X f", "(", ""),
    "brackets_square.cpp": (SENSE + "X f(", "[[", ""),
    "brackets_pairs.cpp": (SENSE + "X f(", "()", ""),
    "brackets.py": ("# @module_start\n# @Sense RequestWhenReady\ndef f", "(", ""),
    "decorators.py": ("# @module_start\n# @Sense RequestWhenReady\n", "@a(\n)\n", ""),
    "parameters.cpp": (SENSE + "X f(", "A a, ", "A z);"),
    "parameters.py": ("# @module_start\n# @Sense RequestWhenReady\ndef f(", "a: A,", "): pass"),
    "requires.cpp": (SENSE, "requires ", ""),
    "attributes.cpp": (SENSE, "[[a]]", ""),
    "trailing.cpp": (SENSE + "auto f() -> ", "A<", ""),
    "arrays.cpp": (SENSE + "X f(A a", "[]", ");"),
    "functions.cpp": (SENSE + "X ", "f(", ");"),
    "attributes.py": ("# @module_start\n# @Sense RequestWhenReady\ndef f(x: ", "a.", "a): pass"),
    "annotations.java": (SENSE, "@A(", ""),
    "types.go": (SENSE + "func f(x ", "map[a]", "A)"),
    "scopes.cpp": (SENSE + "X ", "a::", "f();"),
    "colons.rs": (SENSE + "fn f(", "a:", ")"),
}


def repeated(before: str, part: str, behind: str, size: int = MEGABYTE) -> bytes:
    """Return a text of about so many bytes that repeats a part; `%d` in it is its number."""
    count = (size - len(before) - len(behind)) // len(part)
    parts = (part % number for number in range(count)) if "%d" in part else [part] * count
    return (before + "".join(parts) + behind).encode()


def code(lines: int) -> str:
    """Return ordinary C++ of so many lines."""
    return "".join(CODE % number for number in range(lines // 8))


def tree(folder: Path) -> None:
    plain = code(1000)
    for number in range(1000):
        inner = folder / f"package{number % 20}"
        inner.mkdir(exist_ok=True)
        text = plain
        if number % 10 == 0:
            half = plain.index("\n\n", len(plain) // 2) + 2
            text = plain[:half] + MODULE % {"name": f"M{number}"} + plain[half:]
        (inner / f"file{number}.cpp").write_text(text)


def annotated(folder: Path) -> None:
    for number in range(1000):
        (folder / f"file{number}.cpp").write_text(MODULE % {"name": f"M{number}"} + code(100))


def defined(folder: Path) -> None:
    """Write functions whose bodies stand behind their annotations."""
    body = " {\n" + code(40) + "}\n"
    for number in range(1000):
        module = (MODULE % {"name": f"M{number}"}).replace(";\n", body)
        (folder / f"file{number}.cpp").write_text(module + code(40))


def large(folder: Path) -> None:
    plain = code(100_000)
    with (folder / "large.cpp").open("w") as file:
        file.write("// \N{MICRO SIGN}, \N{EM DASH}, \N{ROBOT FACE}\n")
        number = 0
        while file.tell() < 100 * MEGABYTE:
            file.write(MODULE % {"name": f"M{number}"} + plain)
            number += 1


def measured(path: Path) -> tuple[float, float]:
    """Return the processor time of an extraction in seconds and its memory in MB."""
    command = [sys.executable, "-m", "mars_asp", "extract", str(path)]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode in (0, 1), f"{path}: status {process.returncode}"
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1000


def reading(folder: Path) -> float:
    """Return the seconds that reading every file of a folder takes, a piece at a time."""
    started = time.process_time()
    for path in folder.rglob("*"):
        if path.is_file():
            with path.open("rb", buffering=0) as file:
                while file.read(MEGABYTE):
                    pass
    return time.process_time() - started


def inputs(wanted: list[str]) -> Iterator[tuple[str, Callable[[Path], None]]]:
    """Yield each input's name and what writes it into a folder."""
    for write in (tree, annotated, defined, large):
        if write.__name__ in wanted:
            yield write.__name__, write
    for name, parts in HOSTILE.items():
        if "hostile" in wanted or name in wanted:

            def one(folder: Path, name: str = name, parts: tuple[str, str, str] = parts) -> None:
                # Behind its last annotation a file is not looked at, so that there has to be one.
                mark = {".py": "#", ".m": "%"}.get(Path(name).suffix, "//")
                before, part, behind = parts
                behind += f"\n{mark} @module_end\n"
                (folder / name).write_bytes(repeated(before, part, behind))

            yield name, one


def main() -> None:
    wanted = sys.argv[1:] or ["tree", "annotated", "defined", "large", "hostile"]
    print(f"{'input':24} {'MB':>6} {'s':>7} {'of reading':>10} {'memory MB':>9}")
    for name, write in inputs(wanted):
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as empty:
            write(Path(folder))
            size = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file())
            floor = min(reading(Path(folder)) for _ in range(3))
            starts, results = zip(
                *((measured(Path(empty)), measured(Path(folder))) for _ in range(ROUNDS)),
                strict=True,
            )
            taken = min(results)[0] - min(starts)[0]
            memory = max(used for _, used in results)
            figures = f"{taken:7.3f} {taken / floor:10.0f} {memory:9.0f}"
            print(f"{name:24} {size / MEGABYTE:6.1f} {figures}", flush=True)


if __name__ == "__main__":
    main()
