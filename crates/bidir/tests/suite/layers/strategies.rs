//! Strategies by themselves: their images, with and without the weight, and how much they vary.

use super::lit_room::{LAMPS, lit_room};
use super::settings;
use crate::common::prelude::*;
use bidir::integrator::{CandidateCount, LvcSettings, SamplesPerSubpath};
use bidir::path::Strategy;
use bidir::sampler::SamplerKind;
use bidir::select::ShadowRays;
use bidir::spectrum::luminance;

/// Bidirectional path tracing with these strategies, and raw images of paths of four vertices.
fn with_raw(strategies: &str) -> Settings {
    let mut settings = settings(IntegratorKind::Bdpt, Layers::new(&[], &[], 4).with_raw());
    settings.path.strategies = strategies.parse().expect("a list of strategies");
    settings
}

fn pixels(film: &Film, part: Option<usize>) -> Vec<Rgb> {
    let part = part.expect("the strategy has an image");
    film.part_pixels(part).collect()
}

#[test]
fn a_raw_image_is_what_its_strategy_alone_would_give() {
    let scene = lit_room(8, &LAMPS);
    let all = scene.film(&with_raw("all"), 16, 2);
    for strategy in all.layers().kept_strategies() {
        let raw = pixels(&all, all.layers().raw_part(strategy));
        // No walk depends on the strategies that take part, so both have the same samples.
        let alone = scene
            .film(&with_raw(&strategy.to_string()), 16, 2)
            .develop();
        let alone = alone.pixels.concat();
        for (a, b) in raw.iter().flatten().zip(&alone) {
            assert!((a - b).abs() <= 1e-4 * b, "{strategy}: {a}, not {b}");
        }
        assert!(alone.iter().any(|v| *v > 0.0), "{strategy}");
    }
}

#[test]
fn raw_images_do_not_depend_on_the_choice_of_shadow_rays() {
    let scene = lit_room(8, &LAMPS);
    let chosen = Settings {
        shadow_rays: ShadowRays::PerPair,
        ..with_raw("all")
    };
    let strategy = Strategy::new(1, 2);
    let raw = |film: &Film| pixels(film, film.layers().raw_part(strategy));
    let raw = replicates_of(&scene, &chosen, 6144, raw);
    let alone = replicates(&scene, &with_raw("s1t2"), 6144);
    check_agree("s1t2, one ray per pair", &raw, &alone, &[WHOLE]);
}

#[test]
fn what_has_all_the_weight_is_its_raw_image() {
    let scene = lit_room(8, &LAMPS);
    for (s, t) in [(0, 3), (1, 2), (2, 1), (2, 2)] {
        let strategy = Strategy::new(s, t);
        let film = scene.film(&with_raw(&strategy.to_string()), 4, 2);
        let layers = film.layers();
        let weighted = pixels(&film, layers.weighted_part(strategy));
        assert_eq!(pixels(&film, layers.raw_part(strategy)), weighted);
        assert_eq!(film.develop().pixels, weighted, "{strategy}");
    }
}

/// The film of each of so many passes, rendered one by one.
fn passes(scene: &Shot, settings: &Settings, count: u64) -> Vec<Film> {
    let mut session = scene.session(settings.clone(), 0);
    let pass = |pass| {
        session.start_at(pass);
        steps(&mut session, 1);
        session.take_film().expect("the film is small").0
    };
    (0..count).map(pass).collect()
}

/// The means over pixels of the luminance of a strategy's weighted image, and of how much it varies
/// from film to film.
fn mean_and_variance(films: &[Film], strategy: Strategy) -> [f64; 2] {
    let image = |film: &Film| {
        let pixels = pixels(film, film.layers().weighted_part(strategy)).into_iter();
        let luminances = pixels.map(|pixel| f64::from(luminance(pixel)));
        luminances.collect::<Vec<_>>()
    };
    let images: Vec<_> = films.iter().map(image).collect();
    let (n, size) = (films.len() as f64, images[0].len());
    let of_pixel = |i: usize| {
        let mean = images.iter().map(|image| image[i]).sum::<f64>() / n;
        let square = |image: &Vec<f64>| (image[i] - mean) * (image[i] - mean);
        [mean, images.iter().map(square).sum::<f64>() / (n - 1.0)]
    };
    let moments: Vec<_> = (0..size).map(of_pixel).collect();
    [0, 1].map(|k| moments.iter().map(|moment| moment[k]).sum::<f64>() / size as f64)
}

/// Compares a session's moments of each strategy with its films, pass by pass. Variances of light
/// images, whose paths meet in pixels, may be wrong by the part `tolerance`.
#[track_caller]
fn check_moments(scene: &Shot, settings: Settings, count: u64, tolerance: f64) {
    let settings = Settings {
        sampler: SamplerKind::Independent,
        ..settings
    };
    let films = passes(scene, &settings, count);
    let mut session = scene.session(settings, 0);
    steps(&mut session, count);
    for told in session.strategy_moments() {
        let [mean, variance] = mean_and_variance(&films, told.strategy);
        // Exact where a sample has a pixel of its own.
        let is_light_image = told.strategy.t == 1;
        let bound = variance * if is_light_image { tolerance } else { 1e-4 };
        let found = told.variance.expect("several passes");
        assert!((found - variance).abs() <= bound, "{told:?}: {variance}");
        assert!((told.mean - mean).abs() <= 1e-5 * mean, "{told:?}: {mean}");
    }
}

#[test]
fn strategies_vary_as_their_images_do_from_pass_to_pass() {
    check_moments(&lit_room(4, &LAMPS), with_raw("all"), 512, 0.1);
}

#[test]
fn strategies_of_shared_subpaths_vary_as_their_images_do() {
    let mut settings = with_raw("all");
    settings.integrator = IntegratorKind::Lvc;
    settings.lvc = LvcSettings {
        candidates: CandidateCount::new(12, 3),
        samples_per_subpath: SamplesPerSubpath::power_of_two(1),
        ..LvcSettings::default()
    };
    check_moments(&lit_room(4, &LAMPS), settings, 512, 0.1);
}

#[test]
fn light_images_of_one_path_vary_exactly_as_they_do_from_pass_to_pass() {
    // All four pixels share it, so that none meet.
    let mut settings = with_raw("s1t1,s2t1");
    settings.integrator = IntegratorKind::Lvc;
    settings.lvc.samples_per_subpath = SamplesPerSubpath::power_of_two(2);
    check_moments(&lit_room(2, &LAMPS), settings, 512, 1e-4);
}
