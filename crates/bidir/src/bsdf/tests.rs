//! Every value of [`Bsdf::examples`], from several directions, in each battery.

mod degenerate;
mod densities;
mod energy;
mod identities;
mod layers;
mod simulation;
mod stochastic;

use super::{Bsdf, TransportMode};
use crate::math::{Vec2, Vec3, sin_cos};
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::testing::check_variants;

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

/// Returns the unit direction with cosine `cos` at azimuth `phi`.
fn direction(cos: f32, phi: f32) -> Vec3 {
    let (y, x) = sin_cos(phi);
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * x, sin * y, cos)
}

/// Known directions: along the normal, oblique and grazing, from above and from below.
fn directions() -> [(&'static str, Vec3); 6] {
    let [normal, oblique, grazing] = [Vec3::Z, direction(0.7, 0.5), direction(0.1, 2.0)];
    [
        ("normal", normal),
        ("oblique", oblique),
        ("grazing", grazing),
        ("normal from below", -normal),
        ("oblique from below", -oblique),
        ("grazing from below", -grazing),
    ]
}

/// Every example from every direction, with a name.
fn cases() -> impl Iterator<Item = (String, Bsdf, Vec3)> {
    Bsdf::examples().into_iter().flat_map(|(name, bsdf)| {
        directions().map(|(from, wo)| (format!("{name}, {from}"), bsdf, wo))
    })
}

/// Returns the numbers that one scattering takes: for the lobe, and for the direction.
pub(super) fn numbers(sample: &SampleStream) -> (f32, Vec2) {
    let lobe = sample.get_1d(Dimension::at(2, Purpose::Lobe));
    (lobe, sample.get_2d(Dimension::at(2, Purpose::Scatter)))
}

/// Returns true where the surface looks alike from above and from below.
fn is_two_sided(bsdf: &Bsdf) -> bool {
    match bsdf {
        Bsdf::Dielectric(_) => false,
        Bsdf::Principled(bsdf) => !bsdf.is_solid(),
        _ => true,
    }
}

#[test]
fn every_variant_has_an_example() {
    check_variants!(Bsdf::examples().iter().map(|(_, bsdf)| bsdf), Bsdf:
        Diffuse Conductor Dielectric ThinDielectric DiffuseTransmission CoatedDiffuse CoatedConductor Principled);
}
