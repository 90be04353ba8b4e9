// @module_start
// @module_name Offers
// @DataOut NotifyWhenReady
std::function<void(Map)> subscriber(Scan scan);
// @DataOut RequestWhenReady
Map (*reader(Scan scan))(int);
// @DataIn
void keep(std::function<void()> done, Map map);
// @ControlOut Trans_Z,
Command drive(Map map);
// @ControlOut Trans_Z,,Rotn_Y
Command turn(Map map);
// @module_end
