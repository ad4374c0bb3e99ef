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

/// What is rendered, how, for how long, and where it goes.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  bidir render scenes/cornell.pbrt
      512x512 pixels with 64 samples each, into cornell.exr and cornell.png
  bidir render room.pbrt -o out/room.exr --time 10m --stats out/room.json
      as many passes as fit into ten minutes
  bidir render room.pbrt --shadow-rays per-pair --spp 256
      one connection ray for each pair of subpaths
  bidir render room.pbrt --spp 65536 --checkpoint room.film --resume
      survives the night: the same command goes on where it was stopped
  bidir render room.pbrt --strategies all,-s0
      without the light that camera subpaths hit by chance
  bidir render room.pbrt --replay 17,4,3
      what sample 3 of the pixel in column 17 of row 4 did
  bidir render room.pbrt --replay 17,4,3 --svg sample.svg
      the same as a picture, too")]
pub(crate) struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Where results go.
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    /// What is written beside the picture.
    #[command(flatten)]
    pub(crate) layers: LayerArgs,
    /// How light is estimated.
    #[command(flatten)]
    pub(crate) estimator: EstimatorArgs,
    /// When it is enough.
    #[command(flatten)]
    pub(crate) budget: BudgetArgs,
    /// How it survives and is shared.
    #[command(flatten)]
    pub(crate) long: LongArgs,
    /// The picture's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
    /// Show the render in the browser as it goes, and print the URL on stdout: the page of
    /// `bidir view`, to look at only.
    ///
    /// Without an address it can be reached from this machine alone; on others the URL has a random
    /// token, without which nothing is answered. The server ends with the render.
    #[arg(
        long,
        value_name = "[ADDRESS:]PORT",
        conflicts_with = "replay",
        help_heading = "Output"
    )]
    pub(crate) serve: Option<ServeAddress>,
    /// Show the render as it goes in the image viewer tev, which listens there [default port: 14158].
    ///
    /// The image is called as the scene. The render never waits for tev, which may be started later,
    /// but for at most two seconds at the end, so that the last image arrives.
    #[arg(
        long,
        value_name = "HOST[:PORT]",
        conflicts_with = "replay",
        help_heading = "Output"
    )]
    pub(crate) display_server: Option<TevAddress>,
    /// Repeat one sample instead of rendering, and tell on stdout what it did.
    ///
    /// Prints the vertices of both subpaths, the candidate connections with their strategies,
    /// values, scores and probabilities, which of them were chosen, which are visible, and what was
    /// added to the film. Pixels count from the top left of the whole film, passes from 0; with the
    /// flags of the render that is asked about.
    #[arg(long, value_name = "X,Y,PASS", help_heading = "Debugging")]
    pub(crate) replay: Option<ReplayTarget>,
    /// Print the replayed sample as JSON.
    #[arg(long, requires = "replay", help_heading = "Debugging")]
    pub(crate) json: bool,
    /// Draw the replayed sample, too: from above and from the side, with both subpaths, the candidates,
    /// the shadow rays that were traced, and which of them were blocked.
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
    /// The image. NAME.exr is written with NAME.png beside it; NAME.png alone.
    ///
    /// By default the name that the scene gives its film, with the ending .exr, in the current
    /// folder.
    #[arg(short, long, visible_alias = "outfile", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Write what was counted and measured, with all settings, as JSON.
    ///
    /// `stages` in it is where the time of a sample goes, measured in one of 61: walk, hits (s=0),
    /// light_image (t=1 with its shadow rays), candidates (s>=1, t>=2), select, shadow, direct (all
    /// of path tracing but the walk), film. Times are of one thread, and differ from run to run.
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub(crate) stats: Option<PathBuf>,
    /// What is told meanwhile.
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// What is told meanwhile.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "Output")]
pub(crate) struct TalkArgs {
    /// Tell nothing but warnings and errors, and the progress that --progress asks for.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// How progress is told [default: bar on a terminal, plain elsewhere].
    ///
    /// bar: a bar that is drawn over. plain: a line now and then. ndjson: such lines as objects of
    /// JSON, with the keys progress (0 to 1), pass, passes, seconds and left (seconds). openjd: lines
    /// of Open Job Description on stdout, openjd_progress, openjd_status and openjd_fail.
    #[arg(long, value_parser = named(Display::NAMES))]
    pub(crate) progress: Option<Display>,
}

