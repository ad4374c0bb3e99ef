//! Strategies by themselves: their images, with and without the weight, and how much they vary.

use crate::common::statistics::{WHOLE, check_agree, replicates, replicates_of};
use crate::lit_room::{LAMPS, lit_room};
use crate::{film, settings};
use bidir::driver::{Resources, Session, Settings};
use bidir::film::{Film, Layers};
use bidir::integrator::IntegratorKind;
use bidir::path::Strategy;
use bidir::sampler::SamplerKind;
use bidir::select::ShadowRays;
use bidir::spectrum::{Rgb, luminance};

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
    let all = film(&scene, &with_raw("all"), 16, 2);
    for strategy in all.layers().kept_strategies() {
        let raw = pixels(&all, all.layers().raw_part(strategy));
        // No walk depends on the strategies that take part, so both have the same samples.
        let alone = film(&scene, &with_raw(&strategy.to_string()), 16, 2).develop();
        for (a, b) in raw.iter().flatten().zip(alone.pixels.iter().flatten()) {
            assert!((a - b).abs() <= 1e-4 * b, "{strategy}: {a}, not {b}");
        }
        assert!(
            alone.pixels.iter().flatten().any(|v| *v > 0.0),
            "{strategy}"
        );
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
        let film = film(&scene, &with_raw(&strategy.to_string()), 4, 2);
        let layers = film.layers();
        let weighted = pixels(&film, layers.weighted_part(strategy));
        assert_eq!(pixels(&film, layers.raw_part(strategy)), weighted);
        assert_eq!(film.develop().pixels, weighted, "{strategy}");
    }
}

#[test]
fn strategies_vary_as_their_images_do_from_pass_to_pass() {
    const PASSES: u64 = 512;
    let scene = lit_room(4, &LAMPS);
    let settings = Settings {
        sampler: SamplerKind::Independent,
        ..with_raw("all")
    };
    let session = |first: u64, passes: u64| {
        let resources = Resources::default();
        let session = Session::new(&scene, settings.clone(), &resources);
        let mut session = session.expect("the film is small");
        session.start_at(first);
        (0..passes).for_each(|_| assert!(session.step(&())));
        session
    };
    let images: Vec<Film> = (0..PASSES)
        .map(|pass| session(pass, 1).into_film())
        .collect();
    for told in session(0, PASSES).strategy_moments() {
        let values = images.iter().map(|film| {
            let pixels = pixels(film, film.layers().weighted_part(told.strategy));
            let values = pixels.into_iter().map(|pixel| f64::from(luminance(pixel)));
            values.collect::<Vec<_>>()
        });
        let values: Vec<_> = values.collect();
        let of_pixel = |i: usize| {
            let n = PASSES as f64;
            let mean = values.iter().map(|image| image[i]).sum::<f64>() / n;
            let square = values
                .iter()
                .map(|image| (image[i] - mean) * (image[i] - mean));
            (mean, square.sum::<f64>() / (n - 1.0))
        };
        let moments: Vec<_> = (0..16).map(of_pixel).collect();
        let mean = moments.iter().map(|(mean, _)| mean).sum::<f64>() / 16.0;
        let variance = moments.iter().map(|(_, variance)| variance).sum::<f64>() / 16.0;
        // Exact where a sample has a pixel of its own; light paths of a pass meet in pixels.
        let tolerance = if told.strategy.t == 1 { 0.1 } else { 1e-4 };
        let found = told.variance.expect("several passes");
        assert!(
            (found - variance).abs() <= tolerance * variance,
            "{told:?}: {variance}"
        );
        assert!((told.mean - mean).abs() <= 1e-5 * mean, "{told:?}: {mean}");
    }
}

#[test]
fn counters_do_not_depend_on_threads() {
    let scene = lit_room(8, &LAMPS);
    let stats = [1, 3].map(|threads| {
        let resources = Resources {
            threads,
            ..Resources::default()
        };
        let session = Session::new(&scene, with_raw("all"), &resources);
        let mut session = session.expect("the film is small");
        (0..4).for_each(|_| assert!(session.step(&())));
        session.stats().clone()
    });
    assert_eq!(stats[0], stats[1]);
    assert!(stats[0].strategy_images.rows().count() > 6);
}
