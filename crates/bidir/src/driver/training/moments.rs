//! The variance of a plan, by what the survey found.
//!
//! A term of the survey has the value v = f / D, with D = Σ_j n_j p_j by the balance heuristic. A plan takes
//! D_k of the same path, with its own numbers of samples and roulette, so that
//!
//! M_k = Σ v² D / D_k / (m² + ε) estimates Σ_blocks ∫ f² / D_k / (m² + ε) \[Grittmann22\],
//!
//! with m the mean of a pixel of the block and ε a part of the square of the image's. Covariances within a sample
//! are left out.
//!
//! The variance of a strategy with N samples is its second moment less the square of its mean over N. Only the means of
//! s = 0 and s = 1 are estimated, for each length of paths and each block: even light that the camera sees directly
//! then has little variance.

use super::Settings;
use super::blocks::{BLOCKS, Blocks};
use super::constants::{DARK, LEAST_ALBEDO, LEAST_SHARE, LEAST_VARIANCE};
use super::survey::Survey;
use crate::contribution::Contribution;
use crate::film::FilmSettings;
use crate::integrator::{CandidateCount, IntegratorKind};
use crate::path::{PathContext, PathRoulette, Shares};
use crate::strategy::Strategy;

/// The first surfaces at which the roulette of a plan may differ from that of the survey.
pub(super) const STARTS: usize = 3;

/// Paths of fewer vertices have means of their strategies; those of longer ones are small. Unit: vertices.
const LENGTHS: usize = 16;

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
        self.of_mean_pixel(film) / counts.share(&self.shares).all
    }
}

/// A term of the survey, in units of the root of m² + ε of its block.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeTerm {
    block: usize,
    /// Its part of the mean of its block.
    part: f64,
    /// Its part of the second moment of the survey.
    square: f64,
}

/// The numbers of samples of each kind of strategy, relative to those of the survey. Pairs are of t = 2 and of
/// t > 2.
pub(super) struct Counts {
    pub(super) next_events: [f64; 2],
    pub(super) connections: [f64; 2],
    pub(super) light_images: f64,
    /// The first surface that may end walks.
    pub(super) start: usize,
}

