"""Handles of nodes in C++: which names the topics have that are made through them."""

from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.exchange.ros2 import import_ros2
from mars_asp.exchange.ros2.interface import AT_RUN_TIME
from mars_asp.exchange.ros2.source_cpp import read_cpp
from tests.support.fixtures import Captured
from tests.support.packages import write_package

#: A program, and the topics that it has for its node.
HANDLES = [
    ('void f() { ros::NodeHandle h("~"); h.advertise<A>("t", 1); }', ["~/t"]),
    ('void f() { ros::NodeHandle h = ros::NodeHandle("~"); h.advertise<A>("t", 1); }', ["~/t"]),
    ('void f() { ros::NodeHandle("~").advertise<A>("t", 1); }', ["~/t"]),
    (
        'void f() { ros::NodeHandle h("~"); ros::NodeHandle g(h, "arm"); g.advertise<A>("t", 1); }',
        ["~/arm/t"],
    ),
    (
        'void f() { ros::NodeHandle h; ros::NodeHandle g(h, "arm"); g.advertise<A>("t", 1); }',
        ["arm/t"],
    ),
    ('void f(std::string s) { ros::NodeHandle h(s); h.advertise<A>("t", 1); }', []),
    ('void f(std::string s) { ros::NodeHandle h(s); h.advertise<A>("/t", 1); }', ["/t"]),
    ('void f() { ros::NodeHandle h = this->getPrivateNodeHandle(); h.advertise<A>("t", 1); }',
     ["~/t"]),
    ('void f() { auto& h = getMTPrivateNodeHandle(); h.advertise<A>("t", 1); }', ["~/t"]),
    ('void f() { auto h = getNodeHandle(); h.advertise<A>("t", 1); }', ["t"]),
    ('void f() { getPrivateNodeHandle().advertise<A>("t", 1); }', ["~/t"]),
    # A local handle hides that of another function.
    (
        'void f() { ros::NodeHandle h("~"); }\n'
        'void g() { ros::NodeHandle h; h.advertise<A>("t", 1); }',
        ["t"],
    ),
    # Arguments of functions, constructors and methods.
    (
        'void f(ros::NodeHandle& n) { n.advertise<A>("t", 1); }\n'
        "void g() { f(getPrivateNodeHandle()); }",
        ["~/t"],
    ),
    (
        "struct C { C(ros::NodeHandle& n, int i) : i_(i), n_(n) {}\n"
        '  void init() { n_.advertise<A>("t", 1); }\n  int i_; ros::NodeHandle n_; };\n'
        "struct N { void onInit() { ros::NodeHandle h = getPrivateNodeHandle();\n"
        "  c_.reset(new C(h, 1)); }\n  std::shared_ptr<C> c_; };",
        ["~/t"],
    ),
    (
        'class C { public: void init(ros::NodeHandle& a, ros::NodeHandle& b); };\n'
        'void C::init(ros::NodeHandle& a, ros::NodeHandle& b) {\n'
        '  a.advertise<A>("t", 1); b.advertise<A>("u", 1); }\n'
        "void f(C* c) { c->init(getPrivateNodeHandle(), getNodeHandle()); }",
        ["~/t", "u"],
    ),
    # Members of one name, each of a class of its own.
    (
        'struct P { P() : h_("~") { h_.advertise<A>("p", 1); } ros::NodeHandle h_; };\n'
        'struct Q { Q() { h_.advertise<A>("q", 1); } ros::NodeHandle h_; };',
        ["~/p", "q"],
    ),
    (
        "struct P { void f() { h_ = getPrivateNodeHandle(); }\n"
        '  void g() { h_.advertise<A>("t", 1); }\n  ros::NodeHandle h_; };',
        ["~/t"],
    ),
    (
        "struct P { void f() { h_.reset(new ros::NodeHandle(\"~\")); }\n"
        '  void g() { h_->advertise<A>("t", 1); }\n  ros::NodeHandlePtr h_; };',
        ["~/t"],
    ),
    # Objects of one class that are made from two handles have both topics.
    (
        'void f(ros::NodeHandle n) { n.advertise<A>("t", 1); }\n'
        'void g() { ros::NodeHandle h("~"); f(h); f(ros::NodeHandle("arm")); }',
        ["arm/t", "~/t"],
    ),
    # One that is made of itself, and two that are made of each other.
    ('void f(N h) { ros::NodeHandle g("~"); g = ros::NodeHandle(g, "a"); g.advertise<A>("t", 1); }',
     ["~/t"]),
    (
        'struct P { void f() { g_ = ros::NodeHandle(h_, "a"); h_ = ros::NodeHandle(g_, "b");\n'
        '  h_ = ros::NodeHandle("c"); g_.advertise<A>("t", 1); }\n'
        "  ros::NodeHandle g_; ros::NodeHandle h_; };",
        ["c/a/t", "c/a/b/a/t", "c/a/b/a/b/a/t", "c/a/b/a/b/a/b/a/t"],
    ),
    (
        'void f() { ros::NodeHandle h("~"); image_transport::ImageTransport it(h);\n'
        '  it.advertise("t", 1); }',
        ["~/t"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "topics"), HANDLES)
def test_topics_are_below_the_prefix_of_their_handle(text: str, topics: list[str]) -> None:
    found = read_cpp([(text, "x.cpp")])
    assert [topic.name for topic in found.published] == topics
    assert bool(found.unread) == (not topics)


def test_filters_of_messages_take_the_handle_first() -> None:
    text = 'void f() { ros::NodeHandle h("~"); message_filters::Subscriber<A> s(h, "t", 1); }'
    assert [topic.name for topic in read_cpp([(text, "x.cpp")]).subscribed] == ["~/t"]


#: What makes a sub-node of ROS 2 or uses it, and the topics of the program.
SUB_NODES = [
    ('auto n = node_->create_sub_node("arm"); n->create_publisher<A>("t", 1);', ["arm/t"]),
    ('auto n = node_->create_sub_node("arm"); n->create_publisher<A>("/t", 1);', ["/t"]),
    ('auto n = node_->create_sub_node("arm"); node_->create_publisher<A>("t", 1);', ["t"]),
    ('auto n = node_->create_sub_node(ns); n->create_publisher<A>("t", 1);', []),
    (
        'auto n = node_->create_sub_node("a"); auto m = n->create_sub_node("b");'
        ' m->create_publisher<A>("t", 1);',
        ["a/b/t"],
    ),
    ('node_->create_sub_node("arm")->create_publisher<A>("t", 1);', ["arm/t"]),
    ('sub_ = node_->create_sub_node("arm"); use(sub_);', ["arm/u"]),
]


@pytest.mark.parametrize(("text", "topics"), SUB_NODES)
def test_topics_of_a_sub_node_are_below_its_namespace(text: str, topics: list[str]) -> None:
    other = 'void use(rclcpp::Node::SharedPtr n) { n->create_publisher<A>("u", 1); }\n'
    source = f"{other if 'use' in text else ''}void f() {{ {text} }}"
    found = read_cpp([(source, "x.cpp")])
    assert [topic.name for topic in found.published] == topics
    assert bool(found.unread) == (not topics)


NODELET = """
#include "mine/core.hpp"
class Mine : public nodelet::Nodelet {
  void onInit() override { core_.init(getPrivateNodeHandle()); }
  Core core_;
};
PLUGINLIB_EXPORT_CLASS(mine::Mine, nodelet::Nodelet)
"""
CORE = '#include "mine/core.hpp"\nvoid Core::init(ros::NodeHandle& n) { n.advertise<A>("t", 1); }'
BUILDS = [
    "add_library(core src/core.cpp)\nadd_library(let src/let.cpp)\ntarget_link_libraries(let core)",
    "add_subdirectory(src)",
]


@pytest.mark.parametrize("build", BUILDS)
def test_a_nodelet_has_the_topics_of_its_library(build: str, tmp_path: Path) -> None:
    written = {
        "CMakeLists.txt": build,
        "src/let.cpp": NODELET,
        "src/core.cpp": CORE,
        "src/other.cpp": '#include "mine/core.hpp"\nint main() { node.advertise<A>("u", 1); }',
        "include/mine/core.hpp": "struct Core { void init(ros::NodeHandle& n); };",
        "launch/x.launch": '<launch><node pkg="nodelet" type="nodelet" name="n"'
        ' args="standalone mine/Mine"/></launch>',
    }
    write_package(written, tmp_path)
    [module] = import_ros2([("", str(tmp_path))]).configuration.declared
    assert [(service.port) for service in module.services] == ["/n/t"]


#: Sources of a node that choose its namespace, and what they publish if the launch file has none.
SPACED = [
    ("n.py", "Node.__init__(self, 'n', namespace='arm')", "/arm/t"),
    ("n.py", "super().__init__('n', namespace='arm')", "/arm/t"),
    ("n.py", "super().__init__('n')", "/t"),
    ("n.cpp", 'Node("n", "arm", options)', "/arm/t"),
    ("n.cpp", 'Node("n", options)', "/t"),
]


@pytest.mark.parametrize(("name", "made", "topic"), SPACED)
def test_a_program_chooses_the_namespace_that_no_launch_file_gives(
    name: str, made: str, topic: str, tmp_path: Path
) -> None:
    texts = {
        "n.py": "class N(Node):\n  def __init__(self):\n    {made}\n"
        "    self.create_publisher(A, 't', 1)\nN()\n",
        "n.cpp": 'class N : public Node {{ N() : {made} {{ create_publisher<A>("t", 1); }} }};',
    }
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    (tmp_path / "CMakeLists.txt").write_text("add_executable(n n.cpp)" * name.endswith("cpp"))
    (tmp_path / name).write_text(texts[name].format(made=made))
    for given, full in (("", topic), ('namespace="leg"', "/leg/t")):
        node = f'<node pkg="mine" exec="n" {given}/>'
        (tmp_path / "x.launch.xml").write_text(f"<launch>{node}</launch>")
        [module] = import_ros2([("", str(tmp_path))]).configuration.declared
        assert [service.port for service in module.services] == [full]


SLAM = """
def generate_launch_description():
    file = LaunchConfiguration('file')
    default = os.path.join(get_package_share_directory('mine'), 'config', 'slam.yaml')
    has = HasNodeParams(source_file=file, node_name='slam_toolbox')
    chosen = {chosen}
    return LaunchDescription([
        DeclareLaunchArgument('file', default_value=default),
        Node(package='slam_toolbox', executable='sync_slam_toolbox_node', name='slam_toolbox',
             parameters=[chosen]),
    ])
"""
CHOICES = [
    ("""PythonExpression(['"', file, '" if ', has, ' else "', default, '"'])""", ["/front"]),
    ("default", ["/front"]),
    ("somewhere()", []),
]


@pytest.mark.parametrize(("chosen", "topics"), CHOICES)
def test_parameters_name_topics_where_their_file_is_chosen(
    chosen: str, topics: list[str], tmp_path: Path
) -> None:
    written = {
        "launch/slam.launch.py": SLAM.format(chosen=chosen),
        "config/slam.yaml": "slam_toolbox:\n  ros__parameters:\n    scan_topic: /front\n",
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [end.topic for node in tree.nodes for end in node.subscribed] == topics


def test_a_program_has_the_sources_of_a_library_whose_own_headers_it_includes(
    tmp_path: Path,
) -> None:
    node = '#include "{name}.hpp"\n#include "common.hpp"\n{name}::{name}() : Node("{name}") {{}}'
    written = {
        "CMakeLists.txt": "add_library(core src/server.cpp src/saver.cpp)\n"
        "add_executable(saver_main src/main.cpp)\ntarget_link_libraries(saver_main core)",
        "src/main.cpp": '#include "saver.hpp"\nint main() { rclcpp::spin(make_shared<saver>()); }',
        "src/server.cpp": node.format(name="server"),
        "src/saver.cpp": node.format(name="saver"),
        "include/server.hpp": "",
        "include/saver.hpp": '#include "common.hpp"',
        "include/common.hpp": "",
        "launch/x.launch.xml": '<launch><node pkg="mine" exec="saver_main"/></launch>',
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [node.name for node in tree.nodes] == ["/saver"]


COMPONENT = (
    'class {name} : public rclcpp::Node {{ {name}() : Node("{name}") {{\n'
    'create_publisher<M>("/{name}/t", 1); }} }};\n'
    "RCLCPP_COMPONENTS_REGISTER_NODE(mine::{name})\n"
)
#: Sources of two components in one library, and the topics of the second one.
LIBRARIES = [
    ({"a.cpp": COMPONENT.format(name="A"), "b.cpp": COMPONENT.format(name="B")}, ["/B/t"]),
    ({"a.cpp": COMPONENT.format(name="A") + COMPONENT.format(name="B")}, ["/B/t"]),
    # A derived component has the topics of its base class.
    (
        {
            "a.cpp": COMPONENT.format(name="A"),
            "b.cpp": COMPONENT.format(name="B").replace("rclcpp::Node", "A"),
            "a.hpp": "",
        },
        ["/A/t", "/B/t"],
    ),
]


@pytest.mark.parametrize(("sources", "topics"), LIBRARIES)
def test_a_component_has_no_topics_of_another_in_its_library(
    sources: dict[str, str], topics: list[str], tmp_path: Path
) -> None:
    cmake = "add_library(both a.cpp b.cpp common.hpp)\n" + "".join(
        f'rclcpp_components_register_node(both PLUGIN "mine::{name}" EXECUTABLE {name}_node)\n'
        for name in "AB"
    )
    written = {
        "CMakeLists.txt": cmake,
        "common.hpp": "",
        **{
            name: f'#include "common.hpp"\n#include "a.hpp"\n{text}'
            for name, text in sources.items()
        },
        "launch/x.launch.xml": '<launch><node pkg="mine" exec="B_node"/></launch>',
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert sorted(end.topic for node in tree.nodes for end in node.published) == topics


def test_camera_information_is_beside_the_renamed_image(tmp_path: Path) -> None:
    written = {
        "CMakeLists.txt": "add_executable(e src/e.cpp)",
        "src/e.cpp": 'int main() { it.subscribeCamera("image", 1, f); }',
        "launch/x.launch": '<launch><node pkg="mine" type="e" name="e">'
        '<remap from="image" to="/cam/image_raw"/></node></launch>',
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    ends = [end.topic for node in tree.nodes for end in node.subscribed]
    assert ends == ["/cam/image_raw", "/cam/camera_info"]


def test_camera_information_of_catalogued_programs_is_beside_the_image(tmp_path: Path) -> None:
    program = 'pkg="depthimage_to_laserscan" type="depthimage_to_laserscan" name="laser"'
    launch = f'<launch><node {program}><remap from="image" to="/cam/image"/></node></launch>'
    write_package({"launch/x.launch": launch}, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    ends = [end.topic for node in tree.nodes for end in node.subscribed]
    assert ends == ["/cam/image", "/cam/camera_info"]


def test_a_launch_file_of_ros1_in_a_package_of_ros2_starts_nothing(tmp_path: Path) -> None:
    launch = '<launch><node pkg="mine" type="e" name="e"/></launch>'
    write_package({"launch/old.launch": launch, "launch/new.launch.py": SLAM}, tmp_path)
    manifest = tmp_path / "package.xml"
    manifest.write_text(
        "<package><name>mine</name><export><build_type>ament_cmake</build_type></export></package>"
    )
    trees = import_ros2([("", str(tmp_path))]).trees
    assert [Path(tree.path).name for tree in trees] == ["new.launch.py"]


def test_a_launch_file_of_ros1_means_another_package_than_one_of_ros2(tmp_path: Path) -> None:
    manifest = "<package><name>{}</name><export><build_type>{}</build_type></export></package>"
    source = 'int main() { n->create_publisher<A>("t", 1); }'
    for name, build in (("mine", "ament_cmake"), ("yours", "catkin")):
        written = {"src/e.cpp": source, "CMakeLists.txt": "add_executable(e src/e.cpp)"}
        write_package(written, tmp_path / name)
        (tmp_path / name / "package.xml").write_text(manifest.format(name, build))
    nodes = "".join(f'<node pkg="{name}" type="e" name="{name}"/>' for name in ("mine", "yours"))
    (tmp_path / "robot.launch").write_text(f"<launch>{nodes}</launch>")
    [tree] = import_ros2([("", str(tmp_path))]).trees
    ends = {node.name: [end.topic for end in node.published] for node in tree.nodes}
    assert ends == {"/mine": [], "/yours": ["/t"]}


def test_an_empty_launch_file_is_broken(tmp_path: Path, capsys: Captured) -> None:
    write_package({"launch/robot.launch.py": "\n"}, tmp_path)
    assert run_here(["check", str(tmp_path)]) == 0
    assert "the launch file is empty [broken_file]" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("line", "is_broken"),
    [("<include file='b.launch.py'/>", True), ("<!-- b.launch.py -->", True), ("", False)],
)
def test_an_empty_launch_file_that_no_other_names_is_a_placeholder(
    line: str, is_broken: bool, tmp_path: Path
) -> None:
    launch = f'<launch>{line}<node pkg="joy" exec="joy_node"/></launch>'
    write_package({"launch/a.launch.xml": launch, "launch/b.launch.py": ""}, tmp_path)
    parsed = import_ros2([("", str(tmp_path))])
    assert any(tree.broken for tree in parsed.trees) == is_broken
    assert any("empty launch files" in each.message for each in parsed.warnings) != is_broken


def test_a_parameter_counts_before_a_constant_in_a_header() -> None:
    source = (
        'void f() { n.declare_parameter("t", "/imu"); n.get_parameter("t", topic);\n'
        "  n.create_publisher<A>(topic, 1); }"
    )
    for texts in ([source, HEADER], [HEADER, source]):
        [topic] = read_cpp([(text, f"{at}.cpp") for at, text in enumerate(texts)]).published
        assert topic.parameter == "t"


HEADER = 'struct N { std::string topic = "/other"; };'
TEMPLATE = (
    "template <typename T> struct S {\n"
    '  S() : S<T>(ros::NodeHandle(), ros::NodeHandle("~")) {}\n'
    "  S(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) : nh_(nh), pnh_(pnh) {\n"
    '    pnh_.advertise<A>("t", 1); }\n'
    "  ros::NodeHandle nh_; ros::NodeHandle pnh_; };\n"
)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        # A constructor that calls another one of a template.
        (TEMPLATE, ["~/t"]),
        # A constructor without a call: other code calls it.
        (TEMPLATE.replace("  S() :", "  // S() :"), []),
    ],
)
def test_a_handle_of_a_parameter_is_known_by_the_calls(text: str, found: list[str]) -> None:
    assert [each.name for each in read_cpp([(text, "n.cpp")]).published] == found


@pytest.mark.parametrize(
    ("text", "is_whole"),
    [
        # An object that is made for the node may have topics.
        ('struct N : public rclcpp::Node { Polling<A> sub_{this, "~/in"}; };', False),
        (
            "struct N : public rclcpp::Node { N() : fitter_(this) {} other::Fitter fitter_; };",
            False,
        ),
        ("void f() { auto x = std::make_unique<Fitter>(this); }", False),
        ("void f() { auto x = std::make_unique<tf2_ros::TransformBroadcaster>(*this); }", True),
        ("void f() { s_ = create_subscription<A>(t, 1, std::bind(&N::g, this, _1)); }", True),
        ('void f() { s_ = n.subscribe("t", 1, &N::g, this); }', True),
        # The base class is not here, and gets the name of the node.
        ('class N : public other::Filter { N() : Filter("n") {} };', False),
        ('class N : public rclcpp::Node { N() : Node("n") {} };', True),
        (
            "class F : public rclcpp::Node { F(const char* n) : Node(n) {} };\n"
            'class N : public F { N() : F("n") {} };',
            True,
        ),
    ],
)
def test_objects_and_base_classes_that_are_not_here_may_have_topics(
    text: str, is_whole: bool
) -> None:
    assert read_cpp([(text, "n.cpp")]).unnamed != is_whole


def test_a_name_with_two_texts_is_known_at_run_time() -> None:
    text = (
        'void f() { std::string t = "a"; create_publisher<A>(t, 1); }\n'
        'void g() { std::string t = "a"; if (x) { t = "b"; } create_publisher<A>(t, 1); }'
    )
    found = read_cpp([(text, "n.cpp")])
    assert [each.name for each in found.published] == ["a"]
    assert [each.sort for each in found.unread] == [AT_RUN_TIME]


def test_a_parameter_that_is_read_in_place_has_its_declared_default() -> None:
    text = (
        'A() : Node("a") { declare_parameter("out", "/odom");\n'
        'create_publisher<B>(get_parameter("out").as_string(), 10); }'
    )
    [topic] = read_cpp([(text, "n.cpp")]).published
    assert (topic.name, topic.parameter) == ("/odom", "out")


@pytest.mark.parametrize(
    ("header", "source"),
    [
        ('std::string topic_ = "scan";', "void f() { topic_ = root_ + name(); }"),
        ('std::string topic_ = "scan";', 'std::string topic_ = "points";'),
    ],
)
def test_a_member_with_another_value_elsewhere_is_known_at_run_time(
    header: str, source: str
) -> None:
    made = "void g() { create_publisher<A>(topic_, 1); }"
    found = read_cpp([(f"{source}\n{made}", "n.cpp"), (header, "n.hpp")])
    assert not found.published
    assert [each.sort for each in found.unread] == [AT_RUN_TIME]
    assert [each.name for each in read_cpp([(made, "n.cpp"), (header, "n.hpp")]).published] == [
        "scan"
    ]


def test_a_path_in_quotes_may_be_a_topic() -> None:
    found = read_cpp([('std::vector<std::string> names{"~/in/cloud", "odom"};', "n.cpp")])
    assert [each.name for each in found.names] == ["~/in/cloud"]


PARTLY_READ = """import rclpy, sys
class N(Node):
  def __init__(self):
    super().__init__('n')
    self.create_publisher(CameraInfo, sys.argv[1], 1)
"""
LIKE_IT = PARTLY_READ.replace("sys.argv[1]", "'/camera_info'")
IN_VAIN = (
    "import rclpy\nclass N(Node):\n  def __init__(self):\n    super().__init__('n')\n"
    "    self.create_subscription(CameraInfo, '/front/camera_info', self.f, 1)\n"
)


@pytest.mark.parametrize(("name", "is_found"), [("front", False), ("rear", True)])
def test_a_node_not_wholly_read_may_publish_topics_named_like_it(
    name: str, is_found: bool, tmp_path: Path, capsys: Captured
) -> None:
    launch = '<launch><node pkg="mine" exec="{}.py" name="{}"/></launch>'
    files = {
        "scripts/driver.py": PARTLY_READ,
        "scripts/like.py": LIKE_IT,
        "scripts/viewer.py": IN_VAIN,
        "launch/driver.launch.xml": launch.format("driver", name),
        "launch/like.launch.xml": launch.format("like", "like"),
        "launch/viewer.launch.xml": launch.format("viewer", "viewer"),
    }
    write_package(files, tmp_path)
    assert run_here(["check", str(tmp_path)]) == 0
    assert ("[loose_end]" in capsys.readouterr().out) == is_found


HELPER = (
    "import rclpy\nclass Helper(Node):\n  def __init__(self):\n    super().__init__('helper')\n"
    "class N(Node):\n  def __init__(self):\n    Helper()\n    super().__init__({})\n"
)


@pytest.mark.parametrize("name", ["'driver'", "name_of_run()"])
def test_the_name_of_a_program_with_several_nodes_may_be_any(name: str, tmp_path: Path) -> None:
    written = {
        "scripts/n.py": HELPER.format(name),
        "x.launch.xml": '<launch><node pkg="mine" exec="n.py"/></launch>',
    }
    write_package(written, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [node.is_named for node in tree.nodes] == [False]
