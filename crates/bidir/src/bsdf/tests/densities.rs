use super::{cases, is_two_sided, numbers};
use crate::bsdf::TransportMode;
use crate::testing::{Battery, Domain, Grid, samples};

/// Directions follow the density, and the part that it lacks to 1 is lost below the surface.
#[track_caller]
fn check(is_taken: impl Fn(&str) -> bool) {
    let grid = Grid::new(Domain::sphere(), [20, 40]);
    let mut battery = Battery::new("BSDF densities");
    for (name, bsdf, wo) in cases().filter(|(_, bsdf, _)| !bsdf.is_delta()) {
        // From below a two-sided surface looks the same.
        if !is_taken(&name) || is_two_sided(&bsdf) && wo.z < 0.0 {
            continue;
        }
        let draws = samples(&name, 1 << 20).map(|sample| {
            let (u_lobe, u) = numbers(&sample);
            let drawn = bsdf.sample(wo, TransportMode::Radiance, || u_lobe, u)?;
            // The part of a Dirac lobe is not in the density.
            (!drawn.is_delta).then_some(drawn.wi)
        });
        let pdf = |wi| bsdf.eval(wo, wi, TransportMode::Radiance).pdf;
        battery.chi2(&name, &grid, pdf, draws);
    }
    battery.check();
}

#[test]
fn samples_follow_the_density() {
    check(|name| name.contains("oblique"));
}

/// Directions that make the battery long.
mod statistics {
    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn samples_follow_the_density_along_the_normal_and_grazing() {
        super::check(|name| !name.contains("oblique"));
    }
}
