//! The variance of a plan, from the terms of the survey.
//!
//! A term of the survey has the value v = f / D, with D = Σ_j n_j p_j by the balance heuristic. A plan has the
//! density D_k for the same path, by its own numbers of samples and roulette, so that
//!
//! M_k = Σ v² D / D_k / (m² + ε) estimates Σ_blocks ∫ f² / D_k / (m² + ε) \[Grittmann22\],
//!
//! with m the mean of a pixel of the block, and ε a constant times the square of the image's mean. This is the
//! variance of independent terms; [`quads`](super::quads) adds the covariance of terms of one sample.

use super::blocks::{BLOCKS, Blocks};
use super::constants::{DARK, LEAST_VARIANCE};
use super::counts::{Counts, dot};
use super::quads::{Part, Quad, QuadVariance, Reach};
use super::selection::{self, Expected};
use super::survey::{QUAD, Survey};
use super::terms::{Known, SurveyTerm};
use crate::film::FilmSettings;
use crate::select::ShadowRays;

impl SurveyTerm {
    /// Returns its kind, and the number of terms of a plan that it stands for if the walk reaches its vertex.
    fn rate(&self, known: &Known, counts: &Counts) -> (Part, f64) {
        let deeper = usize::from(self.strategy.t > 2);
        match self.strategy.s {
            0 => {
                let is_seen = known.shares.vertices == 2;
                (Part::Hit { is_seen }, 1.0)
            }
            _ if self.is_next_event => (Part::LightPoint, counts.next_events[deeper]),
            _ => (Part::Connection, counts.connections[deeper] * known.rate),
        }
    }

    /// Returns the reach of its walk.
    fn reach(&self, known: &Known, counts: &Counts) -> Reach {
        let (s, t) = (usize::from(self.strategy.s), usize::from(self.strategy.t));
        Reach {
            t,
            surfaces: counts.surfaces(&known.shares, s),
            longer: counts.longer(&known.shares, s),
        }
    }
}

/// A term of the survey. Unit: the root of m² + ε of its block.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeTerm {
    block: usize,
    value: f64,
    score: f64,
    /// The weight of its square in the sum over blocks.
    scale: f64,
    /// Its part of the second moment of the survey.
    square: f64,
}

/// The variance of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variance {
    /// The variance of pixels.
    pub(super) pixels: f64,
    /// The variance of the mean of a block of 16 x 16 pixels, times their number. It is larger than that of pixels if
    /// neighbours share light subpaths.
    pub(super) blocks: f64,
}

impl Variance {
    /// Returns the geometric mean of both, by which plans are compared: measures of error see the noise of pixels,
    /// and a distant viewer or a denoiser sees the noise of blocks.
    pub(super) fn mean(self) -> f64 {
        (self.pixels * self.blocks).sqrt()
    }
}

impl Survey {
    /// Returns the terms relative to the means of their blocks. None: the survey found no light.
    pub(super) fn relative_terms(&self, film: &FilmSettings) -> Option<Vec<RelativeTerm>> {
        let places = self.places(film);
        let mut means = [0.0; BLOCKS];
        for (term, &(block, scale)) in self.terms.iter().zip(&places) {
            means[block] += f64::from(term.value) * scale;
        }
        let mean = self.luminance / self.samples();
        let relative = |(term, (block, scale)): (&SurveyTerm, (usize, f64))| {
            let norm = (means[block] * means[block] + DARK * mean * mean).sqrt();
            let value = f64::from(term.value) / norm;
            let in_pass = if term.is_light_image() {
                film.pixel_count() as f64
            } else {
                1.0
            };
            RelativeTerm {
                block,
                value,
                score: f64::from(term.score) / norm,
                scale,
                square: value * value * scale / in_pass,
            }
        };
        (mean > 0.0).then(|| self.terms.iter().zip(places).map(relative).collect())
    }

