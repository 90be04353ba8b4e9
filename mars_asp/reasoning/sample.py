"""Sample robots that together have facts of nearly every predicate, to try rule packs on.

Their facts are made when the package is built: to read the robots takes as long as to read a pack.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import memoized
from mars_asp.asp.solve.atoms import Fact
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import MissingFile, Muxed
from mars_asp.reasoning.project import Project, load_project, project_facts

_RANKED = """\
@configuration hierarchical
@modules Camera, Screen, Log, Tool, Head, Platform, Finder, Joystick, Console, Recorder
Screen uses_data_from Camera NotifyAtFrequency 10
Log uses_data_from Camera RequestWhenReady
Finder uses_data_from Camera
Recorder uses_data_from Logg
Finder uses_data_from Recorder
Recorder uses_data_from Finder
Head is_mounted_on Platform (_,_,_,_,_,100)
Camera is_mounted_on Head
Tool is_mounted_on Head 1 (x,45,_,_,_,250,30)
Tool is_controlled_by Finder 1 hold 200 allocation root
Tool is_controlled_by Joystick 2
Head is_controlled_by Joystick 2
Platform is_controlled_by Console, Joystick

@module_start
@module_name Camera
@Sense NotifyAtFrequency 25, RequestWhenReady
image::Raw grab();
@module_end
@module_start
@module_name Screen
@DataIn
void show(Lines lines, void *hint);
@module_end
@module_start
@module_name Recorder
@DataIn
void keep(Raw frame, other::Raw second);
@module_end
@module_start
@module_name Outline
@Converts 2
Edges outline(image::Raw image);
@module_end
@module_start
@module_name Join
@Converts
Lines join(Edges edges);
@module_end
@module_start
@module_name Finder
@ControlOut Trans_X, Rotn_Y
Command find(Lines lines);
@module_end
@module_start
@module_name Tool
@Grasp 0 120 50
void grasp(double width);
@module_end
@module_start
@module_name Head
@Rotn_Y
void pan(double rate);
@Rotn_X -90 90 60
void nod(double rate);
@module_end
@module_start
@module_name Platform
@Rotn_Y
void turn(double rate);
@Trans_Z _ _ 500
void drive(double rate);
@module_end
"""
_FLAT = """\
@specification flat period 50
@modules Eye, Map, Track, DataSplitter1, Wheel, Push, Pull, ArbitrationNode
DataSplitter1 uses_data_from Eye
Map uses_data_from DataSplitter1
Track uses_data_from DataSplitter1
ArbitrationNode is_controlled_by Push 3
ArbitrationNode is_controlled_by Pull 1
Wheel is_controlled_by ArbitrationNode
"""
_PORTS = """\
@configuration
@modules Stereo, Fuse, Monitor, Base
Fuse.near uses_data_from Stereo.left every 51 ms
Base is_controlled_by Monitor

@module_start
@module_name Stereo
@Sense NotifyAtFrequency every 17 ms
Image left();
@Sense NotifyWhenReady
Image right();
@module_end
@module_start
@module_name Fuse
@DataIn
void fuse(Image near, Image far);
@module_end
@module_start
@module_name Monitor
@Guard
@ControlOut
Command watch();
@module_end
"""


def samples() -> tuple[Project, ...]:
    """Return the robots."""
    ranked, flat = load_project("ranked.mars", text=_RANKED), load_project("flat.mars", text=_FLAT)
    # Only foreign files have muxes, missing files and nodes that were not read.
    mux = Muxed("Platform", "twist_mux", ranked.configuration.span)
    node = ranked.configuration.modules[0]
    read = replace(ranked.configuration, muxes=(mux,), opaque=(node,), format="twist_mux")
    missing = MissingFile(node.text, "path", "./camera.py", node.span, builds=True)
    read = replace(read, origin="twist_mux", missing=(missing,))
    muxed = replace(ranked, configuration=read)
    return muxed, flat, load_project("ports.mars", text=_PORTS)


class Sampled(NamedTuple):
    """The facts of a robot, and where its configuration is."""

    facts: tuple[Fact, ...]
    span: Span


def sampled() -> Iterator[Sampled]:
    """Yield the facts of each robot, one robot after the other."""
    for number in range(_COUNT):
        yield memoized("samples", _makers(), [number], _sampled)[number]


#: How many robots there are.
_COUNT = 3


def _sampled(number: int) -> Sampled:
    project = samples()[number]
    return Sampled(project_facts(project), project.configuration.span)


@cache
def _makers() -> tuple[Path, ...]:
    """Return the source files on which the facts of the samples depend."""
    package = Path(__file__).parents[1]
    folders = ("annotations", "kinematics", "language", "model", "reasoning/facts")
    found = [path for folder in folders for path in (package / folder).rglob("*.py")]
    return tuple(sorted((*found, *Path(__file__).parent.glob("*.py"))))
