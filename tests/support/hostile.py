"""Hostile files and commands: each ends with a status of the contract, and touches no other file.

python -m tests.support.hostile HOW_MANY FIRST_SEED

Each command runs in a folder of a stranger, beside a secret that may not be printed, with a secret
in its environment, and beside files of the user that have to stay as they are.
"""

import os
import random
import re
import resource
import signal
import stat
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.support.documents import ROOT

SECRET = "hunter2"
#: Megabytes and seconds that no command may need.
MEMORY, SECONDS = 1500, 60
_WRONG = re.compile(rb"Traceback|internal error|[A-Z][a-z]{1,20}Error\(|reasoner crashed")
FLAT = "@configuration flat\n@modules A, B\nA is_controlled_by B 1\n"
SCENARIO = (
    'seed = 1\nduration = 1\n[robot]\nmodule = "MobilePlatform"\nradius = {}\n'
    "start = [0, 0, 0]\n[world]\nwalls = []\n"
)
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    a, d, t = [Node(package="p", executable="e")], {{"k": "v"}}, "x"
    {}
    return LaunchDescription(a if isinstance(a, list) else [a])
"""
#: Ways for a list, a dictionary or a text to double, over and over.
DOUBLING = (
    "a = [a, a]",
    "a = a + a",
    "a += a",
    "a.extend(a)",
    "a.insert(0, a)",
    "a = [*a, *a]",
    "a = (*a, *a)",
    "a = [each for each in a for each in a]",
    "a.append(a)",
    "d = {**d, **d}",
    "d = {k: d for k in d.items()}",
    "d['x'] = d",
    "d = {str(d): d, **d}",
    "a = list(d.items()) + a; d = {**d, 'x': a}",
    "t = t + t",
    "t = f'{t}{t}'",
    "t = '{0}{0}'.format(t)",
    "t = t * 1000000000",
    "a = a * 1000000000",
    "a = list(zip(a, a, a)) + a",
    "a = [lambda: a, *a]",
    "def f(*a, **d): return [*a, *a, *d]\n    a = f(*a, *a, **d, **d)",
)


class Case(NamedTuple):
    """A command, and the files of the stranger's folder."""

    words: Sequence[str]
    files: dict[str, str | bytes]


def _pick(rng: random.Random, *choices: str) -> str:
    return rng.choice(choices)


def _target(rng: random.Random) -> str:
    return _pick(
        rng,
        *("../secret", "../secret.cpp", "link", "/proc/self/environ", "/proc/1/environ"),
        *("/dev/zero", "/dev/stdin", "/dev/fd/0", "/sys/kernel/notes", "/proc/self/mem", "fifo"),
        *("/", "..", ".", "*", "/**", "/proc/**/environ", "loop/**/*.cpp", "gone", "a" * 5000),
        *("a\0b", "\udcff", "~", "~/x", "a.mars", "../pack", "-", "folder", "/etc/**/passwd"),
    )


def _number(rng: random.Random) -> str:
    digits = rng.choice((1, 10, 19, 400, 4299, 4301, 30_000))
    return _pick(
        rng,
        *("9" * digits, "0x" + "f" * digits, "0b" + "1" * digits, "0o" + "7" * digits),
        *(
            "1e" + "9" * min(digits, 19),
            "-" + "9" * digits,
            "1_" * digits + "0",
            "." + "9" * digits,
        ),
        *("nan", "inf", "-inf", "1e-400", "٣", "1" + "0" * digits + ".5", "0" * digits + "1"),
    )


def _nested(rng: random.Random, opening: str, closing: str) -> str:
    depth = rng.choice((3, 90, 150, 1000, 20_000, 200_000))
    return opening * depth + _pick(rng, "1", "", _number(rng)) + closing * rng.choice((0, 1, depth))