impl Counts {
    /// The counts of the estimator of `settings`, if a light subpath has `light_vertices` vertices that can be
    /// connected on average, and walks of the survey had the roulette `surveyed`.
    pub(super) fn new(settings: &Settings, surveyed: PathRoulette, light_vertices: f64) -> Self {
        let lvc = &settings.lvc;
        let (next_events, connections, light_images) = match settings.integrator {
            IntegratorKind::Path => ([1.0; 2], [0.0; 2], 0.0),
            IntegratorKind::Light => ([0.0; 2], [0.0; 2], 1.0),
            IntegratorKind::Bdpt => ([1.0; 2], [1.0; 2], 1.0),
            IntegratorKind::Lvc | IntegratorKind::Auto => (
                lvc.next_events.get().map(f64::from),
                of_connections(lvc.candidates, light_vertices),
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
    fn share(&self, shares: &Shares) -> Share {
        // Strategy j walks from the camera by surfaces 0 to n - 3 - j.
        let walked = |j: usize| {
            let surfaces = (usize::from(shares.vertices) - j).saturating_sub(2);
            longer(shares.albedos)[self.start.min(surfaces)]
        };
        let pair = |parts: [f32; 2], counts| dot(parts.map(f64::from), counts);
        let hits = f64::from(shares.hits) * walked(0);
        let next_events = pair(shares.next_events, self.next_events) * walked(1);
        let others = pair(shares.connections, self.connections)
            + f64::from(shares.light_images) * self.light_images;
        Share {
            all: (hits + next_events + others).max(LEAST_SHARE),
            hits,
            next_events,
        }
    }
}

/// D_k / D of a path.
struct Share {
    all: f64,
    /// The part of s = 0.
    hits: f64,
    /// The part of s = 1.
    next_events: f64,
}

/// The mean of a block, which terms add to.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    /// The sum of the squares of the terms.
    squares: f64,
}

impl Mean {
    fn add(&mut self, part: f64) {
        self.sum += part;
        self.squares += part * part;
    }

    /// The square of its expectation, by the products of different terms: the square of the sum counts the noise of few
    /// terms as mean. With n samples of the block the expectation of this is about 1 - 1/n of the square.
    fn square(&self) -> f64 {
        self.sum * self.sum - self.squares
    }
}

/// The numbers of samples of a connection with a light walk, M / κ, for t = 2 and t > 2. Where no light vertex can be
/// connected they do not matter.
pub(super) fn of_connections(candidates: CandidateCount, light_vertices: f64) -> [f64; 2] {
    candidates.get().map(|count| match light_vertices {
        0.0 => 1.0,
        vertices => f64::from(count) / vertices,
    })
}

/// The factors by which walks go on more often whose roulette begins at surface 0, 1 and 2, where the first two
/// have these albedos.
pub(super) fn longer(albedos: [f32; 2]) -> [f64; STARTS] {
    let [a, b] = albedos.map(|albedo| f64::from(albedo.clamp(LEAST_ALBEDO, 1.0)));
    [1.0, 1.0 / a, 1.0 / (a * b)]
}

/// a_0 b_0 + a_1 b_1.
pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Survey {
    /// The terms relative to the means of their blocks. None: nothing was found.
    pub(super) fn relative_terms(&self, film: &FilmSettings) -> Option<Vec<RelativeTerm>> {
        let places = self.places(film);
        let mut means = [0.0; BLOCKS];
        for (term, &(block, scale)) in self.terms.iter().zip(&places) {
            means[block] += f64::from(term.value) * scale;
        }
        let mean = self.luminance / self.samples();
        let relative = |(term, (block, scale)): (&Term, (usize, f64))| {
            let norm = (means[block] * means[block] + DARK * mean * mean).sqrt();
            let value = f64::from(term.value) / norm;
            let in_pass = if term.is_light_image() {
                film.light_paths() as f64
            } else {
                1.0
            };
            RelativeTerm {
                block,
                part: value * scale,
                square: value * value * scale / in_pass,
            }
        };
        (mean > 0.0).then(|| self.terms.iter().zip(places).map(relative).collect())
    }

    /// The block of each term, and the factor of its value in the mean of the block.
    fn places(&self, film: &FilmSettings) -> Vec<(usize, f64)> {
        let blocks = Blocks::new(film.crop);
        let samples = blocks.samples(self.stats.samples);
        let place = |term: &Term| {
            let block = blocks.of(term.pixel as usize);
            let count = if term.is_light_image() {
                self.samples() * blocks.size(block)
            } else {
                samples[block]
            };
            (block, 1.0 / count)
        };
        self.terms.iter().map(place).collect()
    }

    /// M_k less the squares of means of strategies s = 0 and s = 1, by [`relative_terms`](Self::relative_terms).
    pub(super) fn variance(&self, relative: &[RelativeTerm], counts: &Counts) -> f64 {
        let (mut moment, mut means) = (0.0, vec![[[Mean::default(); 2]; BLOCKS]; LENGTHS]);
        for (term, relative) in self.terms.iter().zip(relative) {
            let share = counts.share(&term.shares);
            moment += relative.square / share.all;
            if let Some(means) = means.get_mut(usize::from(term.shares.vertices)) {
                let [hits, next_events] = &mut means[relative.block];
                hits.add(relative.part * share.hits / share.all);
                next_events.add(relative.part * share.next_events / share.all);
            }
        }
        let squares = means.iter().enumerate().map(|(vertices, means)| {
            let light_points = counts.next_events[usize::from(vertices > 3)];
            let square = |[hits, next_events]: &[Mean; 2]| {
                hits.square() + next_events.square() / light_points
            };
            means.iter().map(square).sum::<f64>()
        });
        (moment - squares.sum::<f64>()).max(LEAST_VARIANCE * moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort, Task,
        tests::{WHOLE, lamp, room, survey_of, view},
    };
    use crate::film::PixelRect;

    impl Term {
        /// True where connections with light walks can make the path.
        pub(in crate::driver::training) fn has_share_of_connections(&self) -> bool {
            self.shares.connections.iter().sum::<f32>() > 0.0
        }
    }

    /// Variance and cost of path tracing whose roulette begins at a surface, by a survey of these strategies.
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
        let survey = survey_of(task, Effort::WHOLE);
        let mut path = Settings::new(IntegratorKind::Path);
        path.path.roulette = roulette;
        let counts = Counts::new(&path, surveyed, survey.light_vertices());
        let terms = survey.relative_terms(view.film()).expect("a lamp");
        let variance = survey.variance(&terms, &counts);
        [variance, survey.cost(&path, &counts)]
    }

    /// Its own strategies give the same without other numbers of samples, and with the roulette that it has.
    #[test]
    fn all_strategies_tell_variance_and_cost_of_path_tracing() {
        for start in 0..3 {
            let [variance, cost] = of_path("all", 0, start);
            let [own_variance, own_cost] = of_path("s0,s1", start, start);
            let difference = (variance / own_variance - 1.0).abs();
            assert!(difference < 0.04, "{start}: {variance} for {own_variance}");
            let difference = (cost / own_cost - 1.0).abs();
            assert!(difference < 0.02, "{start}: {cost} for {own_cost}");
        }
    }

    #[test]
    fn light_points_divide_the_variance_of_direct_light() {
        for (max_depth, light_points) in
            [(1, CandidateCount::new(8, 1)), (5, CandidateCount::of(8))]
        {
            let (scene, view) = (room(), view(WHOLE));
            let mut settings = Settings::new(IntegratorKind::Lvc);
            settings.path.strategies = "s1".parse().expect("a strategy");
            settings.path.max_depth = Some(max_depth);
            let task = Task {
                scene: &scene,
                view: &view,
                settings: &settings.clone(),
            };
            let survey = survey_of(task, Effort::WHOLE);
            let terms = survey.relative_terms(view.film()).expect("a lamp");
            let [one, many] = [CandidateCount::of(1), light_points].map(|count| {
                settings.lvc.next_events = count;
                survey.variance(&terms, &Counts::new(&settings, settings.path.roulette, 1.0))
            });
            assert!(
                (one / many - 8.0).abs() < 1e-3,
                "{max_depth}: {one}, {many}"
            );
        }
    }

    #[test]
    fn even_light_that_is_seen_directly_is_no_noise() {
        let of_lamp = PixelRect {
            min: [6; 2],
            max: [10; 2],
        };
        let (scene, view) = (lamp(), view(of_lamp));
        let settings = Settings::new(IntegratorKind::Bdpt);
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &settings,
        };
        let survey = survey_of(task, Effort::WHOLE);
        let terms = survey.relative_terms(view.film()).expect("a lamp");
        let counts = Counts::new(&settings, settings.path.roulette, 1.0);
        let moment: f64 = terms.iter().map(|term| term.square).sum();
        let part = survey.variance(&terms, &counts) / moment;
        assert!(part < 0.05, "{part}");
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
            Counts::new(&settings, roulette, 4.0).share(&SHARES).all
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
            let found = settings(start).share(&Shares { vertices, ..SHARES }).all;
            assert!(
                (found - expected).abs() < 1e-6,
                "{start}, {vertices}: {found}"
            );
        }
    }
}
