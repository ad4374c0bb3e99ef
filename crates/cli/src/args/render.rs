//! The flags of `bidir render`.

use super::layers::LayerArgs;
use super::long::LongArgs;
use super::sources::Sources;
use super::values::{CropFractions, Duration, PixelBounds, ReplayTarget, Size, named};
use super::view::ServeAddress;
use super::{SceneArgs, ThreadsArgs, values};
use crate::console::Display;
use bidir::integrator::{
    CandidateCount, Candidates, EmissionKind, IntegratorKind, ProposalKind, SamplesPerSubpath,
};
use bidir::path::{
    LightChoiceKind, LightPointChoice, MisCount, MisHeuristic, PathRoulette, Strategies,
};
use bidir::sampler::SamplerKind;
use bidir::select::ShadowRays;
use clap::{Args, ValueHint};
use std::path::PathBuf;
use viewer::tev::TevAddress;

/// The flags of `bidir render`. Headings of `--help` come in the order of
/// their first fields.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bidir render room.pbrt --integrator auto --time 10m -o room.exr
  bidir render room.glb --spp 64 --denoise
  bidir render room.pbrt --spp 65536 --checkpoint room.film --resume")]
#[command(after_long_help = "\
Examples:
  bidir render room.pbrt --integrator auto --time 10m -o room.exr
      as many passes as fit into ten minutes, into room.exr and room.png
  bidir render room.glb --spp 64 --denoise
      a scene exported from Blender; glTF files are rendered with auto
  bidir render room.pbrt --spp 65536 --checkpoint room.film --resume
      repeat the command to continue an interrupted render
  bidir render room.pbrt --shadow-rays per-pair --stats room.json
      one connection ray per pair of subpaths; the JSON has the ray counts
  bidir render room.pbrt --strategies all,-s0
      without light that camera subpaths hit by chance
  bidir render room.pbrt --replay 17,4,3 --svg sample.svg
      sample 3 of the pixel in column 17, row 4: its terms as text, its paths as a drawing")]
pub(crate) struct RenderArgs {
    /// Where results go.
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    /// Show progress in the browser, read only.
    ///
    /// Prints the URL on stdout. Without ADDRESS the page can be reached from this machine only;
    /// otherwise the URL carries a random token. The server ends with the render. `bidir view` can
    /// also change the render.
    #[arg(
        long,
        value_name = "[ADDRESS:]PORT",
        conflicts_with = "replay",
        help_heading = "Output"
    )]
    pub(crate) serve: Option<ServeAddress>,
    /// Show progress in the image viewer tev [default port: 14158].
    ///
    /// The render never waits for tev, which may be started later, except for at most two seconds at
    /// the end.
    #[arg(
        long,
        value_name = "HOST[:PORT]",
        conflicts_with = "replay",
        help_heading = "Output"
    )]
    pub(crate) display_server: Option<TevAddress>,
    /// The image's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
    /// When it is enough.
    #[command(flatten)]
    pub(crate) budget: BudgetArgs,
    /// How light is estimated.
    #[command(flatten)]
    pub(crate) estimator: EstimatorArgs,
    /// Images beside the main one.
    #[command(flatten)]
    pub(crate) layers: LayerArgs,
    /// How it survives and is shared.
    #[command(flatten)]
    pub(crate) long: LongArgs,
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// How fast it is.
    #[command(flatten, next_help_heading = "Scene and machine")]
    pub(crate) threads: ThreadsArgs,
    /// Repeat one sample and print every term, instead of rendering.
    ///
    /// Prints the vertices of both subpaths; every connection with its strategy, value, score,
    /// probability, weight and visibility; and the values added to the film. X and Y count from the
    /// top left of the whole film, PASS from 0. Repeat the flags of the render.
    #[arg(long, value_name = "X,Y,PASS", help_heading = "Debugging")]
    pub(crate) replay: Option<ReplayTarget>,
    /// Print the replayed sample as JSON.
    #[arg(long, requires = "replay", help_heading = "Debugging")]
    pub(crate) json: bool,
    /// Also draw the replayed sample in plan and elevation.
    ///
    /// Shows both subpaths, the candidates, the traced shadow rays, and the blocked ones among them.
    #[arg(
        long,
        value_name = "FILE.svg",
        requires = "replay",
        help_heading = "Debugging"
    )]
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) svg: Option<PathBuf>,
}