def _value(rng: random.Random) -> str:
    return rng.choice(
        (
            _number(rng),
            _nested(rng, "[", "]"),
            _nested(rng, "{a=", "}"),
            _nested(rng, '{"a":', "}"),
            '"\udcff\\ud800"',
            "[" + "1," * 50_000 + "]",
            '"' + "x" * 100_000 + '"',
            "1979-05-27",
            "null",
        )
    )


def configurations(rng: random.Random) -> Case:
    """Return a configuration that names forbidden files."""
    kind = _pick(rng, "@include", "@sources")
    lines = "".join(f"{kind} {_target(rng)}\n" for _ in range(rng.choice((1, 1, 3, 3000))))
    verb = _pick(rng, "check", "analyse", "synthesise", "explain", "facts")
    return Case((verb, "a.mars"), {"a.mars": FLAT + lines, "fifo": "|", "loop": "-> ."})


def links(rng: random.Random) -> Case:
    """Return a command on a link or a special file, as any of its inputs."""
    target = _pick(rng, "../secret", "/proc/self/environ", "/dev/zero", "|", "../folder", "-> b")
    verbs = (
        ("check", "b.mars"),
        ("check", "a.mars", "--baseline", "b.mars"),
        ("check", "a.mars", "--rules", "b.mars"),
        ("fmt", "b.mars"),
        ("import", "urdf", "b.mars"),
        ("import", "ros2", "b.mars"),
        ("verify", "b.mars", "a.mars"),
        ("run", "a.mars", "--scenario", "b.mars"),
        ("check", "a.mars", "--fix"),
        ("extract", "b.mars", "."),
        ("test", "b.mars"),
    )
    link = target if target == "|" else f"-> {target.removeprefix('-> ')}"
    return Case(rng.choice(verbs), {"a.mars": FLAT, "b.mars": link, "c.cpp": link})


def settings(rng: random.Random) -> Case:
    """Return settings that name forbidden files."""
    key = _pick(rng, "baseline", "rules", "select", "ignore")
    named = _target(rng).replace("\0", "\\u0000").replace("\udcff", "x")
    value = f'"{named}"' if key == "baseline" else f'["{named}"]'
    text = f"{key} = {rng.choice((value, value, _value(rng)))}\n"
    name = _pick(rng, "mars.toml", "pyproject.toml")
    head = "" if name == "mars.toml" else "[tool.mars-asp]\n"
    return Case(("check", "a.mars"), {"a.mars": FLAT, name: head + text, "fifo": "|"})


def numbers(rng: random.Random) -> Case:
    """Return a configuration with odd numbers."""
    line = _pick(rng, "A is_controlled_by B {}", "A uses_data_from B {} Hz", "A is_mounted_on B {}")
    options = _pick(rng, "", " priority {}", " hold {} ms", " (0, 0, {})", " at ({}, 0, 0) mm")
    text = FLAT + (line + options + "\n").replace("{}", _number(rng))
    return Case((_pick(rng, "check", "synthesise", "fmt"), "a.mars"), {"a.mars": text})


def varied(rng: random.Random) -> Case:
    """Return a scenario, and a key with odd values."""
    verb = rng.choice((("run",), ("campaign", "--seeds", "1")))
    key = _pick(
        rng, "robot.radius", "seed", "world.walls", "duration", "a." * 2000 + "b", "robot.0"
    )
    own = _value(rng) if rng.random() < 0.5 else "200"
    vary = f"{key}={_value(rng)}".replace("\0", "")
    words = (*verb, "a.mars", "--scenario", "s.toml", "--vary", vary[:100_000])
    return Case(words, {"a.mars": FLAT, "s.toml": SCENARIO.format(own)})


