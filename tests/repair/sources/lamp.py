class Light: ...


# @module_start
# @module_name Lamp
class Lamp:
    # @DataIn
    def shine(self, light: Light) -> None: ...


# @module_end
