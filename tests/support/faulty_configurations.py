"""Random robots with faults in them, laid out as people lay them out.

Lists over several lines, comments, controllers in lists, module blocks before and after the body,
annotated sources in other languages, line ends of Windows.
"""

import random
from dataclasses import dataclass, field

MODES = ("NotifyWhenReady", "NotifyAtFrequency {}", "RequestWhenReady", "NotifyOnMax(80)")
TYPES = ("Image", "Echoes", "geo::Pose", "Lines", "Cloud")
FUNCTIONS = ("Trans_Z", "Rotn_Y", "Trans_X")


@dataclass
class Robot:
    """A configuration and its sources by file name, and the kind of each module."""

    rng: random.Random
    kinds: dict[str, str] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)

    def of(self, *kinds: str) -> str:
        """Return a module of one of some kinds."""
        return self.rng.choice([name for name, kind in self.kinds.items() if kind in kinds])


def faulty_configuration(seed: int) -> dict[str, bytes]:
    """Return the files of a robot with faults; `robot.mars` is the configuration."""
    rng = random.Random(seed)
    robot = Robot(rng)
    for kind, most in (
        ("Sensor", 4),
        ("Filter", 3),
        ("Sink", 2),
        ("Control", 5),
        ("Wheel", 3),
        ("Bare", 2),
    ):
        for number in range(rng.randint(1, most)):
            robot.kinds[f"{kind}{chr(65 + number)}"] = kind
    _data(robot)
    _control(robot)
    _mounts(robot)
    for fault in rng.sample(_FAULTS, rng.randint(1, 3)):
        fault(robot)
    return _files(robot)


def _data(robot: Robot) -> None:
    rng = robot.rng
    for name, kind in robot.kinds.items():
        if kind in ("Filter", "Sink", "Control", "Bare") and rng.random() < 0.8:
            source = robot.of("Sensor", "Filter")
            if source != name:
                mode = rng.choice(("", "", " NotifyAtFrequency 5", " RequestWhenReady"))
                robot.lines.append(f"{name} uses_data_from {source}{mode}")


def _control(robot: Robot) -> None:
    rng = robot.rng
    controllers = [name for name, kind in robot.kinds.items() if kind == "Control"]
    for name, kind in robot.kinds.items():
        if kind != "Wheel":
            continue
        chosen = rng.sample(controllers, rng.randint(1, len(controllers)))
        if len(chosen) > 1 and rng.random() < 0.5:
            robot.lines.append(f"{name} is_controlled_by {_listed(rng, chosen)}")
            if rng.random() < 0.3:
                other = rng.choice(controllers)
                robot.lines.append(f"{name} is_controlled_by {other} {rng.randint(0, 3)}")
            continue
        base = rng.choice((0, 0, 0, 3, 2147483647 - len(chosen) + 1))
        numbers = rng.sample(range(len(chosen)), len(chosen))
        for controller, number in zip(chosen, numbers, strict=True):
            hold = rng.choice(("", "", " hold 500"))
            robot.lines.append(f"{name} is_controlled_by {controller} {base + number}{hold}")


def _listed(rng: random.Random, names: list[str]) -> str:
    """Return a list of controllers, on one line or several, with comments."""
    if rng.random() < 0.5:
        return ", ".join(names)
    comments = (f",  // {name} goes here" if rng.random() < 0.6 else "," for name in names)
    pieces = [f"{name}{comment}" for name, comment in zip(names, comments, strict=True)]
    pieces[-1] = names[-1] + rng.choice(("", "  # the last one"))
    return "\n    ".join(pieces)


def _mounts(robot: Robot) -> None:
    rng = robot.rng
    for name, kind in robot.kinds.items():
        if kind == "Sensor" and rng.random() < 0.4:
            robot.lines.append(
                f"{name} is_mounted_on {robot.of('Wheel', 'Bare')} {rng.randint(0, 2)}"
            )


def _misspelt(robot: Robot) -> None:
    at = robot.rng.randrange(len(robot.lines))
    words = robot.lines[at].split(" ")
    place = robot.rng.choice([n for n, word in enumerate(words) if word in robot.kinds] or [0])
    words[place] = words[place][:-2] + "x" + words[place][-2:]
    robot.lines[at] = " ".join(words)


def _undeclared(robot: Robot) -> None:
    robot.lines.append(f"{robot.of('Sink', 'Filter')} uses_data_from Stranger99  // who is it")


