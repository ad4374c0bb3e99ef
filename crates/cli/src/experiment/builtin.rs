//! The experiments that the program brings, and how they are asked for.

use crate::args::ExperimentArgs;
use lab::{beyond, paper};
use std::path::PathBuf;

/// The name of that of 1995.
pub(super) const PAPER: &str = "paper";
/// The name of that of all estimators.
pub(super) const BEYOND: &str = "beyond";

/// How the paper is repeated.
pub(super) fn paper(args: &ExperimentArgs, threads: usize) -> paper::Options {
    let effort = if args.quick {
        paper::Effort::Quick
    } else {
        paper::Effort::Full
    };
    paper::Options { effort, threads }
}

/// How estimators are compared: in scenes of the project, and in those that `BIDIR_SCENES` has.
pub(super) fn beyond(args: &ExperimentArgs, threads: usize) -> beyond::Options {
    let usual = if args.quick {
        beyond::Amounts::quick()
    } else {
        beyond::Amounts::full()
    };
    let own = &args.beyond;
    beyond::Options {
        amounts: beyond::Amounts {
            size: own.size.map(|size| size.0),
            seconds: own.seconds.unwrap_or(usual.seconds),
            rays: own.rays.unwrap_or(usual.rays),
            // Whoever names a budget means it.
            judged: beyond::Judged {
                seconds: own.seconds.unwrap_or(usual.judged.seconds),
                rays: own.rays.unwrap_or(usual.judged.rays),
            },
            seeds: own.seeds.unwrap_or(usual.seeds),
            reference_spp: own.reference_spp.unwrap_or(usual.reference_spp),
            ..usual
        },
        threads,
        others: std::env::var_os("BIDIR_SCENES").map(PathBuf::from),
        scenes: own.scenes.clone(),
    }
}

/// The command that runs the same experiment.
pub(super) fn command(args: &ExperimentArgs) -> String {
    let own = &args.beyond;
    let size = own.size.map(|size| size.0);
    let flags = [
        (!own.scenes.is_empty()).then(|| format!("--scenes {}", own.scenes.join(","))),
        size.map(|[width, height]| format!("--size {width}x{height}")),
        own.seconds.map(|seconds| format!("--seconds {seconds}")),
        own.rays.map(|rays| format!("--rays {rays}")),
        own.seeds.map(|seeds| format!("--seeds {seeds}")),
        own.reference_spp
            .map(|spp| format!("--reference-spp {spp}")),
        args.quick.then(|| "--quick".to_owned()),
    ];
    let begin = format!("bidir experiment {} -o FOLDER", args.description.display());
    let words = std::iter::once(begin).chain(flags.into_iter().flatten());
    words.collect::<Vec<_>>().join(" ")
}
