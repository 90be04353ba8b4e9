"""The output of every command for a file, searched for forbidden words and forms.

    python -m tests.support.every_output EACH FILE_OR_FOLDER...

prints forbidden text in the output of every command for the files and the files of folders, each
sentence once, then the number of outputs and the lengths of single answers of `explain`. Only every
EACH-th question about an absent consequence is run.

Every command that takes a `.mars` file gets it; it is compared with the next one in its folder, and
run in each scenario of its folder. The same holds for the robot of a foreign file, which is also
imported but not formatted. `import` reads `.urdf` files, `rules lint` reads `.lp` files, and
`extract` reads all other files.

Single answers are counted as standard output has them, without the messages beside them.

Of `facts`, `fmt`, `export`, `import` and `extract` only messages are read: their standard output is
text for programs, or the user's own. For the same reason `rules list` and `rules show` are left
out, and quotations in messages about rules. An error in a heading such as `@module_start` names it.
"""

import io
import os
import re
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from mars_asp.cli import run_here
from mars_asp.cli.arguments import VERBS
from mars_asp.diagnostic import MarsError
from mars_asp.exchange.foreign import ForeignFile, read_foreign
from mars_asp.exchange.recognise import recognised
from mars_asp.language import parse_text
from mars_asp.model.declarations import MOTION_FUNCTIONS, NODE_NAMES
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.rules import load_rulebook
from tests.support.documents import ROOT
from tests.support.forbidden import HEADING, forbidden_in, wider_than

WIDTH = 80
SCENARIO = ROOT / "examples" / "level1" / "scenario.toml"
#: What prints a file or a table, the lines of which are as long as they are.
_UNBROKEN = ("synthesise", "draw", "extract")
#: What prints text for programs, or the user's own: of these only messages are read.
_MESSAGES_ALONE = ("facts", "fmt", "export", "import", "extract")
#: A single answer has so many lines at most, but for one of twenty.
MOST_LINES = 12

#: Files of others that may be a robot, by the ends of their names, as a launch file in Python may.
_OTHERS = (".yaml", ".yml", ".dot", ".xml", ".launch")
#: What is asked about of the files in a folder, by the ends of their names.
_READ = (".mars", ".urdf", ".lp", ".cpp", ".c", ".hpp", ".py", ".go", ".m", *_OTHERS)

Command = tuple[Sequence[str], str]


class Printed(NamedTuple):
    """The messages of a command on standard error, and its standard output."""

    messages: str
    output: str

    @property
    def text(self) -> str:
        """Return the messages, then the standard output."""
        return self.messages + self.output


def printed(words: Sequence[str], given: str = "") -> Printed:
    """Run a command in this folder with a text as standard input; return its output."""
    messages, output, before = io.StringIO(), io.StringIO(), sys.stdin
    sys.stdin = io.TextIOWrapper(io.BytesIO(given.encode()))
    try:
        with redirect_stdout(output), redirect_stderr(messages):
            run_here(words)
    except SystemExit:
        pass
    finally:
        sys.stdin = before
    return Printed(messages.getvalue(), "" if words[0] in _MESSAGES_ALONE else output.getvalue())


def helps() -> Iterator[Command]:
    """Yield the commands that print help, and some that are called wrongly."""
    yield ["--help"], ""
    yield ["explian"], ""
    for verb in VERBS:
        yield [verb, "--help"], ""
        yield [verb, "--colour", "always"], ""


def of_rules() -> Iterator[Command]:
    """Yield the commands about all rules, and one that tries cases of them."""
    yield ["rules", "lint"], ""
    yield ["rules", "show", "data/divergance"], ""
    yield ["test", os.path.relpath(ROOT / "tests" / "rules" / "can")], ""


def of_file(path: Path, each: int) -> Iterator[Command]:
    """Yield commands about a file in its folder: of a `.mars` file with every n-th question."""
    name = path.name
    format = _foreign(path)
    if path.suffix == ".mars":
        yield from of_whole_files(name)
        yield from questions(name, each)
    elif format != "mars":
        yield ["import", format, name], ""
        yield from of_whole_files(name)
        yield from questions(name, each)
    elif path.suffix == ".urdf":
        yield ["import", "urdf", name], ""
    elif path.suffix == ".lp":
        yield ["rules", "lint", name], ""
    elif path.suffix not in _OTHERS:
        yield ["extract", name], ""


def _foreign(path: Path) -> str:
    """Return the format of a robot of others, `mars` where a file is none."""
    if path.suffix not in (*_OTHERS, ".py"):
        return "mars"
    return recognised(path.read_text(encoding="utf-8", errors="replace"))


