"""The topics that the program of a node publishes and subscribes to, as the program names them."""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

from mars_asp.diagnostic import Span
from mars_asp.exchange.unread import Unread
from mars_asp.model.rates import Rate

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class InterfaceTopic:
    """A topic as a program names it.

    `parameter` is the parameter that gives the name, if any, and `name` its default, empty without
    one. `type` is the message type and `hz` the rate of publication, if known; `span` is its
    location in the program, or None if it comes from the catalogue; `optional` is whether the
    program works as well without it, `measured` whether it reports a motion, whatever its type;
    `last` is whether it is published only as the program ends. The program has the topic only if
    each parameter of `switches` has the paired value. `image` is the image topic of a camera's
    information, which stays beside the image if that is renamed. `parts` are the texts that make up
    a name with parameters in it: each a text, or the default of the parameter beside it.
    """

    name: str
    type: str | None
    span: Span | None = None
    parameter: str | None = None
    hz: Fraction | None = None
    optional: bool = False
    measured: bool = False
    last: bool = False
    switches: tuple[tuple[str, bool], ...] = ()
    image: str = ""
    parts: tuple[tuple[str | None, str | None], ...] = ()


#: What topics are called that a program, or a client of it, names while it runs.
AT_RUN_TIME = "topics named at run time"
BY_CLIENTS = "topics chosen by clients"
NOT_FOLLOWED = "imports of sources that are not in the workspace"
SERVICES = "services and actions"
FURTHER_NODES = "further nodes of one program"
#: The endings of the names of an action and of its topics in ROS 1.
OF_ACTION = ("", "/goal", "/cancel", "/status", "/feedback", "/result")


@dataclass(frozen=True, slots=True)
class Interface:
    """The topics of a program, the name that it gives its node, and whether it is a guard.

    `unread` are its other effects, and topics known only at run time. `clients` is whether other
    programs choose further topics while it runs, `listens` whether they choose its subscriptions,
    `spread` whether it is several nodes, with private topics below the namespace that they are
    given, or else below its name. `names` are those of its services, actions and, in ROS 1,
    parameters, which can also be renamed; `unnamed` is whether it has further ones. `namespace` is
    that of its node if the launch file gives it none, and `is_name_sure` is whether its name is the
    same in every version. `observes` is the node in its process, `~` itself, whose parameters name
    sources of observation, empty if none.
    """

    published: tuple[InterfaceTopic, ...] = ()
    subscribed: tuple[InterfaceTopic, ...] = ()
    node: str | None = None
    guard: bool = False
    unread: tuple[Unread, ...] = ()
    clients: bool = False
    spread: bool = False
    is_name_sure: bool = False
    listens: bool = False
    names: tuple[InterfaceTopic, ...] = ()
    unnamed: bool = False
    namespace: str = ""
    observes: str = ""


def agreed(pairs: Iterable[tuple[str, T]]) -> dict[str, T | None]:
    """Return the common value of each name, or None if its values differ."""
    found: dict[str, T | None] = {}
    for name, value in pairs:
        found[name] = value if found.get(name, value) == value else None
    return found


def rate_of(period: Fraction) -> Rate | None:
    """Return the rate of a period in seconds, above 0; None if it cannot be written exactly."""
    try:
        return Rate(1 / period)
    except ValueError:
        return None
