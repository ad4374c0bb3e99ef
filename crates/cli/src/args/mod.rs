//! The command line, and the help text that documents it.

mod compare;
mod denoise;
mod experiment;
mod farm;
mod film;
mod help;
mod layers;
mod long;
mod mistakes;
mod reference;
mod renamed;
mod render;
mod threads;
mod tonemap;
mod values;
mod view;

pub(crate) use compare::{CompareArgs, MetricArgs};
pub(crate) use denoise::DenoiseArgs;
pub(crate) use experiment::ExperimentArgs;
pub(crate) use farm::{FarmArgs, FarmCommand};
pub(crate) use film::{FilmCommand, MergeArgs, MissingArgs};
pub(crate) use help::command;
pub(crate) use long::{LongArgs, Part};
pub(crate) use reference::ReferenceArgs;
pub(crate) use render::{BudgetArgs, FilmArgs, RenderArgs, TalkArgs};
pub(crate) use threads::ThreadsArgs;
pub(crate) use tonemap::TonemapArgs;
pub(crate) use values::{ReplayTarget, short};
pub(crate) use view::ViewArgs;

use crate::console::{print, print_help};
use crate::exit::{Exit, Failure};
use bidir::ESTIMATOR_VERSION;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Args, FromArgMatches, Parser, Subcommand, ValueHint};
use std::ffi::OsString;
use std::path::PathBuf;

/// Renders pbrt-v4 and glTF scenes with path tracing and bidirectional path tracing.
///
/// Images are written as OpenEXR (linear, 32-bit float) and as PNG (to look at). The same scene,
/// settings and seed give the same bits on any number of threads.
#[derive(Debug, Parser)]
#[command(name = "bidir", version, propagate_version = true, max_term_width = 100, after_long_help = Exit::help())]
pub(crate) struct Cli {
    /// The command.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Colour.
    #[command(flatten)]
    pub(crate) color: ColorArgs,
    /// Warnings about older names on the command line.
    #[arg(skip)]
    pub(crate) renamed: Vec<String>,
}

/// Returns the name and version of the program, its estimator version (only films with the same one can be merged),
/// and the commit, if `BIDIR_COMMIT` was set when the program was built.
fn version() -> String {
    let hash = option_env!("BIDIR_COMMIT").filter(|commit| !commit.is_empty());
    let commit = hash.map_or_else(String::new, |commit| format!(", commit {commit}"));
    let program = formats::film::program();
    format!("{program} (estimator version {ESTIMATOR_VERSION}{commit})\n")
}

impl Cli {
    /// Reads the command line and the environment.
    ///
    /// Errors: the command line does not call a command. The error is its failure, or the result of printing a text
    /// that it asks for, such as help.
    pub(crate) fn read() -> Result<Self, Result<Exit, Failure>> {
        let arguments: Vec<_> = std::env::args_os().collect();
        let mut command = command();
        Self::parsed(&mut command, &arguments).map_err(|error| match error.kind() {
            ErrorKind::DisplayVersion => print(&version()),
            ErrorKind::DisplayHelp | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                print_help(&error)
            }
            _ => Err(mistakes::explained(&error, &command, &arguments)),
        })
    }

    /// Checks that these words are a command line.
    pub(crate) fn check(words: &[OsString]) -> Result<(), Failure> {
        let mut command = command();
        match Self::parsed(&mut command, words) {
            Ok(_) => Ok(()),
            Err(error) => Err(mistakes::explained(&error, &command, words)),
        }
    }

    fn parsed(command: &mut clap::Command, arguments: &[OsString]) -> Result<Self, clap::Error> {
        let matches = command.try_get_matches_from_mut(arguments)?;
        if let Some(("experiment", matches)) = matches.subcommand()
            && let Some(command) = command.find_subcommand_mut("experiment")
        {
            ExperimentArgs::check(command, matches)?;
        }
        let mut cli = Self::from_arg_matches(&matches)?;
        cli.renamed = renamed::warnings(arguments, |name| std::env::var(name).ok());
        if let (Command::Render(args), Some((_, matches))) =
            (&mut cli.command, matches.subcommand())
        {
            let source = |id: &clap::Id| matches.value_source(id.as_str());
            let of_variables = matches
                .ids()
                .filter(|id| source(id) == Some(ValueSource::EnvVariable));
            args.of_variables = of_variables
                .map(|id| id.as_str().replace('_', "-"))
                .collect();
        }
        Ok(cli)
    }
}

