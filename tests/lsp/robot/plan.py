# @module_start
# @module_name Planner
# @ControlOut Trans_Z
def drive(image: Image) -> Motion: ...


# @module_end
