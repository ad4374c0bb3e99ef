//! Compares spectra with the tables of standards.

use super::colorimetry::{conductor, emission};
use super::*;
use glam::DVec3;

#[track_caller]
fn check_at(nm: f64, expected: f64) {
    let samples = vec![[400.0, 1.0], [500.0, 3.0], [600.0, 0.0]];
    let zero = Curve::new(samples.clone(), Beyond::Zero).unwrap();
    assert!((zero.at(nm) - expected).abs() < 1e-12, "at {nm}");
    let last = Curve::new(samples, Beyond::Last).unwrap();
    let clamped = nm.clamp(400.0, 600.0);
    assert!((last.at(nm) - zero.at(clamped)).abs() < 1e-12, "at {nm}");
}

#[test]
fn samples_are_joined_by_lines() {
    for (nm, expected) in [
        (399.0, 0.0),
        (400.0, 1.0),
        (450.0, 2.0),
        (500.0, 3.0),
        (575.0, 0.75),
        (600.0, 0.0),
        (700.0, 0.0),
    ] {
        check_at(nm, expected);
    }
}

#[track_caller]
fn check_color(color: [f32; 3], expected: [f32; 3], tolerance: f32) {
    let close = color
        .iter()
        .zip(expected)
        .all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(close, "{color:?} instead of {expected:?}");
}

#[test]
fn white_reflects_everything_under_daylight() {
    let white = Curve::new(vec![[360.0, 1.0], [830.0, 1.0]], Beyond::Last).unwrap();
    check_color(reflectance(&white), [1.0; 3], 1e-6);
    let d65 = named("stdillum-D65").unwrap();
    check_color(emission(&d65).unwrap(), [1.0; 3], 1e-6);
}

/// Returns the chromaticity of a light whose colour lies within Rec. 709.
fn chromaticity(light: &Curve) -> [f64; 2] {
    let rgb = DVec3::from(emission(light).unwrap().map(f64::from));
    // The matrix of IEC 61966-2-1 from linear sRGB to XYZ.
    let xyz = DVec3::new(
        rgb.dot(DVec3::new(0.4124, 0.3576, 0.1805)),
        rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722)),
        rgb.dot(DVec3::new(0.0193, 0.1192, 0.9505)),
    );
    assert!((xyz.y - 1.0).abs() < 1e-3, "the luminance is {}", xyz.y);
    [xyz.x / xyz.element_sum(), xyz.y / xyz.element_sum()]
}

#[track_caller]
fn check_chromaticity(light: &Curve, expected: [f64; 2], tolerance: f64) {
    let actual = chromaticity(light);
    let distance = libm::hypot(actual[0] - expected[0], actual[1] - expected[1]);
    assert!(distance < tolerance, "{actual:?} instead of {expected:?}");
}

/// CIE 15, table T.3, and the locus of Planck.
#[test]
fn lights_have_the_chromaticities_of_the_standard() {
    for (name, expected) in [
        ("stdillum-A", [0.44757, 0.40745]),
        ("stdillum-D50", [0.34567, 0.35850]),
        ("stdillum-D65", [0.31272, 0.32903]),
        ("illum-acesD60", [0.32168, 0.33767]),
        ("stdillum-F2", [0.3721, 0.3751]),
        ("stdillum-F7", [0.3129, 0.3292]),
        ("stdillum-F11", [0.3805, 0.3769]),
    ] {
        check_chromaticity(&named(name).unwrap(), expected, 6e-4);
    }
    check_chromaticity(&Curve::blackbody(6500.0), [0.31352, 0.32363], 6e-4);
    check_chromaticity(&Curve::blackbody(2856.0), [0.44757, 0.40745], 6e-4);
}

#[test]
fn hues_outside_the_gamut_keep_their_luminance() {
    let red = Curve::new(vec![[640.0, 0.0], [650.0, 1.0], [660.0, 0.0]], Beyond::Zero).unwrap();
    let [r, g, b] = emission(&red).unwrap();
    assert!(r > 4.0 && g == 0.0 && b == 0.0, "{r} {g} {b}");
    assert!((luminance([r, g, b]) - 1.0).abs() < 1e-3);
    let infrared = Curve::new(vec![[900.0, 1.0]], Beyond::Zero).unwrap();
    assert_eq!(emission(&infrared), None);
}

/// The reflectances of the sources, by other programs, of normal incidence in linear sRGB.
#[test]
fn metals_reflect_as_measured() {
    for (metal, expected) in [
        ("Ag", [0.965, 0.953, 0.915]),
        ("Al", [0.907, 0.916, 0.922]),
        ("Cu", [0.953, 0.639, 0.536]),
        ("CuZn", [0.910, 0.778, 0.423]),
        ("MgO", [0.072, 0.073, 0.075]),
        ("TiO2", [0.232, 0.245, 0.273]),
    ] {
        let part = |part: &str| named(&format!("metal-{metal}-{part}")).unwrap();
        let [eta, k] = conductor(&part("eta"), &part("k"));
        let reflected = std::array::from_fn(|i| {
            let (eta, k) = (eta[i], k[i]);
            ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k)
        });
        check_color(reflected, expected, 2e-3);
    }
}

/// Schott's catalogue: n_d.
#[test]
fn glasses_have_the_index_of_the_catalogue() {
    for (glass, expected) in [
        ("BK7", 1.51680),
        ("BAF10", 1.67003),
        ("FK51A", 1.48656),
        ("LASF9", 1.85025),
        ("F5", 1.67270),
        ("SF10", 1.72825),
        ("F11", 1.78472),
    ] {
        let glass = named(&format!("glass-{glass}")).unwrap();
        assert!((glass.at(587.5618) - expected).abs() < 2e-5);
    }
}

#[test]
fn every_name_is_found_and_others_are_not() {
    assert_eq!(names().count(), 14 + 10 + 12 + 4);
    assert!(names().all(|name| named(&name).is_some()));
    for name in ["metal-Cu", "metal-Cu-n", "glass-", "stdillum-F13", "Cu"] {
        assert!(named(name).is_none(), "{name}");
    }
}

#[test]
fn balancing_makes_the_scenes_white_white() {
    for kelvin in [4000.0, 5000.0, 7000.0, 10000.0] {
        let white = daylight_white(kelvin);
        let rec709 = Primaries::rec709();
        let as_color = rgb_from_rgb(
            &Primaries {
                xy: rec709.xy,
                white,
            },
            white,
            [1.0; 3],
        );
        let balanced = adapted(white) * DVec3::from(as_color.map(f64::from));
        check_color(balanced.as_vec3().into(), [1.0; 3], 1e-5);
    }
    assert!((daylight_white(6504.0) - Primaries::rec709().white).length() < 2e-3);
    assert!((planckian_white(2856.0).x - 1.0985).abs() < 1e-3);
}
