//! Feeds a parser with mutations of its seeds, for `tools/attack`: see its `mutations.py`.
//!
//!     mutations TARGET SEED FROM TO PLACE FAILURES   reads mutations FROM to TO - 1
//!     mutations TARGET SEED NUMBER FILE              writes one of them
//!
//! PLACE is a file that holds the number of the mutation that is being read, so that an input that ends
//! the process or never returns is known. Inputs that panic go into the folder FAILURES, a line each on
//! stdout. The exit code is 1 if one did.
#![expect(
    unreachable_pub,
    reason = "the modules belong to a crate where they are reached"
)]
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for a script"
)]

#[path = "../../../../fuzz/src/experiments.rs"]
mod experiments;
#[path = "../../../../fuzz/src/inputs.rs"]
mod inputs;
#[path = "../../../../fuzz/src/mutation.rs"]
mod mutation;

extern crate bidir_lab as lab;

use std::fs::{self, File};
use std::io::{self, Seek, Write};
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A parser and its seeds.
struct Target {
    name: String,
    read: fn(&[u8]),
    seeds: Vec<Vec<u8>>,
    /// Another one gives other mutations.
    seed: u64,
}

impl Target {
    fn new(name: &str, seed: &str) -> Result<Self, String> {
        let read: fn(&[u8]) = match name {
            "pbrt" => inputs::pbrt,
            "gltf" => inputs::gltf,
            "ply" => inputs::ply,
            "image" => inputs::image,
            "film" => inputs::film,
            "spectrum" => inputs::spectrum,
            "nanovdb" => inputs::nanovdb,
            "experiment" => experiments::experiment,
            _ => return Err(format!("there is no target {name}")),
        };
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
        let seeds = mutation::files(&folder.join(name))
            .into_iter()
            .map(fs::read);
        Ok(Self {
            name: name.into(),
            read,
            seeds: seeds
                .collect::<io::Result<_>>()
                .map_err(|error| error.to_string())?,
            seed: number(seed)?,
        })
    }

    /// Mutations of all seeds by turns.
    fn mutation(&self, number: u64) -> Vec<u8> {
        let seed = &self.seeds[(number % self.seeds.len() as u64) as usize];
        let state = self.seed.rotate_left(40) ^ number;
        mutation::mutated(seed, state, u64::MAX)
    }

    /// Reads these mutations. Returns how many panicked.
    fn attack(
        &self,
        numbers: std::ops::Range<u64>,
        place: &str,
        failures: &str,
    ) -> io::Result<u64> {
        let mut place = File::create(place)?;
        let mut failed = 0;
        for number in numbers {
            place.rewind()?;
            place.write_all(format!("{number:20}").as_bytes())?;
            let input = self.mutation(number);
            if catch_unwind(|| (self.read)(&input)).is_err() {
                failed += 1;
                let file = PathBuf::from(failures).join(format!("{}-{number}", self.name));
                fs::write(&file, &input)?;
                println!("{}", file.display());
            }
        }
        Ok(failed)
    }
}

fn number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("{text} is no number"))
}

fn run(arguments: &[&str]) -> Result<u64, String> {
    let said = |error: io::Error| error.to_string();
    match arguments {
        [name, seed, from, to, place, failures] => Target::new(name, seed)?
            .attack(number(from)?..number(to)?, place, failures)
            .map_err(said),
        [name, seed, which, file] => {
            let input = Target::new(name, seed)?.mutation(number(which)?);
            fs::write(file, input).map_err(said)?;
            Ok(0)
        }
        _ => Err("usage: mutations TARGET SEED (FROM TO PLACE FAILURES | NUMBER FILE)".into()),
    }
}

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("mutations: {error}");
            ExitCode::from(2)
        }
    }
}
