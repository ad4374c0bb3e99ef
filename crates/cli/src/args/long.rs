//! The flags of long renders: film files, and parts of a render.

use super::values::duration;
use bidir::film::PassSet;
use clap::{Args, ValueHint};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

/// The film file of a render, and the passes that it renders.
#[derive(Args, Debug)]
#[command(next_help_heading = "Checkpoints and parts")]
pub(crate) struct LongArgs {
    /// Save progress to this film file.
    ///
    /// The file has the exact sums of all pixels. --resume continues from it, `bidir merge` adds it to
    /// others, and `bidir film develop` makes an image of it. The previous file stays as FILE.previous.
    /// SIGUSR1 saves film file and image after the current pass.
    #[arg(long, value_name = "FILE.film", value_hint = ValueHint::FilePath)]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Time between checkpoints.
    #[arg(long, value_name = "DURATION", default_value = "5m", value_parser = duration)]
    #[arg(requires = "checkpoint")]
    pub(crate) checkpoint_every: Duration,
    /// Continue from the checkpoint if it exists.
    ///
    /// The image has the bits of an uninterrupted render. --spp counts all passes, --time only this run.
    /// A film file of another scene, of other settings, or with passes outside the requested ones is
    /// refused.
    #[arg(long, requires = "checkpoint", conflicts_with = "restart")]
    pub(crate) resume: bool,
    /// Start over, and replace the checkpoint if it exists.
    #[arg(long, requires = "checkpoint")]
    pub(crate) restart: bool,
    /// Render passes A to B - 1 only, counted from 0.
    ///
    /// --spp and BIDIR_SPP then have no effect, and a warning says so. Ranges that begin and end at
    /// multiples of powers of two are stratified best. A part of a render writes an image only if
    /// --output names one. `bidir merge` adds parts.
    #[arg(long, value_name = "A..B", conflicts_with = "part", value_parser = passes)]
    pub(crate) passes: Option<Range<u64>>,
    /// Render part I of N of the passes, I from 0, such as 3/16.
    ///
    /// env/N takes I from HyperQueue, Kubernetes or Slurm: the first of HQ_TASK_ID,
    /// JOB_COMPLETION_INDEX and SLURM_ARRAY_TASK_ID (minus SLURM_ARRAY_TASK_MIN) that is set.
    /// `bidir merge` adds parts.
    #[arg(long, value_name = "I/N", value_parser = Part::read)]
    pub(crate) part: Option<Part>,
}

/// Reads a half-open, non-empty range of passes, written `A..B`.
fn passes(text: &str) -> Result<Range<u64>, String> {
    let passes = text.parse::<PassSet>();
    match passes.as_ref().map(PassSet::ranges) {
        Ok([range]) => Ok(range.clone()),
        _ => Err("expected A..B with A < B, such as 0..64".into()),
    }
}

/// One of several equal parts of a render, written `I/N`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// The number of this part. Range: below `of`.
    pub(crate) index: u64,
    /// The number of parts; positive.
    pub(crate) of: u64,
}

impl Part {
    /// Returns the passes of this part out of `passes`. Every pass is in exactly one part.
    pub(crate) fn range(self, passes: u64) -> Range<u64> {
        let edge = |i: u64| (u128::from(passes) * u128::from(i) / u128::from(self.of)) as u64;
        edge(self.index)..edge(self.index + 1)
    }

    fn new(index: u64, of: u64) -> Result<Self, String> {
        if index < of {
            Ok(Self { index, of })
        } else {
            Err(format!(
                "there is no part {index} of {of}: parts are 0 to {}",
                of.saturating_sub(1)
            ))
        }
    }

    /// Reads a part, whose number `env` comes from the environment.
    fn read(text: &str) -> Result<Self, String> {
        let expected = || "expected I/N, such as 3/16, or env/16".to_owned();
        let (index, of) = text.split_once('/').ok_or_else(expected)?;
        let of = of.parse().map_err(|_| expected())?;
        if index == "env" {
            return Self::new(index_from_environment(|name| std::env::var(name).ok())?, of);
        }
        Self::new(index.parse().map_err(|_| expected())?, of)
    }
}

/// Reads the number of this task, counted from 0, from the variables of a scheduler.
fn index_from_environment(variable: impl Fn(&str) -> Option<String>) -> Result<u64, String> {
    let number = |name: &str| {
        let text = variable(name)?;
        Some(
            text.parse::<u64>()
                .map_err(|_| format!("{name}={text} is not a whole number")),
        )
    };
    // Workers of HyperQueue and Kubernetes may run inside a Slurm job: their numbers take precedence.
    let inner = ["HQ_TASK_ID", "JOB_COMPLETION_INDEX"];
    if let Some(id) = inner.iter().find_map(|name| number(name)) {
        return id;
    }
    let id = number("SLURM_ARRAY_TASK_ID")
        .ok_or("none of HQ_TASK_ID, JOB_COMPLETION_INDEX, SLURM_ARRAY_TASK_ID is set")??;
    let first = number("SLURM_ARRAY_TASK_MIN").unwrap_or(Ok(0))?;
    let before = || format!("SLURM_ARRAY_TASK_ID is below SLURM_ARRAY_TASK_MIN, {first}");
    id.checked_sub(first).ok_or_else(before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_every_pass_once() {
        for (passes, of) in [(7, 3), (64, 7), (3, 5), (u64::MAX, 2)] {
            let ranges = (0..of).map(|index| Part { index, of }.range(passes));
            let end = ranges.fold(0, |end, range| {
                assert_eq!(range.start, end);
                range.end
            });
            assert_eq!(end, passes);
        }
    }

    #[test]
    fn malformed_parts_and_ranges_are_refused() {
        for text in ["", "3", "3/3", "-1/3", "a/b", "0/0", "1/"] {
            assert!(Part::read(text).is_err(), "{text}");
        }
        for text in [
            "",
            "4",
            "4..4",
            "5..4",
            "..4",
            "4..",
            "a..b",
            "0..4, 8..9",
            "none",
        ] {
            assert!(passes(text).is_err(), "{text}");
        }
        assert_eq!(Part::read("2/3"), Ok(Part { index: 2, of: 3 }));
        assert_eq!(passes("4..9"), Ok(4..9));
    }

    #[test]
    fn the_number_of_a_task_comes_from_the_scheduler() {
        let check = |set: &[(&str, &str)], expected: Option<u64>| {
            let variable = |name: &str| {
                let (_, value) = set.iter().find(|(key, _)| *key == name)?;
                Some((*value).to_owned())
            };
            assert_eq!(index_from_environment(variable).ok(), expected, "{set:?}");
        };
        check(&[("SLURM_ARRAY_TASK_ID", "5")], Some(5));
        check(
            &[("SLURM_ARRAY_TASK_ID", "5"), ("SLURM_ARRAY_TASK_MIN", "1")],
            Some(4),
        );
        check(
            &[("SLURM_ARRAY_TASK_ID", "0"), ("SLURM_ARRAY_TASK_MIN", "1")],
            None,
        );
        check(
            &[("HQ_TASK_ID", "3"), ("SLURM_ARRAY_TASK_ID", "5")],
            Some(3),
        );
        check(&[("JOB_COMPLETION_INDEX", "2")], Some(2));
        check(&[("HQ_TASK_ID", "x")], None);
        check(&[], None);
    }
}
