"""Repairs applied to the text by a program that reads only the JSON that `explain` prints.

    python -m tests.support.applied_repairs --seeds 1-300
    python -m tests.support.applied_repairs --seeds 1-300 --instances 2

Each repair of each random faulty configuration is written into a copy of its files, which
`analyse` then reads: the finding is gone, nothing new stops or warns that was not announced, and
each controller that ranked strictly above another still does. Of the package only the command line
is used. With `--instances` a file includes the configuration that often, each time as another part
of the robot: a repair of one part then edits all parts.
"""

import argparse
import contextlib
import io
import json
import re
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mars_asp.cli import run_here
from tests.support.faulty_configurations import faulty_configuration

_CONTROL = re.compile(r"\s*(\w+)\s+is_controlled_by\s+(.+)")
_MEMBER = re.compile(r"(\w+)\s*(\d+)?")


def result_of(*arguments: str) -> tuple[int, dict[str, Any], list[dict[str, Any]]]:
    """Return the status of a command, the JSON that it prints, and its diagnostics."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        status = run_here([*arguments, "--format", "json"])
    printed = out.getvalue()
    lines = [line for line in errors.getvalue().splitlines() if line.startswith("{")]
    return status, json.loads(printed) if printed else {}, [json.loads(line) for line in lines]


def applied(text: bytes, edits: Sequence[Mapping[str, Any]]) -> bytes:
    """Return a file with edits of its lines, which keep its line ends."""
    lines = re.split(r"(\r\n|\r|\n)", text.decode("utf-8-sig"))
    contents, ends = lines[::2], [*lines[1::2], ""]
    if contents[-1] == "" and len(contents) > 1:
        contents.pop()
    usual = next((end for end in ends if end), "\n")
    places: dict[int, list[str]] = {n: [line] for n, line in enumerate(contents, 1)}
    for edit in edits:
        if edit["old"] is not None:
            assert contents[edit["line"] - 1] == edit["old"], "`old` is the whole line"
            places[edit["line"]] = [] if edit["new"] is None else [edit["new"]]
    for edit in edits:
        if edit["old"] is None:
            new = edit["new"].split("\n")
            here = places[edit["line"]]
            assert edit["where"] in ("before", "behind")
            places[edit["line"]] = [*new, *here] if edit["where"] == "before" else [*here, *new]
    written = [line for number in sorted(places) for line in places[number]]
    return (usual.join(written) + usual).encode()


def name_of(consequence: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the kind and modules of a finding, which identify it in a later analysis."""
    return consequence["kind"], consequence["subject"], *consequence["participants"]


def ranks(text: str) -> dict[str, dict[str, int]]:
    """Return the declared priority of each controller of each module in a text."""
    text = re.sub(r"(?ms)^@module_start.*?^@module_end[^\n]*", "", text.replace("\r\n", "\n"))
    text = re.sub(r"(?://|#)[^\n]*", "", text)
    text = re.sub(r",\s+", ", ", text)
    found: dict[str, dict[str, int]] = {}
    for line in text.split("\n"):
        match = _CONTROL.match(line)
        if match is None:
            continue
        members = [member.strip() for member in match[2].split(",")]
        for place, member in enumerate(members):
            name, number = _MEMBER.match(member).groups()  # type: ignore[union-attr]
            declared = place if len(members) > 1 else int(number or 0)
            of = found.setdefault(match[1], {})
            of[name] = max(of.get(name, 0), declared)
    return found


def turned(before: dict[str, dict[str, int]], after: dict[str, dict[str, int]]) -> Iterator[str]:
    """Yield a line for each pair of controllers whose strict order is lost after a repair."""
    for module, numbers in before.items():
        now = after.get(module, {})
        for high, above in numbers.items():
            for low, below in numbers.items():
                if above > below and high in now and low in now and now[high] <= now[low]:
                    yield f"at {module} {high} was above {low}"