def journals(rng: random.Random) -> Case:
    """Return a campaign whose file holds something odd."""
    robot, scenario = (
        (ROOT / "examples/level1" / name).read_text() for name in ("config.mars", "scenario.toml")
    )
    header = '{"format": "mars-campaign", "version": ' + _value(rng) + "}\n"
    values = _value(rng), _value(rng)
    run = f'{{"seed": {values[0]}, "vary": {{"a": {values[1]}}}, "verdict": "pass"}}\n'
    files = {
        "r/a.mars": robot,
        "r/s.toml": scenario,
        "o.jsonl": rng.choice((header, header + run, run, "", "\n", "{}\n" * 1000)),
    }
    words = ("campaign", "r/a.mars", "--scenario", "r/s.toml", "--seeds", "1", "-o", "o.jsonl")
    return Case(words, {**files})


def packs(rng: random.Random) -> Case:
    """Return a pack with an odd manifest or odd rules."""
    version = ".".join(_number(rng) for _ in range(rng.choice((1, 1, 3))))
    need = f'needs = ["mars-asp {_pick(rng, ">=", "<", "==")} {version}"]\n'
    text = f'name = "p"\nversion = "{version}"\n{need if rng.random() < 0.7 else ""}'
    if rng.random() < 0.3:
        text = f"name = {_value(rng)}\nversion = {_value(rng)}\n"
    rule = rng.choice((f"p({_number(rng)}).", f"p({_nested(rng, '(', ')')}).", "p(1)."))
    files = {"a.mars": FLAT, "p/pack.toml": text, "p/x.lp": rule}
    words = rng.choice(
        (
            ("check", "a.mars", "--rules", "p"),
            ("rules", "lint", "p"),
            ("rules", "doc", "--rules", "p"),
        )
    )
    return Case(words, {**files})


def baselines(rng: random.Random) -> Case:
    """Return an odd baseline."""
    head = '{"format": "mars-baseline", "version": %s, "findings": %s}'
    text = head % (rng.choice(("1", _value(rng))), _value(rng))
    return Case(("check", "a.mars", "--baseline", "b"), {"a.mars": FLAT, "b": text})


def launches(rng: random.Random) -> Case:
    """Return a launch file that grows without end."""
    times = rng.choice((10, 40, 400))
    body = "\n    ".join(rng.choice(DOUBLING) for _ in range(rng.choice((1, 1, 3)))).replace(
        "\n    ", "\n    "
    )
    text = "\n    ".join([body] * times)
    if rng.random() < 0.3:
        text = f"for i in range(1000):\n        {body}".replace("\n    def", "\n        def")
    return Case(("check", "x.launch.py"), {"x.launch.py": LAUNCH.format(text)})


def nested(rng: random.Random) -> Case:
    """Return a foreign file that is nested deep, or aliases itself."""
    texts = {
        "a.yaml": _nested(rng, "- ", "") + "\n",
        "b.yaml": "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, 60)),
        "c.urdf": '<robot name="r">' + _nested(rng, "<link>", "</link>") + "</robot>",
        "d.dot": "digraph g " + _nested(rng, "{ subgraph ", "}"),
        "e.launch.xml": "<launch>" + _nested(rng, "<group>", "</group>") + "</launch>",
        "f.launch.py": f"x = {_nested(rng, '[', ']')}\n",
        "g.json": _value(rng),
        "h.urdf": '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">'
        '<!ENTITY x SYSTEM "../secret">]><robot name="&b;&x;"/>',
        "i.yaml": f"twist_mux:\n  ros__parameters:\n    topics:\n      a: {{topic: '\\ud800',"
        f" timeout: {_number(rng)}, priority: {_number(rng)}}}\n",
        "j.mars": FLAT + _nested(rng, "A uses_data_from (", ")"),
    }
    name = rng.choice(sorted(texts))
    return Case((_pick(rng, "check", "synthesise"), name), {name: texts[name]})


