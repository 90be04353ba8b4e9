// @module_start
// @module_name A
// @DataOut RequestWhenReady
pub async fn plan(&mut self, g: &'_ msgs::msg::Grid, p: Option<Arc<Pose>>, t: Duration, f: impl Fn(A) -> B) -> Result<Vec<Pose>, Box<dyn Error>> { todo!() }
// @DataOut NotifyWhenReady
fn stream(rx: Receiver<Scan>) -> impl Iterator<Item = Map> + '_ { todo!() }
// @DataOut NotifyWhenReady
// @Output out
fn fill(s: &Scan, out: &mut Map) -> bool { true }
// @DataOut NotifyWhenReady
fn both(x: (A, B), y: [[f64; 3]; 3], z: HashMap<String, Pose>) -> (C, D) { todo!() }
// @DataOut NotifyWhenReady
struct NotAFunction;
// @module_end
