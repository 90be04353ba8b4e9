"""The syntax and meaning, in a sentence, of each keyword of `.mars` files and annotations.

A test ensures that all keywords of the language, of annotations and of modes are listed.
"""

from collections.abc import Mapping
from typing import NamedTuple


class KeywordDoc(NamedTuple):
    """A keyword: its syntax with arguments, and its meaning."""

    written: str
    meaning: str


#: The keywords of a `.mars` file.
STATEMENTS: Mapping[str, KeywordDoc] = {
    "@configuration": KeywordDoc(
        "@configuration [flat | hierarchical] [period MS]",
        "Begins a configuration: which modules there are and how they are related. `flat` control "
        "takes the mean of all commands, `hierarchical` control the one of the highest priority.",
    ),
    "@specification": KeywordDoc(
        "@specification [flat | hierarchical] [period MS]",
        "Begins a specification: a configuration with the nodes that realise it.",
    ),
    "@modules": KeywordDoc(
        "@modules NAME, NAME: DESCRIBED, ...",
        "Lists the modules of the robot. `left: Camera` is a module that `Camera` describes.",
    ),
    "@sources": KeywordDoc(
        "@sources PATH, PATH ...",
        "Names annotated sources: files, folders or globs, relative to this file.",
    ),
    "@Tag": KeywordDoc("NAME @Tag TAG", "States of a module what a rule pack declares as a tag."),
    "@Property": KeywordDoc(
        "NAME @Property PROPERTY VALUE",
        "States of a module what a rule pack declares as a property.",
    ),
    "@include": KeywordDoc(
        "@include PATH [as NAME]",
        "Takes in the modules and relationships of another configuration; `Arm` becomes "
        "`NAME/Arm`.",
    ),
    "is_mounted_on": KeywordDoc(
        "NAME [VERTEX] is_mounted_on NAME [VERTEX] [TRANSFORMATION]",
        "Mounts a module on another one, which moves it along. The tuple is `(axis, degrees, axis, "
        "degrees, x, y, z)` in degrees and millimetres.",
    ),
    "is_controlled_by": KeywordDoc(
        "NAME is_controlled_by NAME [PRIORITY] [hold MS]",
        "Lets a module command another one. A higher number wins; a list of controllers has "
        "ascending priorities from 0.",
    ),
    "uses_data_from": KeywordDoc(
        "NAME[.INPUT] uses_data_from NAME[.OUTPUT] [MODE] [HZ | every N ms]",
        "Delivers data of the right module to the left one, in a mode and at a rate where these "
        "are stated.",
    ),
    "flat": KeywordDoc("flat", "Control in which an arbiter takes the mean of all commands."),
    "hierarchical": KeywordDoc("hierarchical", "Control in which the highest priority wins."),
    "period": KeywordDoc("period MS", "How many milliseconds a flat arbiter takes its mean over."),
    "hold": KeywordDoc(
        "hold MS | forever", "How long a command of this controller stays in force."
    ),
    "forever": KeywordDoc("hold forever", "A command of this controller stays in force for good."),
    "every": KeywordDoc(
        "every N ms | every N s", "The time between two messages, instead of a rate."
    ),
    "allocation": KeywordDoc(
        "allocation root | split",
        "Which of several modules that give an inherited function carries it out.",
    ),
    "root": KeywordDoc(
        "allocation root", "The module nearest to the root carries the function out."
    ),
    "split": KeywordDoc("allocation split", "All modules that give the function carry it out."),
}

_MOTION = "[MIN MAX [RATE]]"


