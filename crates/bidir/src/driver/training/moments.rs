//! Second moment and cost of a plan, by what the survey found.
//!
//! A term of the survey has the value v = f / D, with D = Σ_j n_j p_j by the balance heuristic. A plan takes
//! D_k of the same path, with its own numbers of samples and roulette, so that
//!
//! M_k = Σ v² D / D_k / (m² + ε) estimates Σ_blocks ∫ f² / D_k / (m² + ε) \[Grittmann22\],
//!
//! with m the mean of a pixel of the block and ε a part of the square of the image's. Covariances within a sample
//! are left out.
//!
//! **Cost** is a sum over what was counted, with constant weights: the same on every machine.

use super::Settings;
use super::blocks::{BLOCKS, Blocks};
use super::constants::{
    CANDIDATE, CONNECTED_CAMERA_RAY, CONNECTION_RAY, DARK, DIFFUSE_CANDIDATE, LEAST_ALBEDO,
    LEAST_SHARE, LIGHT_IMAGE, LIGHT_RAY,
};
use super::survey::Survey;
use crate::contribution::Contribution;
use crate::film::FilmSettings;
use crate::integrator::{Batch, IntegratorKind};
use crate::path::{Job, MisHeuristic, PathContext, PathRoulette, Shares};
use crate::select::ShadowRays;
use crate::strategy::Strategy;
use std::ops::AddAssign;

/// The first surfaces at which the roulette of a plan may differ from that of the survey.
const STARTS: usize = 3;

/// A contribution to the image of the survey.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    /// The number of its pixel in the crop.
    pixel: u32,
    pub(super) strategy: Strategy,
    /// v. Unit: luminance.
    value: f32,
    shares: Shares,
}

impl Term {
    /// Of a contribution that landed on a pixel, of which the filter takes a part.
    pub(super) fn new(
        context: &PathContext<'_>,
        contribution: &Contribution,
        (pixel, part): (usize, f32),
        shares: Shares,
    ) -> Self {
        Self {
            pixel: pixel as u32,
            strategy: contribution.term.strategy,
            value: context.luminance(contribution.value()) * part,
            shares,
        }
    }

    fn is_light_image(&self) -> bool {
        self.strategy.t == 1
    }

    /// Its part of the mean of `film`: there is a sample for each pixel, and a light image for the film.
    pub(super) fn of_mean_pixel(&self, film: &FilmSettings) -> f64 {
        if self.is_light_image() {
            f64::from(self.value) / film.light_paths() as f64
        } else {
            self.value.into()
        }
    }

    /// f / D_k: what it is of the value of a pixel of `film` where the numbers of samples are `counts`.
    pub(super) fn value_by(&self, film: &FilmSettings, counts: &Counts) -> f64 {
        self.of_mean_pixel(film) / counts.share(&self.shares)
    }
}

/// The numbers of samples of each kind of strategy, relative to those of the survey. Pairs are of t = 2 and of
/// t > 2.
pub(super) struct Counts {
    next_events: [f64; 2],
    connections: [f64; 2],
    light_images: f64,
    /// The first surface that may end walks.
    start: usize,
}

impl Counts {
    /// The counts of the estimator of `settings`, if a light subpath has `light_vertices` vertices that can be
    /// connected on average, and walks of the survey had the roulette `surveyed`.
    pub(super) fn new(settings: &Settings, surveyed: PathRoulette, light_vertices: f64) -> Self {
        let lvc = &settings.lvc;
        let each = |candidates: u16| f64::from(candidates) / light_vertices.max(LEAST_SHARE);
        let (next_events, connections, light_images) = match settings.integrator {
            IntegratorKind::Path | IntegratorKind::Light => ([1.0; 2], [0.0; 2], 0.0),
            IntegratorKind::Bdpt => ([1.0; 2], [1.0; 2], 1.0),
            IntegratorKind::Lvc | IntegratorKind::Auto => (
                lvc.next_events.get().map(f64::from),
                lvc.candidates.get().map(each),
                1.0 / f64::from(lvc.samples_per_subpath.get()),
            ),
        };
        let start = match settings.path.roulette {
            PathRoulette::Albedo { start } if settings.path.roulette != surveyed => start as usize,
            _ => 0,
        };
        Self {
            next_events,
            connections,
            light_images,
            start: start.min(STARTS - 1),
        }
    }

