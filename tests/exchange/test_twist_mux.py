"""Parameters of muxes: files with what they say beside them, and files that are refused."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.exchange.twist_mux import import_twist_mux
from mars_asp.language import Parsed
from mars_asp.model.declarations import Control
from tests.support.documents import ROOT

FOLDER = ROOT / "tests" / "twist_mux"
FILES = sorted(FOLDER.glob("*.yaml"))


def place(d: Diagnostic) -> str:
    return f"{d.span.line}:{d.span.column}: {d.severity}: {d.message}"


def said(found: Parsed) -> Iterator[str]:
    """What a file says: the muxes, a line for each of their inputs, and what is noteworthy."""
    for mux in found.configuration.muxes:
        yield f"{mux.span.line}:{mux.span.column}: {mux.engine} before {mux.module}"
    for line in found.configuration.relationships:
        assert isinstance(line, Control)
        at = f"{line.span.line}:{line.span.column}"
        yield f"{at}: {line.controlled} < {line.controller} {line.priority} {line.hold_ms}"
    yield from map(place, found.warnings)


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_each_file_says_what_stands_beside_it(file: Path, update_golden: bool) -> None:
    text = file.read_text(encoding="utf-8")
    found = "\n".join(said(import_twist_mux(text, file.name))) + "\n"
    golden = file.with_suffix(".txt")
    if update_golden:
        golden.write_text(found, encoding="utf-8")
    assert golden.read_text(encoding="utf-8") == found


INPUT = "{topic: t, timeout: 0.5, priority: 1}"
MUX = "m:\n  ros__parameters:\n    topics:\n      a: "
NO_MUX = "1:1: error: the file has no mux: neither `topics` nor `subscribers` with an input"
#: A text, and all that is wrong with it.
REFUSED = [
    ("", ["1:1: error: the file is empty"]),
    ("a: 1\n", [NO_MUX]),
    ("topics:\n", [NO_MUX]),
    ("topics: 3\n", ["1:9: error: `topics` is no map of inputs"]),
    ("topics: [3]\n", ["1:10: error: an input of the list is no map"]),
    ("topics:\n- topic: t\n", ["2:3: error: an input of the list has no name"]),
    (
        "topics:\n- {name: a}\n- {name: a}\n",
        [
            "2:10: error: input `a` has no `topic` and no `timeout` and no `priority`",
            "3:10: error: input `a` has no `topic` and no `timeout` and no `priority`",
            "3:10: error: two inputs are named `a`",
        ],
    ),
    (
        MUX + "{topic: 5, timeout: '1', priority: 1.0}\n",
        [
            "4:18: error: the topic of `a` is `5`, not the name of a topic",
            "4:30: error: the timeout of `a` is the text `1`, not a number of seconds",
            "4:45: error: the priority of `a` is `1.0`, not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: , timeout: [], priority: {}}\n",
        [
            "4:17: error: the topic of `a` is nothing, not the name of a topic",
            "4:29: error: the timeout of `a` is a list, not a number of seconds",
            "4:43: error: the priority of `a` is a map, not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: t, timeout: -1, priority: 2147483648}\n",
        [
            "4:30: error: the timeout of `a` is `-1`,"
            " not a number of seconds from 0 to 2147483.647",
            "4:44: error: the priority of `a` is `2147483648`,"
            " not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: t, timeout: 1e999999999, priority: 010}\n",
        [
            "4:30: error: the timeout of `a` is `1e999999999`,"
            " not a number of seconds from 0 to 2147483.647",
            "4:53: error: the priority of `a` is `010`, not a whole number from 0 to 2147483647",
        ],
    ),
    (MUX + "3\n", ["4:10: error: input `a` is no map"]),
    (
        f"{MUX}{INPUT}\n      a: {INPUT}\n",
        ["5:7: error: `a` stands twice in one map"],
    ),
    (
        f"{MUX}{INPUT}\n    topics.a.topic: b\n",
        ["5:5: error: `topic` of `a` stands twice"],
    ),
    (
        "m:\n  ros__parameters:\n    topics:\n    - {name: a}\n",
        ["3:5: error: `topics` is a list under `ros__parameters`, which ROS 2 cannot read as"
         " parameters"],
    ),
    (
        "m:\n  ros__parameters:\n  - topics:\n",
        ["2:3: error: `ros__parameters` holds a list, which ROS 2 cannot read as parameters"],
    ),
    (f"topics: {{cmd_vel_out: {INPUT}}}\n",
     ["1:10: error: `cmd_vel_out` is the name of two things"]),
    ("topics:\n\t- name: a\n",
     ["2:1: error: this is not YAML: found character '\\t' that cannot start any token"]),
    ("topics: [\n",
     ["2:1: error: this is not YAML: expected the node content, but found '<stream end>'"]),
    ("a: *b\n", ["1:4: error: alias `*b` stands for nothing that is complete"]),
    ("a: &b [*b]\n", ["1:8: error: alias `*b` stands for nothing that is complete"]),
    ("a: !!python/object/apply:os.system [ls]\n",
     ["1:4: error: tag `tag:yaml.org,2002:python/object/apply:os.system` is not read"]),
    ("--- {}\n--- {}\n", ["2:1: error: a second document begins here"]),
    ("a: 1\nb: \0\n", ["2:4: error: character U+0000 cannot stand in YAML"]),
    ("[a]: 1\n", ["1:1: error: a key is a list or a map"]),
    ("<<: 1\n", ["1:5: error: `<<` merges what is no map"]),
    ("topics: " + "[" * 100_000, ["1:72: error: lists and maps are nested deeper than 64"]),
    (
        "a0: &a0 [x]\n"
        + "\n".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 9)),
        ["6:45: error: with its aliases the file has more than 100000 nodes"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "wrong"), REFUSED, ids=lambda value: str(value)[:30])
def test_each_file_that_is_refused_says_all_that_is_wrong(text: str, wrong: list[str]) -> None:
    with pytest.raises(MarsError) as caught:
        import_twist_mux(text, "m.yaml")
    assert [place(d) for d in caught.value.diagnostics] == wrong
    assert all(d.help for d in caught.value.diagnostics)
