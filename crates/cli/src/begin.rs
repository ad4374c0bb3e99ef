//! Starts a render: trains its session, which may take longer than the passes.

use crate::args::RenderArgs;
use crate::console::{Console, Display, LineFormat};
use crate::exit::Failure;
use crate::scene_io::{FilmHeader, LoadedScene};
use crate::signals::Signals;
use bidir::driver::{Effort, Resources, SessionError, Settings, Stop};
use formats::film::Render;
use std::time::{Duration, Instant};

/// The time after which a message says that training is running.
const LONG: Duration = Duration::from_secs(2);
/// The limits of training.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TrainingLimits {
    /// The maximum number of samples.
    samples: u64,
    /// Training ends at this time.
    end: Option<Instant>,
}

impl TrainingLimits {
    /// Returns the limits for a render that starts now and has so much time. A render that continues the film
    /// of `earlier` repeats its training. The number of passes sets no limit, so that parts of a render have the
    /// training of the whole.
    pub(crate) fn new(time: Option<Duration>, earlier: Option<&FilmHeader>) -> Self {
        if let Some(earlier) = earlier {
            let samples = formats::film::training_samples(earlier).unwrap_or(u64::MAX);
            return Self { samples, end: None };
        }
        Self {
            samples: u64::MAX,
            end: time.and_then(|time| Instant::now().checked_add(time / Effort::PART)),
        }
    }
}

/// Begins and trains a render. None: a signal or the end of the time came first.
pub(crate) fn render(
    args: &RenderArgs,
    loaded: &LoadedScene,
    settings: &Settings,
    signals: &Signals,
    limits: TrainingLimits,
    console: Console,
) -> Result<Option<Box<Render<'static>>>, Failure> {
    let (subject, settings) = (loaded.subject.clone(), settings.clone());
    let (resources, stop) = (resources(args), signals.stop_flag());
    let train = move || {
        let effort = Effort {
            samples: limits.samples,
            is_late: &|| limits.end.is_some_and(|end| Instant::now() >= end),
            stop: Stop::when(&stop),
        };
        subject.begin(&settings, &resources, effort).map(Box::new)
    };
    let (begun, mut is_said) = (Instant::now(), false);
    let tick = || {
        if !is_said && begun.elapsed() >= LONG {
            is_said = true;
            display(args, console).say("training before the first sample");
        }
    };
    let render = match signals.wait_for(train, tick) {
        Some(Err(SessionError::Stopped)) | None => return Ok(None),
        Some(render) => render,
    };
    let render = render.map_err(|error| failure(loaded, &error))?;
    if let Some(shortage) = render.session.shortage() {
        console.warning(shortage);
    }
    Ok(Some(render))
}

/// Returns the form of progress. A replay as JSON has stdout to itself.
fn display(args: &RenderArgs, console: Console) -> Display {
    match console.display(args.output.talk) {
        Display::Lines(LineFormat::OpenJd) if args.json => Display::Silent,
        display => display,
    }
}

fn resources(args: &RenderArgs) -> Resources {
    Resources {
        threads: args.threads.count.into(),
        clock: args.output.stats.is_some().then_some(Instant::now),
        ..Resources::default()
    }
}

/// Returns the failure of the command for an error of the session.
fn failure(loaded: &LoadedScene, error: &SessionError) -> Failure {
    match error {
        SessionError::NoPath { .. } | SessionError::Stopped => Failure::usage(error.to_string()),
        SessionError::Film(error) => loaded.too_large(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_continued_render_repeats_its_training() {
        let header = |settings: &[(&str, &str)]| {
            let settings = settings.iter();
            let settings = settings.map(|&(name, value)| (name.to_owned(), value.to_owned()));
            FilmHeader::new("bidir", "room.pbrt".to_owned(), settings.collect())
        };
        let (whole, short) = (
            header(&[("trained-mean", "1e0")]),
            header(&[("trained-mean", "1e0"), ("training", "64")]),
        );
        for time in [None, Some(Duration::from_secs(2)), Some(Duration::MAX)] {
            for (earlier, samples) in [(&whole, u64::MAX), (&short, 64)] {
                let end = None;
                let limits = TrainingLimits::new(time, Some(earlier));
                assert_eq!(limits, TrainingLimits { samples, end });
            }
        }
        let alone = TrainingLimits::new(Some(Duration::from_secs(20)), None);
        assert_eq!(alone.samples, u64::MAX);
        let end = alone.end.expect("the time is limited");
        let left = end.saturating_duration_since(Instant::now());
        assert!(left <= Duration::from_secs(2) && left > Duration::from_secs(1));
        let open = TrainingLimits::new(None, None);
        assert_eq!((open.samples, open.end), (u64::MAX, None));
    }
}
