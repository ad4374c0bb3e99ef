//! The flags of `bidir reference`.

use super::render::{EstimatorArgs, FilmArgs, TalkArgs};
use super::{SceneArgs, ThreadsArgs};
use clap::{Args, FromArgMatches, ValueHint};
use std::path::PathBuf;
use std::str::FromStr;

/// Which scene gets a reference, and by which estimators.
#[derive(Args, Debug)]
#[command(after_long_help = "\
Examples:
  bidir reference scenes/cornell.pbrt --spp 4096
      512x512 pixels by bdpt and by path tracing, into cornell.reference
  bidir reference scenes/cornell.pbrt --extend 4096
      as many samples more
  bidir compare cornell.exr --reference cornell.reference
      how far an image is from it
  bidir reference room.pbrt --spp 1024 -o room-inner.reference \\
    --estimator 'bdpt --strategies all,-s0,-t1 --light-point shared' \\
    --against 'bdpt --strategies s1,-t1'
      for estimators that leave some light out")]
pub(crate) struct ReferenceArgs {
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// The folder of the reference [default: NAME.reference, in the current folder].
    ///
    /// What is there already is gone on from, where it is of the same scene and settings.
    #[arg(short, long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    #[arg(help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
    /// What is told meanwhile.
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
    /// Samples per pixel of each estimator, those included that are there already; rounded up to a
    /// multiple of 16 [default: the scene's].
    #[arg(long, value_name = "N", help_heading = "Resources")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=MOST_SAMPLES))]
    pub(crate) spp: Option<u64>,
    /// Add samples to the reference that is there, with the settings that it has.
    #[arg(long, value_name = "N", help_heading = "Resources")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=MOST_SAMPLES))]
    #[arg(conflicts_with_all = ["spp", "estimator", "against", "restart", "size", "crops"])]
    pub(crate) extend: Option<u64>,
    /// Begin anew where there is a reference, and replace it.
    #[arg(long, help_heading = "Resources")]
    pub(crate) restart: bool,
    /// How fast it is.
    #[command(flatten, next_help_heading = "Resources")]
    pub(crate) threads: ThreadsArgs,
    /// The estimator that makes the picture [default: bdpt].
    ///
    /// An integrator, and flags of `bidir render` from its section Estimator, in quotes. What is not
    /// said is as usual, with independent random numbers, and the longest paths and the seed of the
    /// scene; the scene's integrator and sampler have no influence, nor has the environment.
    #[arg(long, value_name = "FLAGS", help_heading = "Estimators")]
    pub(crate) estimator: Option<EstimatorFlags>,
    /// The estimator that it has to agree with, likewise, and not the same but for the seed [default:
    /// path].
    #[arg(long, value_name = "FLAGS", help_heading = "Estimators")]
    pub(crate) against: Option<EstimatorFlags>,
    /// The picture's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
}

/// More would take longer than anybody waits.
const MOST_SAMPLES: u64 = 1 << 40;

/// An estimator in one word of the command line, such as `bdpt --strategies s1,-t1`.
#[derive(Clone, Debug)]
pub(crate) struct EstimatorFlags(pub(crate) EstimatorArgs);

impl FromStr for EstimatorFlags {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let command = clap::Command::new("").no_binary_name(true);
        let command = command.disable_help_flag(true);
        // The environment is of the whole command.
        let command = EstimatorArgs::augment_args(command)
            .mut_args(|flag| flag.env(clap::builder::Resettable::Reset));
        let mut words: Vec<_> = text.split_whitespace().collect();
        if words.first().is_some_and(|word| !word.starts_with('-')) {
            words.insert(0, "--integrator");
        }
        let matches = command.try_get_matches_from(words);
        let flags = matches.and_then(|matches| EstimatorArgs::from_arg_matches(&matches));
        flags.map(Self).map_err(|error| first_line(&error))
    }
}

/// What is wrong, without the usage.
fn first_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    let text = line.trim_start_matches("error: ");
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bidir::integrator::IntegratorKind;

    #[test]
    fn an_estimator_is_a_name_and_flags() {
        let EstimatorFlags(args) = "bdpt --strategies s1,-t1 --seed 4".parse().unwrap();
        assert_eq!(args.integrator, Some(IntegratorKind::Bdpt));
        assert_eq!(args.strategies, Some("s1,-t1".parse().unwrap()));
        assert_eq!((args.seed, args.max_depth), (Some(4), None));
        let EstimatorFlags(args) = "--max-depth 3".parse().unwrap();
        assert_eq!((args.integrator, args.max_depth), (None, Some(3)));
        for (text, part) in [
            ("photons", "invalid value 'photons'"),
            ("bdpt --spp 4", "unexpected argument '--spp'"),
            ("bdpt path", "unexpected argument 'path'"),
        ] {
            let error = text.parse::<EstimatorFlags>().unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