/// How light is estimated.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Estimator")]
pub(crate) struct EstimatorArgs {
    /// The estimator: path tracing, light tracing, or both ends joined [default: the scene's].
    ///
    /// path walks from the camera, light from the lights. bdpt joins the two subpaths of a sample; lvc
    /// joins camera subpaths with light subpaths of many samples; auto tries path, bdpt and lvc with
    /// a few samples, and takes what suits the scene; what is named for lvc, but
    /// --samples-per-subpath, holds there, too.
    #[arg(long, env = "BIDIR_INTEGRATOR", value_parser = named(IntegratorKind::NAMES))]
    pub(crate) integrator: Option<IntegratorKind>,
    /// Which connections between subpaths are traced (bdpt, lvc) [default: what suits the integrator].
    ///
    /// By default all for bdpt, budget:6 for lvc and suited for auto.
    /// all: every one. per-light-vertex, per-camera-vertex, per-pair: one for each light vertex, for
    /// each camera vertex, for each pair of subpaths, drawn by unshadowed contribution.
    /// ray-roulette[:PART]: each by chance, where it adds less than PART of the image's mean (0.1).
    /// budget:K: at most K for each sample. suited: what suits the integrator.
    #[arg(long, env = "BIDIR_SHADOW_RAYS", value_name = "RULE")]
    pub(crate) shadow_rays: Option<ShadowRays>,
    /// How many vertices of shared light subpaths are weighed for the first vertex of a camera subpath and
    /// for each of those behind it (lvc), up to 4096 [default: what suits the integrator].
    ///
    /// By default 12,1 for lvc and suited for auto, which then tries more of them, too, with more shadow
    /// rays. One number is for all vertices; suited is what suits the integrator.
    #[arg(long, value_name = "M[,N]")]
    pub(crate) candidates: Option<Candidates>,
    /// How many light points next-event estimation draws for the first vertex of a camera subpath, and for
    /// each of those behind it, up to 4096 (lvc) [default: 2,1].
    ///
    /// One number is for all vertices.
    #[arg(long, value_name = "M[,N]")]
    pub(crate) next_events: Option<CandidateCount>,
    /// How vertices of shared light subpaths are chosen (lvc) [default: learned].
    ///
    /// learned: by what connections between places contributed in a short render before the first
    /// pass. uniform: each is as likely as others.
    #[arg(long, value_parser = named(ProposalKind::NAMES))]
    pub(crate) proposal: Option<ProposalKind>,
    /// How shared light subpaths choose the light that they begin on (lvc) [default: learned].
    ///
    /// learned: by what the same short render found to reach what is seen. power: by power alone.
    #[arg(long, value_parser = named(EmissionKind::NAMES))]
    pub(crate) emission: Option<EmissionKind>,
    /// How many samples bring one light subpath to those that are shared (lvc): a power of two, up to
    /// 256 [default: 2]. auto tries 1, 2 and 4.
    #[arg(long, value_name = "K")]
    pub(crate) samples_per_subpath: Option<SamplesPerSubpath>,
    /// What weights take for the number of samples of a strategy whose light subpaths are shared (lvc)
    /// [default: expected].
    ///
    /// expected: how often it makes the path. correlated: less, where connections have a camera
    /// subpath in common that the camera rarely finds. resampled: how often it traces the path's shadow
    /// ray, where not all are traced.
    #[arg(long, value_name = "KIND", value_parser = named(MisCount::NAMES))]
    pub(crate) mis_count: Option<MisCount>,
    /// How strategies that make the same path share it [default: balance].
    ///
    /// balance: by how often each makes it. power: by the squares of that. uniform: all alike.
    #[arg(long, env = "BIDIR_MIS", value_parser = named(MisHeuristic::NAMES))]
    pub(crate) mis: Option<MisHeuristic>,
    /// The strategies that take part (bdpt, lvc) [default: all].
    ///
    /// A list of rules, of which the last that matches decides: `all`, `-s0` (without s = 0), `-t1`,
    /// `s2t3` (with this one). s counts vertices from the light, t from the camera. A list that begins
    /// with a removal begins with all, another with none.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(crate) strategies: Option<Strategies>,
    /// Where next-event estimation takes its light point from (bdpt, lvc) [default: fresh].
    ///
    /// fresh: each camera vertex draws its own. shared: all use the start of the light subpath.
    #[arg(long, value_parser = named(LightPointChoice::NAMES))]
    pub(crate) light_point: Option<LightPointChoice>,
    /// How next-event estimation chooses the light (path, bdpt, lvc) [default: tree].
    ///
    /// tree: by what arrives from it at the point, as a hierarchy of the lights estimates. power: by
    /// power alone, as light subpaths of light and bdpt do.
    #[arg(long, value_parser = named(LightChoiceKind::NAMES))]
    pub(crate) light_choice: Option<LightChoiceKind>,
    /// How subpaths end by chance [default: the integrator's].
    ///
    /// By default albedo:1 for path, albedo:2 for light, albedo:0 for bdpt, albedo:0 for lvc and suited
    /// for auto. albedo[:START]: with the albedo they meet. throughput[:START]: with their throughput.
    /// Both from bounce START on. off: only by --max-depth or escape. suited: what suits the integrator.
    #[arg(long, value_name = "RULE")]
    pub(crate) path_roulette: Option<PathRoulette>,
    /// The most bounces of a path; 0 is no limit [default: the scene's].
    #[arg(long, value_name = "N")]
    pub(crate) max_depth: Option<u32>,
    /// The random numbers [default: the scene's].
    ///
    /// sobol: points that are spread evenly over the samples of a pixel, in random order. independent:
    /// numbers that know nothing of each other.
    #[arg(long, env = "BIDIR_SAMPLER", value_parser = named(SamplerKind::NAMES))]
    pub(crate) sampler: Option<SamplerKind>,
    /// Other seeds give unrelated noise [default: the scene's, or 0].
    #[arg(long, env = "BIDIR_SEED", value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// What the values above come from.
    #[arg(skip)]
    pub(crate) sources: Sources,
}

