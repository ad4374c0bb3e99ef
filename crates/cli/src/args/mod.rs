//! The command line: what can be asked, and the help text that documents it.

mod compare;
mod denoise;
mod experiment;
mod farm;
mod film;
mod layers;
mod long;
mod mistakes;
mod reference;
mod render;
mod sources;
mod threads;
mod tonemap;
mod values;
mod view;

pub(crate) use compare::{CompareArgs, MetricArgs};
pub(crate) use denoise::DenoiseArgs;
pub(crate) use experiment::ExperimentArgs;
pub(crate) use farm::{FarmArgs, FarmCommand};
pub(crate) use film::{FilmCommand, MergeArgs, MissingArgs};
pub(crate) use long::{LongArgs, Part};
pub(crate) use reference::ReferenceArgs;
pub(crate) use render::{BudgetArgs, EstimatorArgs, FilmArgs, RenderArgs, TalkArgs};
pub(crate) use threads::ThreadsArgs;
pub(crate) use tonemap::TonemapArgs;
pub(crate) use values::{Duration, PixelBounds, ReplayTarget, Size};
pub(crate) use view::{ServeAddress, ViewArgs};

use crate::exit::Exit;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueHint};
use sources::Sources;
use std::path::PathBuf;

/// Renders scenes by bidirectional path tracing, and spends its shadow rays where they matter.
///
/// Scenes are files of pbrt-v4 and glTF 2.0. Images are written as OpenEXR, linear and exact, and as PNG
/// to look at. The same scene, settings and seed give the same bits, whatever the number of threads.
#[derive(Debug, Parser)]
#[command(name = "bidir", version, propagate_version = true, max_term_width = 100, after_help = Exit::help())]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Colour.
    #[command(flatten)]
    pub(crate) color: ColorArgs,
}

impl Cli {
    /// Reads the command line and the environment.
    pub(crate) fn read() -> Result<Self, clap::Error> {
        let mut command = mistakes::accept_negative(Self::command());
        let arguments: Vec<_> = std::env::args_os().collect();
        let matches = command.try_get_matches_from_mut(&arguments);
        let matches = matches.map_err(|error| mistakes::reworded(error, &command, &arguments))?;
        if let Some(("experiment", matches)) = matches.subcommand()
            && let Some(command) = command.find_subcommand_mut("experiment")
        {
            ExperimentArgs::check(command, matches)?;
        }
        let cli = Self::from_arg_matches(&matches);
        let mut cli = cli.map_err(|error| error.format(&mut command))?;
        if let Command::Render(args) = &mut cli.command
            && let Some((name, matches)) = matches.subcommand()
            && let Some(command) = command.find_subcommand(name)
        {
            args.estimator.sources = Sources::new(command, matches);
        }
        Ok(cli)
    }
}

