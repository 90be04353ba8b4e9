# @module_start
# @module_name Gps
# @Sense NotifyAtFrequency 5
def read() -> Fix: ...
# @module_end

# # @module_start
# # @module_name Compass
# # @Sense NotifyAtFrequency 5
# def turn() -> Heading: ...
# # @module_end
#% @module_start
#: @module_start
"""
# @module_start
"""
