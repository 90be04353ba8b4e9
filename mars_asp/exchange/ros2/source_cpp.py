"""Interfaces of programs in C++, by their tokens: rclcpp and roscpp.

The lexer of annotated sources leaves out comments, strings and dead code. A rate is that of the
timer, or loop, whose function publishes.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache, cached_property, lru_cache
from typing import NamedTuple

from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    angle,
    before,
    closing,
    is_word,
    joined,
    split,
    text_at,
)
from mars_asp.annotations.types import representation
from mars_asp.exchange.ros2.cpp_code import CppCall
from mars_asp.exchange.ros2.cpp_durations import number_in, seconds_in
from mars_asp.exchange.ros2.cpp_handles import Handles, handle_tokens, prefixed_name
from mars_asp.exchange.ros2.cpp_scopes import PARAMETERS, ScopedCode
from mars_asp.exchange.ros2.cpp_texts import CppTexts, resolved_name
from mars_asp.exchange.ros2.interface import (
    AT_RUN_TIME,
    OF_ACTION,
    SERVICES,
    Interface,
    InterfaceTopic,
    agreed,
    rate_of,
)
from mars_asp.exchange.unread import Unread

#: Limits of what is copied or searched more than once; no program comes near them.
_MOST_WORDS = 50
_MOST_TIMERS = 200
_MOST_FOLLOWED = 100
_MOST_PARSED = 1000
_MOST_ALIASES = 8
#: Wrappers of nav2 that publish and hear velocities.
_TWISTS = {"TwistPublisher": True, "TwistSubscriber": False}
#: What publishes or hears images with what is known of the camera, and the types of both.
_CAMERAS = frozenset(
    {"create_camera_publisher", "create_camera_subscription"}
    | {"advertiseCamera", "subscribeCamera"}
)
_IMAGE, _CAMERA_INFO = "sensor_msgs::msg::Image", "sensor_msgs::msg::CameraInfo"
_PATH = re.compile(r"~?/?\w+(?:/\w+)+")
#: What filters messages of a type; the node comes first, and then the topic.
_FILTER = re.compile(r"(?:\w+::)*Subscriber\s*<(?P<type>[^<>,]+)[^<>]*>")
_TIMERS = frozenset({"create_wall_timer", "create_timer", "createTimer", "createWallTimer"})
_RATES = frozenset({"Rate", "WallRate"})
_SERVICES = frozenset(
    {"create_service", "create_client", "advertiseService", "serviceClient", "create_server"}
    | {"SimpleActionServer", "SimpleActionClient"}
)
#: Methods of the node handles of ROS 1 for parameters, which a launch file may rename.
_RENAMED = frozenset({"getParam", "getParamCached", "param", "setParam", "hasParam", "deleteParam"})
#: Macros that register the class of a component.
REGISTERS = frozenset({"RCLCPP_COMPONENTS_REGISTER_NODE", "PLUGINLIB_EXPORT_CLASS"})
#: All that is looked for among calls.
_CALLED = (
    _TIMERS
    | REGISTERS
    | _RATES
    | _SERVICES
    | PARAMETERS
    | _RENAMED
    | _TWISTS.keys()
    | _CAMERAS
    | frozenset(
        "create_publisher create_subscription create_generic_publisher create_generic_subscription"
        " advertise subscribe Subscriber Publisher make_unique make_shared Node LifecycleNode"
        " init".split()
    )
)


class _TopicCall(NamedTuple):
    """A topic that a call creates, with the variable (`keeper`) that stores the result.

    `handle` is the range of tokens of the node handle on which it is called.
    """

    topic: InterfaceTopic
    keeper: str | None
    published: bool
    handle: tuple[int, int]


@lru_cache(maxsize=_MOST_PARSED)
def parsed_file(text: str, path: str) -> "CppFile":
    """Return the parsed file, memoized, as several programs share libraries."""
    return CppFile(text, path, _CALLED, _RATES)


def read_cpp(
    sources: Iterable[tuple[str, str]], component: str = "", others: Collection[str] = ()
) -> Interface:
    """Return the interface of a program whose files are pairs of text and path.

    For a component, the classes in `others` are ignored, except its base classes.
    """
    files = [parsed_file(text, path) for text, path in sources]
    texts = CppTexts(files)
    others = set(others) - set(texts.with_base_classes(component)) if others else others
    kinds: dict[str, str] = {}
    for file in files:
        kinds |= file.callbacks
    aliases = agreed(alias for file in files for alias in file.type_aliases)
    handles = Handles(files, texts)
    used_if = cache(lambda keeper: _used_if(files, keeper, texts))
    published: list[InterfaceTopic] = []
    subscribed: list[InterfaceTopic] = []
    unread: list[Unread] = []
    named: list[InterfaceTopic] = []
    rates = agreed(rate for file in files for rate in file.rates())
    names: list[tuple[str, str]] = []
    for file in files:
        for call in file.calls_outside(others):
            found = file.topic(call, texts, kinds)
            if isinstance(found, Unread):
                unread.append(found)
            elif found is not None:
                switches = file.switches(call.at, texts)
                if found.published and found.keeper:
                    switches |= used_if(found.keeper)
                hz = rates.get(found.keeper or "")
                made = replace(
                    found.topic,
                    type=_aliased(found.topic.type, aliases),
                    hz=hz,
                    switches=tuple(sorted(switches)),
                )
                for topic in _prefixed(made, file, found.handle, handles):
                    if isinstance(topic, Unread):
                        unread.append(topic)
                        continue
                    ends = published if found.published else subscribed
                    ends.append(topic)
                    if call.name in _CAMERAS and topic.parameter is None:
                        beside = f"{topic.name.rpartition('/')[0]}/camera_info".removeprefix("/")
                        beside = f"/{beside}" if topic.name.startswith("/") else beside
                        ends.append(
                            replace(topic, name=beside, type=_CAMERA_INFO, image=topic.name)
                        )
            for further, handle in file.further_names(call, texts):
                prefixed = _prefixed(further, file, handle, handles)
                named += (each for each in prefixed if isinstance(each, InterfaceTopic))
        names += file.node_names(others)
    # A service with a name that only a run knows is noted, but gives no name.
    places = {each.span for each in named}
    unnamed = any(each.sort == SERVICES and each.span not in places for each in unread)
    unnamed |= handles.leave_topics_unread(files, _CALLED)
    paths = dict.fromkeys(path for file in files for path in file.topic_paths)
    named += (InterfaceTopic(each, "", None) for each in paths)
    name, namespace = next(iter(names), (None, ""))
    return Interface(
        tuple(published),
        tuple(subscribed),
        name,
        unread=tuple(unread),
        names=tuple(named),
        unnamed=unnamed,
        namespace=namespace,
    )


class CppFile(ScopedCode):
    """A file in C++ with the topics, callbacks and nodes that its calls and functions make."""

    @cached_property
    def topic_paths(self) -> Sequence[str]:
        """The string literals that look like topics in a namespace."""
        quoted = (self.string(self.tokens[at]) for at in self.strings)
        return [text for text in quoted if text and _PATH.fullmatch(text)]

    @cached_property
    def callbacks(self) -> Mapping[str, str]:
        """The message type of each possible callback, by the function's name."""
        found: dict[str, str] = {}
        for at in self.token_places("Subscriber"):
            end = angle(self.tokens, at + 1)
            if end is not None and is_word(text_at(self.tokens, end)):
                # A filter of messages, which gets its topic later.
                inner = split(self.tokens[at + 2 : min(end - 1, at + _MOST_WORDS)])
                found |= {text_at(self.tokens, end): joined(first) for first in inner[:1]}
        for body in self.bodies:
            groups = split(body.parameters)
            if len(groups) == 1:
                kind = _parameter_type(groups[0])
                if kind is not None:
                    found[body.name] = kind
        # A definition may be in another file, so declarations count.
        return found

    def calls_outside(self, classes: Collection[str]) -> Iterator[CppCall]:
        """Yield the calls that are in none of the given classes."""
        for call in self.calls:
            around = list(self.bodies_at(call.at)) if classes else []
            if not around or self.class_of(around[-1]) not in classes:
                yield call

    def node_names(self, classes: Collection[str]) -> Iterator[tuple[str, str]]:
        """Yield name and namespace of each node that the file creates."""
        tokens = self.tokens
        for call in self.calls_outside(classes):
            if call.name in ("Node", "LifecycleNode", "make_shared", "init"):
                is_node = call.name != "make_shared" or any("Node" in t for t in call.types)
                is_ros = call.name != "init" or text_at(tokens, call.at - 2) == "ros"
                position = 2 if call.name == "init" else 0
                if is_node and is_ros and position < len(call.arguments):
                    name, *others = (
                        self.string(each[0]) if len(each) == 1 else None
                        for each in call.arguments[position:]
                    )
                    if name:
                        yield name, next(iter(others), None) or ""

    # ---- Topics

    def topic(
        self,
        call: CppCall,
        texts: CppTexts,
        kinds: Mapping[str, str],
    ) -> "_TopicCall | Unread | None":
        """Return the topic that a call creates; None if it creates none, `Unread` if unknown."""
        tokens = self.tokens
        owner = text_at(tokens, call.at - 2) if text_at(tokens, call.at - 1) in (".", "->") else ""
        name_at, kind = 0, call.types[0] if call.types else None
        match call.name:
            case "create_publisher" | "create_subscription":
                published = call.name == "create_publisher"
                # The free functions take the node first.
                name_at = 1 if text_at(tokens, call.at - 1) == "::" else 0
                if text_at(tokens, call.at - 2) == "image_transport":
                    kind = _IMAGE
            case "advertise" | "subscribe" if owner and call.arguments:
                published = call.name == "advertise"
                kind = kind or self._taken(call, kinds) or kinds.get(owner)
                # Filters of messages take the node first.
                first, second = (*call.arguments, ())[:2]
                is_named = first[0].text.startswith('"') or not second
                name_at = 0 if is_named or not second[0].text.startswith('"') else 1
            case _ if call.name in _CAMERAS:
                # Those of ROS 2 take the node first.
                published = call.name in ("create_camera_publisher", "advertiseCamera")
                name_at = 1 if call.name.startswith("create") else 0
                kind = _IMAGE
            case "create_generic_publisher" | "create_generic_subscription":
                published = call.name == "create_generic_publisher"
                types = call.arguments[1:2]
                kind = texts.text_of(self, types[0]).text if types else None
            case "Subscriber" if kind is not None and len(call.arguments) >= 2:
                published = False
                name_at = 0 if call.arguments[0][0].text.startswith('"') else 1
            case "Publisher" if kind is not None and len(call.arguments) >= 2:
                # Libraries as realtime_tools have publisher classes of their own.
                published, name_at = True, 1
            case ("TwistPublisher" | "TwistSubscriber") | "make_unique" | "make_shared":
                wrapped = call.name if call.name in _TWISTS else (kind or "").rpartition("::")[2]
                filtered = _FILTER.fullmatch(kind or "")
                if not (filtered or wrapped in _TWISTS) or len(call.arguments) < 2:
                    return None
                published, name_at = _TWISTS.get(wrapped, False), 1
                kind = filtered["type"] if filtered else "geometry_msgs::msg::TwistStamped"
            case name if name in _SERVICES:
                return Unread(SERVICES, name, self.span(tokens[call.at]))
            case _:
                return None
        # A function of the same name may be declared.
        if name_at >= len(call.arguments) or self.is_parameter(call.arguments[name_at]):
            return None
        argument = call.arguments[name_at]
        handle = self._handle(call, name_at)
        resolved = resolved_name(argument)
        if resolved:
            # The handle that is called gives the prefix.
            handle = handle_tokens(self, self.index_of(resolved[0]) - 2)
            argument = tuple(resolved)
        value = texts.text_of(self, argument)
        span = self.span(argument[0])
        if value.text is None and value.parameter is None:
            last = argument[-1]
            shown = self.text[argument[0].offset : last.offset + len(last.text)][:60]
            return Unread(AT_RUN_TIME, shown, span)
        topic = InterfaceTopic(
            value.text or "", None if kind in ("", "auto") else kind, span, value.parameter
        )
        return _TopicCall(topic, self._keeper(call), published, handle)

    def is_parameter(self, argument: Sequence[SourceToken]) -> bool:
        """Whether an argument is the declaration of a parameter, such as `const T & name`."""
        sizes = (size for size, token in enumerate(argument) if token.text == "=")
        last = argument[next(sizes, len(argument)) - 1]
        return is_word(last.text) and self.is_typed(self.index_of(last))

    def switches(self, at: int, texts: CppTexts) -> set[tuple[str, bool]]:
        """Return the ROS parameters that decide whether a token is reached, with their values."""
        found: set[tuple[str, bool]] = set()
        for first, last, holds in self.tests_at(at):
            test = self.tokens[first : min(last, first + _MOST_WORDS)]
            is_any = len(before(test, "||")) < len(test)
            parts = [test] if is_any else split(test, angles=False, sign="&&")
            # Of a conjunction that does not hold it is unknown which part is false.
            for part in parts if holds or len(parts) == 1 else ():
                negated = text_at(part, 0) == "!"
                value = texts.text_of(self, part[negated:])
                if value.parameter is not None:
                    found.add((value.parameter, holds != negated))
        return found

    @cached_property
    def publications(self) -> dict[str, list[int]]:
        """The tokens of `publish` calls, by the variable of the publisher."""
        found: dict[str, list[int]] = {}
        for at in self.token_places("publish"):
            if text_at(self.tokens, at - 1) in (".", "->"):
                found.setdefault(text_at(self.tokens, at - 2), []).append(at)
        return found

    def _handle(self, call: CppCall, name_at: int) -> tuple[int, int]:
        """Return the token range of a call's node handle: its object, or argument 0."""
        if not name_at:
            return handle_tokens(self, call.at)
        opening = call.at + 1
        while text_at(self.tokens, opening) not in ("(", "{", ""):
            opening += 1
        return opening + 1, opening + 1 + len(call.arguments[0])

    def further_names(
        self, call: CppCall, texts: CppTexts
    ) -> Iterator[tuple[InterfaceTopic, tuple[int, int]]]:
        """Yield the name of a service, action or parameter (ROS 1) with its handle."""
        if call.name in _RENAMED:
            if text_at(self.tokens, call.at - 1) not in (".", "->"):
                return
            name_at = 0
        elif call.name in _SERVICES:
            is_free = text_at(self.tokens, call.at - 1) == "::"
            takes_node = call.name in ("create_server", "create_client") and is_free
            first = call.arguments[:1]
            is_named = bool(first) and texts.text_of(self, first[0]).text is not None
            is_action = call.name.startswith("Simple")
            name_at = 1 if takes_node or (is_action and not is_named) else 0
        else:
            return
        if name_at >= len(call.arguments):
            return
        value = texts.text_of(self, call.arguments[name_at])
        if value.text is None:
            return
        span = self.span(self.tokens[call.at])
        topic = InterfaceTopic(value.text, None, span, value.parameter)
        ends = OF_ACTION if call.name.startswith("Simple") else ("",)
        for end in ends:
            yield replace(topic, name=topic.name + end), self._handle(call, name_at)

    def _taken(self, call: CppCall, kinds: Mapping[str, str]) -> str | None:
        """Return the message type that a subscription's callback (in `kinds`) takes, or None."""
        for argument in call.arguments[1:]:
            texts = [token.text for token in argument]
            if "[" in texts:
                opening = next((i for i, t in enumerate(texts) if t == "("), None)
                if opening is not None:
                    inner = argument[opening + 1 : closing(argument, opening) - 1]
                    return _parameter_type(list(inner))
            for text in reversed(texts):
                if text in kinds:
                    return kinds[text]
        return None

    def _keeper(self, call: CppCall) -> str | None:
        """Return the variable to which a call's result is assigned, or None."""
        tokens = self.tokens
        at = call.at - 1
        while at >= 0 and text_at(tokens, at) in ("->", ".", "::", "this", "node", "node_", "nh"):
            at -= 1
        while at >= 0 and (
            is_word(text_at(tokens, at)) or text_at(tokens, at) in ("->", ".", "::")
        ):
            at -= 1
        if text_at(tokens, at) in ("=", "(", "{") and is_word(text_at(tokens, at - 1)):
            return text_at(tokens, at - 1)
        return None

    # ---- Rates

    def rates(self) -> Iterator[tuple[str, Fraction]]:
        """Yield each publisher's variable with the rate of a timer that publishes on it."""
        for hz, ranges in self._timers():
            yield from ((keeper, hz) for keeper in self._publishing(ranges))

    def _timers(self) -> Iterator[tuple[Fraction, list[tuple[int, int]]]]:
        by_name = {body.name: (body.begin, body.end) for body in self.bodies}
        clocks = [call for call in self.calls if call.name in _TIMERS or call.name in _RATES]
        for call in clocks[:_MOST_TIMERS]:
            if call.name in _TIMERS:
                periods = [seconds_in(argument) for argument in call.arguments[:2]]
                seconds = next((each for each in periods if each), None)
                hz = rate_of(seconds) if seconds else None
                if hz is None:
                    continue
                ranges = []
                for argument in call.arguments[1:]:
                    texts = [token.text for token in argument]
                    if texts[:1] == ["["]:
                        ranges.append((call.at, call.end))
                    ranges += [by_name[text] for text in texts if text in by_name]
                yield hz, ranges
            elif call.arguments:
                number = number_in(joined(call.arguments[0]))
                inner = next((b for b in self.bodies_at(call.at) if b.begin < call.at), None)
                if number and inner is not None:
                    yield number, [(inner.begin, inner.end)]

    def _publishing(self, ranges: Iterable[tuple[int, int]]) -> Iterator[str]:
        """Yield the variables on which code in ranges, and functions it calls, publish."""
        by_name = {body.name: (body.begin, body.end) for body in self.bodies}
        waiting, seen = list(ranges), set[tuple[int, int]]()
        while waiting and len(seen) < _MOST_FOLLOWED:
            begin, end = waiting.pop()
            if (begin, end) in seen:
                continue
            seen.add((begin, end))
            for at in range(begin, end):
                text = self.tokens[at].text
                if text == "publish" and text_at(self.tokens, at - 1) in (".", "->"):
                    yield text_at(self.tokens, at - 2)
                elif text in by_name and text_at(self.tokens, at + 1) == "(":
                    waiting.append(by_name[text])


