//! The flags of `bidir experiment`.

use super::ThreadsArgs;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// What is compared, and where the results go.
#[derive(Args, Debug)]
#[command(after_long_help = "\
A description:
  title = \"One ray for each pair\"        # description = \"…\" says more
  seeds = 10                             # first-seed = 0
  size = \"320x240\"                       # of all images; else the scenes' own
  threads = 2                            # of each render; else one per processor
  metrics = [\"relmse\", \"relmse_trim\"]    # beside rmse; names are those of `bidir compare`
  pyramid = \"all\"                        # shows each strategy (s, t) of this method, once in each
  # pyramid-spp = 64                     # scene; it is in no figure of the comparison

  [settings]                             # of all methods: names and values are those of the flags
  integrator = \"bdpt\"                    # of `bidir render` from --integrator to --sampler
  max-depth = 16                         # what nobody sets is the scene's

  [[scene]]
  file = \"room.pbrt\"                     # relative to the description; name and size if you like
  reference = \"references/room\"          # a folder of `bidir reference`, or an image; or
  # reference-spp = 4096                 # made first, with reference-strategies = \"all\"

  [[method]]                             # ratios are relative to the first
  name = \"all\"
  [[method]]
  name = \"one\"
  shadow-rays = \"per-pair\"

  [[budget]]                             # one of
  rays = 500                             # rays per pixel, those of training too
  # samples = 64                         # samples per pixel
  # seconds = 10                         # training and passes

Examples:
  bidir experiment experiments/shadow-rays.toml -o out/shadow-rays
      every method under every budget and seed; the same again goes on where it was stopped
  bidir experiment room.toml -o out/quick --quick
      small and coarse, to see whether it works
  bidir experiment paper --quick -o out/paper
      the statements of the 1995 paper, each with a verdict")]
#[command(mut_arg("threads", |threads| threads.help(
    "Threads of each render, instead of the description's [default: its own, or one per processor]"
)))]
pub(crate) struct ExperimentArgs {
    /// The description, a file of TOML; or `paper`, the experiment of Lafortune and Willems (1995) claim
    /// by claim, which needs no file (one of that name is ./paper).
    #[arg(value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) description: PathBuf,
    /// The folder of the results, which is made where it is not there.
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) output: PathBuf,
    /// Begin anew; without it, records of the same experiment in the folder are gone on from, and
    /// those of another are refused, and those of another machine, program or number of threads.
    /// References of the same scene and settings stay.
    #[arg(long)]
    pub(crate) restart: bool,
    /// Small and coarse: at most 3 seeds and 64 pixels a side, an eighth of budgets and references. Of
    /// `paper`: all claims with wider intervals, in a quarter of an hour instead of two hours.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run on the nodes of a Ray cluster, each with all of its threads: `auto` finds the one that runs
    /// here, `local` starts one on this machine, HOST:PORT is another. Needs the Python package.
    #[arg(long, value_name = "ADDRESS", conflicts_with = "threads")]
    pub(crate) ray: Option<String>,
    /// How fast it is.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
    /// Tell nothing but warnings and errors.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
