//! The render of a lane.

use crate::shared::{Interrupts, Query, SharedState, Subject};
use crate::view::RenderView;
use bidir::driver::{Progress, Settings, Stop};
use bidir::integrator::IntegratorKind;
use bidir::path::PathRoulette;
use bidir::settings::{Choice, Request};
use formats::film::{FilmHeader, Render, Stopping};
use std::time::{Duration, Instant};

/// The render of a lane with its view.
pub(super) struct RenderSlot {
    pub(super) render: Render<'static>,
    pub(super) view: RenderView,
    /// A warning that the image has no content.
    pub(super) blank: Option<String>,
}

/// Gives a pass up where a command ends it.
struct Watch<'a> {
    interrupts: &'a Interrupts,
    /// True for the first pass of a moving camera, which ends: clients see a move that goes on.
    is_patient: bool,
    start: Instant,
}

impl Progress for Watch<'_> {
    fn advance(&self, _samples: u64) {}

    fn stop(&self) -> Stop<'_> {
        if self.is_patient {
            self.interrupts.stop_unless_moved()
        } else {
            self.interrupts.stop()
        }
    }

    fn nanoseconds(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

impl RenderSlot {
    /// Renders the next pass, and shares a frame where it is due. Returns its time; None: it was given
    /// up.
    pub(super) fn step(
        &mut self,
        interrupts: &Interrupts,
        state: &SharedState,
        is_preview: bool,
    ) -> Option<Duration> {
        let watch = Watch {
            interrupts,
            is_patient: is_preview && self.render.session.film().passes().is_empty(),
            start: Instant::now(),
        };
        let is_done = self.render.session.step(&watch);
        let time = watch.start.elapsed();
        if !is_done {
            return None;
        }
        self.view.add_pass(&self.render.session, time, state);
        // Now and then, as it develops the film.
        if self.render.session.film().passes().len().is_power_of_two() {
            self.blank = self.render.session.blank_warning();
        }
        Some(time)
    }

    pub(super) fn is_complete(&self) -> bool {
        self.view.is_complete(&self.render.session)
    }

    /// Shares the newest frame.
    pub(super) fn show(&mut self, state: &SharedState) {
        self.view.show(&self.render.session, state);
    }

    /// Returns the header of files of the passes so far.
    pub(super) fn header(&self) -> FilmHeader {
        let stopping = if self.is_complete() {
            Stopping::Fixed
        } else {
            Stopping::Time
        };
        self.render.header(self.view.rendered(), stopping)
    }

    pub(super) fn answer(&self, query: Query) {
        let header = || self.header();
        query(Some(&Subject {
            session: &self.render.session,
            generation: self.view.generation(),
            header: &header,
        }));
    }
}

/// Returns the settings of a preview, which needs no training: no camera would stand still for as long as
/// `auto` tries estimators. Bidirectional path tracing samples all light paths of the others.
/// `roulette` is the requested one.
pub(super) fn without_training(
    wanted: &Settings,
    roulette: Option<Choice<PathRoulette>>,
) -> Settings {
    let mut settings = wanted.clone();
    if matches!(
        settings.integrator,
        IntegratorKind::Auto | IntegratorKind::Lvc
    ) {
        let request = Request {
            integrator: Some(IntegratorKind::Bdpt),
            path_roulette: roulette,
            ..Request::default()
        };
        settings = request.apply(&settings);
    }
    if settings.shadow_rays.needs_mean() {
        settings.shadow_rays = settings.integrator.shadow_rays();
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;
    use IntegratorKind::{Auto, Bdpt, Light, Lvc, Path};

    #[test]
    fn previews_train_for_nothing() {
        let rules = ["auto", "per-pair", "ray-roulette"];
        let expected = [
            (Path, Path),
            (Light, Light),
            (Bdpt, Bdpt),
            (Auto, Bdpt),
            (Lvc, Bdpt),
        ];
        for (rule, (integrator, expected)) in rules
            .iter()
            .flat_map(|rule| expected.map(|pair| (rule, pair)))
        {
            let mut wanted = Settings::default();
            wanted.set_integrator(integrator);
            let rule: Choice<_> = rule.parse().expect("a rule");
            let request = Request {
                shadow_rays: Some(rule),
                ..Request::default()
            };
            let wanted = request.apply(&wanted);
            let preview = without_training(&wanted, Some(Choice::Fixed(PathRoulette::Off)));
            assert_eq!(preview.integrator, expected);
            assert!(!preview.shadow_rays.needs_mean());
            let is_other = preview.integrator != wanted.integrator;
            assert_eq!(preview.path.roulette == PathRoulette::Off, is_other);
        }
    }
}
