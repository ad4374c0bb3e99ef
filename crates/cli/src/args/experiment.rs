//! The flags of `bidir experiment`.

use super::ThreadsArgs;
use super::values::{count, positive_number, size};
use crate::output;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, ValueHint};
use lab::experiment::Extent;
use std::path::PathBuf;

/// The description of the experiment, and the folder for its results.
#[derive(Args, Debug)]
#[command(after_long_help = include_str!("experiment.txt").trim_end())]
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
    /// Folder for the results, created if it does not exist [default: NAME.results].
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    output: Option<PathBuf>,
    /// Start over.
    ///
    /// Without it, the command continues from records of the same experiment in the folder, and refuses
    /// those of another experiment, machine, program or number of threads. References of the same scene
    /// and settings stay.
    #[arg(long)]
    pub(crate) restart: bool,
    /// Small and coarse: at most 3 seeds and 64 pixels a side, an eighth of budgets and references.
    ///
    /// A description's [quick] can say otherwise. paper: all claims with wider intervals, in three minutes
    /// on two cores instead of forty. beyond: 3 seeds of small images and 2 seconds, in half an hour
    /// instead of a day.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run on the nodes of a Ray cluster: auto, local, or HOST:PORT.
    ///
    /// auto finds the cluster that runs here, local starts one on this machine. Each node uses all of its
    /// threads: --threads is an error, as are flags of the extent, and BIDIR_THREADS has no effect. Needs the
    /// Python package; BIDIR_PYTHON names the interpreter that has it (python3).
    #[arg(long, value_name = "ADDRESS")]
    #[arg(conflicts_with_all = ["scenes", "size", "seconds", "rays", "seeds", "reference_spp"])]
    pub(crate) ray: Option<String>,
    /// The number of threads.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
    /// Print only warnings and errors.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// The extent; the last field, because its help heading applies to all that follow.
    #[command(flatten)]
    pub(crate) extent: ExtentArgs,
}

impl ExperimentArgs {
    /// Returns the folder for the results.
    pub(crate) fn folder(&self) -> PathBuf {
        let default = || output::named_after(&self.description, ".results");
        self.output.clone().unwrap_or_else(default)
    }

    /// Refuses --threads beside --ray: the nodes choose their own number of threads. A conflict declared in clap would
    /// also refuse BIDIR_THREADS, which applies to all commands.
    pub(super) fn check(command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
        let is_given = |name| matches.value_source(name) == Some(ValueSource::CommandLine);
        if is_given("ray") && is_given("threads") {
            let message = "--ray cannot be used with --threads: each node uses all of its threads";
            return Err(command.error(ErrorKind::ArgumentConflict, message));
        }
        Ok(())
    }
}

/// Parts of the extent, in place of the description's and of --quick's.
#[derive(Args, Debug)]
#[command(next_help_heading = "Extent, in place of the description's")]
pub(crate) struct ExtentArgs {
    /// Comma-separated names of scenes [default: all].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    scenes: Vec<String>,
    /// Size of all images.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Amount of budgets in seconds of training and rendering.
    #[arg(long, value_name = "S", value_parser = positive_number)]
    seconds: Option<f64>,
    /// Amount of budgets in rays per pixel, training included.
    #[arg(long, value_name = "N", value_parser = positive_number)]
    rays: Option<f64>,
    /// Number of seeds; intervals need 2 or more.
    #[arg(long, value_name = "N", value_parser = count::<u64>(1..=100_000))]
    seeds: Option<u64>,
    /// Samples per pixel of each integrator of a rendered reference.
    #[arg(long, value_name = "N", value_parser = count::<u64>(1..=1 << 32))]
    reference_spp: Option<u64>,
}

impl ExtentArgs {
    /// Returns the extent that these flags give.
    pub(crate) fn extent(&self) -> Extent {
        Extent {
            scenes: self.scenes.clone(),
            size: self.size,
            seeds: self.seeds,
            seconds: self.seconds,
            rays: self.rays,
            reference_spp: self.reference_spp,
        }
    }

    /// Returns the given flags, in the form of a command line.
    pub(crate) fn words(&self) -> impl Iterator<Item = String> {
        let number = |flag: &str, number: Option<f64>| number.map(|n| format!("{flag} {n}"));
        let whole = |flag: &str, number: Option<u64>| number.map(|n| format!("{flag} {n}"));
        let flags = [
            (!self.scenes.is_empty()).then(|| format!("--scenes {}", self.scenes.join(","))),
            self.size
                .map(|[width, height]| format!("--size {width}x{height}")),
            number("--seconds", self.seconds),
            number("--rays", self.rays),
            whole("--seeds", self.seeds),
            whole("--reference-spp", self.reference_spp),
        ];
        flags.into_iter().flatten()
    }
}