/// Colour of messages.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ColorArgs {
    /// No colour in messages, as with `NO_COLOR` or `TERM=dumb` in the environment.
    #[arg(long, global = true)]
    pub(crate) no_color: bool,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an image.
    ///
    /// Every setting is taken from the first of these that has it: the flag, the environment
    /// variable, the scene file, the default. Rendering goes pass by pass, one sample of every pixel
    /// at a time.
    ///
    /// Ctrl-C ends after the running pass and writes the image; a second Ctrl-C ends at once, and so
    /// does the first before there is a pass. With --checkpoint the first ends with exit code 75: the
    /// same command with --resume goes on.
    Render(Box<RenderArgs>),
    /// Render a scene in the browser: watch it, ask it, change it.
    ///
    /// Prints the URL of a page that shows the render as it goes, and serves it until Ctrl-C. The
    /// page switches estimators and compares two of them side by side in equal time, moves the
    /// camera, tells of pixels and of strategies, and saves images into the current folder.
    ///
    /// The page is a part of the program, and asks nothing of the network. It can be reached from
    /// this machine alone, unless --bind says otherwise.
    View(Box<ViewArgs>),
    /// Tell what is in a scene.
    ///
    /// Prints its film, camera and settings, the number of shapes, triangles, materials, lights and
    /// textures, its extent, and the memory that rendering takes; which light paths each integrator
    /// misses or finds by chance only, and what a render would refuse.
    Info(InfoArgs),
    /// Render a reference: a picture that others can be measured against.
    ///
    /// Two estimators that could disagree render the scene, each in 16 replicates with seeds of
    /// their own. Welch's t-test compares the replicates of both, on the mean of the film and on
    /// blocks of pixels, with Šidák's correction at level 0.001; where it finds a difference, the
    /// command exits with 6, and what was written is refused as a reference.
    ///
    /// The folder gets `picture.exr`, the mean of the first estimator with its variance,
    /// `against.exr`, that of the second, `provenance.json`, which tells how it was made and whether
    /// both agree, and `films`, from which samples can be added. `bidir compare --reference` takes the
    /// folder.
    ///
    /// Ctrl-C ends after the running pass with exit code 75: the same command goes on. Whatever was
    /// stopped or extended, the bits are those of a reference that was made at once.
    Reference(Box<ReferenceArgs>),
    /// Compare image A with the reference B, or images of several seeds with one reference.
    ///
    /// Prints, over red, green and blue of all pixels: the root of the mean square error (`rmse`), the
    /// mean of (a-b)²/(b²+0.01) (`relmse`), both without the worst 0.1 % of pixels (`rmse_trim`,
    /// `relmse_trim`), `relmse` of means over blocks of 16 x 16 pixels (`relmse_block`), the mean of
    /// |a-b|/(|b|+0.01) (`mape`), the mean of A divided by the mean of B (`mean_ratio`), and whether both
    /// have the same size and the same bits (`identical`); with --flip, the mean difference that is seen
    /// (`flip`, `flip_hdr`).
    ///
    /// Where both have variances, as images of `render --aov variance,samples` and references have, two
    /// tests tell whether the difference is noise: `z_pixels` over all pixels and `z_blocks` over
    /// blocks of them, each with p, the probability of so large a difference where both have the same
    /// expectation, and the place of the largest difference. Below 0.001 it is hardly noise; of images
    /// of few samples with fireflies the variances are too small, and so is p.
    ///
    /// With several images and --reference, each number is the mean over the images, between the
    /// bounds of its 95 % interval, by Student's t distribution: the images have to be renders of
    /// independent seeds.
    Compare(CompareArgs),
    /// Compare methods: scenes × methods × budgets × seeds, from a description in TOML.
    ///
    /// Every render is compared with the reference of its scene. Prints tables of means over the seeds
    /// and of ratios to the first method, which are paired by seed, with 95 % intervals; writes
    /// results.json with every record, report.html, records.ndjson to go on from, and the images of
    /// the first seed.
    ///
    /// Budgets are equal samples, equal rays or equal time. Ctrl-C ends after the running pass with
    /// exit code 75: the same command goes on.
    Experiment(ExperimentArgs),
    /// Tell what is in film files, develop them to images, or check them.
    #[command(subcommand)]
    Film(FilmCommand),
    /// Add film files of one render to one film file.
    ///
    /// In any order and any grouping the result has the bits of one render. Files of another scene or
    /// other settings, and passes that two files have, are refused, and so is replacing a film file that
    /// has passes which the result has not.
    Merge(MergeArgs),
    /// Tell which passes of a shared render no film file has.
    ///
    /// Prints one range per line, as `render --passes` takes it, or with --parts one share per line,
    /// as `render --part` takes it; exits with 6 where something is missing.
    Missing(MissingArgs),
    /// Bring an image to the screen: linear light becomes a PNG.
    ///
    /// The image that `bidir render` writes has light of any strength; this makes it brighter or
    /// darker, and fits it to the screen. The image itself is not changed.
    Tonemap(TonemapArgs),
    /// Take the noise out of an image, by Open Image Denoise.
    ///
    /// The layers `Albedo` and `Ns` (or else `N`) of the image guide the filter where it has them: they
    /// tell texture and edges from noise. They are denoised first themselves. The picture in R, G and B
    /// is replaced; the noisy one stays as the layer `Noisy`. Denoised pixels are biased.
    ///
    /// Open Image Denoise is a library of its own, of version 2. `pip install pyoidn` brings it, as do
    /// the archives of its project and many systems.
    Denoise(DenoiseArgs),
    /// Print a job file that renders a scene in shares on many machines.
    ///
    /// Each share is a part of the passes, with a film file NAME.part-I-of-N.film from which it goes on
    /// where it was stopped; the last step merges them to NAME.film and develops NAME.exr, which has the bits
    /// of a render in one piece. The job file is a beginning: read it, and add what your machines ask
    /// for.
    ///
    /// For example: bidir farm slurm room.pbrt --parts 16 --spp 4096 > room.sh; sh room.sh
    #[command(subcommand)]
    Farm(FarmCommand),
    /// Print a completion script for a shell.
    ///
    /// For example: bidir completions bash > ~/.local/share/bash-completion/completions/bidir
    Completions(CompletionsArgs),
    /// Print the manual page, in the language of man(7).
    ///
    /// For example: bidir man render | man -l -
    Man(ManArgs),
}

/// Which scene, and how it is read.
#[derive(Args, Clone, Debug)]
pub(crate) struct SceneArgs {
    /// The scene: a file of pbrt-v4, or `-` for standard input; `.gltf` or `.glb` is glTF 2.0.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) scene: PathBuf,
    /// Replace what is not supported by something near, with a warning, instead of stopping.
    #[arg(long, help_heading = "Scene")]
    pub(crate) lenient: bool,
    /// Treat warnings as errors: exit with 6 before anything is rendered.
    #[arg(long, help_heading = "Scene")]
    pub(crate) strict: bool,
    /// The instruction set that rays are traced with. It changes speed, never a bit.
    ///
    /// By default the fastest that this machine has, but never avx512.
    #[arg(long, env = "BIDIR_ISA", value_name = "NAME", value_parser = values::isa)]
    #[arg(help_heading = "Resources")]
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
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

/// The flags of `bidir man`.
#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// The command that the page is of, such as `render` or `film info`; without it, the page of the
    /// whole.
    pub(crate) command: Vec<String>,
}
