"""Programs in Python over several files: imports are followed, or noted as missing."""

from collections.abc import Mapping

import pytest

from mars_asp.exchange.ros2.interface import NOT_FOLLOWED
from mars_asp.exchange.ros2.source_python import PythonPrograms

NODE = "class N(Node):\n  def __init__(self):\n    self.create_publisher(A, 't', 1)\n"
MAIN = "def main():\n  N()\n"

#: Modules with their texts, and the names that are not found; the topic is, where none is.
PROGRAMS: list[tuple[Mapping[str, str], list[str]]] = [
    ({"p.main": f"from .core.node import N\n{MAIN}", "p.core.node": NODE}, []),
    (
        {
            "p.main": f"from .core import N\n{MAIN}",
            "p.core": "from .node import N",
            "p.core.node": NODE,
        },
        [],
    ),
    ({"p.main": f"from .core import *\n{MAIN}", "p.core": NODE}, []),
    ({"p.main": "from .core import node\ndef main():\n  node.N()\n", "p.core.node": NODE}, []),
    ({"p.main": "import p.node\ndef main():\n  p.node.N()\n", "p.node": NODE}, []),
    ({"p.main": f"from p.node import N\n{MAIN}", "p.node": NODE}, []),
    (
        {
            "p.main": "import asyncio\nfrom .node import N\nasync def start():\n  N()\n"
            "def main():\n  asyncio.run(start())\n",
            "p.node": NODE,
        },
        [],
    ),
    ({"p.main": f"from .node import N\n{MAIN}"}, ["p.node.N"]),
    ({"p.main": f"from .node import N\n{MAIN}", "p.node": "class N(:"}, ["p.node.N"]),
    ({"p.main": f"from p.node import N\n{MAIN}", "p": ""}, ["p.node.N"]),
    (
        {"p.main": f"from .core import N\n{MAIN}", "p.core": "from .node import N"},
        ["p.core.node.N"],
    ),
]  # fmt: skip

PACKAGES = frozenset({"p", "p.core"})


def find(texts: Mapping[str, str], module: str) -> tuple[str, str] | None:
    end = "/__init__.py" if module in PACKAGES else ".py"
    return (texts[module], module.replace(".", "/") + end) if module in texts else None


@pytest.mark.parametrize(("texts", "missing"), PROGRAMS)
def test_imports_are_followed_or_noted(texts: Mapping[str, str], missing: list[str]) -> None:
    found = PythonPrograms(lambda module: find(texts, module)).interface("p.main", "main")
    assert found is not None
    assert [topic.name for topic in found.published] == ([] if missing else ["t"])
    assert [note.name for note in found.unread if note.sort == NOT_FOLLOWED] == missing


#: Imports that no source of the workspace has to give.
FOREIGN = [
    "from other import N",
    "from p.msg import N",
    "from .node import LIMIT as N",
    "import numpy as N",
]


@pytest.mark.parametrize("statement", FOREIGN)
def test_imports_of_libraries_messages_and_constants_are_not_missing(statement: str) -> None:
    texts = {"p": "", "p.main": f"{statement}\n{MAIN}", "p.node": "LIMIT = 3\n"}
    found = PythonPrograms(lambda module: find(texts, module)).interface("p.main", "main")
    assert found is not None and not found.unread
