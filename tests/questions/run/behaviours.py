"""What the modules of these scenarios do, some of them wrongly."""

from itertools import count

_calls = count(1)


def go():
    return "Trans_Z", 400


def spin():
    return "Rotn_Y", 45


def bad(ranges):
    raise ValueError("no echo in beam 3")


def sometimes(ranges):
    if next(_calls) % 7 == 3:
        return {}["beam"]
    return min(ranges)


def halt():
    raise ValueError("no plan")


def grab():
    return "Grasp", 40


def look(near):
    return ("Rotn_Y", 30) if near < 900 else None
