
/// Panics in a step for every input but 0 and -1, and at the start for 2; not a number for -1: what a mistake in a
/// model must not do to its host.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Bomb { fuse: f64, left: f64 }

impl Model for Bomb {
    const NAME: &'static str = "bomb";
    const DESCRIPTION: &'static str = "Panics";
    fn variables() -> Table<Self> {
        Table::new([
        input("fuse", "1", real!(fuse), 0.0, "Burns"),
        output("left", "1", real!(left), "What is left"),
    ])
    }

    fn step_size(&self) -> f64 { 1e-4 }

    fn initialize(&mut self) -> Result<()> {
        assert!(self.fuse != 2.0, "boom at the start");
        Ok(())
    }

    fn step(&mut self, _length: f64) -> Result<()> {
        assert!(self.fuse <= 0.0, "boom");
        self.left = 1.0 + self.fuse.sqrt();
        Ok(())
    }
}
