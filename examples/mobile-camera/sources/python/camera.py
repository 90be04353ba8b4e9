"""The camera and the screen that shows what it sees."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ImageFormat:
    """Grey values of an image, row by row."""

    width: int
    height: int
    pixels: bytes


# @module_start
# @module_name Camera
# @Sense NotifyAtFrequency 25
def grabimage() -> ImageFormat:
    """Return what the camera sees; a chequered wall, as long as there is none."""
    width, height = 64, 48
    return ImageFormat(width, height, bytes(255 * ((k // 8) % 2) for k in range(width * height)))
# @module_end


class OperatorScreen:
    """Shows the latest image."""

    # @module_start
    # @module_name OperatorScreen
    # @DataIn
    def show(self, image: ImageFormat) -> None:
        self.latest = image
    # @module_end
