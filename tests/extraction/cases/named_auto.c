// @module_start
// @module_name A
// @DataOut NotifyWhenReady
Command auto();
// @module_end
