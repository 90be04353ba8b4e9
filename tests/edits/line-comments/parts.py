# @module_start
# @module_name Lamp
class Lamp:
    #@DataIn
    def shine(self, light: Light) -> None: ...


# @module_end
# @module_start
# @module_name Ear
    @property
    def hear(self) -> Echoes: ...
# @module_end
