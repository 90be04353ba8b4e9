# A file with no module, and yet an annotation.
# Write to joe@Sense.com, or see @param.
import angular  # @Input x


# @Sense NotifyAtFrequency 25
def grab() -> Image: ...


# @DataOut RequestWhenReady
def plan(i: Image) -> Path: ...
