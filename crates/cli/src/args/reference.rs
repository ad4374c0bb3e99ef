//! The flags of `bidir reference`.

use super::render::{FilmArgs, TalkArgs};
use super::values::count;
use super::{SceneArgs, ThreadsArgs, mistakes};
use bidir::settings::Request;
use clap::{Args, FromArgMatches, ValueHint};
use std::path::PathBuf;

/// The scene that gets a reference, and its estimators.
#[derive(Args, Debug)]
#[command(after_long_help = include_str!("reference.txt").trim_end())]
pub(crate) struct ReferenceArgs {
    /// Folder of the reference [default: NAME.reference, in the current folder].
    ///
    /// The command continues an existing reference of the same scene and settings.
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    #[arg(help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    /// Messages and progress.
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
    /// Samples per pixel of each estimator, in multiples of 16 [default: the scene's].
    ///
    /// Includes the samples that the reference has already.
    #[arg(long, value_name = "N", help_heading = "Samples")]
    #[arg(value_parser = count::<u64>(1..=MOST_SAMPLES))]
    pub(crate) spp: Option<u64>,
    /// Add N samples per pixel to an existing reference, with its settings.
    #[arg(long, value_name = "N", help_heading = "Samples")]
    #[arg(value_parser = count::<u64>(1..=MOST_SAMPLES))]
    #[arg(conflicts_with_all = ["spp", "estimator", "against", "restart", "size", "crops"])]
    pub(crate) extend: Option<u64>,
    /// Start over, and replace an existing reference.
    #[arg(long, help_heading = "Samples")]
    pub(crate) restart: bool,
    /// Estimator of the image [default: bdpt].
    ///
    /// In quotes, an integrator and flags of `bidir render` under Integrator, Shadow rays and Shared
    /// light subpaths. Defaults are those of `bidir render`, with the independent sampler and with the
    /// scene's maximum depth and seed; the scene's integrator and sampler and the environment have no
    /// effect.
    #[arg(long, value_name = "FLAGS", help_heading = "Estimators", value_parser = estimator)]
    estimator: Option<Request>,
    /// Estimator of the cross-check [default: path].
    ///
    /// Written in the same way; it must differ from the first in more than the seed.
    #[arg(long, value_name = "FLAGS", help_heading = "Estimators", value_parser = estimator)]
    against: Option<Request>,
    /// The image's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// The number of threads.
    #[command(flatten, next_help_heading = "Scene and machine")]
    pub(crate) threads: ThreadsArgs,
}

impl ReferenceArgs {
    /// Returns the requested settings of the image's estimator and of the cross-check.
    pub(crate) fn requests(&self) -> [Request; 2] {
        [&self.estimator, &self.against].map(|flags| flags.clone().unwrap_or_default())
    }
}

/// Maximum number of samples per pixel, beyond any practical render.
const MOST_SAMPLES: u64 = 1 << 40;

/// Reads an estimator in one argument of the command line, such as `bdpt --strategies s1,-t1`.
fn estimator(text: &str) -> Result<Request, String> {
    let empty = clap::Command::new("").no_binary_name(true);
    // Variables apply to the whole command, not to one of its estimators.
    let mut command = Request::augment_args(empty.disable_help_flag(true))
        .mut_args(|flag| flag.env(clap::builder::Resettable::Reset));
    let mut words: Vec<_> = text.split_whitespace().collect();
    if words.first().is_some_and(|word| !word.starts_with('-')) {
        words.insert(0, "--integrator");
    }
    let matches = command.try_get_matches_from_mut(words);
    let flags = matches.and_then(|matches| Request::from_arg_matches(&matches));
    flags.map_err(|error| {
        let failure = mistakes::explained(&error, &command, &[]);
        failure.message().to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::integrator::IntegratorKind;

    #[test]
    fn an_estimator_is_a_name_and_flags() {
        let args = estimator("bdpt --strategies s1,-t1 --seed 4").unwrap();
        assert_eq!(args.integrator, Some(IntegratorKind::Bdpt));
        assert_eq!(args.strategies, Some("s1,-t1".parse().unwrap()));
        assert_eq!((args.seed, args.max_depth), (Some(4), None));
        let args = estimator("--max-depth 3").unwrap();
        assert_eq!((args.integrator, args.max_depth), (None, Some(3)));
        for (text, part) in [
            ("photons", "--integrator: `photons` is not one of path"),
            ("bdpt --spp 4", "there is no flag `--spp`"),
            ("bdpt path", "unexpected argument `path`"),
        ] {
            let error = estimator(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