def _unused(robot: Robot) -> None:
    robot.kinds["Idle"] = "Bare"
    robot.kinds["Spare"] = "Sensor"


def _tie(robot: Robot) -> None:
    for at, line in enumerate(robot.lines):
        words = line.split(" ")
        if " is_controlled_by " in line and len(words) > 3 and words[3].isdigit():
            words[3] = robot.rng.choice(("0", "1", "2147483647"))
            robot.lines[at] = " ".join(words)


def _missing_priority(robot: Robot) -> None:
    for at, line in enumerate(robot.lines):
        words = line.split(" ")
        if (
            " is_controlled_by " in line
            and len(words) == 4
            and "," not in line
            and robot.rng.random() < 0.7
        ):
            robot.lines[at] = " ".join(words[:3])


def _twice(robot: Robot) -> None:
    robot.lines.append(robot.rng.choice(robot.lines))


def _cycle(robot: Robot) -> None:
    names = [name for name, kind in robot.kinds.items() if kind == "Control"]
    robot.rng.shuffle(names)
    for first, second in zip(names, [*names[1:], names[0]], strict=True):
        robot.lines.append(f"{first} is_controlled_by {second}")
    if robot.rng.random() < 0.5:
        robot.lines.append(f"{names[0]} is_controlled_by {names[0]}")


def _data_cycle(robot: Robot) -> None:
    names = [name for name, kind in robot.kinds.items() if kind == "Filter"]
    for first, second in zip(names, [*names[1:], names[0]], strict=True):
        robot.lines.append(f"{first} uses_data_from {second}")


def _crowd(robot: Robot) -> None:
    base = robot.of("Bare", "Wheel")
    vertex = robot.rng.choice((1, 2, 2147483647))
    for name in [name for name, kind in robot.kinds.items() if kind == "Sensor"][:3]:
        robot.lines.append(f"{name} is_mounted_on {base} {vertex} (y,90,_,_,0,0,100)  // tight")


def _mount_cycle(robot: Robot) -> None:
    first, second = robot.of("Wheel"), robot.of("Bare")
    robot.lines += [f"{first} is_mounted_on {second}", f"{second} is_mounted_on {first}"]


def _wrong_class(robot: Robot) -> None:
    if robot.rng.random() < 0.5:
        robot.lines.append(f"{robot.of('Sink', 'Control')} uses_data_from {robot.of('Wheel')}")
    else:
        robot.lines.append(f"{robot.of('Wheel')} is_controlled_by {robot.of('Sensor', 'Filter')}")


def _reversed(robot: Robot) -> None:
    if robot.rng.random() < 0.5:
        robot.lines.append(f"{robot.of('Control')} is_controlled_by {robot.of('Wheel')}")
    else:
        robot.lines.append(f"{robot.of('Sensor')} uses_data_from {robot.of('Sink', 'Filter')}")


def _stuck(robot: Robot) -> None:
    robot.lines.append(f"{robot.of('Sink', 'Bare')} is_controlled_by {robot.of('Control')}")


def _infeasible(robot: Robot) -> None:
    client, source = robot.of("Sink", "Control"), robot.of("Sensor", "Filter")
    mode = robot.rng.choice(
        ("NotifyAtFrequency 2000", "NotifyWhenReady", "NotifyOnMin(3)", "NotifyAtFrequency")
    )
    robot.lines.append(f"{client} uses_data_from {source} {mode}  # as fast as it goes")


_FAULTS = (
    _misspelt,
    _undeclared,
    _unused,
    _tie,
    _missing_priority,
    _twice,
    _cycle,
    _data_cycle,
    _crowd,
    _mount_cycle,
    _wrong_class,
    _reversed,
    _stuck,
    _infeasible,
)