/// Where results go.
#[derive(Args, Debug)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutputArgs {
    /// Output image: .exr with a .png beside it, or .png [default: the scene's name].
    ///
    /// The default is the file name that the scene gives its film, or else the name of the scene file,
    /// with the ending .exr, in the current folder. No output of any command replaces a file that the
    /// command reads or its scene names, by whatever path or link: exit code 4. pbrt's spelling
    /// --outfile is accepted.
    #[arg(short, long, alias = "outfile", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Write settings, ray counts and timings as JSON.
    ///
    /// `stages` has the share of each stage in the time of a sample, measured on one sample in 61:
    /// walk, hits (s=0), light_image (t=1 with its shadow rays), candidates (s>=1, t>=2), select,
    /// shadow, direct (path tracing without the walk), film. Timings are those of one thread and
    /// differ from run to run.
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub(crate) stats: Option<PathBuf>,
    /// Messages and progress.
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// Messages and progress.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Output")]
pub(crate) struct TalkArgs {
    /// Print only warnings and errors.
    ///
    /// Progress that --progress requests is still printed.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Progress format [default: bar on a terminal, plain elsewhere].
    ///
    /// bar: a progress bar. plain: a line now and then. ndjson: lines of JSON with the keys progress
    /// (0 to 1), pass, passes, seconds and left (seconds). openjd: lines of Open Job Description on
    /// stdout (openjd_progress, openjd_status, openjd_fail). All others go to stderr.
    #[arg(long, value_name = "FORMAT", value_parser = named(Display::NAMES))]
    pub(crate) progress: Option<Display>,
}

