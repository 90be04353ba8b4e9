# été @module_start
# @module_start
# @module_name Café
# @module_end
