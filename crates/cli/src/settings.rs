//! The settings of a render from flags, environment and scene. `clap` gives flags precedence over the
//! environment; here both take precedence over the scene.

use crate::args::{BudgetArgs, LongArgs, Part, RenderArgs};
use crate::console::Console;
use crate::exit::Failure;
use crate::scene_io::LoadedScene;
use bidir::driver::{Session, Settings};
use bidir::integrator::{BlindSpot, LostLight, lost_light, missing_light};
use bidir::path::MAX_VERTICES;
use formats::scene::Lamp;
use std::ops::Range;
use std::time::Duration;

/// Warns of flags and variables that have no effect on this render. Returns the number of warnings.
pub(crate) fn warn_unused(args: &RenderArgs, settings: &Settings, console: Console) -> usize {
    let integrator = format!("on the integrator `{}`", settings.integrator);
    let spp = args.budget.spp.filter(|_| args.long.passes.is_some());
    let ignored = args.estimator.ignored(settings).into_iter();
    let ignored = ignored.map(|name| (format!("--{name}"), &*integrator));
    let spp = spp.map(|_| ("--spp".to_owned(), "where --passes is given"));
    ignored
        .chain(spp)
        .map(|(flag, on)| {
            let name = args.sources.name(&flag);
            console.warning(format_args!("{name} has no effect {on}"));
        })
        .count()
}

/// Warns of light that the list of strategies, given by `flag`, loses. Returns the number of warnings.
///
/// Errors: the list makes no path, so that the image would be black.
pub(crate) fn check_strategies(
    flag: &str,
    loaded: &LoadedScene,
    settings: &Settings,
    console: Console,
) -> Result<usize, Failure> {
    let path = &settings.path;
    let Some(lost) = lost_light(&loaded.scene, &loaded.view, settings.integrator, path) else {
        return Ok(0);
    };
    let message = format!("{flag} {} {lost}", path.strategies);
    match lost {
        LostLight::All { max_vertices } => {
            let failure = Failure::usage(message);
            Err(match max_vertices {
                Some(most) if most < MAX_VERTICES => failure.with_hint(format!(
                    "raise --max-depth: paths of {} bounces have {most} vertices, and no path has more \
                     than {MAX_VERTICES}",
                    most - 2
                )),
                Some(_) => failure.with_hint("no path has more vertices"),
                None => failure.with_hint(
                    "strategy sNtM has N light vertices and M camera vertices: M is at least 1, \
                     N + M at least 2",
                ),
            })
        }
        LostLight::Lengths(_) | LostLight::Specular(_) => {
            console.warning(message);
            Ok(1)
        }
    }
}

/// Warns of light that all strategies of the estimator miss, and names its lamps. Returns the number of
/// warnings.
pub(crate) fn warn_missing(loaded: &LoadedScene, settings: &Settings, console: Console) -> usize {
    let integrator = settings.integrator;
    let missing = missing_light(&loaded.scene, &loaded.view, integrator, &settings.path);
    for &spot in &missing {
        let (paths, remedy) = (spot.description(), spot.remedy());
        let lamps = lamps(loaded, spot);
        console.warning(format_args!(
            "`{integrator}` misses {paths}{lamps}; {remedy}"
        ));
    }
    missing.len()
}

/// Names the lamps whose light is missing, as the end of a clause: the place of the first, the number of
/// the others. Empty if the light of every lamp is missing.
fn lamps(loaded: &LoadedScene, spot: BlindSpot) -> String {
    let lights = loaded.scene.lights();
    let is_concerned = |lamp: &&Lamp| spot.concerns(&lights[lamp.light as usize]);
    let first = loaded.lamps.iter().find(is_concerned);
    let Some(first) = first.filter(|_| spot != BlindSpot::SeenBySpecular) else {
        return String::new();
    };
    let kind = lights[first.light as usize].kind();
    let count = lights.iter().filter(|light| spot.concerns(light)).count();
    let others = match count - 1 {
        0 => String::new(),
        1 => " and another light".to_owned(),
        others => format!(" and {others} other lights"),
    };
    format!(", here of the {kind} light at {}{others}", first.place)
}

/// The limits of a render: the one that is reached first ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Budget {
    /// The first pass.
    pub(crate) first: u64,
    /// The maximum number of passes from `first` on.
    pub(crate) passes: Option<u64>,
    /// The maximum time.
    pub(crate) time: Option<Duration>,
    /// The relative error at which the render ends.
    pub(crate) noise: Option<f64>,
}

impl Budget {
    /// Returns the passes that may be rendered.
    pub(crate) fn range(&self) -> Range<u64> {
        let end = self.passes.map_or(u64::MAX, |passes| self.first + passes);
        self.first..end
    }

