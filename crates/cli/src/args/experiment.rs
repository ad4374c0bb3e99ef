//! The flags of `bidir experiment`.

use super::ThreadsArgs;
use super::values::{Size, positive_number};
use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, ValueHint};
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
  # reference-witness = \"lvc\"            # what it has to agree with, instead of path

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
      the statements of the 1995 paper, each with a verdict
  bidir experiment beyond --quick -o out/beyond
      all estimators and each idea behind them, against what is aimed at; BIDIR_SCENES names
      the folder that has the scenes made by others in pbrt-v4/, which are left out without it")]
#[command(mut_arg("threads", |threads| threads.help(
    "Threads of each render, instead of the description's [default: its own, or one per processor]"
)))]
pub(crate) struct ExperimentArgs {
    /// The description, a file of TOML; or `paper`, the experiment of Lafortune and Willems (1995) claim
    /// by claim, or `beyond`, all estimators in nine scenes: these need no file (one of that name is
    /// ./paper).
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
    /// `paper`: all claims with wider intervals, in five minutes of two cores instead of forty. Of
    /// `beyond`: 3 seeds of small images, 2 seconds, in half an hour instead of a day.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run on the nodes of a Ray cluster, each with all of its threads: `auto` finds the one that runs
    /// here, `local` starts one on this machine, HOST:PORT is another. Needs the Python package. Not with
    /// --threads; `BIDIR_THREADS` has no influence there.
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) ray: Option<String>,
    /// How fast it is.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
    /// Tell nothing but warnings and errors.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// What is rendered of `beyond`; last, as its heading holds for all that follow.
    #[command(flatten)]
    pub(crate) beyond: BeyondArgs,
}

impl ExperimentArgs {
    /// Refuses --threads beside --ray, whose nodes decide that. A conflict of clap's would refuse the
    /// variable, too, which is there for all commands.
    pub(super) fn check(command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
        let is_given = |name| matches.value_source(name) == Some(ValueSource::CommandLine);
        if is_given("ray") && is_given("threads") {
            let message = "--ray cannot be used with --threads: nodes render with all of theirs";
            return Err(command.error(ErrorKind::ArgumentConflict, message));
        }
        Ok(())
    }
}

/// How much is rendered of `beyond`, instead of what `--quick` or its absence says.
#[derive(Args, Debug)]
#[command(next_help_heading = "Of `beyond` alone")]
pub(crate) struct BeyondArgs {
    /// These scenes, with commas between them [default: all].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    #[arg(value_parser = PossibleValuesParser::new(lab::beyond::scene_names()))]
    pub(crate) scenes: Vec<String>,
    /// Width and height of all images [default: 160x120 or as many pixels in the scene's shape with
    /// --quick, else twice the sides].
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
    /// Equal time: seconds of training and rendering for each estimator [default: 60; --quick renders
    /// 2, and weighs training as in 60].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    pub(crate) seconds: Option<f64>,
    /// Equal rays: rays per pixel for each estimator and each idea, those of training included
    /// [default: 500; --quick renders 100, and weighs training as in 2000, as a whole run has four
    /// times the pixels].
    #[arg(long, value_name = "N", value_parser = positive_number)]
    pub(crate) rays: Option<f64>,
    /// How many seeds: gains have intervals from 2 on [default: 10, --quick 3].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(crate) seeds: Option<u64>,
    /// Samples per pixel of references, of each of their two estimators [default: 4096, --quick 1024].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 32))]
    pub(crate) reference_spp: Option<u64>,
}

impl BeyondArgs {
    /// The name of a flag that is given. None: none is.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let flags = [
            ("--scenes", !self.scenes.is_empty()),
            ("--size", self.size.is_some()),
            ("--seconds", self.seconds.is_some()),
            ("--rays", self.rays.is_some()),
            ("--seeds", self.seeds.is_some()),
            ("--reference-spp", self.reference_spp.is_some()),
        ];
        flags
            .into_iter()
            .find_map(|(name, is_given)| is_given.then_some(name))
    }
}