def outputs(rng: random.Random) -> Case:
    """Return a command that would write over its inputs, or two outputs into one."""
    out = _pick(rng, "a.mars", "b.mars", "./a.mars", "link", "hard", "x.svg", "../a/a.mars")
    words = rng.choice(
        (
            ("synthesise", "a.mars", "-o", out),
            ("explain", "a.mars", "-o", f"{out}.html"),
            ("check", "a.mars", "--write-baseline", out),
            ("check", "a.mars", "--write-baseline", "mars.toml"),
            ("draw", "a.mars", "-o", "x.svg"),
            ("import", "urdf", "r.urdf", "-o", "r.urdf"),
            ("run", "a.mars", "--scenario", "s.toml", "--plot", "x.svg", "--plot", "x.svg"),
            ("run", "a.mars", "--scenario", "s.toml", "--report", "x.html", "--replay", "./x.html"),
            ("campaign", "a.mars", "--scenario", "s.toml", "--seeds", "1", "-o", out),
        )
    )
    files = {
        "a.mars": FLAT + "@include b.mars\n",
        "b.mars": "@configuration flat\n@modules C\n",
        "s.toml": SCENARIO.format(200),
        "link": "-> b.mars",
        "hard": "= b.mars",
        "r.urdf": '<robot name="r"><link name="l"/></robot>',
        "mars.toml": "ignore = []\n",
    }
    return Case(words, {**files})


def names(rng: random.Random) -> Case:
    """Return files with odd names."""
    name = "".join(
        rng.choice(('"', "\\", "\n", "\udcff", "é", "\x01", "%*", ").", "a", " ", "'"))
        for _ in "12345"
    )
    name = name.lstrip("-").replace("/", "") + ".mars"
    verb = rng.choice(
        (
            ("check", name),
            ("explain", name),
            ("synthesise", name, "-o", f"o{name}"),
            ("explain", name, "-o", f"o{name}.html"),
            ("check", name, "--format", _pick(rng, "sarif", "json", "github")),
            ("check", "c.mars", "--rules", f"p{name}"),
            ("explain", "c.mars", name),
            ("check", "c.mars", "--sources", f"p{name}"),
        )
    )
    rules = "%*! odd(X: module) *%\nodd(X) :- module(X).\n"
    files = {
        "c.mars": FLAT,
        name: FLAT,
        f"p{name}/{name}.lp": rules,
        f"p{name}/x.cpp": "// @Sense\n",
    }
    return Case(verb, {**files})


def bytes_(rng: random.Random) -> Case:
    """Return an example with some bytes changed, in any command."""
    found = sorted(ROOT.glob("examples/level*/*.*")) + sorted(ROOT.glob("tests/urdf/*.urdf"))
    found += sorted(ROOT.glob("tests/ros2/*/launch/*.py")) + sorted(ROOT.glob("tests/rosgraph/*"))
    path = rng.choice([each for each in found if each.is_file()])
    raw = bytearray(path.read_bytes())
    for _ in range(rng.choice((1, 5, 50))):
        at = rng.randrange(len(raw) + 1)
        raw[at : at + rng.choice((0, 1, 20))] = rng.randbytes(rng.choice((0, 1, 5)))
    verb = _pick(rng, "check", "synthesise", "explain", "fmt", "verify", "extract", "draw -o x.svg")
    first, *others = verb.split()
    return Case((first, path.name, *others), {path.name: bytes(raw)})


SHAPES: Sequence[Callable[[random.Random], Case]] = (
    *(configurations, links, settings, numbers, varied, journals, packs, baselines, launches),
    *(nested, outputs, names, bytes_),
)


