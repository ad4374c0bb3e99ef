//! The flags of `bidir farm`.

use super::values::count;
use clap::{Args, Subcommand, ValueHint};

/// The scheduler.
#[derive(Debug, Subcommand)]
pub(crate) enum FarmCommand {
    /// Print a Slurm job array: a script for sbatch that can also submit itself and the last step.
    Slurm(FarmArgs),
    /// Print a HyperQueue task array: a script that submits itself, waits, and runs the last step.
    Hyperqueue(FarmArgs),
    /// Print a Kubernetes Indexed Job: YAML with the last step in its comments.
    K8s(FarmArgs),
    /// Print a script for any POSIX shell: for one machine, or several that share a folder.
    Shell(FarmArgs),
}

/// The scene, and the number of parts.
#[derive(Args, Debug)]
pub(crate) struct FarmArgs {
    /// Scene file, under a name that every machine finds.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) scene: String,
    /// Number of parts.
    #[arg(long, value_name = "N", value_parser = count::<u64>(1..=100_000))]
    pub(crate) parts: u64,
    /// Samples per pixel of the whole render [default: the scene's].
    #[arg(long, value_name = "N", value_parser = count::<u64>(1..=u64::MAX))]
    pub(crate) spp: Option<u64>,
    /// Output image; its name without .exr also names the film files [default: the scene's name].
    #[arg(short, long, value_name = "FILE.exr", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<String>,
    /// More flags for `bidir render`, after `--`; none that names a file, which all parts would write.
    #[arg(last = true, value_name = "FLAG")]
    pub(crate) flags: Vec<String>,
}
