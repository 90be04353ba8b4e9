// @module_start
// @module_name Turn
// @ControlOut Trans_Z, Rotn_Y
// @Window 50
Command turn(Heading heading, Sweep sweep);
// @Done
Heading arrived();
// @Reset
void restart(Moved moved);
// @Reset
void again();
// @Done NotifyWhenReady
Heading late();
// @Done
Heading left(Sweep sweep);
// @Window soon
// @DataOut NotifyWhenReady
Heading right(Sweep sweep);
// @Window 50
// @Done
Heading gone();
// @module_end
// @module_start
// @module_name Eye
// @Sense NotifyWhenReady
// @Window 50
Sweep see();
// @module_end