/// Colour of messages.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ColorArgs {
    /// Print messages without colour.
    ///
    /// NO_COLOR and TERM=dumb in the environment do the same; FORCE_COLOR turns colour on.
    #[arg(long, global = true)]
    pub(crate) no_color: bool,
}

impl ColorArgs {
    /// Finds the flags in a command line that cannot be parsed.
    pub(crate) fn of_words() -> Self {
        let no_color = std::env::args_os().any(|word| word == "--no-color");
        Self { no_color }
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an image.
    ///
    /// A setting comes from the first of these that has it: the flag, the environment variable, the
    /// scene file, the default. A pbrt file that leaves a setting out gets pbrt-v4's default: 1280x720
    /// pixels, 16 samples per pixel of the sobol sampler, path with at most 5 bounces, a Gaussian
    /// filter. A glTF file is rendered with auto, at most 12 bounces, 64 samples per pixel and a height
    /// of 720 pixels.
    ///
    /// Ctrl-C leaves the current pass and writes the image of the complete ones, or nothing if there are
    /// none; a second Ctrl-C stops at once. With --checkpoint, Ctrl-C ends with exit code 75 once the film
    /// file has a pass; the same command with --resume continues.
    Render(Box<RenderArgs>),
    /// Render a scene in the browser: compare integrators, move the camera, inspect pixels.
    ///
    /// Prints the URL of a page that shows the render, and serves it until Ctrl-C. The page switches
    /// integrators, compares two of them side by side at equal time, moves the camera, explains pixels
    /// and strategies, and saves images into the current folder.
    ///
    /// The page is part of the program and loads nothing from the network. Only this machine can reach
    /// it, unless --bind says otherwise.
    View(Box<ViewArgs>),
    /// Print the contents of a scene, and the light that each integrator misses.
    ///
    /// Prints film, camera and settings; the number of shapes, triangles, materials, lights and textures;
    /// the extent; the memory that rendering takes; the light paths that each integrator misses or samples
    /// badly; and the features that a render would refuse.
    Info(InfoArgs),
    /// Render a reference image, cross-checked by a second estimator.
    ///
    /// Two different estimators render the scene, each in 16 replicates with their own seeds. Welch's
    /// t-test compares their replicates, on the mean of the film and on blocks of pixels, with Šidák's
    /// correction at level 0.001. If they differ, the command exits with code 6, and the result is
    /// refused as a reference.
    ///
    /// The folder gets `picture.exr`, the mean of the first estimator with its variance; `against.exr`,
    /// that of the second; `provenance.json`, with all settings, the result of the test and checksums; and
    /// `films`, which --extend adds samples to. `bidir compare --reference` takes the folder, and refuses
    /// it if one of the first three files is missing or damaged.
    ///
    /// Ctrl-C leaves the current pass and ends with exit code 75: the same command continues. The bits
    /// are those of an uninterrupted run.
    Reference(Box<ReferenceArgs>),
    /// Print error metrics of images against a reference.
    ///
    /// Compares image A with the reference B, or images of several seeds with one reference, over red,
    /// green and blue of all pixels. rmse: root mean square error. relmse: mean of (a-b)²/(b²+0.01).
    /// rmse_trim, relmse_trim: the same without the worst 0.1 % of pixels. relmse_block: relmse of means
    /// over blocks of 16 x 16 pixels. mape: mean of |a-b|/(|b|+0.01). mean_ratio: mean of A over mean of
    /// B. identical: the same size and the same bits. With --flip: flip and flip_hdr, the mean visible
    /// difference.
    ///
    /// If both images have variances (those of `render --aov variance,samples` and references have),
    /// z_pixels and z_blocks test for a difference beyond noise, over pixels and over blocks of them.
    /// Each has p, the probability of a difference this large between images of the same expectation,
    /// and the place of the largest difference. A p below 0.001 is hardly noise, but images with few
    /// samples and fireflies underestimate their variances, and so p. z_blocks adds the variances of
    /// pixels, so it holds only if the errors of pixels are uncorrelated: pixels of `lvc` and `auto` share
    /// light subpaths, which makes p too small, and the command warns.
    ///
    /// With several images and --reference, each number is the mean over the images, between the bounds
    /// of its 95 % confidence interval (Student's t). The images must be renders with independent seeds.
    Compare(CompareArgs),
    /// Compare methods over scenes, budgets and seeds, as a TOML file describes.
    ///
    /// Compares every render with the reference of its scene. Prints tables of means over the seeds and
    /// of ratios to the first method, paired by seed, with 95 % confidence intervals. Writes
    /// results.json with every record, report.html, records.ndjson to continue from, and the images of
    /// the first seed.
    ///
    /// Budgets are equal samples, equal rays or equal time. Ctrl-C leaves the current pass and ends
    /// with exit code 75: the same command continues.
    Experiment(ExperimentArgs),
    /// Inspect, develop or verify film files.
    #[command(subcommand)]
    Film(FilmCommand),
    /// Add film files of one render to one film file.
    ///
    /// In any order and grouping, the result has the bits of one render. The command refuses files of
    /// different scenes or settings and files with the same passes, and replaces an existing film file
    /// only by one that has all of its passes.
    Merge(MergeArgs),
    /// List the passes of a shared render that no film file has.
    ///
    /// Prints one range per line, for `render --passes`, or with --parts one part per line, for
    /// `render --part`. Exits with code 6 if anything is missing.
    Missing(MissingArgs),
    /// Convert a linear image to a PNG for the screen.
    ///
    /// Scales the image by --exposure and applies a tone mapping operator. The input stays as it is.
    Tonemap(TonemapArgs),
    /// Denoise an image with Open Image Denoise.
    ///
    /// The layers `Albedo` and `Ns` (or `N`) guide the filter if the image has them; they are denoised
    /// first. R, G and B are replaced; the noisy image stays as the layer `Noisy`. Denoised pixels are
    /// biased.
    ///
    /// Open Image Denoise 2 is a separate library: `pip install pyoidn` installs it, as do the archives
    /// of its project and many systems.
    Denoise(DenoiseArgs),
    /// Print a job file that renders a scene in parts on many machines.
    ///
    /// Each part renders a share of the passes into a film file NAME.part-I-of-N.film, and continues from
    /// it after an interruption. The last step merges them to NAME.film and develops NAME.exr, which has
    /// the bits of an undivided render. Treat the job file as a draft: read it, and add the settings of
    /// your cluster.
    ///
    /// For example: bidir farm slurm room.pbrt --parts 16 --spp 4096 > room.sh; sh room.sh
    #[command(subcommand)]
    Farm(FarmCommand),
    /// Print a completion script for a shell.
    ///
    /// For example: bidir completions bash > ~/.local/share/bash-completion/completions/bidir
    Completions(CompletionsArgs),
    /// Print a manual page.
    ///
    /// For example: bidir man render | man -l -
    Man(ManArgs),
}

/// The scene file, and how it is read.
#[derive(Args, Clone, Debug)]
pub(crate) struct SceneArgs {
    /// A .pbrt, .gltf or .glb file; `-` reads pbrt from standard input.
    ///
    /// A file with any other ending is read as pbrt-v4.
    #[arg(value_hint = ValueHint::FilePath, help_heading = None::<&str>)]
    pub(crate) scene: PathBuf,
    /// Substitute similar features for unsupported ones, with a warning.
    ///
    /// Without it, they are errors.
    #[arg(long, help_heading = "Scene and machine")]
    pub(crate) lenient: bool,
    /// Treat warnings as errors: exit with code 6 before rendering.
    #[arg(long, help_heading = "Scene and machine")]
    pub(crate) strict: bool,
    /// Instruction set of ray tracing: scalar, sse2, avx2 or avx512 [default: the fastest but avx512].
    ///
    /// It changes the speed, never the image.
    #[arg(long, env = "BIDIR_ISA", value_name = "NAME", value_parser = values::isa)]
    #[arg(help_heading = "Scene and machine")]
    pub(crate) isa: Option<accel::Isa>,
}

/// The flags of `bidir info`.
#[derive(Args, Debug)]
pub(crate) struct InfoArgs {
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The flags of `bidir completions`.
#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// Shell.
    pub(crate) shell: clap_complete::Shell,
}

/// The flags of `bidir man`.
#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// Command, such as `render` or `film info` [default: bidir itself].
    pub(crate) command: Vec<String>,
    /// Print the reference of all commands in Markdown: docs/reference/cli.md.
    #[arg(long, hide = true, conflicts_with = "command")]
    pub(crate) markdown: bool,
}
