// @module_start
// @module_name A
// @DataOut RequestWhenReady
// @Input zzz: Scan
Map f(Scan s);
// @DataOut RequestWhenReady
// @Output Map
// @Output Grid
bool g(Scan s, Map & out);
// @Output Map
int x;
// @DataOut RequestWhenReady
// @Input Scan, Imu
// @Input s: none
Map h(Scan s);
// @DataOut RequestWhenReady
// @Output out
// @Input time: none
bool i(Scan s, Map & out, Stamp time);
// @DataOut RequestWhenReady
// @Output
Map j(Scan s);
// @DataOut RequestWhenReady
// @Output 3 maps
Map k(Scan s);
// @DataOut RequestWhenReady
// @Input none
// @Output std::vector<Map>
int l(Scan s);
Map m(Scan s);
// @Output Map
// @module_end
