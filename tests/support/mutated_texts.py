"""Rule files, packs and cases with random changes: nothing but a refusal may come of them.

python -m tests.support.mutated_texts HOW_MANY FIRST_SEED

Texts are read in child processes, so that a crash is noticed. Endless grounding is stopped by a
timer, or by a limit on memory, as the command does it.
"""

import functools
import os
import random
import re
import resource
import signal
import sys
import time
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

from mars_asp.asp.cases import find_cases
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.cli.diagnostic_text import diagnostic_text
from mars_asp.diagnostic import MarsError, point
from mars_asp.reasoning import rules as built_in
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.cases import run_case
from mars_asp.reasoning.rules import load_rulebook
from tests.support.documents import ROOT
from tests.support.random_packs import random_pack

#: So many texts are read by one child, each for so many seconds at most.
BATCH, SECONDS = 500, 2.0
_MEMORY = 2 * 1024**3
#: Our own rules that the texts are grounded with: all of them would take most of the time.
_KEPT = "rules/vocabulary.lp"
_LONGEST = 240
_WORD = re.compile(r'"[^"\n]*"|[\w\']+|\W')
_TOKENS = (
    *". .. , ; : :- :~ | ( ) [ ] { } @ & $ _ - + * ** / ~ ? ^ = != <".split(),
    *('"', "\\", "%", "%*", "*%", "\n", "\t", "\f", "\r", "\0", " "),
    *"2147483647 2147483648 -2147483648 0 1 -1 /-1 1/0 0xffffffff X _ 'x not #true #false".split(),
    *"#const #show #defined #minimize #maximize #sum #sum+ #count #min #inf #sup #project".split(),
    *"#program #include #script #external #theory #heuristic #edge @f(1) &a{} X+1 X*X 1..3".split(),
    *"consequence( participant( module( node( splitter( error note _said( p(X) q(1) X=1".split(),
    " :- module(M).\n",
    "\x85",
    "\u2028",
    "\ufeff",
    "ö",
    "机",
    "%= p(1)\n",
    "%! id: a/b\n",
    "%*! p(X) *%\n",
    "asp 1 0 0\n",
)


@functools.cache
def texts() -> tuple[str, ...]:
    """Return the texts to change: fragments of built-in rules, packs and cases."""
    rules = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "rules").rglob("*.lp"))]
    found = [part for text in rules for part in text.split("\n\n") if ":-" in part]
    found += [random_pack(seed).text for seed in range(200)]
    others = (*sorted((ROOT / "tests/packs").glob("*.lp")), *(ROOT / "examples").rglob("*.lp"))
    others += find_cases([ROOT / "tests/rules"])
    found += [path.read_bytes().decode("utf-8", errors="replace") for path in others]
    return tuple(map(_short, found))


def _short(text: str) -> str:
    """Return a text up to the end of a line that may end a statement."""
    return text if len(text) <= _LONGEST else text[: text.find(".\n", _LONGEST) + 2]


def mutated(seed: int) -> bytes:
    """Return a text with random changes."""
    rng = random.Random(seed)
    text = rng.choice(texts())
    for _ in range(rng.choice((1, 1, 1, 1, 2, 2, 3, 5))):
        text = _changed(text, rng)
    raw = bytearray(text.encode("utf-8", "surrogatepass"))
    if rng.random() < 0.1 and raw:
        raw[rng.randrange(len(raw))] = rng.randrange(256)
    return bytes(raw)


def _changed(text: str, rng: random.Random) -> str:
    words = [match.span() for match in _WORD.finditer(text)] or [(0, 0)]
    (at, near), (other, after) = sorted((rng.choice(words), rng.choice(words)))
    match rng.randrange(16):
        case 0:
            return text[:at] + text[near:]
        case 1:
            return text[:at] + text[at:near] * rng.choice((2, 3, 40)) + text[near:]
        case 2:
            return text[:at] + text[other:]
        case 3:
            return text[:at] + rng.choice(texts())[:200] + text[at:]
        case 4:
            sign = chr(rng.choice((rng.randrange(32), rng.randrange(0x3000))))
            return text[:at] + sign + text[near:]
        case 5 if rng.random() < 0.05:
            return text[:at] + rng.choice(_TOKENS) * rng.choice((300, 6000)) + text[at:]
        case 6 | 7 | 8:
            return text[:at] + text[other:after] + text[near:other] + text[at:near] + text[after:]
        case 9 | 10 | 11:
            return text[:at] + text[other:after] + text[near:]
    return text[:at] + rng.choice(_TOKENS) + text[rng.choice((at, near)) :]


