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
    use crate::bsdf::FacetScattering;
    use crate::driver::training::{
        Effort, TrainingInput,
        tests::{WHOLE, grey, room_with, survey_of, view},
    };
    use crate::integrator::CandidateCount;
    use crate::material::{ConductorIndex, Material, Roughness};
    use crate::path::PathRoulette;
    use crate::texture::{ColorTexture, FloatTexture};

    /// Returns the part of first connections with light walks that are diffuse, and the mean price of one of twelve
    /// candidates more, in a room with this ball.
    fn diffuse_part_and_price(ball: Material, mis: MisHeuristic) -> [f64; 2] {
        let (scene, view) = (room_with(ball), view(WHOLE));
        let mut settings = Settings::new(IntegratorKind::Lvc);
        settings.path.mis = mis;
        let input = TrainingInput {
            scene: &scene,
            view: &view,
            settings: &settings.clone(),
        };
        let survey = survey_of(input, Effort::at_most(1024));
        let mut cost = |count| {
            settings.lvc.candidates = CandidateCount::new(count, 1);
            let counts = Counts::new(
                &settings,
                settings.path.roulette,
                survey.light_vertices(),
                256,
            );
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
        let metal = || Material::Conductor {
            index: ConductorIndex::Reflectance(ColorTexture::Constant([0.9; 3])),
            scattering: FacetScattering::Single,
            roughness: Roughness {
                u: FloatTexture::Constant(0.5),
                v: FloatTexture::Constant(0.5),
                ..Roughness::SMOOTH
            },
        };
        for (ball, mis, expected) in [
            (grey(0.4), MisHeuristic::Balance, 1.0..=1.0),
            (metal(), MisHeuristic::Balance, 0.5..=0.95),
        ] {
            let [part, price] = diffuse_part_and_price(ball, mis);
            assert!(expected.contains(&part), "{part}");
            let of_all = CANDIDATE + part * (DIFFUSE_CANDIDATE - CANDIDATE);
            assert!((price - of_all).abs() < 1e-9, "{price} for {of_all}");
        }
        // Other heuristics evaluate each connection alone.
        let [_, price] = diffuse_part_and_price(grey(0.4), MisHeuristic::Power);
        assert!((price - CANDIDATE).abs() < 1e-9, "{price}");
    }

    #[test]
    fn rules_bound_the_rays_of_estimators_with_candidates() {
        let (scene, view) = (room_with(grey(0.4)), view(WHOLE));
        let settings = Settings::new(IntegratorKind::Bdpt);
        let input = TrainingInput {
            scene: &scene,
            view: &view,
            settings: &settings,
        };
        let survey = survey_of(input, Effort::at_most(1024));
        let cost = |integrator, shadow_rays| {
            let mut settings = Settings::new(integrator);
            settings.shadow_rays = shadow_rays;
            survey.cost(
                &settings,
                &Counts::new(&settings, PathRoulette::Off, 1.0, 256),
            )
        };
        let rules = [ShadowRays::All, ShadowRays::PerPair, ShadowRays::Budget(1)];
        let [all, pair, one] = rules.map(|rule| cost(IntegratorKind::Bdpt, rule));
        assert!(
            pair < 0.8 * all && (pair - one).abs() < 1e-9,
            "{pair} {one} {all}"
        );
        let [all, pair, one] = rules.map(|rule| cost(IntegratorKind::Path, rule));
        assert!(
            (pair - all).abs() + (one - all).abs() < 1e-9,
            "{pair} {one} {all}"
        );
    }
}
