//! Scattering whose light is known: once on the way of a ray, many times under a surface, and around a point light.

use super::VACUUM;
use crate::common::prelude::*;
use bidir::camera::{Camera, Spherical, SphericalMapping};
use bidir::math::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The means of `steps` parts of an interval.
fn middles([from, to]: [f64; 2], steps: usize) -> impl Iterator<Item = f64> {
    let width = (to - from) / steps as f64;
    (0..steps).map(move |i| from + (i as f64 + 0.5) * width)
}

#[track_caller]
fn check(
    name: &str,
    shot: &Shot,
    (kind, depth): (IntegratorKind, Option<u32>),
    passes: u64,
    expected: [f64; 3],
) {
    let result = replicates(shot, &settings(kind, depth), passes);
    let name = format!("{name}, {kind}");
    check_agree(&name, &result, &result.exactly(expected), &[WHOLE]);
}

// Light that is scattered once.

const LAMP: Vec3 = Vec3::new(0.0, 0.8, 2.0);
const ABSORPTION: Rgb = [0.1, 0.2, 0.0];
const SCATTERING: Rgb = [0.2, 0.4, 0.8];
const MEAN_COSINE: f32 = 0.4;
/// The tangent of half the field of view.
const HALF_FIELD: f32 = 0.05;

/// A point light beside the field of view, in fog without end.
fn lamp_in_fog() -> Shot {
    let mut builder = ShotBuilder::new(narrow_camera(Vec3::ZERO, 8, HALF_FIELD), 8);
    builder.light(point_light(LAMP));
    builder.fill(medium(ABSORPTION, SCATTERING, MEAN_COSINE));
    builder.build()
}

/// ∫ σ_s p(cosθ) / r² · exp(-σ_t (s + r)) ds along a ray, with r from the lamp to the place at s. With
/// s = a + h tan φ, where a is the place nearest to the lamp, at the distance h, ds / r² = dφ / h and cosθ = -sin φ
/// \[Pegoraro09\].
fn scattered_once(direction: DVec3, scattering: f64, extinction: f64) -> f64 {
    let lamp = LAMP.as_dvec3();
    let nearest = direction.dot(lamp);
    let beside = (lamp.length_squared() - nearest * nearest).sqrt();
    let begin = libm::atan2(-nearest, beside);
    let g = f64::from(MEAN_COSINE);
    let steps = 512;
    let terms = middles([begin, FRAC_PI_2], steps).map(|angle| {
        let base = 1.0 + g * g + 2.0 * g * libm::sin(angle);
        let phase = (1.0 - g * g) / (4.0 * PI * base * base.sqrt());
        let way = nearest + beside * libm::tan(angle) + beside / libm::cos(angle);
        phase * libm::exp(-extinction * way)
    });
    let width = (FRAC_PI_2 - begin) / steps as f64;
    scattering / beside * terms.sum::<f64>() * width
}

/// The mean over the film.
fn seen_of_lamp() -> [f64; 3] {
    let field = f64::from(HALF_FIELD);
    std::array::from_fn(|lane| {
        let scattering = f64::from(SCATTERING[lane]);
        let extinction = scattering + f64::from(ABSORPTION[lane]);
        let rays = middles([-field, field], 16)
            .flat_map(|x| middles([-field, field], 16).map(move |y| DVec3::new(x, y, 1.0)));
        let seen = rays.map(|ray| scattered_once(ray.normalize(), scattering, extinction));
        seen.sum::<f64>() / 256.0
    })
}

#[test]
fn fog_around_a_point_light_shines_as_far_as_it_scatters_once() {
    let expected = seen_of_lamp();
    for kind in [IntegratorKind::Path, IntegratorKind::Bdpt] {
        check("once", &lamp_in_fog(), (kind, Some(1)), 8192, expected);
    }
}

// Light that is scattered any number of times.

/// The albedo of one scattering, lane by lane.
const ALBEDO: Rgb = [0.5, 0.9, 0.99];

/// A ball of a thousand free paths under an even sky, seen from above.
fn thick_ball() -> Shot {
    const EXTINCTION: f32 = 1000.0;
    let mut builder = ShotBuilder::new(narrow_camera(Vec3::new(0.0, 0.0, -3.0), 4, 0.01), 4);
    builder.sky([1.0; 3]);
    let scattering = ALBEDO.map(|albedo| EXTINCTION * albedo);
    let absorption = ALBEDO.map(|albedo| EXTINCTION * (1.0 - albedo));
    let inside = builder.medium(medium(absorption, scattering, 0.0));
    builder.bound(sphere(Vec3::ZERO, 1.0), VACUUM, inside);
    builder.build()
}

