"""Names in sources in Python have scopes and branches: an independent run has the same topics."""

from itertools import chain, count, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.exchange.ros2.source_python import PythonPrograms
from tests.support.campaigns import examples


def read(text: str) -> tuple[list[str], bool]:
    """Return the topics of a program, and whether it may have more."""
    found = PythonPrograms(lambda name: (text, "m.py") if name == "m" else None).interface(
        "m", None
    )
    assert found is not None
    return sorted({end.name for end in found.published}), bool(found.unread)


def method(*lines: str, name: str = "__init__(self)") -> str:
    return f"    def {name}:\n" + "".join(f"        {line}\n" for line in lines)


PUBLISH = "self.create_publisher(A, topic, 1)"


@pytest.mark.parametrize(
    ("uses", "is_last"),
    [
        (method("self.pub.publish(A())", name="destroy_node(self)"), True),
        (method("self.halt(self.pub)", name="shutdown(self)"), True),
        (method("on_shutdown(self.stop)") + method("self.pub.publish()", name="stop(self)"), True),
        # Its own code also calls it.
        (
            method("on_shutdown(self.stop)", "self.stop()")
            + method("self.pub.publish()", name="stop(self)"),
            False,
        ),
        (
            method("self.pub.publish(A())", name="shutdown(self)")
            + method("self.pub.publish(A())", name="tick(self)"),
            False,
        ),
        (method("self.pub.publish(A())", name="close(self)") + "N().pub.publish(A())\n", False),
        ("", False),
    ],
)
def test_a_publisher_may_be_for_the_end_of_a_program(uses: str, is_last: bool) -> None:
    made = method("self.pub = self.create_publisher(A, 'a', 1)", name="make(self)")
    text = f"class N(Node):\n{made}{uses}\nN()\n"
    found = PythonPrograms(lambda _: (text, "m.py")).interface("m", None)
    assert found is not None
    assert [end.last for end in found.published] == [is_last]


#: The body of a class of nodes, its topics, and whether it may have more.
CASES = {
    "numbers are added": (
        method("for i in range(1, 1 + 2):", f"    topic = f'a{{i}}'; {PUBLISH}"),
        ["a1", "a2"],
        False,
    ),
    "texts are joined and stripped": (
        method("for topic in ['/'.join(['a', 'b']), '/c'.strip('/')]:", f"    {PUBLISH}"),
        ["a/b", "c"],
        False,
    ),
    "an inner loop goes over the item of an outer one": (
        method("for row in [['a', 'b'], ['c']]:", "    for topic in row:", f"        {PUBLISH}"),
        ["a", "b", "c"],
        False,
    ),
    "the numbers of an unknown list are not known": (
        method("for i, _ in enumerate(other()):", f"    topic = f'a{{i}}'; {PUBLISH}"),
        [],
        True,
    ),
    "each method has names of its own": (
        method("topic = 'a'", PUBLISH, name="f(self)")
        + method("topic = 'b'", PUBLISH, name="g(self)"),
        ["a", "b"],
        False,
    ),
    "methods do not see names of the class": (
        "    i = 0\n" + method("for i in self.all:", "    self.create_publisher(A, f'a{i}', 1)"),
        [],
        True,
    ),
    "two branches": (
        method("if x:", "    topic = 'a'", "else:", "    topic = 'b'", PUBLISH),
        ["a", "b"],
        False,
    ),
    "one branch": (method("topic = 'a'", "if x:", "    topic = 'b'", PUBLISH), ["a", "b"], False),
    "the other branch": (
        method("topic = 'a'", "if x:", "    topic = 'b'", "else:", f"    {PUBLISH}"),
        ["a"],
        False,
    ),
    "a choice in one line": (method("topic = 'a' if x else 'b'", PUBLISH), ["a", "b"], False),
    "one name after another": (
        method("topic = 'a'", PUBLISH, "topic = 'b'", PUBLISH),
        ["a", "b"],
        False,
    ),
    "never before": (method("topic = 'a'", "topic = 'b'", PUBLISH), ["b"], False),
    "two on one line": (method("topic, other = 'a', 'b'", PUBLISH), ["a"], False),
    "a longer name": (
        method("topic = 'a'", "topic += '/b'", "topic = topic + '/c'", PUBLISH),
        ["a/b/c"],
        False,
    ),
    "a counter": (
        method("i = 0", "while i < 3:", "    topic = f'a{i}'", f"    {PUBLISH}", "    i += 1"),
        ["a0"],
        True,
    ),
    "an attribute of two methods": (
        method("self.t = 'a'", name="f(self)")
        + method("self.t = 'b'", name="g(self)")
        + method("self.create_publisher(A, self.t, 1)", name="h(self)"),
        ["a", "b"],
        False,
    ),
    "an attribute that is empty at first": (
        method("self.t = None")
        + method("self.t = 'b'", "self.create_publisher(A, self.t, 1)", name="g(self)"),
        ["b"],
        False,
    ),
    "a method that is called with each": (
        method(PUBLISH, name="f(self, topic)")
        + method("topic = 'no'", "self.f('a')", "self.f(topic='b')"),
        ["a", "b"],
        False,
    ),
    "a method that nothing here calls": (
        method(PUBLISH, name="f(self, topic)") + method("topic = 'no'"),
        [],
        True,
    ),
    "an exception": (
        method("topic = 'a'", "try:", "    topic = 'b'", "except E:", "    pass", PUBLISH),
        ["a", "b"],
        False,
    ),
    "a method that is called very often": (
        method(PUBLISH, name="f(self, topic)") + method(*(f"self.f('a{at}')" for at in range(64))),
        sorted(f"a{at}" for at in range(64)),
        False,
    ),
    "more calls than are followed": (
        method(PUBLISH, name="f(self, topic)") + method(*(f"self.f('a{at}')" for at in range(65))),
        sorted(f"a{at}" for at in (0, *range(2, 65))),
        True,
    ),
    "a name of the module": (
        method("global topic", PUBLISH) + "topic = 'a'\n",
        ["a"],
        False,
    ),
}


