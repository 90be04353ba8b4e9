"""What a Watchdog does in a run."""

from mars_asp.behaviour import Command


class Watchdog:
    """Hands on the commands that it hears, and stops the effector once they expire."""

    def step(self, command: Command | None) -> Command | None:
        """Return what was commanded; nothing is commanded any more where nothing is in force."""
        return command or None
