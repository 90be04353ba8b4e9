// @module_start
// @module_name Camera
// 😀 @Sense is not the first word of this comment
// @Sense NotifyAtFrequency 20
Image grab();
// @module_end
