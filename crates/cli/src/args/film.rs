//! The commands for film files.

use super::values::count;
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

/// The commands below `bidir film`.
#[derive(Debug, Subcommand)]
pub(crate) enum FilmCommand {
    /// Print the scene, settings, passes and ray counts of a film file.
    Info {
        /// Film file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Write the image of a film file.
    Develop {
        /// Film file.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Output image, .exr or .png.
        #[arg(short, long, value_name = "IMAGE", value_hint = ValueHint::FilePath)]
        output: PathBuf,
    },
    /// Verify all checksums; exit with code 4 if a file is damaged.
    Verify {
        /// Film files.
        #[arg(required = true, value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
    },
}

/// The flags of `bidir merge`.
#[derive(Args, Debug)]
pub(crate) struct MergeArgs {
    /// Film files.
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// Output film file.
    ///
    /// An existing film file is replaced only if the result has all of its passes; any other file is
    /// left alone. It may be one of the input films: those that were merged into it before are then
    /// skipped, so the same command can be repeated.
    #[arg(short, long, value_name = "FILE.film", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// Also write the image, .exr or .png.
    #[arg(long, value_name = "IMAGE", value_hint = ValueHint::FilePath)]
    pub(crate) image: Option<PathBuf>,
}

/// The flags of `bidir missing`.
#[derive(Args, Debug)]
pub(crate) struct MissingArgs {
    /// Existing film files; there may be none.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// Number of passes of the whole render.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = count::<u64>(1..=u64::MAX))]
    pub(crate) spp: u64,
    /// Number of parts that the passes are rendered in.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = count::<u64>(1..=1_000_000))]
    pub(crate) parts: Option<u64>,
    /// Print JSON with the keys passes and parts.
    #[arg(long)]
    pub(crate) json: bool,
}
