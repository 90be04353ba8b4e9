// @module_start
// @module_name Head
// @Rotn_Y -90 90
fn pan(rate: f64) {}
/* a /* nested */ comment
 * @Sense NotifyAtFrequency 10 */
#[inline]
pub fn grab<'a>(c: char, s: &'a str) -> Result<Box<Image>, Error> { let q = '"'; todo!() }
// @module_end