    /// The number of samples of a connection with a light walk.
    pub(super) fn of_connection(&self, strategy: Strategy) -> f64 {
        self.connections[usize::from(strategy.t > 2)]
    }

    /// D_k / D of a path.
    fn share(&self, shares: &Shares) -> f64 {
        // Strategy j walks from the camera by surfaces 0 to n - 3 - j.
        let walked = |j: usize| {
            let surfaces = (usize::from(shares.vertices) - j).saturating_sub(2);
            longer(shares.albedos)[self.start.min(surfaces)]
        };
        let pair = |parts: [f32; 2], counts| dot(parts.map(f64::from), counts);
        let share = f64::from(shares.hits) * walked(0)
            + pair(shares.next_events, self.next_events) * walked(1)
            + pair(shares.connections, self.connections)
            + f64::from(shares.light_images) * self.light_images;
        share.max(LEAST_SHARE)
    }
}

/// The factors by which walks go on more often whose roulette begins at surface 0, 1 and 2, where the first two
/// have these albedos.
fn longer(albedos: [f32; 2]) -> [f64; STARTS] {
    let [a, b] = albedos.map(|albedo| f64::from(albedo.clamp(LEAST_ALBEDO, 1.0)));
    [1.0, 1.0 / a, 1.0 / (a * b)]
}

/// Counts of the survey's samples, with walks whose roulette begins at surface 0, 1 and 2.
#[derive(Clone, Copy, Default)]
pub(super) struct Work([WorkOf; STARTS]);

/// Counts of samples; pairs are of t = 2 and of t > 2.
#[derive(Clone, Copy, Default)]
struct WorkOf {
    /// Rays of camera walks.
    camera_rays: f64,
    /// Connections with light points.
    next_events: [f64; 2],
    /// Connections with light walks.
    connections: [f64; 2],
    /// Connections with light walks whose two vertices are diffuse, by the balance heuristic.
    diffuse: [f64; 2],
    /// Samples that have any connection.
    connected: f64,
}

impl Work {
    /// Adds the one sample of `batch`.
    pub(super) fn add(&mut self, job: &Job<'_>, batch: &Batch) {
        let walk = batch.camera.get(0);
        let rays = walk.vertices.len() - 1 + usize::from(walk.escape.is_some());
        let albedo = |i: usize| walk.vertices.get(i).map_or(1.0, |vertex| vertex.albedo_fwd);
        let longer = longer([albedo(1), albedo(2)]);
        for (start, work) in self.0.iter_mut().enumerate() {
            let rays = (0..rays).map(|before| longer[before.min(start)]);
            work.camera_rays += rays.sum::<f64>();
            for candidate in &batch.candidates {
                let Strategy { s, t } = candidate.term.strategy;
                let (s, t) = (usize::from(s), usize::from(t));
                let deeper = usize::from(t > 2);
                if s < job.settings.light_point.first_walked() {
                    work.next_events[deeper] += longer[(t - 2).min(start)];
                } else {
                    work.connections[deeper] += 1.0;
                    work.diffuse[deeper] += f64::from(batch.is_diffuse(candidate));
                }
            }
            work.connected += f64::from(!batch.candidates.is_empty());
        }
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, more: Self) {
        for (work, more) in self.0.iter_mut().zip(&more.0) {
            work.camera_rays += more.camera_rays;
            work.connected += more.connected;
            for deeper in 0..2 {
                work.next_events[deeper] += more.next_events[deeper];
                work.connections[deeper] += more.connections[deeper];
                work.diffuse[deeper] += more.diffuse[deeper];
            }
        }
    }
}

