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
        short, long = sorted((words, others), key=len)
        return long[-len(short) :] == short
    different = [pair for pair in zip(words, others, strict=True) if pair[0] != pair[1]]
    if len(different) != 1:
        return False
    [(word, another)] = different
    parts, further = word.split("_"), another.split("_")
    if len(parts) != len(further):
        short, long = sorted((parts, further), key=len)
        remaining = iter(long)
        return all(part in remaining for part in short)
    return is_misspelt(topic, other)


def is_misspelt(topic: str, other: str) -> bool:
    """Whether two different topics differ in the spelling of one part of one word."""
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
