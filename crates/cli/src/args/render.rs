//! The flags of `bidir render`.

use super::layers::LayerArgs;
use super::long::LongArgs;
use super::values::{ReplayTarget, named};
use super::{SceneArgs, ThreadsArgs, values, view};
use crate::console::Display;
use bidir::film::PixelRect;
use bidir::settings::Request;
use clap::{Args, ValueHint};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;
use viewer::tev::TevAddress;

/// The flags of `bidir render`. The order of the fields is the order of the headings in `--help`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  bidir render room.pbrt --integrator auto --time 10m -o room.exr
  bidir render room.glb --spp 64 --denoise
  bidir render room.pbrt --spp 65536 --checkpoint room.film --resume")]
#[command(after_long_help = include_str!("render.txt").trim_end())]
pub(crate) struct RenderArgs {
    /// The files to write, and messages.
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    /// Show progress in the browser, read only.
    ///
    /// Prints the URL on stdout. Without ADDRESS the page can be reached from this machine only;
    /// otherwise the URL carries a random token. The server ends with the render. `bidir view` can
    /// also change the render.
    #[arg(long, value_name = "[ADDRESS:]PORT", conflicts_with = "replay")]
    #[arg(help_heading = "Output", value_parser = view::serve_address)]
    pub(crate) serve: Option<SocketAddr>,
    /// Show progress in the image viewer tev [default port: 14158].
    ///
    /// The render never waits for tev, which may be started later, except for at most two seconds at
    /// the end.
    #[arg(long, value_name = "HOST[:PORT]", conflicts_with = "replay")]
    #[arg(help_heading = "Output")]
    pub(crate) display_server: Option<TevAddress>,
    /// The image's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
    /// The limits that end the render.
    #[command(flatten)]
    pub(crate) budget: BudgetArgs,
    /// The settings of the estimator.
    #[command(flatten)]
    pub(crate) estimator: Request,
    /// The flags whose values come from environment variables.
    #[arg(skip)]
    pub(crate) of_variables: Vec<String>,
    /// The layers.
    #[command(flatten)]
    pub(crate) layers: LayerArgs,
    /// The film file, and the passes to render.
    #[command(flatten)]
    pub(crate) long: LongArgs,
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// The number of threads.
    #[command(flatten, next_help_heading = "Scene and machine")]
    pub(crate) threads: ThreadsArgs,
    /// Repeat one sample and print every term, instead of rendering.
    ///
    /// Prints the vertices of both subpaths; every connection with its strategy, value, score,
    /// probability, weight and visibility; and the values added to the film. X and Y count from the
    /// top left of the whole film, PASS from 0. Repeat the flags of the render.
    #[arg(long, value_name = "X,Y,PASS", help_heading = "Debugging")]
    #[arg(value_parser = values::replay_target)]
    pub(crate) replay: Option<ReplayTarget>,
    /// Print the replayed sample as JSON.
    #[arg(long, requires = "replay", help_heading = "Debugging")]
    pub(crate) json: bool,
    /// Also draw the replayed sample in plan and elevation.
    ///
    /// Shows both subpaths, the candidates, the traced shadow rays, and the blocked ones among them.
    #[arg(long, value_name = "FILE.svg", requires = "replay")]
    #[arg(help_heading = "Debugging")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) svg: Option<PathBuf>,
}

/// The files to write, and messages.
#[derive(Args, Debug)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutputArgs {
    /// Output image: .exr with a .png beside it, or .png [default: the scene's name].
    ///
    /// The default is the file name that the scene gives its film, or else the name of the scene file,
    /// with the ending .exr, in the current folder. An output that would replace an input, or a file
    /// that the scene names, is refused (exit code 4). pbrt's spelling --outfile is accepted.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Write settings, ray counts and timings as JSON.
    ///
    /// `stages` has the share of each stage in the time of a sample, measured on one sample in 7:
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

/// The limits of a render: the one that is reached first ends it.
#[derive(Args, Debug)]
#[command(next_help_heading = "Stopping")]
pub(crate) struct BudgetArgs {
    /// Samples per pixel [default: the scene's].
    ///
    /// With --time or --noise the default is unlimited; the limit that is reached first ends the render.
    /// A pass takes one sample of every pixel. 4k is 4000, 1e6 a million.
    #[arg(long, env = "BIDIR_SPP", value_name = "N")]
    #[arg(value_parser = values::count::<u64>(1..=u64::MAX))]
    pub(crate) spp: Option<u64>,
    /// Stop after this time: 90, 90s, 10m, 1h30m.
    ///
    /// Counts training and checkpoints, not loading the scene and writing the image. A pass that would
    /// not finish in time is not started, or left. If none is complete, that is an error, and no file is
    /// written. Training takes at most a tenth of the time; shorter training means more noise.
    #[arg(long, env = "BIDIR_TIME", value_name = "DURATION", value_parser = values::duration)]
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
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Image")]
pub(crate) struct FilmArgs {
    /// Image size in pixels [default: the scene's].
    ///
    /// In another aspect ratio, a pbrt scene keeps its view and is stretched, with a warning; a glTF scene
    /// shows more.
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Render only this rectangle of pixels; X1 and Y1 are exclusive [default: the scene's].
    #[arg(long, value_name = "X0,Y0,X1,Y1", group = "crops")]
    #[arg(value_parser = values::pixel_bounds)]
    pub(crate) crop: Option<PixelRect>,
    /// The same in pbrt's order.
    #[arg(long, value_name = "X0,X1,Y0,Y1", group = "crops")]
    #[arg(value_parser = values::pbrt_pixel_bounds)]
    pub(crate) pixelbounds: Option<PixelRect>,
    /// The same in pbrt's order, as fractions of the image.
    #[arg(long, value_name = "X0,X1,Y0,Y1", group = "crops")]
    #[arg(value_parser = values::crop_fractions)]
    pub(crate) cropwindow: Option<[f32; 4]>,
}

#[cfg(test)]
mod tests {
    use crate::args::Cli;
    use bidir::driver::Settings;
    use bidir::integrator::IntegratorKind;
    use bidir::settings::Request;
    use clap::CommandFactory;

    /// Returns the help text of a flag of `bidir render`.
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
    fn the_help_has_the_defaults_of_the_library() {
        let of = |integrator| Request::of(&Settings::new(integrator)).texts();
        let of_lvc = of(IntegratorKind::Lvc);
        let same = ["samples-per-subpath", "proposal", "light-start"];
        for name in same
            .into_iter()
            .chain(["strategies", "mis", "light-point", "light-choice"])
        {
            check_default(name, &of_lvc[name]);
        }
        for name in ["path-roulette", "candidates", "next-events", "shadow-rays"] {
            let help = help_of(name);
            for (integrator, kind) in IntegratorKind::NAMES {
                let default = of(kind).remove(name);
                let part = default.map(|default| match &default[..] {
                    "auto" => format!("chosen by a survey for {integrator}"),
                    default => format!("{default} for {integrator}"),
                });
                assert!(part.is_none_or(|part| help.contains(&part)), "{help}");
            }
        }
        let settings = Settings::default();
        check_default("seed", format_args!("the scene's, or {}", settings.seed));
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
