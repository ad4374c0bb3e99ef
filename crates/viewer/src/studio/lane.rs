//! A render among those that are shown side by side.

use crate::board::{Board, Interrupts, Look, Subject};
use crate::exhibit::Exhibit;
use bidir::driver::{Progress, Session, Settings};
use bidir::integrator::IntegratorKind;
use bidir::path::PathRoulette;
use bidir::settings::{Choice, Request};
use formats::film::{FilmHeader, Stopping, of_run};
use std::time::{Duration, Instant};

/// A render with what is shown of it.
pub(super) struct Lane {
    pub(super) session: Session<'static>,
    pub(super) exhibit: Exhibit,
    /// That of its empty film.
    pub(super) header: FilmHeader,
}

/// Gives a pass up where a request ends it.
struct Watch<'a> {
    interrupts: &'a Interrupts,
    /// True where a moving camera is let finish its first pass, so that something is seen of a move
    /// that goes on.
    is_patient: bool,
    start: Instant,
}

impl Progress for Watch<'_> {
    fn advance(&self, _samples: u64) {}

    fn should_stop(&self) -> bool {
        self.interrupts.is_changed() || (self.interrupts.is_moved() && !self.is_patient)
    }

    fn nanoseconds(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

impl Lane {
    /// Renders the next pass, and shows it where it is time. The time that it took; None: it was
    /// given up.
    pub(super) fn step(
        &mut self,
        interrupts: &Interrupts,
        board: &Board,
        is_preview: bool,
    ) -> Option<Duration> {
        let watch = Watch {
            interrupts,
            is_patient: is_preview && self.session.film().passes().is_empty(),
            start: Instant::now(),
        };
        let is_done = self.session.step(&watch);
        let time = watch.start.elapsed();
        if !is_done {
            return None;
        }
        self.exhibit.add_pass(&self.session, time, board);
        Some(time)
    }

    pub(super) fn is_complete(&self) -> bool {
        self.exhibit.is_complete(&self.session)
    }

    /// Shows what there is.
    pub(super) fn show(&mut self, board: &Board) {
        self.exhibit.show(&self.session, board);
    }

    /// What files say of what was rendered so far.
    pub(super) fn header(&self) -> FilmHeader {
        let stopping = if self.is_complete() {
            Stopping::Fixed
        } else {
            Stopping::Time
        };
        let header = of_run(&self.header, &self.session, self.exhibit.rendered());
        FilmHeader { stopping, ..header }.of(self.session.film())
    }

    /// Lets somebody look.
    pub(super) fn let_look(&self, look: Look) {
        let header = || self.header();
        look(Some(&Subject {
            session: &self.session,
            generation: self.exhibit.generation(),
            header: &header,
        }));
    }
}

/// What a preview is rendered with: no camera would stand still for as long as `auto` tries estimators.
/// Bidirectional path tracing finds whatever the others do. `roulette` is the one that was asked for.
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
