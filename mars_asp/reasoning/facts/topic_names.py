"""Which names of topics may be meant for one topic."""

import re

from mars_asp.spelling import nearest

_NUMBERED = re.compile(r"\d")


def are_alike(topic: str, other: str) -> bool:
    """Whether two different topics differ by a namespace, or in the spelling or parts of one word.

    Parts are between underscores: `cmd_vel` and `cmd_vel_nav`.
    """
    words, others = topic.split("/")[1:], other.split("/")[1:]
    if len(words) != len(others):
        return is_in_namespace(topic, other)
    different = [pair for pair in zip(words, others, strict=True) if pair[0] != pair[1]]
    if len(different) != 1:
        return False
    [(word, another)] = different
    short, long = sorted((word.split("_"), another.split("_")), key=len)
    remaining = iter(long)
    has_parts = len(short) < len(long) and all(part in remaining for part in short)
    return has_parts or is_misspelt(topic, other)


def is_in_namespace(topic: str, other: str) -> bool:
    """Whether one of two topics has the name of the other in a further namespace."""
    return topic != other and (topic.endswith(other) or other.endswith(topic))


def is_misspelt(topic: str, other: str) -> bool:
    """Whether two different topics differ in the spelling of one part of one word.

    Underscores and capitals are such a difference: `estop` and `e_stop`.
    """
    if topic != other and topic.count("/") == other.count("/"):
        plain, further = (name.replace("_", "").lower() for name in (topic, other))
        if plain == further:
            return True
    parts, others = (re.split("[/_]", name) for name in (topic, other))
    if len(parts) != len(others) or topic.count("/") != other.count("/"):
        return False
    odd = [pair for pair in zip(parts, others, strict=True) if pair[0] != pair[1]]
    # `camera1` and `camera2` are two names, and so are `left_wheel` and `right_wheel`.
    return (
        len(odd) == 1
        and not _NUMBERED.search("".join(odd[0]))
        and nearest(odd[0][0], odd[0][1:]) is not None
    )