/// How light is estimated.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Integrator")]
pub(crate) struct EstimatorArgs {
    /// path, light, bdpt, lvc, or auto to choose by a short trial [default: the scene's].
    ///
    /// path: path tracing. light: light tracing. bdpt: bidirectional path tracing. lvc: the same with
    /// light subpaths shared by many samples (light vertex cache). auto: tries path, bdpt and lvc on a
    /// few samples and takes the one with the least variance × cost, counted in rays. A glTF file names no integrator
    /// and is rendered with auto.
    #[arg(long, env = "BIDIR_INTEGRATOR", value_name = "NAME")]
    #[arg(value_parser = named(IntegratorKind::NAMES))]
    pub(crate) integrator: Option<IntegratorKind>,
    /// Maximum number of bounces; 0 is unlimited [default: the scene's].
    #[arg(long, value_name = "N")]
    pub(crate) max_depth: Option<u32>,
    /// MIS heuristic: balance, power or uniform [default: balance].
    ///
    /// Strategies that make the same path are weighted by their densities, by the squares of these, or
    /// equally.
    #[arg(long, env = "BIDIR_MIS", value_name = "HEURISTIC")]
    #[arg(value_parser = named(MisHeuristic::NAMES))]
    pub(crate) mis: Option<MisHeuristic>,
    /// Strategies (s, t) in use, such as all,-s0 or s2t3 (bdpt, lvc, auto) [default: all].
    ///
    /// s counts vertices from the light, t from the camera. The list has rules such as all, -s0
    /// (without s = 0), -t1 and s2t3; the last rule that matches a strategy wins. A list that begins
    /// with a removal begins with all strategies, any other with none.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(crate) strategies: Option<Strategies>,
    /// Russian roulette of subpaths: albedo[:START], throughput[:START], off, auto [default: the
    /// integrator's].
    ///
    /// albedo, throughput: subpaths survive with the albedo that they meet, or with their throughput.
    /// START is the first bounce that it applies to (0). off: subpaths end by --max-depth or by leaving
    /// the scene. auto: the integrator's default. Defaults: albedo:1 for path, albedo:2 for light,
    /// albedo:0 for bdpt, albedo:0 for lvc, auto for auto.
    #[arg(long, value_name = "RULE")]
    pub(crate) path_roulette: Option<PathRoulette>,
    /// How next-event estimation picks a light: tree or power (path, bdpt, lvc, auto) [default: tree].
    ///
    /// tree: a hierarchy of the lights estimates the light that arrives from each. power: by power
    /// alone.
    #[arg(long, value_name = "RULE", value_parser = named(LightChoiceKind::NAMES))]
    pub(crate) light_choice: Option<LightChoiceKind>,
    /// Light point of next-event estimation (bdpt, lvc, auto) [default: fresh].
    ///
    /// fresh: one per camera vertex. shared: the start of the light subpath.
    #[arg(long, value_name = "RULE", value_parser = named(LightPointChoice::NAMES))]
    pub(crate) light_point: Option<LightPointChoice>,
    /// Sampler: sobol or independent [default: the scene's].
    ///
    /// sobol: Owen-scrambled Sobol' points, stratified over the samples of a pixel. independent:
    /// independent uniform numbers.
    #[arg(long, env = "BIDIR_SAMPLER", value_name = "NAME")]
    #[arg(value_parser = named(SamplerKind::NAMES))]
    pub(crate) sampler: Option<SamplerKind>,
    /// Random seed [default: the scene's, or 0].
    ///
    /// Images of different seeds have independent noise.
    #[arg(long, env = "BIDIR_SEED", value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Which connections are traced (bdpt, lvc, auto) [default: the integrator's].
    ///
    /// all: all that can carry light. per-light-vertex, per-camera-vertex, per-pair: one for each light
    /// vertex, camera vertex or pair of subpaths, drawn by unoccluded contribution (optimisations 1, 2
    /// and 3 of Lafortune and Willems, 1995). ray-roulette[:T]: Russian roulette below the fraction T
    /// (0.1) of the image's mean. budget:K: at most K per sample, the largest for certain. auto: the
    /// integrator's default. No rule is biased. Defaults: all for bdpt, budget:6 for lvc, auto for auto.
    #[arg(long, env = "BIDIR_SHADOW_RAYS", value_name = "RULE")]
    #[arg(help_heading = "Shadow rays")]
    pub(crate) shadow_rays: Option<ShadowRays>,
    /// Light vertices considered per camera vertex: M at the first, N at later ones (lvc, auto)
    /// [default: the integrator's].
    ///
    /// Each from 1 to 4096; one number is for all vertices; auto: the integrator's default. Defaults:
    /// 12,1 for lvc, auto for auto, which tries several numbers together with budgets of shadow rays.
    #[arg(long, value_name = "M[,N]", help_heading = "Shared light subpaths")]
    pub(crate) candidates: Option<Candidates>,
    /// Light samples per camera vertex: M at the first, N at later ones (lvc, auto) [default: 2,1].
    ///
    /// Each from 1 to 4096; one number is for all vertices.
    #[arg(long, value_name = "M[,N]", help_heading = "Shared light subpaths")]
    pub(crate) next_events: Option<CandidateCount>,
    /// How candidates are drawn: learned in training, or uniform (lvc, auto) [default: learned].
    ///
    /// Training is a short render before the first pass.
    #[arg(long, value_name = "RULE", value_parser = named(ProposalKind::NAMES))]
    #[arg(help_heading = "Shared light subpaths")]
    pub(crate) proposal: Option<ProposalKind>,
    /// How light subpaths pick their light: learned, or by power (lvc, auto) [default: learned].
    ///
    /// learned: by the light of each that reached visible surfaces in training.
    #[arg(long, alias = "emission", value_name = "RULE")]
    #[arg(value_parser = named(EmissionKind::NAMES), help_heading = "Shared light subpaths")]
    pub(crate) light_start: Option<EmissionKind>,
    /// Samples per light subpath, a power of two up to 256 (lvc) [default: 2].
    ///
    /// auto tries 1, 2 and 4. Where light subpaths are so long that those of a group would fill more than
    /// about 30 MB, there are fewer.
    #[arg(long, value_name = "K", help_heading = "Shared light subpaths")]
    pub(crate) samples_per_subpath: Option<SamplesPerSubpath>,
    /// Sample counts in the MIS weights of shared light subpaths (lvc, auto) [default: expected].
    ///
    /// expected: connections per path. correlated: fewer where connections share a camera subpath that
    /// the camera rarely samples. resampled: traced shadow rays.
    #[arg(long, value_name = "RULE", value_parser = named(MisCount::NAMES))]
    #[arg(help_heading = "Shared light subpaths")]
    pub(crate) mis_count: Option<MisCount>,
    /// The environment variables among the sources of these values.
    #[arg(skip)]
    pub(crate) sources: Sources,
}