/// When it is enough: what is reached first ends the render.
#[derive(Args, Debug)]
#[command(next_help_heading = "Resources")]
pub(crate) struct BudgetArgs {
    /// Samples per pixel, which is the number of passes [default: the scene's].
    ///
    /// With --time or --noise and no --spp there is no limit.
    #[arg(long, env = "BIDIR_SPP", value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) spp: Option<u64>,
    /// The time for rendering: 90, 90s, 10m, 1h30m.
    ///
    /// Reading the scene and writing the image do not count; writing film files does. A pass that would
    /// overrun is not begun, but the first one of a run always is.
    #[arg(long, env = "BIDIR_TIME", value_name = "DURATION")]
    pub(crate) time: Option<Duration>,
    /// The relative error to reach: the root mean square of the pixels' standard errors, divided by
    /// the mean of the image, both of luminance.
    ///
    /// Looked at from 16 passes on, after every eighth more. A picture that decides itself when it is
    /// done is slightly biased: the file says so.
    #[arg(long, value_name = "ERROR", value_parser = values::positive_number)]
    pub(crate) noise: Option<f64>,
    /// How fast it is.
    #[command(flatten)]
    pub(crate) threads: ThreadsArgs,
}

/// The picture's geometry.
#[derive(Args, Debug)]
#[command(next_help_heading = "Film")]
pub(crate) struct FilmArgs {
    /// Width and height of the whole film in pixels.
    ///
    /// The view stays that of the scene: a size of another shape has pixels that are not square, and a
    /// warning says so.
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,
    /// Render only these pixels, from x0,y0 up to but not including x1,y1.
    #[arg(long, value_name = "X0,Y0,X1,Y1", group = "crops")]
    pub(crate) crop: Option<PixelBounds>,
    /// The same in the order of pbrt.
    #[arg(long, value_name = "X0,X1,Y0,Y1", group = "crops")]
    #[arg(value_parser = PixelBounds::from_pbrt)]
    pub(crate) pixelbounds: Option<PixelBounds>,
    /// The same as fractions of the film, in the order of pbrt.
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
    fn the_help_tells_the_true_defaults() {
        let settings = Settings::default();
        let path = &settings.path;
        check_default("next-events", settings.lvc.next_events);
        check_default("samples-per-subpath", settings.lvc.samples_per_subpath);
        check_default(
            "proposal",
            name_of(&ProposalKind::NAMES, settings.lvc.proposal),
        );
        check_default(
            "emission",
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
