use super::*;
use crate::sampler::{Domain, Sampler, SamplerKind};
use crate::spectrum::Spectrum;
use crate::strategy::Strategy;
use crate::testing::{check_near, check_texts};

fn candidate(s: usize, t: usize, score: f32) -> Candidate {
    Candidate {
        term: Term {
            strategy: Strategy::new(s, t),
            light: 0,
            contribution: Spectrum::splat(score),
            weight: 1.0,
        },
        score,
        vertices: [0; 2],
        light_vertex: s as u32 - 1,
    }
}

/// Two light and three camera vertices, with scores that span eight orders of magnitude.
fn candidates() -> Vec<Candidate> {
    let scores = [0.5, 2e-3, 40.0, 1e-6, 3.0, 2.0];
    let pairs = [(1, 2), (1, 3), (1, 4), (2, 2), (2, 3), (2, 4)];
    let all = pairs.into_iter().zip(scores);
    all.map(|((s, t), score)| candidate(s, t, score)).collect()
}

/// Two light points, and three vertices of a light cache of which two are as deep, in the order of cells;
/// two camera vertices share one of them.
fn cached_candidates() -> Vec<Candidate> {
    let all = [
        (0, (1, 2), 0.5),
        (0, (1, 2), 40.0),
        (8, (2, 2), 2e-3),
        (1, (3, 2), 3.0),
        (10, (2, 2), 1.0),
        (8, (2, 3), 2e-2),
    ];
    let candidate = |(light_vertex, (s, t), score)| Candidate {
        light_vertex,
        ..candidate(s, t, score)
    };
    all.map(candidate).into()
}

const RULES: [ShadowRays; 8] = [
    ShadowRays::All,
    ShadowRays::PerLightVertex,
    ShadowRays::PerCameraVertex,
    ShadowRays::PerPair,
    ShadowRays::RayRoulette(0.3),
    ShadowRays::Budget(1),
    ShadowRays::Budget(2),
    ShadowRays::Budget(6),
];

/// Returns how often each candidate was chosen in `n` draws, and the probability it is said to have, whether
/// it is chosen or not; `check` sees every draw.
fn frequencies(
    rule: ShadowRays,
    candidates: &[Candidate],
    n: u64,
    mut check: impl FnMut(&[Chosen]),
) -> Vec<(f64, f64)> {
    let selector = rule.selector(10.0);
    let sampler = Sampler::new(SamplerKind::Independent, 11);
    let probs = selector.probabilities(candidates);
    let mut frequencies = vec![0.0; candidates.len()];
    let mut chosen = Vec::new();
    for index in 0..n {
        chosen.clear();
        let stream = sampler.stream(Domain::Camera, 0, index);
        selector.select(candidates, Draws(&stream), &mut chosen);
        check(&chosen);
        for c in &chosen {
            let i = c.candidate as usize;
            frequencies[i] += 1.0 / n as f64;
            assert_eq!(c.prob.to_bits(), probs[i].to_bits(), "{rule} {i}");
        }
    }
    frequencies.into_iter().zip(probs).collect()
}

#[track_caller]
fn check_frequencies(candidates: &[Candidate]) {
    let n = 200_000;
    for rule in RULES {
        let found = frequencies(rule, candidates, n, |_| ());
        for (i, (frequency, prob)) in found.into_iter().enumerate() {
            // Five standard deviations of a binomial frequency.
            let bound = 5.0 * (prob * (1.0 - prob) / n as f64).sqrt() + 1e-9;
            assert!(prob > 0.0, "{rule} {i}");
            check_near(frequency, prob, bound, format!("{rule} {i}"));
        }
    }
}

#[test]
fn candidates_are_chosen_with_the_probability_that_is_stated() {
    check_frequencies(&candidates());
    check_frequencies(&cached_candidates());
}

/// As an image may have by a filter with negative lobes.
#[test]
fn roulette_with_a_negative_mean_traces_everything() {
    for mean in [-3.0, 0.0] {
        let roulette = ShadowRays::RayRoulette(0.3);
        let probs = roulette.selector(mean).probabilities(&candidates());
        assert!(probs.iter().all(|&prob| prob >= 1.0), "{mean}: {probs:?}");
    }
}

#[test]
fn no_rule_traces_more_rays_than_it_says() {
    let limit = |rule| match rule {
        ShadowRays::PerLightVertex => 2,
        ShadowRays::PerCameraVertex => 3,
        ShadowRays::PerPair => 1,
        ShadowRays::Budget(rays) => rays as usize,
        ShadowRays::All | ShadowRays::RayRoulette(_) => 6,
    };
    for rule in RULES {
        frequencies(rule, &candidates(), 2000, |chosen| {
            assert!(chosen.len() <= limit(rule), "{rule}");
        });
    }
}

#[test]
fn vertices_of_a_light_cache_have_one_ray_each() {
    let candidates = cached_candidates();
    let row = |chosen: &Chosen| candidates[chosen.candidate as usize].light_vertex;
    frequencies(ShadowRays::PerLightVertex, &candidates, 2000, |chosen| {
        let mut rows: Vec<_> = chosen.iter().map(row).collect();
        rows.sort_unstable();
        assert_eq!(rows, [0, 1, 8, 10]);
    });
}

#[test]
fn chosen_ones_of_others_are_left_alone_also_where_there_are_no_candidates() {
    let stream = Sampler::new(SamplerKind::Independent, 1).stream(Domain::Camera, 0, 0);
    let before = Chosen {
        candidate: 5,
        prob: 0.25,
    };
    for rule in RULES {
        let (mut chosen, selector) = (vec![before], rule.selector(10.0));
        selector.select(&[], Draws(&stream), &mut chosen);
        assert_eq!(chosen, [before], "{rule}");
        selector.select(&cached_candidates(), Draws(&stream), &mut chosen);
        assert_eq!(chosen[0], before, "{rule}");
    }
}

#[test]
fn one_ray_of_budget_is_one_per_pair() {
    let probabilities = |rule: ShadowRays| rule.selector(10.0).probabilities(&candidates());
    let budget = probabilities(ShadowRays::Budget(1));
    for (a, b) in budget.into_iter().zip(probabilities(ShadowRays::PerPair)) {
        check_near(a, b, 1e-6, "a candidate");
    }
}

#[test]
fn a_budget_holds_for_scores_that_vanish_beside_others() {
    let sampler = Sampler::new(SamplerKind::Independent, 1);
    for scores in [[1.0, 1e-17, 1e-30], [1e30, 1.0, 1.0], [1e-38, 1e-38, 1.0]] {
        let candidates: Vec<_> = (0..3).map(|i| candidate(1, 2 + i, scores[i])).collect();
        for index in 0..1000 {
            let stream = sampler.stream(Domain::Camera, 0, index);
            for rays in [1, 2] {
                let mut chosen = Vec::new();
                Budget { rays }.select(&candidates, Draws(&stream), &mut chosen);
                assert!(chosen.len() <= rays as usize, "{scores:?}");
            }
        }
    }
}

#[test]
fn rules_are_read_and_written() {
    let names = RULES.map(|rule| rule.to_string());
    let bad = [
        "",
        "none",
        "budget",
        "budget:0",
        "budget:x",
        "ray-roulette:-1",
        "all:2",
    ];
    check_texts::<ShadowRays>(&names.each_ref().map(String::as_str), &bad);
    let default = ShadowRays::RayRoulette(ShadowRays::DEFAULT_ROULETTE);
    assert_eq!("ray-roulette".parse(), Ok(default));
}
