# @module_start
# @module_name A
# @Data_Out RequestWhenReady
# @Output Grid
def build(s: Scan): ...
# @DataOut RequestWhenReady
# @ouput Grid
def build2(s: Scan): ...
# @Ouput Map
# @DataOut RequestWhenReady
def build3(s: Scan): ...
# @Sense, NotifyWhenReady
def grab() -> Image: ...
# @notify me
# @since 1.2
# @param x
# @module_end;