    /// Returns the budget of a render; `scene` is the scene's number of samples per pixel.
    ///
    /// Errors: a part that has no passes.
    pub(crate) fn new(args: &BudgetArgs, long: &LongArgs, scene: u64) -> Result<Self, Failure> {
        let (time, noise) = (args.time.map(|time| time.0), args.noise);
        let is_open = time.is_some() || noise.is_some();
        let all = args.spp.or((!is_open).then_some(scene));
        let part = match (&long.passes, long.part) {
            (Some(range), _) => Some(range.0.clone()),
            (None, Some(part)) => Some(passes_of(part, all.unwrap_or(scene))?),
            (None, None) => None,
        };
        Ok(Self {
            first: part.as_ref().map_or(0, |range| range.start),
            passes: part.map_or(all, |range| Some(range.end - range.start)),
            time,
            noise,
        })
    }

    /// Returns true if there is time for another pass, which takes about `pass`.
    ///
    /// The first pass of a run always has time: otherwise a render that is continued might never end.
    pub(crate) fn has_time(&self, rendered: u64, elapsed: Duration, pass: Duration) -> bool {
        rendered == 0 || self.time.is_none_or(|time| elapsed + pass <= time)
    }

    /// Returns true if noise may end the render and is measured after this number of passes.
    pub(crate) fn looks_at_noise(&self, passes: u64) -> bool {
        self.noise.is_some() && Session::looks_at_noise(passes)
    }

    /// Estimates the remaining time after `elapsed`, at the rate of the passes from `before` to `now`, which
    /// took `rendering`. Training before them does not count. None: the budget limits neither passes nor
    /// time.
    pub(crate) fn left(
        &self,
        [before, now]: [f64; 2],
        elapsed: Duration,
        rendering: Duration,
    ) -> Option<Duration> {
        let of_passes = self.passes.map(|most| {
            let left = (most as f64 - now).max(0.0) / (now - before).max(1e-9);
            let seconds = rendering.as_secs_f64() * left;
            Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
        });
        let of_time = self.time.map(|most| most.saturating_sub(elapsed));
        of_passes.into_iter().chain(of_time).min()
    }

    /// Returns the used fraction of the budget after a number of passes, which may be fractional. Range:
    /// `[0, 1]`.
    pub(crate) fn used(&self, passes: f64, elapsed: Duration) -> f64 {
        let of_passes = self.passes.map_or(0.0, |most| passes / most as f64);
        let of_time = self.time.map_or(0.0, |most| elapsed.div_duration_f64(most));
        of_passes.max(of_time).clamp(0.0, 1.0)
    }
}

/// Returns the passes of a part.
fn passes_of(part: Part, passes: u64) -> Result<Range<u64>, Failure> {
    let range = part.range(passes);
    if !range.is_empty() {
        return Ok(range);
    }
    let Part { index, of } = part;
    let message = format!("part {index} of {of} has no passes: there are {passes} in all");
    Err(Failure::usage(message).with_hint("use fewer parts, or more passes with --spp"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn budget(passes: u64) -> Budget {
        Budget {
            first: 0,
            passes: Some(passes),
            time: Some(SECOND * 10),
            noise: Some(0.01),
        }
    }

    #[test]
    fn noise_is_measured_after_every_eighth_more() {
        let measured: Vec<_> = (0..40)
            .filter(|passes| budget(99).looks_at_noise(*passes))
            .collect();
        assert_eq!(measured, [16, 18, 20, 22, 24, 26, 28, 30, 32, 36]);
    }

    #[test]
    fn a_pass_that_would_exceed_the_time_is_not_started() {
        let budget = budget(9);
        assert!(budget.has_time(5, SECOND * 7, SECOND * 3));
        assert!(!budget.has_time(5, SECOND * 8, SECOND * 3));
        assert!(
            budget.has_time(0, SECOND * 20, SECOND),
            "the first pass always has time"
        );
    }

    #[test]
    fn the_remaining_time_does_not_depend_on_training() {
        let (trained, open) = (SECOND * 300, None);
        let left = |time| {
            let budget = Budget { time, ..budget(10) };
            // Six passes come from the checkpoint, and two took four seconds.
            budget.left([6.0, 8.0], trained + SECOND * 4, SECOND * 4)
        };
        assert_eq!(left(open), Some(SECOND * 4));
        assert_eq!(left(Some(SECOND * 600)), Some(SECOND * 4));
        assert_eq!(left(Some(SECOND * 307)), Some(SECOND * 3));
        assert_eq!(left(Some(SECOND)), Some(Duration::ZERO));
    }

    #[test]
    fn the_remaining_time_of_a_noise_limit_is_unknown() {
        let budget = Budget {
            passes: None,
            time: None,
            ..budget(1)
        };
        assert_eq!(budget.left([0.0, 8.0], SECOND, SECOND), None);
    }

    #[test]
    fn the_nearer_limit_counts() {
        let budget = budget(10);
        assert!((budget.used(5.0, SECOND) - 0.5).abs() < 1e-9);
        assert!((budget.used(1.0, SECOND * 8) - 0.8).abs() < 1e-9);
        assert!((budget.used(1.0, SECOND * 80) - 1.0).abs() < 1e-9);
    }
}