@functools.cache
def _facts() -> tuple[Fact, ...]:
    here = point("c.mars", 1, 1)
    result = (
        Atom("module", ("A",)),
        Atom("module", ("B",)),
        Atom("uses_data_from", (1, "A", "B")),
        Atom("is_controlled_by", (2, "A", "B")),
        Atom("priority", (2, 7)),
        Atom("hold", (2, 2147483647)),
    )
    return tuple(Fact(atom, here) for atom in result)


def read(path: Path, own: Rulebook) -> str:
    """Read a text as a pack and as a case; return `taken` or `refused` for each."""
    became = []
    for use in (_as_pack, _as_case):
        try:
            use(path, own)
            became.append("taken")
        except MarsError as error:
            assert error.diagnostics
            for each in error.diagnostics:
                diagnostic_text(each).encode()
            became.append("refused")
    return " ".join(became)


def _as_pack(path: Path, own: Rulebook) -> None:
    book = load_rulebook([path], ())
    analyse(_facts(), book, point("c.mars", 1, 1))


def _as_case(path: Path, own: Rulebook) -> None:
    run_case(path, own)


def faults(first: int, count: int, seen: Counter[str]) -> Iterator[str]:
    """Yield the faults of texts, by their seeds; count the outcomes of the others in `seen`."""
    whole = load_rulebook(stages=())
    own_texts = [n for n, path in enumerate(whole.paths) if path == _KEPT]
    rules = tuple(rule for rule in whole.rules if rule.span.path == _KEPT)
    own = Rulebook(rules, tuple(whole.texts[n] for n in own_texts), paths=(_KEPT,))
    seal = built_in.seal()
    with (
        TemporaryDirectory() as folder,
        mock.patch.object(built_in, "_built_in", lambda *_: own),
        mock.patch.object(built_in, "seal", lambda: seal),
    ):
        begin, end = first, first + count
        while begin < end:
            begin = yield from _batch(range(begin, min(end, begin + BATCH)), own, folder, seen)


def _batch(
    seeds: Sequence[int], own: Rulebook, folder: str, seen: Counter[str]
) -> Generator[str, None, int]:
    """Read texts in a child, as far as it comes; return the seed to go on with."""
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        os.close(reader)
        _read_all(seeds, own, folder, writer)
    os.close(writer)
    with os.fdopen(reader, encoding="utf-8") as lines:
        entries = [line.rstrip("\n") for line in lines]
    _, status = os.waitpid(child, 0)
    done = [line for line in entries if not line.startswith("!")]
    seen.update(done)
    yield from (line[1:] for line in entries if line.startswith("!"))
    at = seeds[0] + len(entries)
    if os.WIFEXITED(status) and os.WEXITSTATUS(status) == 0:
        return at
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGPROF:
        seen["ended by the clock"] += 1
    else:
        yield f"{at}: the process ended, status {status}"
    return at + 1


def _read_all(seeds: Sequence[int], own: Rulebook, folder: str, writer: int) -> None:
    """Write the outcome of each text to `writer`; then end this process."""
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    path = Path(folder, "mine.lp")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    for seed in seeds:
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        try:
            path.write_bytes(mutated(seed))
            line = read(path, own)
        except MemoryError:
            line = "ended by the limit on memory"
        except BaseException as error:
            line = f"!{seed}: {error!r:.300}".replace("\n", " ")
        os.write(writer, f"{line}\n".encode())
    os._exit(0)


if __name__ == "__main__":
    how_many, first_seed = map(int, sys.argv[1:])
    began = time.process_time() + sum(os.times()[2:4])
    seen: Counter[str] = Counter()
    wrong = 0
    for each in faults(first_seed, how_many, seen):
        wrong += 1
        print(each, flush=True)
    used = time.process_time() + sum(os.times()[2:4]) - began
    print(
        f"{how_many} texts from seed {first_seed}: {wrong} faults, {used:.0f} s of processor time"
    )
    for became, times in seen.most_common():
        print(f"  {times:7} {became}")
