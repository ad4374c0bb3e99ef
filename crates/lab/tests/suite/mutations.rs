//! Mutated descriptions and results never make `lab` panic; see the test of the same name in `formats`.
#![expect(
    unreachable_pub,
    reason = "the modules are public in the crate that they belong to"
)]

#[path = "../../../../fuzz/src/check.rs"]
mod check;
#[path = "../../../../fuzz/src/experiments.rs"]
mod experiments;
#[path = "../../../../fuzz/src/mutation.rs"]
mod mutation;

use std::path::Path;

#[test]
fn experiments() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/experiment");
    check::check(&seeds, 20_000, experiments::experiment);
}
