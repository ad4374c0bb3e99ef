//! The commands for film files.

use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

/// What to do with film files.
#[derive(Debug, Subcommand)]
pub(crate) enum FilmCommand {
    /// Tell whose film it is, which passes it has, and what was counted.
    Info {
        /// The film file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Make an image of a film file.
    Develop {
        /// The film file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// The image, NAME.exr or NAME.png.
        #[arg(short, long, value_name = "IMAGE", value_hint = ValueHint::FilePath)]
        output: PathBuf,
    },
    /// Compare all checksums; exits with 4 where a file is damaged.
    Verify {
        /// The film files.
        #[arg(required = true, value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
    },
}

/// The flags of `bidir merge`.
#[derive(Args, Debug)]
pub(crate) struct MergeArgs {
    /// The film files.
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// The film file of all of them. One that is there is replaced where the result has all of its
    /// passes, and nothing else is.
    #[arg(short, long, value_name = "FILE.film", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// Make an image of it, too: NAME.exr or NAME.png.
    #[arg(long, value_name = "IMAGE", value_hint = ValueHint::FilePath)]
    pub(crate) image: Option<PathBuf>,
}

/// The flags of `bidir missing`.
#[derive(Args, Debug)]
pub(crate) struct MissingArgs {
    /// The film files that are there; none are needed.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// The passes that there should be.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) spp: u64,
    /// The shares that they are rendered in.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) parts: Option<u64>,
    /// Print JSON with the keys passes and parts.
    #[arg(long)]
    pub(crate) json: bool,
}
