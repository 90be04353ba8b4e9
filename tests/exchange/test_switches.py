"""Topics that a parameter switches on or off: a node lacks them with that value."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from tests.support.packages import write_package

CPP = """
class N : public rclcpp::Node {{
public:
  N() : Node("n") {{
    odom_ = declare_parameter<bool>("odom", true);
    get_parameter("tf", tf_);
    {made}
  }}
  void tick() {{ {used} }}
}};
int main() {{ N(); }}
"""
MAKE = 'pub_ = create_publisher<A>("t", 1);'
USE = "pub_->publish(a);"
#: Where a publisher is made and used, and the parameters with which the node does not have it.
IN_CPP = [
    (MAKE, USE, ""),
    (f"if (odom_) {{ {MAKE} }}", USE, "odom: false"),
    (f"if (odom_) {MAKE}", USE, "odom: False"),
    (f"if (!odom_) {{ {MAKE} }}", USE, "odom: true"),
    (f"if (odom_) {{ x(); }} else {{ {MAKE} }}", USE, "odom: true"),
    (f'if (this->get_parameter("odom").as_bool()) {{ {MAKE} }}', USE, "odom: false"),
    (f"if (tf_ && ready) {{ {MAKE} }}", USE, "tf: false"),
    (f"if (tf_ || ready) {{ {MAKE} }}", USE, ""),
    (MAKE, f"if (odom_) {{ {USE} }}", "odom: false"),
    (MAKE, f"if (odom_) {{ {USE} }} {USE}", ""),
    (f"if (odom_) {{ x(); }} {MAKE}", USE, ""),
]

PYTHON = """
class N(Node):
    def __init__(self):
        super().__init__('n')
        self.declare_parameter('odom', True)
        self.odom = self.get_parameter('odom').get_parameter_value().bool_value
        {made}
    def tick(self):
        {used}
def main():
    N()
"""
MAKES = "self.pub = self.create_publisher(A, 't', 1)"
USES = "self.pub.publish(a)"
IN_PYTHON = [
    (MAKES, USES, ""),
    (f"if self.odom: {MAKES}", USES, "odom: false"),
    (f"if self.get_parameter('odom').value: {MAKES}", USES, "odom: false"),
    (f"if bool(self.get_parameter('odom').value): {MAKES}", USES, "odom: false"),
    (f"if not self.odom: {MAKES}", USES, "odom: true"),
    (f"if self.odom and ready: {MAKES}", USES, "odom: false"),
    (f"if self.odom or ready: {MAKES}", USES, ""),
    (MAKES, f"if self.odom: {USES}", "odom: false"),
    (MAKES, f"self.tick() if self.odom else {USES}", "odom: true"),
]


def topics(written: dict[str, str], folder: Path) -> list[str]:
    """Return the topics of the nodes of a folder with these files."""
    write_package(written, folder)
    found = import_ros2([("", str(folder))]).configuration
    return [service.port or "" for module in found.declared for service in module.services]


def given(given_text: str) -> dict[str, str]:
    """Return a launch file that starts the node with parameters of a file."""
    node = '<node pkg="mine" exec="n"><param from="$(find-pkg-share mine)/p.yaml"/></node>'
    return {
        "launch/x.launch.xml": f"<launch>{node}</launch>",
        "p.yaml": f"n: {{ros__parameters: {{{given_text or 'other: false'}}}}}\n",
    }


@pytest.mark.parametrize(("made", "used", "without"), IN_CPP)
def test_parameters_switch_publishers_of_cpp(
    made: str, used: str, without: str, tmp_path: Path
) -> None:
    source = CPP.format(made=made, used=used)
    written = {"CMakeLists.txt": "add_executable(n src/n.cpp)", "src/n.cpp": source}
    assert topics({**written, **given(without)}, tmp_path) == ([] if without else ["/t"])
    given_text = "odom: false, tf: false" if not without else "other: true"
    assert topics({**written, **given(given_text)}, tmp_path) == ["/t"]


@pytest.mark.parametrize(("made", "used", "without"), IN_PYTHON)
def test_parameters_switch_publishers_of_python(
    made: str, used: str, without: str, tmp_path: Path
) -> None:
    setup = "setup(entry_points={'console_scripts': ['n = mine.n:main']})"
    written = {"setup.py": setup, "mine/n.py": PYTHON.format(made=made, used=used)}
    assert topics({**written, **given(without)}, tmp_path) == ([] if without else ["/t"])
    given_text = "odom: false" if not without else "other: true"
    assert topics({**written, **given(given_text)}, tmp_path) == ["/t"]