@pytest.mark.parametrize(("body", "topics", "more"), CASES.values(), ids=CASES)
def test_names_have_scopes_and_branches(body: str, topics: list[str], more: bool) -> None:
    assert read(f"class N(Node):\n{body}") == (topics, more)


def test_parameters_of_a_method_belong_together() -> None:
    body = method("self.make(A, 'a')", "self.make(B, 'b')") + method(
        "self.create_publisher(kind, topic, 1)", name="make(self, kind, topic)"
    )
    text = f"class N(Node):\n{body}"
    found = PythonPrograms(lambda name: (text, "m.py") if name == "m" else None).interface(
        "m", None
    )
    assert found is not None
    assert [(end.name, end.type) for end in found.published] == [("a", "A"), ("b", "B")]


NAMES = st.sampled_from(["u", "v", "w"])
TEXTS = st.one_of(
    st.sampled_from(["'a'", "'b'", "'c'"]),
    NAMES,
    st.builds("{} + 'd'".format, NAMES),
)
SIMPLE = st.one_of(
    st.builds("{} = {}".format, NAMES, TEXTS),
    st.builds("self.create_publisher(A, {}, 1)".format, NAMES),
)


def indented(head: str, *blocks: list[str]) -> list[str]:
    lines = [head]
    for at, block in enumerate(blocks):
        lines += ["else:"] * (at > 0) + [f"    {line}" for line in block]
    return lines


def statements(inner: st.SearchStrategy[list[str]]) -> st.SearchStrategy[list[str]]:
    block = st.lists(inner, min_size=1, max_size=3).map(
        lambda parts: list(chain.from_iterable(parts))
    )
    return st.one_of(
        st.builds(lambda one: indented("if self.test():", one), block),
        st.builds(lambda one, two: indented("if self.test():", one, two), block, block),
        st.builds(lambda name, one: indented(f"for {name} in ['x', 'y']:", one), NAMES, block),
    )


PROGRAMS = st.lists(
    st.recursive(SIMPLE.map(lambda line: [line]), statements, max_leaves=6), min_size=1, max_size=6
).map(lambda parts: ["u = 'i'", "v = 'j'", "w = 'k'", *chain.from_iterable(parts)])


class Recorder:
    """A node that records its topics, with given answers of its tests."""

    def __init__(self, answers: tuple[bool, ...]) -> None:
        self.answers, self.topics, self.at = answers, set[str](), count()

    def test(self) -> bool:
        at = next(self.at)
        return self.answers[at % len(self.answers)]

    def create_publisher(self, _kind: object, topic: str, _qos: int) -> None:
        self.topics.add(topic)


@settings(max_examples=examples(50, 150), deadline=None)
@given(PROGRAMS)
def test_a_run_has_no_topic_that_was_not_read(lines: list[str]) -> None:
    text = "class N:\n" + method(*lines)
    names: dict[str, type] = {}
    exec(text, {"A": object}, names)
    tests = sum("test()" in line for line in lines)
    run = set[str]()
    for answers in product((True, False), repeat=min(tests, 6) or 1):
        recorder = Recorder(answers)
        names["N"].__init__(recorder)  # type: ignore[misc]
        run |= recorder.topics
    found, more = read(text.replace("class N", "class N(Node)"))
    assert more or run <= set(found)
    if not tests and "for" not in text:
        assert set(found) == run
