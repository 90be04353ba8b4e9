// @module_start
// @module_name
// @Sense RequestWhenReady
X a();
// @module_end
// @module_start
// @Sense RequestWhenReady
X b();
// @module_end
// @module_start
// @module_name Left Camera
// @module_end
// @module_start
// @module_name 2nd
// @module_end
// @module_start
// @module_name A
// @module_name B
// @module_end
// @module_start
//   @module_name   A
// @module_end
// @module_start
// @module_name Camera-1
// @module_end
