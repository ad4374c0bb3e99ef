use super::{MODES, cases, numbers};
use crate::bsdf::{Bsdf, BsdfSample, TransportMode, same_hemisphere};
use crate::math::{Vec2, Vec3, sqr, warp};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::testing::{check_close, check_near, samples};

/// Checks a value or a density of facets. At a facet that light grazes, the transmittance is 1 minus almost 1, and the
/// cosine beyond a root of 1 minus almost 1: they have few digits left.
#[track_caller]
fn check_facets(actual: f32, expected: f32, case: &str) {
    let slack = (expected - actual).clamp(-1e-4, 1e-4);
    check_close(actual + slack, expected, 1e-3, case);
}

#[track_caller]
fn check_spectra(actual: Spectrum, expected: Spectrum, case: &str) {
    for (actual, expected) in actual.0.into_iter().zip(expected.0) {
        check_facets(actual, expected, case);
    }
}

/// Checks what one draw must have in common with `eval` and `pdf`.
#[track_caller]
fn check_sample(bsdf: &Bsdf, wo: Vec3, mode: TransportMode, drawn: &BsdfSample, case: &str) {
    let wi = drawn.wi;
    assert!((wi.length() - 1.0).abs() < 1e-4, "{case}: wi {wi}");
    assert!(!drawn.is_delta && drawn.pdf > 0.0, "{case}");
    let value = bsdf.eval(wo, wi, mode);
    check_close(drawn.pdf, value.pdf, 1e-3, case);
    check_close(drawn.pdf_reverse, value.pdf_reverse, 1e-3, case);
    check_close(drawn.albedo_reverse, value.albedo_reverse, 1e-6, case);
    let weight = value.f * (wi.z.abs() / drawn.pdf);
    check_spectra(drawn.weight, weight, case);
}

/// Checks that f is symmetric, up to the η² of radiance, and that `pdf_reverse` and `albedo_reverse` are the density
/// and the albedo of the exchanged directions.
#[track_caller]
fn check_reciprocity(bsdf: &Bsdf, wo: Vec3, wi: Vec3, case: &str) {
    let [forth, back] = [[wo, wi], [wi, wo]].map(|[a, b]| MODES.map(|mode| bsdf.eval(a, b, mode)));
    for (forth, back) in forth.iter().zip(&back) {
        check_facets(forth.pdf, back.pdf_reverse, case);
        check_facets(forth.pdf_reverse, back.pdf, case);
        let albedo = bsdf.albedo(wi).max_lane();
        check_close(forth.albedo_reverse, albedo, 1e-6, case);
    }
    let [radiance, importance] = forth.map(|value| value.f);
    check_spectra(radiance, back[1].f, case);
    if same_hemisphere(wo, wi) {
        check_spectra(radiance, back[0].f, case);
        check_spectra(radiance, importance, case);
    } else {
        // (η_o/η_i)², with wo on the side that radiance goes to.
        let index = |w: Vec3| if w.z > 0.0 { 1.0 } else { index_inside(bsdf) };
        check_spectra(radiance, importance * sqr(index(wo) / index(wi)), case);
    }
}

fn index_inside(bsdf: &Bsdf) -> f32 {
    match bsdf {
        Bsdf::Dielectric(dielectric) => dielectric.eta,
        Bsdf::Principled(principled) => principled.index_inside(),
        // Both sides are outside.
        _ => 1.0,
    }
}

/// Checks a draw of a Dirac lobe beside others: a walk the other way comes back by the same lobe, with
/// the densities exchanged.
#[track_caller]
fn check_dirac_lobe(bsdf: &Bsdf, wo: Vec3, mode: TransportMode, drawn: &BsdfSample, case: &str) {
    let n = 64;
    let mut ways = (0..n).filter_map(|i| {
        let u_lobe = (i as f32 + 0.5) / n as f32;
        bsdf.sample(drawn.wi, mode.reversed(), || u_lobe, Vec2::splat(0.5))
    });
    let back = ways.find(|back| back.is_delta && (back.wi - wo).length() < 1e-4);
    let back = back.unwrap_or_else(|| panic!("{case}: no way back of {drawn:?}"));
    check_close(back.pdf, drawn.pdf_reverse, 1e-3, case);
    check_close(back.pdf_reverse, drawn.pdf, 1e-3, case);
    let value = |of: &BsdfSample| of.weight * (of.pdf / of.wi.z.abs());
    check_spectra(value(&back), value(drawn), case);
}

