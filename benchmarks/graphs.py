"""Graphs of ROS robots: `check`, `analyse` and `synthesise` of dumps as large as Autoware's.

    python benchmarks/graphs.py [NODES TOPICS]

A dump of each kind of 106 nodes and 650 topics, which nodes publish and subscribe to as unevenly as
in Autoware: most have one or two subscribers, some a dozen, a tenth two publishers, a tenth none.
Prints processor seconds of whole commands without start-up, which is that of `mars-asp --version`
with clingo loaded, as a median of three runs.
"""

import random
import statistics
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

NODES, TOPICS, TYPES, RUNS = 106, 650, 90, 3
#: Runs a command and prints the CPU seconds that it took.
_USED = """
import resource, subprocess, sys
to = subprocess.DEVNULL
subprocess.run(sys.argv[1:], stdout=to, stderr=to)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
"""


class Topic(NamedTuple):
    """A topic: its name and type, who publishes it and who subscribes to it."""

    name: str
    type: str
    publishers: list[str]
    subscribers: list[str]


def graph(nodes: int, topics: int, rng: random.Random) -> list[Topic]:
    """Return topics, each with who publishes it and who subscribes to it."""
    names = [f"/stage{number // 12}/node{number}" for number in range(nodes)]
    found = []
    for number in range(topics):
        # A few nodes publish much: about a third of them have several outputs.
        first = min(int(rng.paretovariate(1.2)) * rng.randrange(1, 8), nodes - 1)
        publishers = rng.sample(names, rng.choices([0, 1, 2], [1, 8, 1])[0])
        publishers = [names[first], *publishers[1:]] if publishers else []
        many = rng.choices([0, 1, 2, 3, 6, 12], [20, 40, 20, 10, 8, 2])[0]
        if not publishers:
            many = max(many, 1)
        subscribers = [name for name in rng.sample(names, many) if name not in publishers]
        kind = rng.randrange(TYPES)
        type_ = "geometry_msgs/msg/Twist" if number % 200 == 7 else f"pkg{kind % 9}/msg/Type{kind}"
        found.append(Topic(f"/stage{first // 12}/topic{number}", type_, publishers, subscribers))
    return found


def rosdiscover(topics: list[Topic]) -> Iterator[str]:
    """Yield the lines of a dump of ROSDiscover."""
    for node, (out, into) in by_node(topics).items():
        yield f"- fullname: {node}"
        for key, own in (("pubs", out), ("subs", into)):
            yield f"  {key}:"
            for topic in own:
                yield f"  - format: {topic.type.replace('/msg', '')}"
                yield "    implicit: false"
                yield f"    name: {topic.name}"
        yield "  provides:"
        for service in range(6):
            yield f"  - {{format: rcl/Set, name: {node}/service{service}}}"


def caret(topics: list[Topic]) -> Iterator[str]:
    """Yield the lines of an architecture file of CARET."""
    yield "nodes:"
    for node, (out, into) in by_node(topics).items():
        yield f"- node_name: {node}"
        yield "  callbacks:"
        yield "  - {callback_name: timer, callback_type: timer_callback, period_ns: 100000000}"
        for number, topic in enumerate(into):
            yield f"  - callback_name: subscription_callback_{number}"
            yield "    callback_type: subscription_callback"
            yield f"    topic_name: {topic.name}"
            yield f"    symbol: Node::on(std::shared_ptr<{topic.type.replace('/', '::')}>)"
        yield "  publishes:"
        for topic in out:
            yield f"  - {{topic_name: {topic.name}, callback_names: [timer]}}"


def node_info(topics: list[Topic]) -> Iterator[str]:
    """Yield what `ros2 node info` prints of each node."""
    for node, (out, into) in by_node(topics).items():
        yield node
        for head, own in (("Subscribers", into), ("Publishers", out)):
            yield f"  {head}:"
            yield from (f"    {topic.name}: {topic.type}" for topic in own)
        yield "  Service Servers:"
        yield from (f"    {node}/service{number}: rcl/srv/Set" for number in range(6))


def topic_info(topics: list[Topic]) -> Iterator[str]:
    """Yield what `ros2 topic info -v` prints of each topic."""
    for topic in topics:
        yield f"$ ros2 topic info -v {topic.name}"
        yield f"Type: {topic.type}"
        for word, kind, nodes in (
            ("Publisher", "PUBLISHER", topic.publishers),
            ("Subscription", "SUBSCRIPTION", topic.subscribers),
        ):
            yield f"{word} count: {len(nodes)}"
            for node in nodes:
                space, _, name = node.rpartition("/")
                yield f"Node name: {name}\nNode namespace: {space}\nEndpoint type: {kind}"
                yield "QoS profile:\n  Reliability: RELIABLE\n  Durability: VOLATILE"


def dot(topics: list[Topic]) -> Iterator[str]:
    """Yield what rqt_graph saves, with nodes and topics."""
    yield "digraph graphname {"
    for node in by_node(topics):
        yield f'\t"n_{node}" [label="{node}", shape=ellipse, tooltip="{node}"];'
    for topic in topics:
        name = topic.name
        yield f'\t"t_{name}" [label="{name}", shape=box, tooltip="topic:{name}", pos="1,2"];'
        yield from (f'\t"n_{node}" -> "t_{name}" [penwidth=1];' for node in topic.publishers)
        yield from (f'\t"t_{name}" -> "n_{node}" [penwidth=1];' for node in topic.subscribers)
    yield "}"


def by_node(topics: list[Topic]) -> dict[str, tuple[list[Topic], list[Topic]]]:
    """Return what each node publishes, and what it subscribes to."""
    found: dict[str, tuple[list[Topic], list[Topic]]] = defaultdict(lambda: ([], []))
    for topic in topics:
        for node in topic.publishers:
            found[node][0].append(topic)
        for node in topic.subscribers:
            found[node][1].append(topic)
    return dict(found)


def seconds(*words: str) -> float:
    """Return the processor seconds of a command, the median of some runs."""
    runs = [
        float(
            subprocess.run(
                [sys.executable, "-c", _USED, *words], capture_output=True, text=True, check=True
            ).stdout
        )
        for _ in range(RUNS)
    ]
    return statistics.median(runs)


def main() -> None:
    """Measure each kind of dump."""
    nodes, topics = map(int, sys.argv[1:3] or (NODES, TOPICS))
    made = graph(nodes, topics, random.Random(1))
    mars = (sys.executable, "-P", "-m", "mars_asp")
    start = seconds(sys.executable, "-c", "import clingo, mars_asp.cli")
    ends = sum(len(topic.publishers) + len(topic.subscribers) for topic in made)
    print(f"{len(by_node(made))} nodes, {len(made)} topics, {ends} ends; start-up {start:.2f} s")
    with tempfile.TemporaryDirectory() as folder:
        for kind, suffix in (
            (rosdiscover, "yml"),
            (caret, "yaml"),
            (node_info, "txt"),
            (topic_info, "txt"),
            (dot, "dot"),
        ):
            path = Path(folder) / f"{kind.__name__}.{suffix}"
            path.write_text("\n".join(kind(made)) + "\n", encoding="utf-8")
            taken = {
                verb: seconds(*mars, verb, "--quiet", str(path)) - start
                for verb in ("check", "analyse", "synthesise")
            }
            told = ", ".join(f"{verb} {used:.2f} s" for verb, used in taken.items())
            print(f"{kind.__name__} ({path.stat().st_size // 1000} kB): {told}")


if __name__ == "__main__":
    main()
