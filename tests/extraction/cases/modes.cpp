// @module_start
// @module_name A
// @Sense
X a();
// @Sense NotifyWhenReady 25
X b();
// @Sense NotifyAtFrequency 25 Hz
X c();
// @Sense NotifyAtFrequency 2.5, RequestWhenReady, NotifyOnMin(300, of=nearest)
X d();
// @Sense notifyWhenReady
X e();
// @Sense NotifyWhenReady RequestWhenReady
X f();
// @Sense NotifyWhenReady, , RequestWhenReady
X g();
// @Sense NotifyAtFrequency 0
X h();
// @Sense NotifyAtFrequency(25)
X i();
// @Sense NotifyAtFrequency 1e3
X j();
// @Sense NotifyWhenReady(3)
X k();
// @Sense 25
X l();
// @Sense NotifyOnValue(a)
X m();
// @Sense NotifyAtFrequency 25, NotifyOnChange 5
X n();
// @module_end
