"""Whether rules keep the modules apart that nothing in a configuration connects.

Facts name modules and relationships, and say by that which of them belong together. Rules keep
them apart when each instance is about one such part alone: all its literals that tell parts apart
are linked by variables whose values hold the name or identifier of something in the part. Then the
ground program of a configuration is that of its parts side by side, and each can be resolved by
itself. That is found out from the rules alone, by the shapes that hold for the arguments of every
atom they can derive.

What the rules of the base derive is known as a whole; only the rules of the resolution need to
keep parts apart. Of the others no more is asked than what they promise of their heads.
"""

from mars_asp.asp.slice.portions import Apart, Portion, kept_apart

__all__ = ["Apart", "Portion", "kept_apart"]
