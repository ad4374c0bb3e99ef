//! The render of a lane.

use crate::shared::{Interrupts, Lane, Query, SharedState};
use crate::view::RenderView;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::PathRoulette;
use bidir::settings::{Choice, Request};
use formats::film::{Render, Stopping, Watch};
use std::time::{Duration, Instant};

/// The render of a lane with its view.
pub(super) struct RenderSlot {
    pub(super) render: Render,
    pub(super) view: RenderView,
    /// A warning that the image has no content.
    pub(super) blank: Option<String>,
}

impl RenderSlot {
    /// Renders the next pass, and shares a frame if one is due. Returns the time of the pass. None: a command
    /// interrupted it.
    pub(super) fn step(
        &mut self,
        interrupts: &Interrupts,
        state: &SharedState,
        is_preview: bool,
    ) -> Option<Duration> {
        let render = &mut self.render;
        // The first pass of a moving camera ends: clients see a move that goes on.
        let is_patient = is_preview && render.session.film().passes().is_empty();
        let stop = if is_patient {
            interrupts.stop_unless_moved()
        } else {
            interrupts.stop()
        };
        let start = Instant::now();
        if !render.step(&Watch { stop, start }) {
            return None;
        }
        let time = start.elapsed();
        render.stopping = if self.view.is_complete(render) {
            Stopping::Fixed
        } else {
            Stopping::Time
        };
        self.view.add_pass(render, state);
        // Now and then, as it develops the film.
        if render.session.film().passes().len().is_power_of_two() {
            self.blank = render.session.blank_warning();
        }
        Some(time)
    }

    pub(super) fn is_complete(&self) -> bool {
        self.view.is_complete(&self.render)
    }

    /// Shares the newest frame.
    pub(super) fn show(&mut self, state: &SharedState) {
        self.view.show(&self.render, state);
    }

    pub(super) fn answer(&self, query: Query) {
        query(Some(&Lane {
            render: &self.render,
            generation: self.view.generation(),
        }));
    }
}

/// Returns the settings of a preview, without training: `auto` would try estimators for longer than a camera
/// stands still. Bidirectional path tracing replaces `auto` and `lvc`, as it samples all of their paths.
/// `roulette` is the requested Russian roulette.
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