def hostile(seed: int) -> list[str]:
    """Run one command, and return its faults."""
    rng = random.Random(seed)
    case = SHAPES[seed % len(SHAPES)](rng)
    with tempfile.TemporaryDirectory() as made:
        home = Path(made)
        _users_files(home)
        folder = home / "a"
        for name, content in case.files.items():
            _make(folder, name, content)
        before = _state(home)
        status, printed, used, took = _run(case.words, folder)
        after = _state(home)
    wrong = []
    if status not in (0, 1, 2, 3):
        wrong.append(f"status {status}")
    if found := _WRONG.search(printed):
        wrong.append(
            printed[max(0, found.start() - 100) : found.end() + 200].decode(errors="replace")
        )
    if SECRET.encode() in printed:
        wrong.append("printed a secret")
    if used > MEMORY or took > SECONDS:
        wrong.append(f"took {used:.0f} MB and {took:.0f} s")
    lost = [path for path, held in before.items() if after.get(path) != held]
    if case.words[0] == "fmt" or "o.jsonl" in case.words:
        lost = [path for path in lost if not path.startswith("a/")]
    if "-o" in case.words and status == 2:
        lost += [path for path in after if path not in before and path.startswith("a/")]
    if lost:
        wrong.append(f"touched {lost}")
    shown = " ".join(case.words)[:300]
    return [f"seed {seed}: {shown!a}: {each}" for each in wrong]


def _users_files(home: Path) -> None:
    """Lay out files of the user, with names as of our temporary files."""
    for name in (".mars-asp.abc", ".mars-asp.0123456789abcdef.1", "keep"):
        _make(home, f"a/{name}", "of the user")
    _make(home, "secret", f"TOKEN={SECRET} (secret)\n@Sense {SECRET}\n")
    _make(home, "secret.cpp", f"// @module_start\n// @module_name A\n// @Sense {SECRET}\nX f();\n")
    _make(home, "pack/x.lp", f"{SECRET}(secret) x.\n")
    _make(home, "folder/x.mars", f"{SECRET}\n")


def _make(folder: Path, name: str, content: str | bytes) -> None:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif content == "|":
        os.mkfifo(path)
    elif content.startswith("-> "):
        path.symlink_to(content[3:])
    elif content.startswith("= "):
        path.hardlink_to(folder / content[2:])
    else:
        path.write_bytes(content.encode(errors="surrogateescape"))


def _state(home: Path) -> dict[str, object]:
    """Return the content of files below a folder, by their paths."""
    found: dict[str, object] = {}
    for path in sorted(home.rglob("*")):
        mode = path.lstat().st_mode
        regular = stat.S_ISREG(mode)
        found[str(path.relative_to(home))] = path.read_bytes() if regular else mode
    return found


def _run(words: Sequence[str], folder: Path) -> tuple[int, bytes, float, float]:
    """Return the status of a command, its output, and the megabytes and seconds that it takes.

    These are seconds of processor time.
    """
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if not child:
            _become(words, folder, printed.fileno())
        _, status, usage = os.wait4(child, 0)
        printed.seek(0)
        content = printed.read()
    return (
        os.waitstatus_to_exitcode(status),
        content,
        usage.ru_maxrss / 1024,
        usage.ru_utime + usage.ru_stime,
    )


def _become(words: Sequence[str], folder: Path, printed: int) -> None:
    """Be the command, which forks a worker as always."""
    try:
        os.setpgid(0, 0)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for stream in (1, 2):
            os.dup2(printed, stream)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        signal.alarm(2 * SECONDS)
        os.chdir(folder)
        os.environ["TOKEN"] = SECRET
        from mars_asp import cli

        sys.stdout = os.fdopen(os.dup(1), "w", encoding="utf-8", errors="backslashreplace")
        sys.stderr = os.fdopen(os.dup(2), "w", encoding="utf-8", errors="backslashreplace")
        status = cli.run_command([word.replace("\0", "") for word in words])
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    except BaseException as error:
        os.write(2, f"Traceback: {error!r}".encode(errors="replace"))
        os._exit(99)


def main() -> int:
    """Run as many commands as the command line requests."""
    number, first = [*map(int, sys.argv[1:]), *(1000, 0)[len(sys.argv) - 1 :]][:2]
    began = time.monotonic()
    wrong: list[str] = []
    for seed in range(first, first + number):
        for each in hostile(seed):
            wrong.append(each)
            print(each, flush=True)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    spent = time.monotonic() - began
    print(f"{number} commands, {len(wrong)} faults, {spent:.0f} s, at most {peak:.0f} MB")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
