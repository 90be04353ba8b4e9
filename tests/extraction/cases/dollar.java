// @module_start
// @module_name Doors
// @DataOut NotifyWhenReady
public Rooms$Door find(Outer$Inner<Häuser$Änderung> scan, $Own own);
// @Output nav.Rooms$Door
// @DataOut RequestWhenReady
Object ask();
// @module_end
