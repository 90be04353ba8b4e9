"""Strategies of Hypothesis for configurations."""

from decimal import Decimal

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from mars_asp.diagnostic import point
from mars_asp.model.declarations import FOREVER, Configuration, Control, Data, Mode, Mount, Name
from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, every
from tests.support.campaigns import examples

HERE = point("config.mars", 1, 1)
NAMES = ("A", "B", "/robot1/base", "dora-camera", 'the "3 # eyes"', "Wheel")
#: Instances: modules that another, which is named or not, describes.
DESCRIBED = {"B": "A", "dora-camera": 'the eye\'s "driver"', "Wheel": "/base"}
few = settings(
    max_examples=examples(15, 60),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=True,
)

names = st.sampled_from(NAMES)
modes = st.sampled_from(
    [
        (None, None),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), Rate(Decimal("12.5"))),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), Rate(Decimal("0.001"))),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), Rate(Decimal("2147483.647"))),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), Rate(Decimal("58.8235294117647"))),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), every(17, "ms")),
        (Mode("NotifyAtFrequency", text="NotifyAtFrequency"), every(3, "s")),
        (Mode("RequestWhenReady", text="RequestWhenReady"), None),
        (Mode("NotifyOnMax", (Decimal(80),), text="NotifyOnMax(80)"), None),
    ]
)
#: Slashes, a blank, a quote, names quoted for a `.` or as a number, and a number after `#`.
ports = st.none() | st.sampled_from(
    ["image", "/imu/data", "bumper response", 'say "go"', "a.b", "3", "Raw#2", "hold", "every"]
)
data = st.builds(
    lambda client, source, mode, *ends: Data(client, source, HERE, *mode, *ends),
    names,
    names,
    modes,
    ports,
    ports,
)
control = st.builds(
    lambda controlled, controller, priority, hold: Control(
        controlled, controller, HERE, priority, hold
    ),
    names,
    names,
    st.none() | st.integers(0, 3) | st.sampled_from([50_000, MOST - 1, MOST]),
    st.none() | st.integers(1, 500) | st.just(MOST) | st.just(FOREVER),
)
mount = st.builds(
    lambda mounting, mounted, vertex: Mount(mounting, mounted, HERE, vertex, vertex),
    names,
    names,
    st.none() | st.integers(0, 4) | st.just(MOST),
)
configurations = st.builds(
    lambda relationships, architecture, kind: Configuration(
        "config.mars",
        HERE,
        kind,
        architecture,
        architecture == "hierarchical",
        modules=tuple(Name(n, HERE, DESCRIBED.get(n)) for n in NAMES),
        relationships=tuple(relationships),
    ),
    st.lists(data | control | mount, max_size=9, unique=True),
    st.sampled_from(["flat", "hierarchical"]),
    st.sampled_from(["configuration", "specification"]),
)
