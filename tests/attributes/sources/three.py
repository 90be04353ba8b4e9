"""A camera in Python."""


class Image:
    """What it delivers."""


class Python:
    """The camera."""

    # @module_start
    # @module_name Python
    # @Tag safety_critical
    # @Property latency_ms 3
    # @Sense NotifyWhenReady
    @property
    def python(self) -> Image:
        """Take a picture."""
        return Image()

    # @module_end
