//! A test of a parser: it returns for seeds and for their mutations, the same in every run.

use super::mutation::{files, mutated};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Calls `read` with each file of a folder of seeds, and with `rounds` mutations of each.
///
/// Panics: where `read` does, with the file and the number of the mutation.
pub fn check(seeds: &Path, rounds: u64, read: impl Fn(&[u8])) {
    for (number, file) in files(seeds).iter().enumerate() {
        let seed = fs::read(file).expect("the seed can be read");
        for round in 0..=rounds {
            // The first is the seed itself.
            let input = mutated(&seed, (number as u64) << 32 | round, round);
            let outcome = catch_unwind(AssertUnwindSafe(|| read(&input)));
            let text = String::from_utf8_lossy(&input);
            assert!(
                outcome.is_ok(),
                "panics: mutation {round} of {}:\n{text}",
                file.display()
            );
        }
    }
}