def included(files: Mapping[str, bytes], instances: int) -> dict[str, bytes]:
    """Return the files of a robot that includes a configuration several times."""
    body = files["robot.mars"]
    header = re.search(rb"(?m)^@configuration[^/\r\n]*", body)
    assert header is not None
    includes = [f"@include part.mars as part{number}" for number in range(instances)]
    main = "\n".join([header[0].decode(), *includes, ""])
    return {**files, "robot.mars": main.encode(), "part.mars": body}


def check_repairs(seed: int, folder: Path, instances: int = 0) -> tuple[int, int, list[str]]:
    """Return the numbers of findings and repairs of a random configuration, and the faults."""
    files = faulty_configuration(seed)
    body = "part.mars" if instances else "robot.mars"
    files = included(files, instances) if instances else files
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text)
    main = str(folder / "robot.mars")
    status, before, remarks = result_of("analyse", main)
    if status == 2:
        return 0, 0, [f"{seed}: not readable: {remarks}"]
    _, found, _ = result_of("explain", main, "--repair")
    wrong: list[str] = []
    tried = 0
    for repair in found["repairs"]:
        finding = repair["consequence"]
        for number, mend in enumerate(repair["repairs"], 1):
            tried += 1
            changed = {}
            for path in {line["path"] for line in mend["lines"]}:
                name = str(Path(path).relative_to(folder))
                edits = [line for line in mend["lines"] if line["path"] == path]
                changed[name] = applied(files[name], edits)
            for name, text in changed.items():
                (folder / name).write_bytes(text)
            label = f"{seed}: {name_of(finding)} repair {number}"
            wrong += [f"{label}: {each}" for each in _wrong(main, finding, mend, before, remarks)]
            unranked = any("unrank" in part for e in mend["edits"] for part in e["parts"])
            old, new = (ranks(side[body].decode()) for side in (files, {**files, **changed}))
            wrong += [f"{label}: {each}" for each in turned(old, new) if not unranked]
            for name in changed:
                (folder / name).write_bytes(files[name])
    return len(found["repairs"]), tried, wrong


def _wrong(
    main: str,
    finding: Mapping[str, Any],
    mend: Mapping[str, Any],
    before: Mapping[str, Any],
    remarks: Sequence[Mapping[str, Any]],
) -> Iterator[str]:
    status, after, new_remarks = result_of("analyse", main)
    if status == 2:
        yield f"does not parse: {new_remarks}"
        return
    had, has = (Counter(map(name_of, each["consequences"])) for each in (before, after))
    about = Counter((c["kind"], c["subject"]) for c in before["consequences"])
    left = Counter((c["kind"], c["subject"]) for c in after["consequences"])
    if left[finding["kind"], finding["subject"]] >= about[finding["kind"], finding["subject"]]:
        yield "the finding is still there"
    announced = {name_of(warning) for warning in mend["warnings"]}
    for consequence in after["consequences"]:
        name = name_of(consequence)
        if has[name] <= had[name] or consequence["severity"] == "note":
            continue
        if consequence["severity"] == "error":
            yield f"brings an error: {consequence['message']}"
        elif name not in announced:
            yield f"brings a warning that it did not announce: {consequence['message']}"
    entries = {warning["message"] for warning in mend["warnings"]}
    known = Counter((r["code"], r["message"]) for r in remarks)
    for remark in new_remarks:
        key = remark["code"], remark["message"]
        known[key] -= 1
        if known[key] < 0 and remark["severity"] != "note" and remark["message"] not in entries:
            yield f"brings a remark that it did not announce: {remark['message']}"


def main() -> int:
    """Check the repairs of many configurations; print each fault and the totals."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", default="1-300")
    parser.add_argument("--instances", type=int, default=0)
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    began = time.monotonic()
    findings = tried = failed = 0
    kinds = 0
    for seed in range(int(first), int(last or first) + 1):
        with tempfile.TemporaryDirectory() as folder:
            some, repairs, wrong = check_repairs(seed, Path(folder), options.instances)
        kinds += 1
        findings, tried, failed = findings + some, tried + repairs, failed + len(wrong)
        for line in wrong:
            print(line, flush=True)
    print(
        f"{kinds} configurations, {findings} findings, {tried} repairs: {failed} wrong;"
        f" {time.monotonic() - began:.0f} s"
    )
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
