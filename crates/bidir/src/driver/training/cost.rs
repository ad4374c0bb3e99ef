//! The cost of a plan, from the counts of the survey. Its weights are constants: it is the same on every machine.

use super::Settings;
use super::constants::{
    CANDIDATE, CONNECTED_CAMERA_RAY, CONNECTION_RAY, DIFFUSE_CANDIDATE, LIGHT_IMAGE, LIGHT_POINT,
    LIGHT_RAY,
};
use super::counts::{Counts, dot};
use super::survey::Survey;
use crate::integrator::IntegratorKind;
use crate::path::MisHeuristic;
use crate::select::ShadowRays;

impl Survey {
    /// Returns the mean cost of a sample with `settings`, which take `counts` samples of each kind of strategy. Unit:
    /// rays of path tracing's walks.
    pub(super) fn cost(&self, settings: &Settings, counts: &Counts) -> f64 {
        let work = &self.work;
        let light_points = dot(work.next_events[counts.start], counts.next_events);
        let connections = dot(work.connections, counts.connections);
        let diffuse = match settings.path.mis {
            MisHeuristic::Balance => dot(work.diffuse, counts.connections),
            _ => 0.0,
        };
        // The other rules may trace every candidate.
        let most = match settings.shadow_rays {
            _ if !settings.integrator.has_candidates() => f64::INFINITY,
            ShadowRays::Budget(rays) => f64::from(rays) * work.connected,
            ShadowRays::PerPair => work.connected,
            _ => f64::INFINITY,
        };
        let camera_ray = match settings.integrator {
            IntegratorKind::Lvc => CONNECTED_CAMERA_RAY,
            _ => 1.0,
        };
        let of_light = LIGHT_RAY * self.stats.rays.light as f64
            + LIGHT_IMAGE * self.stats.rays.light_image as f64;
        let all = camera_ray * work.camera_rays[counts.start]
            + counts.light_images * of_light
            + CONNECTION_RAY * (light_points + connections).min(most)
            + LIGHT_POINT * light_points
            + CANDIDATE * (connections - diffuse)
            + DIFFUSE_CANDIDATE * diffuse;
        all / self.samples()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort,
        tests::{WHOLE, grey, input, room_with, survey_of, view},
    };
    use crate::integrator::CandidateCount;
    use crate::material::Material;
    use crate::path::PathRoulette;
    use crate::testing::{check_near, prelude::metal};

    /// Returns the part of first connections with light walks that are diffuse, and the mean price of one of twelve
    /// candidates more, in a room with this ball.
    fn diffuse_part_and_price(ball: Material, mis: MisHeuristic) -> [f64; 2] {
        let (scene, view) = (room_with(ball), view(WHOLE));
        let mut settings = Settings::new(IntegratorKind::Lvc);
        settings.path.mis = mis;
        let survey = survey_of(input(&scene, &view, &settings), Effort::at_most(1024));
        let (roulette, light_vertices) = (settings.path.roulette, survey.light_vertices());
        let mut cost = |count| {
            settings.lvc.candidates = CandidateCount::new(count, 1);
            let counts = Counts::new(&settings, roulette, light_vertices, 256);
            survey.cost(&settings, &counts)
        };
        let [few, many] = [12, 24].map(&mut cost);
        let drawn = 12.0 / survey.light_vertices();
        let work = &survey.work;
        let made = work.connections[0] * drawn / survey.samples();
        [work.diffuse[0] / work.connections[0], (many - few) / made]
    }

    #[test]
    fn candidates_cost_least_between_diffuse_vertices() {
        for (ball, mis, expected) in [
            (grey(0.4), MisHeuristic::Balance, 1.0..=1.0),
            (metal(0.5), MisHeuristic::Balance, 0.5..=0.95),
        ] {
            let [part, price] = diffuse_part_and_price(ball, mis);
            assert!(expected.contains(&part), "{part}");
            let of_all = CANDIDATE + part * (DIFFUSE_CANDIDATE - CANDIDATE);
            check_near(price, of_all, 1e-9, "price");
        }
        // Other heuristics evaluate each connection alone.
        let [_, price] = diffuse_part_and_price(grey(0.4), MisHeuristic::Power);
        check_near(price, CANDIDATE, 1e-9, "price");
    }

    #[test]
    fn rules_bound_the_rays_of_estimators_with_candidates() {
        let (scene, view) = (room_with(grey(0.4)), view(WHOLE));
        let settings = Settings::new(IntegratorKind::Bdpt);
        let survey = survey_of(input(&scene, &view, &settings), Effort::at_most(1024));
        let cost = |integrator, shadow_rays| {
            let mut settings = Settings::new(integrator);
            settings.shadow_rays = shadow_rays;
            let counts = Counts::new(&settings, PathRoulette::Off, 1.0, 256);
            survey.cost(&settings, &counts)
        };
        let rules = [ShadowRays::All, ShadowRays::PerPair, ShadowRays::Budget(1)];
        let [all, pair, one] = rules.map(|rule| cost(IntegratorKind::Bdpt, rule));
        assert!(pair < 0.8 * all, "{pair} {all}");
        check_near(pair, one, 1e-9, "bdpt");
        let [all, pair, one] = rules.map(|rule| cost(IntegratorKind::Path, rule));
        check_near(pair, all, 1e-9, "path");
        check_near(one, all, 1e-9, "path");
    }
}
