// @module_start
// @module_name A
// @Sense RequestWhenReady
X f();
// @module_end
// @module_start
//     @module_name A
// @Sense RequestWhenReady
X f();
// @module_end