/// H(1) of \[Chandrasekhar60, §V\] for even scattering, which solves
/// 1 / H(μ) = √(1 - ω) + ω/2 ∫ μ' H(μ') / (μ + μ') dμ'.
fn h_upwards(albedo: f64) -> f64 {
    const STEPS: usize = 400;
    let cosines: Vec<f64> = middles([0.0, 1.0], STEPS).collect();
    let next = |h: &[f64], mu: f64| {
        let pairs = cosines.iter().zip(h);
        let terms = pairs.map(|(other, h)| other * h / (mu + other));
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * terms.sum::<f64>() / STEPS as f64)
    };
    let mut h = vec![1.0; STEPS];
    for _ in 0..200 {
        h = cosines.iter().map(|&mu| next(&h, mu)).collect();
    }
    next(&h, 1.0)
}

#[track_caller]
fn check_thick(kind: IntegratorKind, passes: u64) {
    let expected = ALBEDO.map(|albedo| {
        let albedo = f64::from(albedo);
        1.0 - h_upwards(albedo) * (1.0 - albedo).sqrt()
    });
    check("thick", &thick_ball(), (kind, None), passes, expected);
}

#[test]
fn thick_matter_reflects_what_h_functions_say() {
    check_thick(IntegratorKind::Path, 2048);
}

// Fluence around a point light.

/// Independent uniform numbers \[Steele14\].
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed_again = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed_again ^ (mixed_again >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a direction whose cosine to `axis` is given.
    fn around(&mut self, axis: DVec3, cos: f64) -> DVec3 {
        // A second direction that is not along the axis makes the frame.
        let other = if axis.x.abs() < 0.5 {
            DVec3::X
        } else {
            DVec3::Y
        };
        let u = axis.cross(other).normalize();
        let (angle, sin) = (2.0 * PI * self.next(), (1.0 - cos * cos).max(0.0).sqrt());
        let across = u * libm::cos(angle) + axis.cross(u) * libm::sin(angle);
        (axis * cos + across * sin).normalize()
    }
}

/// Returns the fluence of scattered light at a free path from a point light of intensity 1, by photons that are absorbed
/// or scattered, and nothing else: collisions in a shell, over its volume. `g` is not 0.
fn fluence_by_photons(albedo: f64, g: f64, photons: u32) -> f64 {
    const SHELL: [f64; 2] = [0.95, 1.05];
    let (mut numbers, mut collisions) = (Numbers(7), 0u32);
    for _ in 0..photons {
        let (mut place, mut is_scattered) = (DVec3::ZERO, false);
        let up = 2.0 * numbers.next() - 1.0;
        let mut direction = numbers.around(DVec3::Z, up);
        loop {
            place += direction * -libm::log(1.0 - numbers.next());
            let is_inside = (SHELL[0]..SHELL[1]).contains(&place.length());
            collisions += u32::from(is_scattered && is_inside);
            if numbers.next() >= albedo {
                break;
            }
            is_scattered = true;
            let part = (1.0 - g * g) / (1.0 - g + 2.0 * g * numbers.next());
            direction = numbers.around(direction, (1.0 + g * g - part * part) / (2.0 * g));
        }
    }
    let [inner, outer] = SHELL.map(|r| 4.0 / 3.0 * PI * r * r * r);
    // Intensity 1 is a power of 4π.
    4.0 * PI * f64::from(collisions) / f64::from(photons) / (outer - inner)
}

/// Returns all around a place at a free path from a point light.
fn around_a_lamp(albedo: f32, g: f32) -> Shot {
    let mapping = SphericalMapping::EqualArea;
    let camera = Spherical::new(&Affine3A::IDENTITY, Vec2::splat(4.0), mapping);
    let mut builder = ShotBuilder::new(Camera::Spherical(camera.expect("a camera")), 4);
    builder.light(point_light(Vec3::new(0.36, 0.48, 0.8)));
    builder.fill(medium([1.0 - albedo; 3], [albedo; 3], g));
    builder.build()
}

/// Comparisons that need millions of samples.
mod statistics {
    use super::*;

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn connections_know_thick_matter_and_light_that_is_scattered_once() {
        check_thick(IntegratorKind::Bdpt, 4096);
        check_thick(IntegratorKind::Lvc, 4096);
        // Light tracing has no finite variance here, as vertices come as near to the lens as they like.
        let once = (IntegratorKind::Lvc, Some(1));
        check("once", &lamp_in_fog(), once, 8192, seen_of_lamp());
    }

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn light_around_a_lamp_is_that_of_photons_alone() {
        const G: f32 = 0.3;
        let fluence = fluence_by_photons(0.9, f64::from(G), 24_000_000);
        let expected = [fluence / (4.0 * PI); 3];
        for kind in [IntegratorKind::Bdpt, IntegratorKind::Lvc] {
            let shot = around_a_lamp(0.9, G);
            check("lamp", &shot, (kind, None), 12288, expected);
        }
    }
}
