use super::{cases, numbers};
use crate::bsdf::{Bsdf, TransportMode};
use crate::testing::{Battery, Domain, Grid, samples};

/// Directions are drawn as the density says, and what it lacks to 1 is lost below the surface.
#[test]
fn samples_follow_the_density() {
    let grid = Grid {
        domain: Domain::sphere(),
        columns: 20,
        rows: 40,
    };
    let mut battery = Battery::new("BSDF densities");
    for (name, bsdf, wo) in cases().filter(|(_, bsdf, _)| !bsdf.is_delta()) {
        let two_sided = matches!(bsdf, Bsdf::Diffuse(_) | Bsdf::Conductor(_));
        if two_sided && wo.z < 0.0 {
            continue; // The same as from above.
        }
        let draws = samples(&name, 1 << 20).map(|sample| {
            let (u_lobe, u) = numbers(&sample);
            Some(bsdf.sample(wo, TransportMode::Radiance, u_lobe, u)?.wi)
        });
        battery.chi2(&name, &grid, |wi| bsdf.pdf(wo, wi), draws);
    }
    battery.check();
}
