//! Film files: parts of a render, operations on them, and interrupted writers.

mod files;
mod shares;
mod writers;

use crate::common::{Ran, Workplace};

impl Workplace {
    /// Renders a part of seven passes into a film file.
    fn render_share(&self, share: &str, film: &str) -> Ran {
        self.run(&format!(
            "render room.pbrt --passes {share} -q --checkpoint {film}"
        ))
        .expect(0)
    }

    #[track_caller]
    fn expect_same(&self, a: &str, b: &str) {
        self.run(&format!("compare {a} {b} --exact")).expect(0);
    }
}
