//! Fresnel's equations for unpolarised light.

use crate::math::{safe_sqrt, sqr};
use crate::spectrum::Spectrum;
use glam::Vec4;

/// Returns the reflectance of an interface between dielectrics.
///
/// `cos_i` is the cosine on the side that light arrives from: positive outside, negative inside.
/// `eta` is the index inside divided by the index outside. The value is the same for both
/// directions along one refracted path.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> f32 {
    // η_t / η_i for the side at hand.
    let ratio = if cos_i > 0.0 { eta } else { 1.0 / eta };
    let cos_i = cos_i.abs().min(1.0);
    let sin2_t = (1.0 - sqr(cos_i)) / sqr(ratio);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = safe_sqrt(1.0 - sin2_t);
    let parallel = (ratio * cos_i - cos_t) / (ratio * cos_i + cos_t);
    let perpendicular = (cos_i - ratio * cos_t) / (cos_i + ratio * cos_t);
    (sqr(parallel) + sqr(perpendicular)) / 2.0
}

/// Returns Schlick's weight (1-μ)⁵ [Schlick94, eq. 15].
#[inline]
pub fn schlick(cos: f32) -> f32 {
    let x = (1.0 - cos).clamp(0.0, 1.0);
    sqr(sqr(x)) * x
}

/// Returns the reflectance of a conductor with index `eta + i·k` against vacuum, all lanes at once
/// [Lagarde13, "Fresnel term of conductors"].
#[inline]
pub fn conductor(cos_i: f32, eta: Spectrum, k: Spectrum) -> Spectrum {
    let [eta2, k2] = [eta, k].map(|index| Vec4::from(index.0) * Vec4::from(index.0));
    let root = |lanes: Vec4| lanes.max(Vec4::ZERO).sqrt();
    let cos_i = cos_i.abs().min(1.0);
    let cos2 = sqr(cos_i);
    let sin2 = 1.0 - cos2;
    let difference = eta2 - k2 - sin2;
    let a2_plus_b2 = root(difference * difference + 4.0 * eta2 * k2);
    let a = root((a2_plus_b2 + difference) / 2.0);
    let cross = 2.0 * cos_i * a;
    let perpendicular = contrast(a2_plus_b2 + cos2, cross);
    let parallel = perpendicular * contrast(cos2 * a2_plus_b2 + sqr(sin2), cross * sin2);
    let mean = (perpendicular + parallel) / 2.0;
    Spectrum(mean.clamp(Vec4::ZERO, Vec4::ONE).to_array())
}

/// Returns (sum - cross) / (sum + cross); 1 where both are zero: at normal incidence for a black index of
/// zero, and at grazing incidence for the index of vacuum.
#[inline]
fn contrast(sum: Vec4, cross: Vec4) -> Vec4 {
    let is_any = (sum + cross).cmpgt(Vec4::ZERO);
    Vec4::select(is_any, (sum - cross) / (sum + cross), Vec4::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_near;

    #[test]
    fn known_reflectances() {
        // At Brewster's angle, tanθ = η, only the perpendicular part is left.
        let cos_brewster = 1.0 / (1.0f32 + 2.25).sqrt();
        let perpendicular = (2.25f32 - 1.0) / (2.25 + 1.0);
        let [eta, k] = [0.2, 3.0].map(Spectrum::splat);
        // Along a refracted path both directions reflect alike.
        let cos_t = (1.0f32 - (1.0 - 0.09) / (1.33 * 1.33)).sqrt();
        for (case, found, expected) in [
            ("normal", dielectric(1.0, 1.5), 0.04),
            ("normal, from within", dielectric(-1.0, 1.5), 0.04),
            (
                "gold",
                conductor(1.0, eta, k)[0],
                (0.64 + 9.0) / (1.44 + 9.0),
            ),
            (
                "Brewster",
                dielectric(cos_brewster, 1.5),
                sqr(perpendicular) / 2.0,
            ),
            ("total", dielectric(-0.5, 1.5), 1.0),
            ("grazing", dielectric(1e-7, 1.5), 1.0),
            ("both ways", dielectric(0.3, 1.33), dielectric(-cos_t, 1.33)),
        ] {
            check_near(found, expected, 1e-5, case);
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cos_i in [0.1, 0.4, 0.9] {
            let metal = conductor(cos_i, Spectrum::splat(1.5), Spectrum::ZERO)[0];
            check_near(metal, dielectric(cos_i, 1.5), 1e-5, cos_i);
        }
    }
}
