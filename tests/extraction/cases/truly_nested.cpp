// @module_start
// @module_name Outer
// @Sense RequestWhenReady
X f();
// @module_start
// @module_name Inner
// @Sense RequestWhenReady
Y g();
// @module_end
// @DataOut RequestWhenReady
Z h(X x);
// @module_end
// @module_end