def _files(robot: Robot) -> dict[str, bytes]:
    rng = robot.rng
    described = [name for name in robot.kinds if rng.random() < 0.85]
    end = rng.choice(("\n", "\n", "\r\n"))
    files = {}
    blocks: list[str] = []
    cpp: list[str] = []
    python: list[str] = []
    for name in described:
        group = rng.choice((blocks, blocks, cpp, python))
        group.append(name)
    header = [f"@configuration{rng.choice(('', ' flat', ' flat period 50', ' hierarchical'))}"]
    if "hierarchical" not in header[0] and rng.random() < 0.5:
        header = ["@configuration hierarchical  // one wins"]
    sources = []
    if cpp:
        files["src/parts.cpp"] = _text(_cpp(robot, cpp), rng.choice(("\n", "\r\n")))
        sources.append("src/parts.cpp")
    if python:
        files["src/parts.py"] = _text(_python(robot, python), "\n")
        sources.append("src/parts.py")
    header += [f"@sources {', '.join(sources)}"] if sources else []
    names = [name for name in robot.kinds if rng.random() < 0.97 or name in described]
    if rng.random() < 0.5:
        header.append(f"@modules {', '.join(names)}  // all of them")
    else:
        header += ["@modules " + ",  // and\n    ".join(names), ""]
    lines = robot.lines.copy()
    if rng.random() < 0.5:
        rng.shuffle(lines)
    text = [part for line in lines for part in line.split("\n")]
    written = [line for name in blocks for line in _block(robot, name)]
    body = [*header, *text]
    whole = [*written, "", *body] if rng.random() < 0.3 else [*body, "", *written]
    files["robot.mars"] = _text("\n".join(whole).split("\n"), end, last=rng.random() < 0.8)
    return files


def _text(lines: list[str], end: str, *, last: bool = True) -> bytes:
    return (end.join(lines) + (end if last else "")).encode()


def _annotations(robot: Robot, name: str) -> tuple[list[str], list[str], str]:
    """Return a module's functions, the annotations of its function, and that in C++."""
    rng, kind = robot.rng, robot.kinds[name]
    takes, gives = rng.choice(TYPES), rng.choice(TYPES)
    mode = rng.choice(MODES).format(rng.choice((10, 25, "12.5")))
    match kind:
        case "Sensor":
            return [], [f"@Sense {mode}"], f"{gives} sense();"
        case "Filter":
            more = rng.choice((takes, f"{takes} first, {rng.choice(TYPES)}"))
            return [], [f"@DataOut {mode}"], f"{gives} filter({more} in);"
        case "Sink":
            return [], ["@DataIn"], f"void show({takes} in);"
        case "Control":
            functions = rng.choice(("", "", " Trans_Z", " Trans_Z, Rotn_Y"))
            return [], [f"@ControlOut{functions}"], f"Command decide({takes} in);"
        case "Wheel":
            return [f"@{rng.choice(FUNCTIONS)}{rng.choice(('', ' -90 90 30'))}"], [], ""
        case _:
            return [], [], rng.choice(("", "void run();", "Image picture();"))


def _block(robot: Robot, name: str) -> list[str]:
    functions, services, declaration = _annotations(robot, name)
    body = [*functions, *services, *([declaration] if declaration else [])]
    return ["@module_start", f"@module_name {name}", *body, "@module_end", ""]


def _cpp(robot: Robot, names: list[str]) -> list[str]:
    lines = ["#include <robot.h>", ""]
    for name in names:
        functions, services, declaration = _annotations(robot, name)
        style = robot.rng.choice(("//", "///", "block", "each"))
        marks = ["@module_start", f"@module_name {name}", *functions]
        if style == "block":
            lines += ["/*", *(f" * {mark}" for mark in marks), " */"]
            lines += [f"/* {mark} -- as measured */" for mark in services]
        elif style == "each":
            lines += [f"/* {mark} */" for mark in (*marks, *services)]
        else:
            lines += [f"{style} {mark}" for mark in (*marks, *services)]
        lines += [f"  {declaration}"] if declaration else ["int unrelated = 0;"]
        lines += ["// @module_end", ""]
    return lines


def _python(robot: Robot, names: list[str]) -> list[str]:
    lines = ['"""Parts of a robot."""', ""]
    for name in names:
        functions, services, declaration = _annotations(robot, name)
        lines += ["# @module_start", f"# @module_name {name}", *(f"# {f}" for f in functions)]
        lines += [f"# {mark}" for mark in services]
        if declaration:
            kind, _, rest = declaration.partition(" ")
            inside = rest[rest.index("(") + 1 : rest.index(")")]
            hints = []
            for number, part in enumerate(filter(None, inside.split(", "))):
                hints.append(f"in{number}: '{part.split(' ')[0].replace('::', '.')}'")
            shown = "None" if kind == "void" else f"'{kind.replace('::', '.')}'"
            lines += [f"def {rest[: rest.index('(')]}({', '.join(hints)}) -> {shown}:", "    ..."]
        lines += ["# @module_end", ""]
    return lines