/// A Dirac lobe is drawn with the probability P that is in its coefficient, `pdf = P η² |cosθ_i|`.
#[test]
fn dirac_lobes_among_others_are_as_frequent_as_they_say() {
    let mut lobes = 0;
    for (name, bsdf, wo) in cases() {
        let draw = |u_lobe| bsdf.sample(wo, TransportMode::Radiance, || u_lobe, Vec2::splat(0.4));
        let drawn = [0.0, 0.9999].map(|u| draw(u).filter(|drawn| drawn.is_delta));
        for dirac in drawn.into_iter().flatten() {
            let n = 10_000;
            let at = |i: i32| draw((i as f32 + 0.5) / n as f32);
            let is_same = |drawn: BsdfSample| drawn.is_delta && drawn.wi.dot(dirac.wi) > 0.9999;
            let same = (0..n).filter(|&i| at(i).is_some_and(is_same));
            let share = same.count() as f32 / n as f32;
            let index = if dirac.wi.z > 0.0 {
                1.0
            } else {
                index_inside(&bsdf)
            };
            let prob = dirac.pdf / (sqr(index) * dirac.wi.z.abs());
            check_near(share, prob, 2e-4, &name);
            lobes += 1;
        }
    }
    assert!(lobes > 20, "{lobes}");
}

#[test]
fn draws_agree_with_value_and_density_and_light_flows_both_ways() {
    for (name, bsdf, wo) in cases().filter(|(_, bsdf, _)| !bsdf.is_delta()) {
        for sample in samples(&name, 2000) {
            let (u_lobe, u) = numbers(&sample);
            for mode in MODES {
                let Some(drawn) = bsdf.sample(wo, mode, || u_lobe, u) else {
                    continue;
                };
                if drawn.is_delta {
                    check_dirac_lobe(&bsdf, wo, mode, &drawn, &name);
                    continue;
                }
                check_sample(&bsdf, wo, mode, &drawn, &name);
                check_reciprocity(&bsdf, wo, drawn.wi, &name);
            }
        }
    }
}

/// Checks a draw of a Dirac distribution: nothing but a draw finds it.
#[track_caller]
fn check_dirac(bsdf: &Bsdf, wo: Vec3, mode: TransportMode, u_lobe: f32, case: &str) {
    let drawn = bsdf.sample(wo, mode, || u_lobe, Vec2::splat(0.5));
    let drawn = drawn.expect("a Dirac distribution loses nothing");
    let is_drawn = drawn.is_delta && drawn.pdf > 0.0 && drawn.pdf_reverse > 0.0;
    let value = bsdf.eval(wo, drawn.wi, mode);
    assert!(is_drawn && value.f.is_black() && value.pdf <= 0.0, "{case}");
    check_dirac_lobe(bsdf, wo, mode, &drawn, case);
}

#[test]
fn dirac_distributions_are_the_same_from_both_ends() {
    for (name, bsdf, wo) in cases().filter(|(_, bsdf, _)| bsdf.is_delta()) {
        for mode in MODES {
            check_dirac(&bsdf, wo, mode, 0.0, &name);
            check_dirac(&bsdf, wo, mode, 0.9999, &name);
        }
    }
}

/// Opaque BSDFs have no value for directions on opposite sides.
#[test]
fn light_goes_through_only_what_transmits() {
    let mut all = 0;
    for (name, bsdf) in Bsdf::examples() {
        let mut crossing = 0;
        for (wo, wi) in samples(name, 400).map(|sample| {
            let get = |i| sample.get_2d(Dimension::at(i, Purpose::Scatter));
            (warp::uniform_sphere(get(0)), warp::uniform_sphere(get(1)))
        }) {
            let f = bsdf.eval(wo, wi, TransportMode::Radiance).f;
            crossing += usize::from(!f.is_black() && !same_hemisphere(wo, wi));
        }
        assert!(crossing == 0 || bsdf.transmits(), "{name}: {crossing}");
        all += crossing;
    }
    // About 1000 by any seed: that there are any is what the rest of this test needs.
    assert!(all > 500, "{all}");
}
