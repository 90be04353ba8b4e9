class Light: ...


class Echoes: ...


# @module_start
# @module_name Lamp
class Lamp:
    # @DataIn
    def shine(self, light: Light) -> None: ...


# @module_end
# @module_start
# @module_name Ear
class Head:
    # @Rotn_Z
    @property
    def hear(self) -> Echoes:
        return Echoes()


# @module_end
