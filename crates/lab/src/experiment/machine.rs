//! The machine of an experiment, on which times depend.

use crate::results::Machine;
use bidir::scene::Isa;

impl Machine {
    /// The processor's name if the system gives none.
    pub const UNKNOWN: &'static str = "unknown";

    /// Describes this machine; [`run`](super::run()) fills in the number of threads.
    pub fn here() -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = processor.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            (name.trim() == "model name").then(|| value.trim().to_owned())
        });
        Self {
            processor: model.unwrap_or_else(|| Self::UNKNOWN.to_owned()),
            isa: Isa::detect().name().to_owned(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            threads: 0,
        }
    }
}