def _prefixed(
    topic: InterfaceTopic, file: ScopedCode, handle: tuple[int, int], handles: Handles
) -> Iterator[InterfaceTopic | Unread]:
    """Yield a topic with its name below each possible prefix of its handle."""
    for prefix in handles.prefixes(file, *handle):
        name = prefixed_name(prefix, topic.name)
        if topic.name.startswith(("/", "~")) or not topic.name:
            yield topic
            return
        if name is None:
            yield Unread(AT_RUN_TIME, topic.name, topic.span or file.span(file.tokens[0]))
        else:
            yield replace(topic, name=name)


def _aliased(kind: str | None, aliases: Mapping[str, str | None]) -> str | None:
    """Return the type that an alias names, None if unknown; other types unchanged."""
    for _ in range(_MOST_ALIASES):
        if kind is None or kind not in aliases:
            break
        kind = aliases[kind]
    return kind


def _used_if(files: Sequence["CppFile"], keeper: str, texts: CppTexts) -> set[tuple[str, bool]]:
    """Return the ROS parameters, with values, that decide whether a publisher is used at all."""
    places = [(file, at) for file in files for at in file.publications.get(keeper, ())]
    used = [file.switches(at, texts) for file, at in places[:_MOST_FOLLOWED]]
    return set.intersection(*used) if 0 < len(places) <= _MOST_FOLLOWED else set()


def _parameter_type(tokens: Sequence[SourceToken]) -> str | None:
    """Return the type of a parameter without name and pointer types, or None."""
    words = list(tokens)
    if len(words) > 1 and is_word(words[-1].text) and words[-2].text not in ("::", "<", ","):
        words = words[:-1]
    text = joined(words)
    known = representation(text)
    # ROS 1 has `ImageConstPtr` beside `Image::ConstPtr`.
    for end in ("ConstPtr", "Ptr"):
        if known is not None and known.endswith(end):
            known = known.removesuffix(end)
    return known or None
