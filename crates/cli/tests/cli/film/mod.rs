//! Film files: shares of a render, what becomes of them, and writers that end early.

mod files;
mod shares;
mod writers;

use crate::common::{Ran, Workplace};

impl Workplace {
    /// Renders a share of seven passes into a film file.
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
