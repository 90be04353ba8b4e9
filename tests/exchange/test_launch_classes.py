"""Launch files in Python that build their nodes by classes and helper functions of their own."""

import pytest

from mars_asp.exchange.ros2.read import import_ros2
from mars_asp.language import Parsed

START = """
from dataclasses import dataclass
from launch import LaunchDescription
from launch_ros.actions import Node

def eye(name, **more):
    return Node(package="v4l2_camera", executable="v4l2_camera_node", name=name, **more)

"""


def launched(text: str) -> Parsed:
    return import_ros2([(START + text.lstrip("\n"), "robot.launch.py")])


FACTORY = """
class Settings:
    side = 'left'
    def __init__(self, names):
        self.names = names
        self.first = self._first()
        self.paths = {{'a': self.first + '_a'}}
    def _first(self):
        return self.names[0]

class Base:
    def one(self, name):
        return eye(name)

class Factory(Base):
    def __init__(self, settings):
        self.settings = settings
        self.made = []
    @property
    def last(self):
        return self.settings.names[1]
    @staticmethod
    def plain(name):
        return [eye(name)]
    @classmethod
    def right(cls):
        return cls.plain('right')
    def all(self):
        self.made += [self.one(each) for each in self.settings.names]
        self.made.append(eye(self.settings.paths['a']))
        return self.made

def generate_launch_description():
    factory = Factory(Settings(['x', 'y']))
    return LaunchDescription({actions})
"""
#: What is launched, and its nodes.
ACTIONS = [
    ("factory.all()", ["/x", "/y", "/x_a"]),
    ("[factory.one('z')] + factory.plain('w')", ["/z", "/w"]),
    ("[eye(factory.last), eye(factory.settings.first)]", ["/y", "/x"]),
    ("[eye(factory.settings.side), *Factory.right()]", ["/left", "/right"]),
    ("[eye(Settings.side)]", ["/left"]),
    ("[factory.one(n) for n in factory.settings.names]", ["/x", "/y"]),
]


@pytest.mark.parametrize(("actions", "nodes"), ACTIONS)
def test_nodes_are_made_by_the_methods_of_classes(actions: str, nodes: list[str]) -> None:
    found = launched(FACTORY.format(actions=actions))
    assert [name.text for name in found.configuration.modules] == nodes
    assert not [note for note in found.warnings if "condition" in note.message]


def test_fields_of_data_classes_are_attributes() -> None:
    found = launched(
        """
@dataclass
class Robot:
    name: str
    side: str = 'left'

def generate_launch_description():
    robots = [Robot('a'), Robot(name='b', side='right')]
    return LaunchDescription([eye(each.name + '_' + each.side) for each in robots])
"""
    )
    assert [name.text for name in found.configuration.modules] == ["/a_left", "/b_right"]


#: The body of a helper function, and the nodes that it makes without and with a namespace.
HELPERS = [
    ("return eye('n', namespace=ns)", ["/n", "/s/n"]),
    ("return eye('n', namespace=ns) if ns else eye('m')", ["/m", "/s/n"]),
    ("return eye('m') if ns is None else eye('n', namespace=ns)", ["/m", "/s/n"]),
    ("return eye('n', namespace=ns) if ns is not None else eye('m')", ["/m", "/s/n"]),
    ("return eye('m') if not ns else eye('n', namespace=ns)", ["/m", "/s/n"]),
    ("return eye('n', namespace=ns or 'r')", ["/r/n", "/s/n"]),
    ("return eye('left' if ns == 's' else 'right')", ["/right", "/left"]),
]


@pytest.mark.parametrize(("body", "nodes"), HELPERS)
def test_a_helper_knows_which_arguments_it_is_given(body: str, nodes: list[str]) -> None:
    found = launched(
        f"def make(ns=None):\n    {body}\n"
        "def generate_launch_description():\n    return LaunchDescription([make(), make('s')])\n"
    )
    assert [name.text for name in found.configuration.modules] == nodes


def test_a_loop_over_an_unknown_list_has_one_round() -> None:
    found = launched(
        "def generate_launch_description():\n"
        "    return LaunchDescription([eye(f'n{i}') for i, _ in enumerate(other())])\n"
    )
    assert [name.text for name in found.configuration.modules] == ["/n0"]


VALUES = {
    "numbers are added": ("for i in range(1, 2 + 1)", "f'n{i}'", ["n1", "n2"]),
    "rounds start at a number": (
        "for i, _ in enumerate(['x', 'y'], start=2)",
        "f'n{i}'",
        ["n2", "n3"],
    ),
    "texts have holes by percent": ("for i in range(2)", "'n%d_%s' % (i, 'a')", ["n0_a", "n1_a"]),
    "texts are joined": ("for i in ['a', 'b']", "'_'.join(['n', i])", ["n_a", "n_b"]),
    "ends are stripped": ("for i in ['/a']", "i.strip('/')", ["a"]),
    "an unknown list is as long as another": (
        "for i, _ in zip(['a', 'b'], other())",
        "f'n{i}'",
        ["na", "nb"],
    ),
    "a format is left to a run": ("for i in range(1)", "f'n{i:02d}'", ["v4l2_camera"]),
}


@pytest.mark.parametrize(("loop", "name", "nodes"), VALUES.values(), ids=VALUES)
def test_values_are_those_of_a_run_or_unknown(loop: str, name: str, nodes: list[str]) -> None:
    found = launched(
        f"def generate_launch_description():\n    return LaunchDescription([eye({name}) {loop}])\n"
    )
    assert [name.text for name in found.configuration.modules] == [f"/{node}" for node in nodes]


IMPORTING = """
from random import uniform
from acme_launch import described, include as included, wrap
from launch.actions import LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit

def generate_launch_description():
    found = LaunchDescription([eye("a"), LogInfo(msg=described()), wrap([eye("b")])])
    found.add_action(included("mux", described()))
    found.add_action(TimerAction(period=uniform(1, 2), actions=[]))
    found.add_action(RegisterEventHandler(OnProcessExit(on_exit=wrap([]))))
    return found
"""


#: The same functions by the names of their modules.
BY_MODULE = (
    IMPORTING.replace("from acme_launch import described, include as included, wrap", "{}")
    .replace("described()", "acme.tools.described()")
    .replace("included(", "acme.tools.include(")
    .replace("wrap(", "acme.tools.wrap(")
)


@pytest.mark.parametrize(
    "text",
    [
        IMPORTING,
        BY_MODULE.format("import acme.tools"),
        BY_MODULE.replace("acme.tools", "tools").format("import acme.tools as tools"),
    ],
)
def test_actions_of_imported_functions_are_noted(text: str) -> None:
    found = launched(text)
    [note] = [each for each in found.warnings if "imported functions" in each.message]
    sentence = "actions made by imported functions not read: 3 (`wrap`, `include`)"
    assert (note.kind, note.message) == ("not_read", sentence)
    assert [each.text for each in found.configuration.modules] == ["/a", "/b"]
