"""Names in C++ have scopes and branches: one with two texts is known at run time."""

import pytest

from mars_asp.exchange.ros2.source_cpp import read_cpp

MADE = "create_publisher<A>(topic, 1);"
OTHERS = 'struct N { std::string topic = "x"; void f() { %s } };'

NAMES = [
    # A member is shadowed.
    (OTHERS % f"for (auto topic : all) {{ {MADE} }}", []),
    (OTHERS % f"for (auto topic : all) {MADE}", []),
    (OTHERS % f"for (const auto & [topic, type] : all) {{ {MADE} }}", []),
    (OTHERS % f"try {{ }} catch (const std::string & topic) {{ {MADE} }}", []),
    (OTHERS % f"auto g = [](const std::string & topic) -> int {{ {MADE} }};", []),
    (OTHERS % f"if (auto topic = next(); true) {{ }} else {{ {MADE} }}", []),
    (OTHERS % f'std::string a = "a", topic = "b"; {MADE}', ["b"]),
    (OTHERS % f'if (a) {{ }} std::string a{{"a"}}, topic; {MADE}', []),
    (OTHERS % f'struct L {{ std::string topic = "b"; void g() {{ {MADE} }} }};', ["b"]),
    (OTHERS.replace("void f()", "auto f(std::string topic) -> std::string") % MADE, []),
    # Variables of other scopes.
    (f'void f() {{ {{ std::string topic = "a"; {MADE} }} {{ auto topic = g(); {MADE} }} }}', ["a"]),
    (
        f'namespace a {{ auto topic = "x"; void f() {{ {MADE} }} }}\n'
        f'namespace b {{ auto topic = "y"; void f() {{ {MADE} }} }}\n'
        "void f() { create_publisher<A>(b::topic, 1); }",
        ["x", "y", "y"],
    ),
    (
        f'{OTHERS % ""} struct M {{ std::string topic = "y"; void f(); }};\n'
        f"void M::f() {{ {MADE} }}",
        ["y"],
    ),
    (f"{OTHERS % ''} struct M : public N {{ void f() {{ {MADE} }} }};", ["x"]),
    (f"{OTHERS % ''} struct M : public other::N2 {{ void f() {{ {MADE} }} }};", []),
    # Arguments of all calls.
    (f'struct N {{ void f(std::string topic) {{ {MADE} }} void g() {{ f("z"); }} }};', ["z"]),
    (f'struct N {{ void f(std::string topic) {{ {MADE} }} void g() {{ f("z"); f("y"); }} }};', []),
    (
        f'struct N {{ void f(std::string topic) {{ {MADE} }} void g() {{ bind(&N::f, "z"); }} }};',
        [],
    ),
    (
        'struct N { void f(const std::string & topic = "k"); void g() { f(); } };\n'
        f"void N::f(const std::string & topic) {{ {MADE} }}",
        ["k"],
    ),
    # Values that change.
    (f'void f() {{ std::string topic = "a"; topic += "/b"; {MADE} }}', []),
    (f'void f() {{ std::string topic = "a"; topic.append("/b"); {MADE} }}', []),
    (f'void f() {{ std::string topic = "a"; std::cin >> topic; {MADE} }}', []),
    (f'void f() {{ std::string topic = "a"; load(&topic); {MADE} }}', []),
    (
        'void g(std::string & t) { t = "b"; }\n'
        f'void f() {{ std::string topic = "a"; g(topic); {MADE} }}',
        [],
    ),
    (
        'struct N { N(std::string topic) : topic(topic) { } std::string topic = "x";\n'
        f"void f() {{ {MADE} }} }};",
        [],
    ),
    # Parameters.
    (f'void f() {{ get_parameter("a", topic); {MADE} get_parameter("b", topic); }}', []),
    ('void f() { create_publisher<A>(get_parameter("a").as_string() + "/b", 1); }', []),
    (
        'void f() { std::string topic = "s"; declare_parameter("t", topic);\n'
        f'get_parameter("t", topic); {MADE} }}',
        ["s"],
    ),
    # Whole names.
    ('void f() { nh.advertise<A>(nh.resolveName("t"), 1); }', ["t"]),
    ('void f() { ros::NodeHandle p("~"); nh.advertise<A>(p.resolveName("t"), 1); }', ["~/t"]),
    ('void f() { n->create_publisher<A>(n->resolve_topic_name("t"), 1); }', ["t"]),
]


@pytest.mark.parametrize(("text", "topics"), NAMES)
def test_a_topic_has_the_text_of_the_variable_in_scope(text: str, topics: list[str]) -> None:
    assert [topic.name for topic in read_cpp([(text, "n.cpp")]).published] == topics


def test_a_declaration_of_a_function_names_no_topic() -> None:
    """A function may have the name of one that makes topics."""
    declared = "void create_publisher(const std::string & topic, std::string kind = {});"
    called = "void f() { create_publisher<A>(topic, 1); }"
    for text, shown in ((declared, []), (called, ["topic"]), (declared + called, ["topic"])):
        assert [each.name for each in read_cpp([(text, "a.cpp")]).unread] == shown


ALIASED = [
    ("using Cloud = sensor_msgs::msg::PointCloud2;", "sensor_msgs::msg::PointCloud2"),
    ("typedef sensor_msgs::msg::PointCloud2 Cloud;", "sensor_msgs::msg::PointCloud2"),
    ("using C = a::B; using Cloud = C;", "a::B"),
    ("struct M { using Cloud = a::B; }; struct N { using Cloud = a::C; };", None),
    ("using a::Cloud;", "Cloud"),
]


@pytest.mark.parametrize(("text", "kind"), ALIASED)
def test_a_topic_has_the_type_of_an_alias(text: str, kind: str | None) -> None:
    """An alias is in another file, and two of one name may differ."""
    made = 'void f() { create_publisher<Cloud>("x", 1); }'
    [topic] = read_cpp([(made, "a.cpp"), (text, "a.hpp")]).published
    assert topic.type == kind
