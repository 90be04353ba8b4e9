"""Controllers of ros2_control, which spawners load into a manager as nodes of its process.

How spawners are called: controller_manager/controller_manager/spawner.py of
https://github.com/ros-controls/ros2_control.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeAlias

from mars_asp.exchange.ros2.launch import Started
from mars_asp.exchange.ros2.names import Renaming, joined
from mars_asp.exchange.ros2.parameters import GivenParameter
from mars_asp.exchange.unread import Unread

Values: TypeAlias = Callable[[Started, str], Mapping[str, GivenParameter]]

_PACKAGE = "controller_manager"
#: Programs that run the controllers which spawners load.
MANAGERS = frozenset({"ros2_control_node"})
_SPAWNERS = frozenset({"spawner", "spawner.py"})
#: Options of spawners that a value follows, by their names for us.
_VALUES = {
    "-c": "manager",
    "--controller-manager": "manager",
    "-p": "file",
    "--param-file": "file",
    "-t": "type",
    "--controller-type": "type",
    "-n": "",
    "--namespace": "",
    "--controller-manager-timeout": "",
    "--switch-timeout": "",
    # What the command line asks for, where a spawner always makes a controller active.
    "--set-state": "",
    "--service-call-timeout": "",
}


@dataclass(frozen=True, slots=True)
class _Spawned:
    """The arguments of a spawner: controllers, the full name of their manager, and more.

    `type` is empty where parameters give it; `files` are paths as they are written.
    """

    controllers: tuple[str, ...]
    manager: str
    type: str = ""
    files: tuple[str, ...] = ()
    remaps: tuple[Renaming, ...] = ()


def with_controllers(
    started: Sequence[Started],
    values: Values,
    find: Callable[[str], Path | None],
    *,
    is_part: bool = False,
) -> Iterator[Started | Unread]:
    """Yield the started nodes, with controllers in place of their spawners.

    A spawner whose manager is started elsewhere stays, as the manager's parameters are unknown.

    Args:
        started: All started nodes of a robot.
        values: A function from a started node and its full name to the values of its parameters.
        find: A function from a path to its file in the workspace, or to None.
        is_part: Whether these are only a part of a robot, so that a manager elsewhere counts as
            one without parameters and remappings.
    """
    managers = {
        joined(each.namespace, each.name or _PACKAGE): each
        for each in started
        if each.package == _PACKAGE and each.executable in MANAGERS
    }
    for each in started:
        spawned = _spawned_by(each)
        manager = None if spawned is None else managers.get(spawned.manager)
        if spawned is not None and manager is None and is_part:
            namespace = spawned.manager.rpartition("/")[0] or "/"
            manager = replace(each, namespace=namespace, name="", remaps=(), parameters={})
        if spawned is None or manager is None:
            yield each
            continue
        files = tuple(filter(None, map(find, spawned.files)))
        manager_values = values(replace(manager, files=(*manager.files, *files)), spawned.manager)
        for name in spawned.controllers:
            controller = _controller(name, each, manager, spawned, files)
            own = values(controller, joined(manager.namespace, name))
            given = manager_values.get(f"{name}.type") or own.get("type")
            kind = spawned.type or (given.text if given else "")
            if kind:
                yield replace(controller, package=kind.partition("/")[0], executable=kind)
            else:
                yield Unread("controllers whose type no parameter gives", name, each.span)


def _spawned_by(started: Started) -> _Spawned | None:
    """Return the arguments of a spawner, or None if the node is not one."""
    if started.package != _PACKAGE or started.executable not in _SPAWNERS:
        return None
    given: dict[str, list[str]] = {}
    remaps: list[Renaming] = []
    words = iter(started.arguments)
    for word in words:
        option, sign, value = word.partition("=")
        if word == "--ros-args":
            break
        if ":=" in word:
            # `--controller-ros-args` takes one word with all of them.
            for each in word.split():
                source, is_rule, target = each.partition(":=")
                if is_rule:
                    remaps.append((source, target))
        elif not word.startswith("-"):
            given.setdefault("controllers", []).append(word)
        elif option in _VALUES:
            given.setdefault(_VALUES[option], []).append(value if sign else next(words, ""))
    return _Spawned(
        tuple(filter(None, given.get("controllers", ()))),
        joined(started.namespace, given.get("manager", [_PACKAGE])[-1]),
        given.get("type", [""])[-1],
        tuple(given.get("file", ())),
        tuple(remaps),
    )


def _controller(
    name: str, spawner: Started, manager: Started, spawned: _Spawned, files: Sequence[Path]
) -> Started:
    """Return the node of a controller, still without its type; it is renamed as its manager is."""
    return replace(
        manager,
        plugin=True,
        name=name,
        # What a controller is given itself comes before what its process is.
        remaps=(*spawned.remaps, *manager.remaps),
        spans={**manager.spans, **dict.fromkeys(spawned.remaps, spawner.span)},
        files=(*manager.files, *files),
        # A launch file gives parameters to a node of a name, else to the whole process.
        parameters={} if manager.name else manager.parameters,
        span=spawner.span,
        conditions=(*manager.conditions, *spawner.conditions),
        arguments=(),
    )
