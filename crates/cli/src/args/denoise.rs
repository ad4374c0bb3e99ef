//! The flags of `bidir denoise`.

use super::ThreadsArgs;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// An image, and where it goes without its noise.
#[derive(Args, Debug)]
#[command(
    after_help = "Environment:\n  BIDIR_OIDN  the library of Open Image Denoise 2, or a folder that \
    has it; by default\n              the one that the system finds\n\n\
    Examples:\n  bidir denoise room.exr -o room-clean.exr\n  \
    BIDIR_OIDN=oidn/lib bidir denoise room.exr -o room-clean.png"
)]
#[command(mut_arg("threads", |threads| threads.help(
    "Threads; 0 leaves that to the library [default: 0]"
)))]
pub(crate) struct DenoiseArgs {
    /// The image, an EXR; of one that was denoised before, the noisy picture that it still has.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) image: PathBuf,
    /// The denoised image, NAME.exr with all other layers and attributes of the image, or NAME.png.
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// How fast it is.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
}
