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

  [settings]                             # of all methods: names and values are those of the flags of
  integrator = \"bdpt\"                    # `bidir render` under Integrator (but --seed), Shadow rays and
  max-depth = 16                         # Shared light subpaths; the scene's settings are the defaults

  [[scene]]
  file = \"room.pbrt\"                     # relative to the description; name and size are optional
  reference = \"references/room\"          # a folder of `bidir reference`, or an image; or
  # reference-spp = 4096                 # made first, with reference-strategies = \"all\"
  # reference-cross-check = \"lvc\"        # the estimator that it must agree with [path]

  [[method]]                             # ratios are relative to the first
  name = \"all\"
  [[method]]
  name = \"one\"
  shadow-rays = \"per-pair\"

  [[budget]]                             # one of
  rays = 500                             # rays per pixel, those of training too
  # samples = 64                         # samples per pixel
  # seconds = 10                         # of training and passes

Examples:
  bidir experiment experiments/shadow-rays.toml -o out/shadow-rays
      every method under every budget and seed; repeat the command to continue
  bidir experiment room.toml -o out/quick --quick
      small and coarse, to try a description
  bidir experiment paper --quick -o out/paper
      the statements of the 1995 paper, each with a verdict
  bidir experiment beyond --quick -o out/beyond
      all integrators and each idea behind them, against targets; BIDIR_SCENES names a folder
      with pbrt-v4/, the scenes made by others, which are left out without it")]
#[command(mut_arg("threads", |threads| threads
    .help("Threads of each render [default: the description's, or one per processor]")
    .long_help("Threads of each render [default: the description's, or one per processor]")))]
pub(crate) struct ExperimentArgs {
    /// Description in TOML; or a built-in experiment: `paper` or `beyond`.
    ///
    /// paper: the statements of Lafortune and Willems (1995), one by one. beyond: all integrators in
    /// nine scenes. A file with one of these names is ./paper or ./beyond.
    #[arg(value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) description: PathBuf,
    /// Folder for the results, created if it does not exist.
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) output: PathBuf,
    /// Start over.
    ///
    /// Without it, the command continues from records of the same experiment in the folder, and refuses
    /// those of another experiment, machine, program or number of threads. References of the same scene
    /// and settings stay.
    #[arg(long)]
    pub(crate) restart: bool,
    /// Small and coarse: at most 3 seeds and 64 pixels a side, an eighth of budgets and references.
    ///
    /// paper: all claims with wider intervals, in five minutes on two cores instead of forty. beyond: 3
    /// seeds of small images and 2 seconds, in half an hour instead of a day.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run on the nodes of a Ray cluster: auto, local, or HOST:PORT.
    ///
    /// auto finds the cluster that runs here, local starts one on this machine. Each node uses all of its
    /// threads: --threads is an error, and BIDIR_THREADS has no effect. Needs the Python package;
    /// BIDIR_PYTHON names the interpreter that has it (python3).
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) ray: Option<String>,
    /// How fast it is.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
    /// Print only warnings and errors.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// The extent of `beyond`; last, as its heading holds for all that follow.
    #[command(flatten)]
    pub(crate) beyond: BeyondArgs,
}

impl ExperimentArgs {
    /// Refuses --threads beside --ray, whose nodes decide that. A conflict of clap's would refuse the
    /// variable, too, which is there for all commands.
    pub(super) fn check(command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
        let is_given = |name| matches.value_source(name) == Some(ValueSource::CommandLine);
        if is_given("ray") && is_given("threads") {
            let message = "--ray cannot be used with --threads: each node uses all of its threads";
            return Err(command.error(ErrorKind::ArgumentConflict, message));
        }
        Ok(())
    }
}

/// How much is rendered of `beyond`, instead of what `--quick` or its absence says.
#[derive(Args, Debug)]
#[command(next_help_heading = "Only for `beyond`")]
pub(crate) struct BeyondArgs {
    /// Comma-separated scenes [default: all].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    #[arg(value_parser = PossibleValuesParser::new(lab::beyond::scene_names()))]
    pub(crate) scenes: Vec<String>,
    /// Size of all images [default: 320x240, or 160x120 with --quick, at the scene's aspect ratio].
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
    /// Equal time: seconds of training and rendering per integrator [default: 60, or 2 with --quick].
    ///
    /// --quick weighs training as in 60 seconds.
    #[arg(long, value_name = "S", value_parser = positive_number)]
    pub(crate) seconds: Option<f64>,
    /// Equal rays: rays per pixel, training included [default: 500, or 100 with --quick].
    ///
    /// --quick weighs training as in 2000 rays per pixel, because a full run has four times the pixels.
    #[arg(long, value_name = "N", value_parser = positive_number)]
    pub(crate) rays: Option<f64>,
    /// Number of seeds; intervals need 2 or more [default: 10, or 3 with --quick].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub(crate) seeds: Option<u64>,
    /// Samples per pixel of each estimator of a reference [default: 4096, or 1024 with --quick].
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