#: The words of annotations, without their `@`.
ANNOTATIONS: Mapping[str, KeywordDoc] = {
    "module_start": KeywordDoc(
        "@module_start", "Begins a module; what is annotated until `@module_end` belongs to it."
    ),
    "module_name": KeywordDoc("@module_name NAME", "Names the module."),
    "module_end": KeywordDoc("@module_end", "Ends the module."),
    "Sense": KeywordDoc(
        "@Sense MODES [HZ]",
        "A sensor: the declaration that follows delivers data. `NotifyAtFrequency` needs its HZ.",
    ),
    "DataOut": KeywordDoc(
        "@DataOut MODES [HZ]",
        "An algorithm that delivers data: what the declaration that follows returns.",
    ),
    "ControlOut": KeywordDoc(
        "@ControlOut [FUNCTIONS]",
        "An algorithm that commands others, in these functions where they are named.",
    ),
    "DataIn": KeywordDoc(
        "@DataIn", "The declaration that follows only consumes data, as a screen does."
    ),
    "Converts": KeywordDoc(
        "@Converts [COST]",
        "A converter: makes its return type of its one parameter, at a cost (default 1).",
    ),
    **{
        f"{function}_{axis}": KeywordDoc(
            f"@{function}_{axis} {_MOTION}",
            f"The module {moves} its {axis} axis; bounds in {unit}, RATE per second.",
        )
        for function, moves, unit in (
            ("Rotn", "turns about", "degrees"),
            ("Trans", "moves along", "millimetres"),
        )
        for axis in "XYZ"
    },
    "Grasp": KeywordDoc(
        f"@Grasp {_MOTION}",
        "A two-fingered gripper; bounds are its opening width in millimetres.",
    ),
    "Vertex": KeywordDoc(
        "@Vertex N [TRANSFORMATION]", "Where vertex N is in the module's reference frame."
    ),
    "Guard": KeywordDoc(
        "@Guard",
        "A module through which every command to what it controls is meant to pass.",
    ),
    "Tag": KeywordDoc("@Tag NAME", "States of the module what a rule pack declares as a tag."),
    "Property": KeywordDoc(
        "@Property NAME VALUE", "States of the module what a rule pack declares as a property."
    ),
    "Output": KeywordDoc(
        "@Output TYPE | NAME | none",
        "What the declaration delivers, instead of its return type: a type or a parameter.",
    ),
    "Input": KeywordDoc(
        "@Input TYPE, TYPE | NAME: TYPE",
        "What the declaration takes in, instead of the types of its parameters.",
    ),
    "Port": KeywordDoc("@Port NAME", "The name of the output, instead of that of the function."),
    "Signature": KeywordDoc(
        "@Signature DECLARATION", "Is read instead of a declaration that cannot be read."
    ),
}

#: The delivery modes.
MODES: Mapping[str, KeywordDoc] = {
    "NotifyWhenReady": KeywordDoc("NotifyWhenReady", "Sends each message as soon as there is one."),
    "NotifyAtFrequency": KeywordDoc("NotifyAtFrequency HZ", "Sends messages at a rate in Hertz."),
    "NotifyOnMax": KeywordDoc(
        "NotifyOnMax[(LIMIT)]",
        "Sends a message where the value reaches LIMIT; without one, where it is above all before.",
    ),
    "NotifyOnMin": KeywordDoc(
        "NotifyOnMin[(LIMIT)]",
        "Sends a message where the value falls to LIMIT; without one, where it is "
        "below all before.",
    ),
    "NotifyOnValue": KeywordDoc(
        "NotifyOnValue[(VALUE[, TOLERANCE])]", "Sends a message where the value becomes this one."
    ),
    "NotifyOnChange": KeywordDoc(
        "NotifyOnChange[(DIFFERENCE)]", "Sends a message where the value has changed so much."
    ),
    "RequestWhenReady": KeywordDoc("RequestWhenReady", "Sends a message when one is asked for."),
}

#: The keys of comments above rules.
METADATA: Mapping[str, KeywordDoc] = {
    "id": KeywordDoc("%! id: FILE/NAME", "The name of the rule, which is unique."),
    "because": KeywordDoc(
        "%! because: TEXT", "What the rule tells; `{X}` is a variable of its body."
    ),
    "help": KeywordDoc("%! help: TEXT", "What to do about it."),
    "why": KeywordDoc("%! why: TEXT", "What the rule is about and why that matters."),
    "example": KeywordDoc("%! example: PATH", "A case in which the rule fires."),
    "effect": KeywordDoc("%! effect: TEXT", "What will happen, in a sentence."),
    "fits": KeywordDoc("%! fits: TEXT", "Why what the rule computes fits into 32 bits."),
    "who": KeywordDoc("%! who: TERM, ...", "Who takes part in the consequence."),
    "at": KeywordDoc("%! at: TERM, ...", "The lines that the consequence is about."),
    "in": KeywordDoc("%! in: TERM, ...", "The launch trees in which the consequence holds."),
    "lines": KeywordDoc("%! lines: TERM, ...", "The lines that an answer to why not speaks of."),
}
