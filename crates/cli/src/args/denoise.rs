//! The flags of `bidir denoise`.

use super::ThreadsArgs;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// The image to denoise, and the output image.
#[derive(Args, Debug)]
#[command(
    after_help = "Environment:\n  BIDIR_OIDN  the library of Open Image Denoise 2 or its folder \
    [default: the system's]\n\nExamples:\n  bidir denoise room.exr\n  \
    BIDIR_OIDN=oidn/lib bidir denoise room.exr -o room-clean.png"
)]
#[command(mut_arg("threads", |threads| threads
    .help("Threads [default: the library's choice]")
    .long_help("Threads [default: the library's choice]\n\n0 is the default.")))]
pub(crate) struct DenoiseArgs {
    /// Image, an EXR.
    ///
    /// An image that was denoised before is denoised again from its layer Noisy.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) image: PathBuf,
    /// Output image: .exr with all other layers and attributes, or .png [default: NAME-clean.exr].
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// The number of threads.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
}
