//! Inputs that are nearly right: seeds with a few places changed, the same in every run.

use std::fs;
use std::path::{Path, PathBuf};

/// Stand-ins for the numbers of texts.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "255",
    "65536",
    "2147483647",
    "-2147483648",
    "18446744073709551615",
    "1e38",
    "-1e38",
    "1e-44",
    "nan",
    "inf",
    "0x7fffffff",
];

/// The bytes of a seed with at most `most` places changed; the same for the same `state`.
pub fn mutated(seed: &[u8], state: u64, most: u64) -> Vec<u8> {
    let mut input = seed.to_vec();
    let mut random = Random(state);
    for _ in 0..most.min(1 + random.below(4) as u64) {
        mutate(&mut input, &mut random);
    }
    input
}

/// The files of a folder of seeds, by name.
///
/// Panics: without one.
pub fn files(seeds: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(seeds).expect("the folder of the seeds is there");
    let mut files: Vec<_> = entries
        .map(|entry| entry.expect("it is listed").path())
        .collect();
    files.sort();
    assert!(
        !files.is_empty(),
        "there are no seeds in {}",
        seeds.display()
    );
    files
}

/// Numbers without a pattern: SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `end`, which is not zero.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

/// Changes one place.
fn mutate(input: &mut Vec<u8>, random: &mut Random) {
    if input.is_empty() {
        input.push(random.next() as u8);
        return;
    }
    let at = random.below(input.len());
    match random.below(8) {
        0 => input[at] ^= 1 << random.below(8),
        1 => input[at] = [0, 1, 0x7f, 0x80, 0xff][random.below(5)],
        2 => input.truncate(at),
        3 => drop(input.remove(at)),
        4 => {
            let end = (at + 1 + random.below(64)).min(input.len());
            let piece = input[at..end].to_vec();
            let to = random.below(input.len());
            input.splice(to..to, piece);
        }
        5 => {
            let end = (at + 1 + random.below(64)).min(input.len());
            input.drain(at..end);
        }
        6 => {
            let end = (at + [2, 4, 8][random.below(3)]).min(input.len());
            let fill = [0, 0x7f, 0xff][random.below(3)];
            input[at..end].fill(fill);
        }
        _ => replace_number(input, at, NUMBERS[random.below(NUMBERS.len())]),
    }
}

/// Puts a number in place of the first one from `at` on.
fn replace_number(input: &mut Vec<u8>, at: usize, number: &str) {
    let is_part = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
    let Some(begin) = input[at..].iter().position(is_part) else {
        return;
    };
    let begin = at + begin;
    let length = input[begin..]
        .iter()
        .take_while(|byte| is_part(byte))
        .count();
    input.splice(begin..begin + length, number.bytes());
}