    /// Returns the block of each term, and the factor by which the term's value enters the mean of the block.
    fn places(&self, film: &FilmSettings) -> Vec<(usize, f64)> {
        let blocks = Blocks::new(film.crop);
        let samples = blocks.samples(self.stats.samples);
        let place = |term: &SurveyTerm| {
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

    /// Returns the variance of a plan with `counts`, from the [`relative_terms`](Self::relative_terms) and what is
    /// `known` of each.
    pub(super) fn judge(
        &self,
        relative: &[RelativeTerm],
        known: &[Known],
        counts: &Counts,
    ) -> Judgement {
        let mut sums = Sums::default();
        let quad_of = |term: &SurveyTerm| u64::from(term.sample) / QUAD;
        let mut begin = 0;
        for terms in self.terms.chunk_by(|a, b| quad_of(a) == quad_of(b)) {
            let range = begin..begin + terms.len();
            begin = range.end;
            let all = terms
                .iter()
                .zip(&relative[range.clone()])
                .zip(&known[range]);
            sums.add(
                self.quad(terms[0].sample),
                all.map(|((term, relative), known)| (term, relative, known)),
                counts,
            );
        }
        sums.judgement(counts)
    }

    /// Returns the four samples that include sample `number`, without terms.
    fn quad(&self, number: u32) -> Quad {
        let first = number as usize / QUAD as usize * QUAD as usize;
        Quad::new(std::array::from_fn(|i| self.light_numbers[first + i]))
    }
}

/// The variance of plans that differ only in their shadow rays.
pub(super) struct Judgement {
    /// M_k.
    moment: f64,
    /// The variance of a pixel, if all shadow rays are traced.
    all: f64,
    /// The variance that the other pixels of a block add, because they share light subpaths.
    common: f64,
    /// The connections of the survey, as candidates of the plan.
    candidates: Vec<Expected>,
}

impl Judgement {
    /// Returns the variance if `rule` chooses the shadow rays.
    pub(super) fn variance(&self, rule: ShadowRays) -> Variance {
        let selection = match rule {
            ShadowRays::Budget(rays) => selection::variance(&self.candidates, f64::from(rays)),
            ShadowRays::PerPair => selection::variance(&self.candidates, 1.0),
            _ => 0.0,
        };
        let pixels = (self.all + selection).max(LEAST_VARIANCE * self.moment);
        Variance {
            pixels,
            blocks: pixels + self.common,
        }
    }
}

/// Sums over the terms of the survey.
#[derive(Default)]
struct Sums {
    moment: f64,
    /// The sum of T² that products of a connection with itself contribute.
    of_light: f64,
    quads: QuadVariance,
    candidates: Vec<Expected>,
}

impl Sums {
    /// Adds the terms of one pixel to its `quad`.
    fn add<'a>(
        &mut self,
        mut quad: Quad,
        terms: impl Iterator<Item = (&'a SurveyTerm, &'a RelativeTerm, &'a Known)>,
        counts: &Counts,
    ) {
        let mut scale = 0.0;
        for (term, relative, known) in terms {
            let ratio = counts.density_ratio(&known.shares);
            let is_seen = known.shares.vertices == 2;
            let alone = if is_seen {
                ratio.light_images
            } else {
                ratio.all
            };
            let square = relative.square / (ratio.all * ratio.all);
            self.moment += square * (alone + dot(known.excess, counts.connections));
            self.of_light += square * dot(known.squares, counts.connections.map(|n| n * n));
            if term.is_light_image() {
                continue;
            }
            scale = relative.scale;
            let value = relative.value / ratio.all;
            let (part, rate) = term.rate(known, counts);
            let (i, reach) = (
                term.sample as usize % QUAD as usize,
                term.reach(known, counts),
            );
            quad.add(i, part, reach, value * rate);
            if relative.score > 0.0 && rate > 0.0 {
                self.candidates.push(Expected {
                    block: relative.block as u32,
                    sample: term.sample,
                    count: rate,
                    score: relative.score / ratio.all * f64::from(known.root_visibility),
                    value,
                    scale,
                });
            }
        }
        self.quads.add(&quad, counts, scale);
    }

    fn judgement(mut self, counts: &Counts) -> Judgement {
        let quads = &self.quads;
        let (mut all, mut common) = (self.moment + quads.alone(), 0.0);
        if let Some(draws) = &counts.draws {
            let moment = self.of_light + quads.pairs - quads.mean_squares;
            let of_light = moment.max(0.0) / draws.subpaths;
            all += of_light;
            common = of_light * quads.correlation() * draws.neighbours;
        }
        self.candidates.sort_by_key(|candidate| candidate.block);
        Judgement {
            moment: self.moment,
            all,
            common,
            candidates: self.candidates,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::known::Judge;
    use crate::driver::training::plan::typical;
    use crate::driver::training::{
        Effort, Settings, TrainingInput,
        tests::{input, lamp, large_view, room, survey_of, view},
    };
    use crate::film::PixelRect;
    use crate::integrator::{CandidateCount, IntegratorKind};
    use crate::path::PathRoulette;
    use crate::testing::check_close;

    impl SurveyTerm {
        /// Returns true where connections with light walks can make the path.
        pub(in crate::driver::training) fn has_share_of_connections(&self) -> bool {
            self.shares.connections.iter().sum::<f32>() > 0.0
        }
    }

    /// Returns the variance of the estimator of `settings`, all of whose shadow rays are traced, and its cost.
    fn judged(input: TrainingInput<'_>, settings: &Settings) -> [f64; 2] {
        let survey = survey_of(input, Effort::WHOLE);
        let terms = survey.relative_terms(input.view.film()).expect("a lamp");
        let judge = Judge::new(
            input,
            &typical(input.settings),
            &survey,
            &survey.log.cells(),
        );
        let variance = judge.judge(settings, &terms).variance(ShadowRays::All);
        let cost = survey.cost(settings, &judge.counts(settings));
        [variance.pixels, cost]
    }

    /// Variance and cost of path tracing whose roulette begins at a surface, by surveys of these strategies.
    fn of_path(strategies: &str, surveyed: u32, start: u32) -> [f64; 2] {
        let (scene, view) = (room(), large_view());
        let mut settings = Settings::new(IntegratorKind::Bdpt);
        settings.path.strategies = strategies.parse().expect("a list of strategies");
        let [surveyed, roulette] = [surveyed, start].map(|start| PathRoulette::Albedo { start });
        settings.path.roulette = surveyed;
        let mut path = Settings::new(IntegratorKind::Path);
        path.path.roulette = roulette;
        let of_seeds = (0..4).map(|seed| {
            settings.seed = seed;
            judged(input(&scene, &view, &settings), &path)
        });
        of_seeds.fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]])
    }

    /// Its own strategies give the same without other numbers of samples, and with the roulette that it has, but for the
    /// noise of means: a survey divides by its own, of 64 samples of each block here. With 16 they differ by four times as
    /// much.
    #[test]
    fn all_strategies_tell_variance_and_cost_of_path_tracing() {
        for start in 0..3 {
            let [variance, cost] = of_path("all", 0, start);
            let [own_variance, own_cost] = of_path("s0,s1", start, start);
            check_close(variance, own_variance, 0.17, start);
            check_close(cost, own_cost, 0.02, start);
        }
    }

    /// They do not divide the variance of the camera subpath. Each is drawn from a part of
    /// the lights of its own, which gains nothing with one lamp.
    #[test]
    fn light_points_divide_the_variance_of_direct_light() {
        let of_first: fn(u16) -> CandidateCount = |count| CandidateCount::new(count, 1);
        for (max_depth, of, tolerance) in [(1, of_first, 0.1), (5, CandidateCount::of, 0.05)] {
            let (scene, view) = (room(), large_view());
            let mut settings = Settings::new(IntegratorKind::Lvc);
            settings.path.strategies = "s1".parse().expect("a strategy");
            settings.path.max_depth = Some(max_depth);
            let mut variance = |count, seed| {
                settings.seed = seed;
                let surveyed = settings.clone();
                settings.lvc.next_events = of(count);
                judged(input(&scene, &view, &surveyed), &settings)[0]
            };
            let [one, two, eight] =
                [1, 2, 8].map(|count| (0..4).map(|seed| variance(count, seed)).sum::<f64>());
            let name = format!("{max_depth}: {one}, {two}, {eight}");
            assert!(0.0 < eight && eight < two, "{name}");
            // By 1 - 1/8 and by 1/2 - 1/8.
            check_close((one - eight) / (two - eight), 7.0 / 3.0, tolerance, name);
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
        let input = input(&scene, &view, &settings);
        let survey = survey_of(input, Effort::WHOLE);
        let terms = survey.relative_terms(view.film()).expect("a lamp");
        let moment: f64 = terms.iter().map(|term| term.square).sum();
        let part = judged(input, &settings)[0] / moment;
        assert!(part < 0.05, "{part}");
    }
}
