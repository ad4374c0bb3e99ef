//! Normals that turn, and those that do not.

use super::*;
use crate::math::sin_cos;

const LOBES: [Lobes; 4] = [
    Lobes::Diffuse(0.0),
    Lobes::Diffuse(0.5),
    Lobes::Diffuse(1.0),
    Lobes::Glossy,
];

/// Unit directions and normals, each pair on one side: the first is the geometric normal's.
fn cases() -> impl Iterator<Item = [Vec3; 2]> {
    let at = |i: u16, z: f32| {
        let (sin, cos) = sin_cos(2.4 * f32::from(i));
        (Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt()).with_z(z)
    };
    let pairs = (0..40).flat_map(|i| (0..40).map(move |j| (i, j)));
    pairs.map(move |(i, j)| {
        let o = at(i, 0.01 + 0.98 * (f32::from(i) * 0.618).fract());
        [
            o,
            at(3 * j + 1, 0.05 + 0.95 * (f32::from(j) * 0.414).fract()),
        ]
    })
}

/// The normal is one that the camera sees by its rule, on the front, and as it was where it may be.
#[test]
fn turned_normals_are_seen() {
    let n_g = Vec3::Z;
    let mut turns = [0; 4];
    for [o, n_s] in cases() {
        for (i, lobes) in LOBES.into_iter().enumerate() {
            let n = turned(n_s, n_g, o, lobes).unwrap_or(n_s);
            let mirrored = n * (2.0 * n.dot(o)) - o;
            let (seen, least) = match lobes {
                Lobes::Diffuse(gloss) => (n.dot(o), least_diffuse_cosine(o.z, gloss)),
                Lobes::Glossy => (mirrored.z, least_cosine(o.z)),
            };
            assert!((n.length() - 1.0).abs() < 1e-4 && n.z > 0.0 && n.dot(o) > 0.0);
            let is_turned = n != n_s;
            turns[i] += usize::from(is_turned);
            let is_least = seen > least - 1e-4 && (!is_turned || seen < least + 1e-3);
            assert!(is_least, "{seen}, {least}: {o}, {n_s}, {lobes:?}");
            // Where all see what is mirrored above the surface, none turns.
            let along = n_s.dot(o);
            let height = 2.0 * along * n_s.z - o.z;
            assert!(!is_turned || height < least_cosine(o.z));
            // Seen from below, and with all on the other side, it is the same.
            let below = turned(-n_s, -n_g, o, lobes).unwrap_or(-n_s);
            assert!(below.distance(-n) < 1e-5);
        }
        assert!(turned(n_g, n_g, o, Lobes::Glossy).is_none());
    }
    assert!(turns.iter().all(|&turns| turns > 200), "{turns:?}");
}

/// It turns steadily: near directions see near normals.
#[test]
fn turned_normals_are_continuous() {
    for [o, n_s] in cases() {
        let near = (o + Vec3::new(1e-4, -1e-4, 5e-5)).normalize();
        for lobes in LOBES {
            let [a, b] = [o, near].map(|o| turned(n_s, Vec3::Z, o, lobes).unwrap_or(n_s));
            assert!(a.distance(b) < 0.02, "{a}, {b}: {o}, {n_s}, {lobes:?}");
        }
    }
}