/// When it is enough: the limit that is reached first ends the render.
#[derive(Args, Debug)]
#[command(next_help_heading = "Stopping")]
pub(crate) struct BudgetArgs {
    /// Samples per pixel [default: the scene's].
    ///
    /// With --time or --noise the default is unlimited; the limit that is reached first ends the render.
    /// A pass takes one sample of every pixel.
    #[arg(long, env = "BIDIR_SPP", value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) spp: Option<u64>,
    /// Stop after this time: 90, 90s, 10m, 1h30m.
    ///
    /// Counts training and checkpoints, not loading the scene and writing the image. A pass that would
    /// not finish in time is not started, but every run renders at least one. Training that would take more
    /// than a second beyond this time is cut short, with a warning: the image has more noise.
    #[arg(long, env = "BIDIR_TIME", value_name = "DURATION")]
    pub(crate) time: Option<Duration>,
    /// Stop at this relative error, such as 0.05.
    ///
    /// The error is the root mean square of the pixels' standard errors over the mean of the image, both
    /// in luminance. It is checked after 16 passes and after every eighth more. Stopping by it biases
    /// the image slightly, which the file records.
    #[arg(long, value_name = "ERROR", value_parser = values::positive_number)]
    pub(crate) noise: Option<f64>,
}

/// The image's geometry.
#[derive(Args, Debug)]
#[command(next_help_heading = "Image")]
pub(crate) struct FilmArgs {
    /// Image size in pixels [default: the scene's].
    ///
    /// The view stays; another aspect ratio makes pixels that are not square, with a warning.
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
    /// Render only this rectangle of pixels; X1 and Y1 are exclusive [default: the scene's].
    #[arg(long, value_name = "X0,Y0,X1,Y1", group = "crops")]
    pub(crate) crop: Option<PixelBounds>,
    /// The same in pbrt's order.
    #[arg(long, value_name = "X0,X1,Y0,Y1", group = "crops")]
    #[arg(value_parser = PixelBounds::from_pbrt)]
    pub(crate) pixelbounds: Option<PixelBounds>,
    /// The same in pbrt's order, as fractions of the image.
    #[arg(long, value_name = "X0,X1,Y0,Y1", group = "crops")]
    pub(crate) cropwindow: Option<CropFractions>,
}

#[cfg(test)]
mod tests {
    use super::{
        EmissionKind, IntegratorKind, LightChoiceKind, LightPointChoice, MisCount, MisHeuristic,
        ProposalKind,
    };
    use crate::args::Cli;
    use crate::settings::name_of;
    use bidir::driver::Settings;
    use clap::CommandFactory;

    /// The help text of a flag of `bidir render`.
    fn help_of(flag: &str) -> String {
        let cli = Cli::command();
        let render = cli.find_subcommand("render").unwrap();
        let argument = render
            .get_arguments()
            .find(|argument| argument.get_long() == Some(flag));
        let argument = argument.unwrap();
        let help = argument.get_long_help().or(argument.get_help());
        help.unwrap().to_string()
    }

    #[track_caller]
    fn check_default(flag: &str, default: impl std::fmt::Display) {
        let help = help_of(flag);
        assert!(
            help.contains(&format!("[default: {default}]")),
            "--{flag}: {help}"
        );
    }

    #[test]
    fn the_help_has_the_true_defaults() {
        let settings = Settings::default();
        let path = &settings.path;
        check_default("next-events", settings.lvc.next_events);
        check_default("samples-per-subpath", settings.lvc.samples_per_subpath);
        check_default(
            "proposal",
            name_of(&ProposalKind::NAMES, settings.lvc.proposal),
        );
        check_default(
            "light-start",
            name_of(&EmissionKind::NAMES, settings.lvc.emission),
        );
        check_default(
            "mis-count",
            name_of(&MisCount::NAMES, settings.lvc.mis_count),
        );
        check_default("strategies", &path.strategies);
        let help = help_of("path-roulette");
        for (name, integrator) in IntegratorKind::NAMES {
            let roulette = integrator.roulette();
            assert!(help.contains(&format!("{roulette} for {name}")), "{help}");
        }
        let help = help_of("candidates");
        for integrator in [IntegratorKind::Lvc, IntegratorKind::Auto] {
            let name = name_of(&IntegratorKind::NAMES, integrator);
            let candidates = integrator.candidates();
            assert!(help.contains(&format!("{candidates} for {name}")), "{help}");
        }
        let help = help_of("shadow-rays");
        let names = IntegratorKind::NAMES.into_iter();
        for (name, integrator) in names.filter(|(_, integrator)| integrator.has_candidates()) {
            let rays = integrator.shadow_rays();
            assert!(help.contains(&format!("{rays} for {name}")), "{help}");
        }
        check_default("mis", name_of(&MisHeuristic::NAMES, path.mis));
        check_default(
            "light-point",
            name_of(&LightPointChoice::NAMES, path.light_point),
        );
        check_default(
            "light-choice",
            name_of(&LightChoiceKind::NAMES, path.light_choice),
        );
        check_default("seed", format_args!("the scene's, or {}", settings.seed));
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
