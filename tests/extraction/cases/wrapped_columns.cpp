// @module_start
// @module_name A
// @Sense NotifyWhenReady, -- as it comes
//        NotifyAtFreq 5
X f();
// @DataOut NotifyWhenReady,
//   NotifyAtFrequency 25, -- both
//   NotifyOnValue(30, 0.5)
X g(Y y);
// @module_end
