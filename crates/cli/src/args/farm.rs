//! The flags of `bidir farm`.

use clap::{Args, Subcommand, ValueHint};

/// Who hands out the shares.
#[derive(Debug, Subcommand)]
pub(crate) enum FarmCommand {
    /// A job array of Slurm, as a script for sbatch that can also submit itself and the last step.
    Slurm(FarmArgs),
    /// A task array of HyperQueue, as a script that submits itself, waits, and does the last step.
    Hyperqueue(FarmArgs),
    /// An Indexed Job of Kubernetes, as YAML with the last step in its comments.
    K8s(FarmArgs),
    /// A script for any POSIX shell: one machine, or several that share a folder.
    Shell(FarmArgs),
}

/// What is rendered, and in how many shares.
#[derive(Args, Debug)]
pub(crate) struct FarmArgs {
    /// The scene: a file that every machine finds under this name.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) scene: String,
    /// The number of shares.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(crate) parts: u64,
    /// Samples per pixel of the whole [default: the scene's].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) spp: Option<u64>,
    /// The image, whose name without .exr is also that of the film files [default: the scene's name,
    /// ending in .exr, in the current folder].
    #[arg(short, long, value_name = "FILE.exr", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<String>,
    /// More flags for `bidir render`, after `--`; those that name files, or that the job sets itself,
    /// are refused.
    #[arg(last = true, value_name = "FLAG")]
    pub(crate) flags: Vec<String>,
}