/// a_0 b_0 + a_1 b_1.
fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Survey {
    /// The cost of a sample by `settings`, with `counts` of these. Unit: rays of path tracing's walks.
    pub(super) fn cost(&self, settings: &Settings, counts: &Counts) -> f64 {
        let work = &self.work.0[counts.start];
        let candidates =
            dot(work.next_events, counts.next_events) + dot(work.connections, counts.connections);
        let diffuse = match settings.path.mis {
            MisHeuristic::Balance => dot(work.diffuse, counts.connections),
            _ => 0.0,
        };
        let traced = match settings.shadow_rays {
            ShadowRays::Budget(most) => candidates.min(f64::from(most) * work.connected),
            _ => candidates,
        };
        let camera_ray = match settings.integrator {
            IntegratorKind::Lvc => CONNECTED_CAMERA_RAY,
            _ => 1.0,
        };
        let of_light = LIGHT_RAY * self.stats.rays.light as f64
            + LIGHT_IMAGE * self.stats.rays.light_image as f64;
        let all = camera_ray * work.camera_rays
            + counts.light_images * of_light
            + CONNECTION_RAY * traced
            + CANDIDATE * (candidates - diffuse)
            + DIFFUSE_CANDIDATE * diffuse;
        all / self.samples()
    }

    /// v² / (m² + ε) of each term, as it counts in the mean of a pixel of its block. None: nothing was found.
    pub(super) fn relative_squares(&self, film: &FilmSettings) -> Option<Vec<f64>> {
        let blocks = Blocks::new(film.crop);
        let samples = blocks.samples(self.stats.samples);
        // The block of a term, and s of (4).
        let place = |term: &Term| {
            let block = blocks.of(term.pixel as usize);
            let count = if term.is_light_image() {
                self.samples() * blocks.size(block)
            } else {
                samples[block]
            };
            (block, 1.0 / count)
        };
        let mut means = [0.0; BLOCKS];
        for term in &self.terms {
            let (block, scale) = place(term);
            means[block] += f64::from(term.value) * scale;
        }
        let mean = means.iter().sum::<f64>() / BLOCKS as f64;
        let square = |term: &Term| {
            let (block, scale) = place(term);
            let value = f64::from(term.value);
            let in_pass = if term.is_light_image() {
                blocks.pixels()
            } else {
                1.0
            };
            let relative = value * value / (means[block] * means[block] + DARK * mean * mean);
            relative * scale / in_pass
        };
        (mean > 0.0).then(|| self.terms.iter().map(square).collect())
    }

    /// M_k, by [`relative_squares`](Self::relative_squares).
    pub(super) fn moment(&self, squares: &[f64], counts: &Counts) -> f64 {
        let terms = self.terms.iter().zip(squares);
        terms
            .map(|(term, square)| square / counts.share(&term.shares))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort, Task,
        tests::{WHOLE, grey, room, room_with, view},
    };
    use crate::integrator::CandidateCount;
    use crate::material::{ConductorIndex, Material, Roughness};
    use crate::texture::{ColorTexture, FloatTexture};

    impl Term {
        /// True where connections with light walks can make the path.
        pub(in crate::driver::training) fn has_share_of_connections(&self) -> bool {
            self.shares.connections.iter().sum::<f32>() > 0.0
        }
    }

    /// Second moment and cost of path tracing whose roulette begins at a surface, by a survey of these strategies.
    fn of_path(strategies: &str, surveyed: u32, start: u32) -> [f64; 2] {
        let (scene, view) = (room(), view(WHOLE));
        let mut settings = Settings::new(IntegratorKind::Bdpt);
        settings.path.strategies = strategies.parse().expect("a list of strategies");
        let [surveyed, roulette] = [surveyed, start].map(|start| PathRoulette::Albedo { start });
        settings.path.roulette = surveyed;
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &settings,
        };
        let survey = Survey::run(task, Effort::WHOLE);
        let mut path = Settings::new(IntegratorKind::Path);
        path.path.roulette = roulette;
        let counts = Counts::new(&path, surveyed, survey.light_vertices());
        let squares = survey.relative_squares(view.film());
        let moment = survey.moment(&squares.expect("a lamp"), &counts);
        [moment, survey.cost(&path, &counts)]
    }

    /// Its own strategies give the same without other numbers of samples, and with the roulette that it has.
    #[test]
    fn all_strategies_tell_second_moment_and_cost_of_path_tracing() {
        for start in 0..3 {
            let [moment, cost] = of_path("all", 0, start);
            let [own_moment, own_cost] = of_path("s0,s1", start, start);
            let difference = (moment / own_moment - 1.0).abs();
            assert!(difference < 0.04, "{start}: {moment} for {own_moment}");
            let difference = (cost / own_cost - 1.0).abs();
            assert!(difference < 0.02, "{start}: {cost} for {own_cost}");
        }
    }

    /// The part of first connections with light walks that are diffuse, and the mean price of twelve candidates more,
    /// in a room with this ball.
    fn diffuse_part_and_price(ball: Material, mis: MisHeuristic) -> [f64; 2] {
        let (scene, view) = (room_with(ball), view(WHOLE));
        let mut settings = Settings::new(IntegratorKind::Lvc);
        settings.path.mis = mis;
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &settings.clone(),
        };
        let survey = Survey::run(task, Effort::at_most(1024));
        let mut cost = |count| {
            settings.lvc.candidates = CandidateCount::new(count, 1);
            let counts = Counts::new(&settings, settings.path.roulette, survey.light_vertices());
            survey.cost(&settings, &counts)
        };
        let [few, many] = [12, 24].map(&mut cost);
        let drawn = 12.0 / survey.light_vertices();
        let work = &survey.work.0[0];
        let made = work.connections[0] * drawn / survey.samples();
        [work.diffuse[0] / work.connections[0], (many - few) / made]
    }

    #[test]
    fn candidates_cost_least_between_diffuse_vertices() {
        let metal = || Material::Conductor {
            index: ConductorIndex::Reflectance(ColorTexture::Constant([0.9; 3])),
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

    const SHARES: Shares = Shares {
        hits: 0.05,
        next_events: [0.0, 0.25],
        connections: [0.1, 0.2],
        light_images: 0.4,
        albedos: [0.5, 0.25],
        vertices: 5,
    };

    #[test]
    fn a_plan_takes_of_a_path_what_its_numbers_of_samples_are() {
        let share = |integrator| {
            let settings = Settings::new(integrator);
            let roulette = PathRoulette::Albedo { start: 0 };
            Counts::new(&settings, roulette, 4.0).share(&SHARES)
        };
        let (path, bdpt) = (0.05 / 0.5 + 0.25 / 0.5, 1.0);
        let lvc = 0.05 + 0.25 + 0.1 * 12.0 / 4.0 + 0.2 / 4.0 + 0.4 / 2.0;
        for (integrator, expected) in [
            (IntegratorKind::Path, path),
            (IntegratorKind::Bdpt, bdpt),
            (IntegratorKind::Lvc, lvc),
        ] {
            let found = share(integrator);
            assert!((found - expected).abs() < 1e-6, "{integrator:?}: {found}");
        }
    }

    #[test]
    fn walks_go_on_at_the_first_surfaces_of_a_path_that_has_them() {
        let settings = |start| {
            let mut settings = Settings::new(IntegratorKind::Path);
            settings.path.roulette = PathRoulette::Albedo { start };
            Counts::new(&settings, PathRoulette::Albedo { start: 0 }, 4.0)
        };
        // The surfaces that the walk of a hit scatters at, and that of next-event estimation: n - 2 and n - 3.
        for (start, vertices, expected) in [
            (2, 2, 0.05 + 0.25),
            (2, 3, 0.05 / 0.5 + 0.25),
            (2, 4, 0.05 / 0.125 + 0.25 / 0.5),
            (2, 5, 0.3 / 0.125),
            (9, 5, 0.3 / 0.125),
            (1, 5, 0.3 / 0.5),
            (0, 5, 0.3),
        ] {
            let found = settings(start).share(&Shares { vertices, ..SHARES });
            assert!(
                (found - expected).abs() < 1e-6,
                "{start}, {vertices}: {found}"
            );
        }
    }
}
