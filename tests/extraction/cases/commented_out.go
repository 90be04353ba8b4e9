package robot

// @module_start
// @module_name Gps
// @Sense NotifyAtFrequency 5
func read() Fix { return Fix{} }

// @module_end

/*
// @module_start
// @module_name Compass
// @Sense NotifyAtFrequency 5
func turn() Heading { return Heading{} }

// @module_end
*/

// // @module_start