def of_whole_files(name: str) -> Iterator[Command]:
    """Yield commands about a file as a whole, the specification and files like it among them."""
    for verb in ("check", "analyse", "synthesise", "explain"):
        yield [verb, name], ""
    for options in ("--depth all --all", "--places", "--repair", "--alternatives"):
        yield ["explain", name, *options.split()], ""
    for form in ("mmd", "svg"):
        yield ["draw", name, "-o", "-", "--as", form], ""
    for options in ("--dry-run", "--why --explain --duration 2"):
        yield ["run", name, "--scenario", os.path.relpath(SCENARIO), *options.split()], ""
    for scenario in sorted(Path().glob("*.toml")):
        yield ["run", name, "--scenario", scenario.name, "--why", "--explain"], ""
    yield ["facts", name], ""
    yield ["fmt", "--check", name], ""
    yield ["export", "urdf", name], ""
    alike = sorted(Path().glob(f"*{Path(name).suffix}"))
    for other in [each.name for each in alike if each.name > name][:1]:
        yield ["diff", name, other], ""
    specification = printed(["synthesise", name, "--quiet"]).output
    yield ["verify", "-", name], specification
    for text in _shortened(specification):
        yield ["verify", "-", name], text
    for text in _shortened(Path(name).read_text(encoding="utf-8", errors="replace")):
        yield ["diff", name, "-"], text
        yield ["check", "-"], text


def _shortened(text: str) -> Iterator[str]:
    """Yield a text without each of its first lines that relate, and with one of them twice."""
    lines = text.splitlines(keepends=True)
    related = [number for number, line in enumerate(lines) if line[:1].isupper()]
    for number in related[:: max(1, len(related) // 4)]:
        yield "".join([*lines[:number], *lines[number + 1 :]])
    for number in related[:1]:
        yield "".join([*lines[: number + 1], *lines[number:]])


def questions(name: str, each: int = 1) -> Iterator[Command]:
    """Yield questions about each name in a file, and every n-th about absent consequences."""
    found = printed(["explain", name]).output
    for line in found.split("\n"):
        if line[:1].isalpha() and ":" in line:
            subject = line.partition(":")[0].partition(",")[0]
            yield ["explain", name, subject], ""
            if subject.isalnum():
                yield ["verify", "--without", subject, name], ""
    try:
        text = Path(name).read_text(encoding="utf-8")
        format = _foreign(Path(name))
        ours = format == "mars"
        parsed = parse_text(text, name) if ours else read_foreign([ForeignFile(name, text, format)])
        modules = [module.text for module in parsed.configuration.modules]
    except (MarsError, UnicodeDecodeError):
        return
    kinds = [*NODE_NAMES.values(), *sorted(consequence_kinds(load_rulebook()))]
    queries = [f"{kind}({module})" for module in modules for kind in kinds]
    for module in modules[::each]:
        yield ["explain", name, module], ""
        yield ["explain", name, module, "--repair"], ""
        yield ["can", name, f"{MOTION_FUNCTIONS[len(module) % 6]} of {module}"], ""
    for atom in queries[len(name) % each :: each]:
        yield ["explain", name, "--why-not", atom], ""


def answers(words: Sequence[str], output: str) -> Sequence[str]:
    """Return the single answers in the output of a command; a module has one for each topic."""
    if words[0] != "explain" or len(words) < 3 or not output:
        return ()
    if words[2] == "--why-not":
        return (output.strip(),)
    if words[2].startswith("-") or "--repair" in words:
        return ()
    return output.strip().split("\n\n")


_HEAD = re.compile(r"(?m)^\S+:\d+:\d+: .*$")


def wrong_in(words: Sequence[str], output: str) -> Iterator[str]:
    """Yield forbidden text in the output of a command.

    Of a diagram only labels are read, of messages about rules only unquoted text.
    """
    read = output
    if words[0] == "draw":
        read = "\n".join(re.findall(r"[>\[]\"?([^<>\[\]\"]+)\"?[<\]]", output))
    elif words[0] == "synthesise":
        read = "\n".join(line for line in output.split("\n") if "//" in line or ": " in line)
    elif words[0] == "rules":
        read = re.sub(r"`[^`]*`", "``", re.sub(r"^ *\d+ \| .*$", "", output, flags=re.MULTILINE))
    for wrong in forbidden_in(read):
        if not (words[0] == "extract" and wrong.startswith(HEADING)):
            yield wrong
    if words[0] not in _UNBROKEN:
        # The head of a finding is one line that programs can read.
        yield from wider_than(WIDTH, _HEAD.sub("", output) if words[0] == "check" else output)


def main(words: Sequence[str]) -> int:
    """Check the output of every command for files; return whether any of it is forbidden."""
    each = int(words[0])
    paths = [path for name in words[1:] for path in _files(Path(name).resolve())]
    outputs = 0
    lengths: Counter[int] = Counter()
    seen: set[str] = set()
    for path in paths:
        os.chdir(path.parent)
        commands = of_file(path, each)
        for command, given in commands if outputs else chain(helps(), of_rules(), commands):
            found = printed(command, given)
            outputs += 1
            lengths.update(len(each.split("\n")) for each in answers(command, found.output))
            for wrong in wrong_in(command, found.text):
                sentence = re.sub(r"`[^`]*`|\d+", "", wrong)
                if sentence not in seen:
                    seen.add(sentence)
                    print(f"{path}: mars-asp {' '.join(command)}: {wrong}", flush=True)
    single = lengths.total()
    long = sum(many for lines, many in lengths.items() if lines > MOST_LINES)
    print(f"{outputs} outputs of {len(paths)} files: {len(seen)} sentences hold what is forbidden")
    print(f"{single} single answers: {long} have more than {MOST_LINES} lines")
    return int(bool(seen) or long * 20 > single)


def _files(path: Path) -> Sequence[Path]:
    if not path.is_dir():
        return [path]
    return sorted(each for each in path.rglob("*") if each.suffix in _READ and each.is_file())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
