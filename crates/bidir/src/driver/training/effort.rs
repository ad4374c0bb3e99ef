//! How long training may take.

use super::survey::Survey;
use super::{Settings, Training, plan};
use crate::integrator::IntegratorKind;
use crate::scene::Scene;
use crate::view::View;

/// How long training may take. A host that has no time for it renders with the results of a few samples: with more
/// noise, but of the same image.
#[derive(Clone, Copy)]
pub enum Effort<'a> {
    /// As long as it takes.
    Whole,
    /// As long as it takes, unless this becomes true before: then what it found is forgotten, as if it had been
    /// [`Effort::Short`]. Asked by all threads.
    Until(IsLate<'a>),
    /// 16 samples, which is no time at all. Nothing is learnt from them, and `auto` takes `bdpt`.
    Short,
}

/// Whether training is to be given up.
pub(super) type IsLate<'a> = &'a (dyn Fn() -> bool + Sync);

/// Training was given up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Late;

/// The settings with everything decided that they leave open, and what a few samples found.
pub(super) fn short(
    scene: &Scene,
    view: &View,
    settings: Settings,
) -> (Settings, Option<Training>) {
    let mut settings = settings;
    let is_open = settings.integrator == IntegratorKind::Auto;
    let plan = is_open.then(|| plan::BDPT.keeping(&settings));
    if let Some(plan) = plan {
        settings = plan.apply(&settings);
    }
    if plan.is_none() && !settings.needs_training() {
        return (settings, None);
    }
    let training = Training {
        plan,
        is_short: true,
        ..Training::of(&Survey::short(scene, view, &settings))
    };
    training.bound_cache(view, &mut settings);
    (settings, Some(training))
}
