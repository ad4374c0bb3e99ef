//! The numbers of samples of strategies in a plan, and the densities of paths that they give.

use super::Settings;
use super::constants::{BLOCK_PIXELS, LEAST_ALBEDO, LEAST_SHARE};
use crate::integrator::{CandidateCount, IntegratorKind, LvcSettings, group_size};
use crate::path::{PathRoulette, Shares};
use crate::strategy::Strategy;

/// The number of surfaces at which the roulette of a plan may begin: 0, 1 and 2.
pub(super) const STARTS: usize = 3;

/// The number of samples of each kind of strategy, relative to the survey. The elements of pairs are for t = 2 and
/// for t > 2.
pub(super) struct Counts {
    pub(super) next_events: [f64; 2],
    pub(super) connections: [f64; 2],
    pub(super) light_images: f64,
    /// The draws of connections with light walks. None: every connection with one light walk is made.
    pub(super) draws: Option<Draws>,
    /// The first surface at which roulette may end a walk.
    pub(super) start: usize,
}

impl Counts {
    /// Returns the counts of the estimator of `settings`, if a light subpath has `light_vertices` connectable
    /// vertices on average. `surveyed` is the roulette of the survey's walks.
    pub(super) fn new(
        settings: &Settings,
        surveyed: PathRoulette,
        light_vertices: f64,
        pixels: u64,
    ) -> Self {
        let lvc = &settings.lvc;
        let (next_events, connections, light_images) = match settings.integrator {
            IntegratorKind::Path => ([1.0; 2], [0.0; 2], 0.0),
            IntegratorKind::Light => ([0.0; 2], [0.0; 2], 1.0),
            IntegratorKind::Bdpt => ([1.0; 2], [1.0; 2], 1.0),
            IntegratorKind::Lvc | IntegratorKind::Auto => (
                lvc.next_events.get().map(f64::from),
                of_connections(lvc.candidates, light_vertices),
                1.0 / f64::from(lvc.samples_per_subpath.get()),
            ),
        };
        let start = match settings.path.roulette {
            PathRoulette::Albedo { start } if settings.path.roulette != surveyed => start as usize,
            _ => 0,
        };
        let shares_light = settings.integrator == IntegratorKind::Lvc;
        Self {
            next_events,
            connections,
            light_images,
            draws: shares_light.then(|| Draws::new(lvc, pixels)),
            start: start.min(STARTS - 1),
        }
    }

    /// Returns the number of samples of a connection with a light walk.
    pub(super) fn of_connection(&self, strategy: Strategy) -> f64 {
        self.connections[usize::from(strategy.t > 2)]
    }

    /// Returns ρ_j, the factor by which walks of the plan reach the last camera vertex of strategy j more often than
    /// walks of the survey.
    pub(super) fn longer(&self, shares: &Shares, j: usize) -> f64 {
        longer(shares.albedos)[self.surfaces(shares, j)]
    }

    /// Returns the number of surfaces that may end the walk of strategy j in the survey, but not in the plan: of the
    /// surfaces 0 to n - 3 - j, at which the walk continues.
    pub(super) fn surfaces(&self, shares: &Shares, j: usize) -> usize {
        let surfaces = (usize::from(shares.vertices) - j).saturating_sub(2);
        self.start.min(surfaces)
    }

    /// Returns D_k / D of a path.
    pub(super) fn density_ratio(&self, shares: &Shares) -> DensityRatio {
        let pair = |parts: [f32; 2], counts| dot(parts.map(f64::from), counts);
        let hits = f64::from(shares.hits) * self.longer(shares, 0);
        let next_events = pair(shares.next_events, self.next_events) * self.longer(shares, 1);
        let light_images = f64::from(shares.light_images) * self.light_images;
        let others = pair(shares.connections, self.connections) + light_images;
        DensityRatio {
            all: (hits + next_events + others).max(LEAST_SHARE),
            light_images,
        }
    }
}

/// The draws of connections from the light subpaths of a group.
pub(super) struct Draws {
    /// The number of candidates of each camera vertex, for t = 2 and for t > 2.
    pub(super) candidates: [f64; 2],
    /// The number of light subpaths of a group.
    pub(super) subpaths: f64,
    /// The mean number of other samples of a group in a block of 16 x 16 pixels.
    pub(super) neighbours: f64,
}

impl Draws {
    /// Returns the draws of `settings` in a film of `pixels` pixels.
    fn new(settings: &LvcSettings, pixels: u64) -> Self {
        let group = group_size(pixels);
        let of_block = BLOCK_PIXELS * group.min(pixels) as f64 / pixels as f64;
        Self {
            candidates: settings.candidates.get().map(f64::from),
            subpaths: (group as f64 / f64::from(settings.samples_per_subpath.get())).max(1.0),
            neighbours: (of_block - 1.0).max(0.0),
        }
    }
}

/// D_k / D of a path.
pub(super) struct DensityRatio {
    pub(super) all: f64,
    /// The part of t = 1.
    pub(super) light_images: f64,
}

/// Returns M / κ, the number of samples of a connection with a light walk, for t = 2 and t > 2. Without connectable
/// light vertices it does not matter, and is 1.
pub(super) fn of_connections(candidates: CandidateCount, light_vertices: f64) -> [f64; 2] {
    candidates.get().map(|count| match light_vertices {
        0.0 => 1.0,
        vertices => f64::from(count) / vertices,
    })
}

/// Returns the factors by which walks go on more often if their roulette begins at surface 0, 1 or 2, given the
/// albedos of surfaces 0 and 1.
pub(super) fn longer(albedos: [f32; 2]) -> [f64; STARTS] {
    let [a, b] = albedos.map(|albedo| f64::from(albedo.clamp(LEAST_ALBEDO, 1.0)));
    [1.0, 1.0 / a, 1.0 / (a * b)]
}

/// Returns a_0 b_0 + a_1 b_1.
pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_near;

    const SHARES: Shares = Shares {
        hits: 0.05,
        next_events: [0.0, 0.25],
        connections: [0.1, 0.2],
        light_images: 0.4,
        albedos: [0.5, 0.25],
        vertices: 5,
    };

    #[test]
    fn a_plan_takes_of_a_path_what_its_numbers_of_samples_are() {
        let ratio = |integrator| {
            let settings = Settings::new(integrator);
            let roulette = PathRoulette::Albedo { start: 0 };
            Counts::new(&settings, roulette, 4.0, 1 << 16)
                .density_ratio(&SHARES)
                .all
        };
        let (path, bdpt) = (0.05 / 0.5 + 0.25 / 0.5, 1.0);
        let lvc = 0.05 + 0.25 + 0.1 * 12.0 / 4.0 + 0.2 / 4.0 + 0.4 / 2.0;
        for (integrator, expected) in [
            (IntegratorKind::Path, path),
            (IntegratorKind::Bdpt, bdpt),
            (IntegratorKind::Lvc, lvc),
        ] {
            check_near(ratio(integrator), expected, 1e-6, integrator);
        }
    }

    #[test]
    fn walks_go_on_at_the_first_surfaces_of_a_path_that_has_them() {
        let settings = |start| {
            let mut settings = Settings::new(IntegratorKind::Path);
            settings.path.roulette = PathRoulette::Albedo { start };
            Counts::new(&settings, PathRoulette::Albedo { start: 0 }, 4.0, 1 << 16)
        };
        // The surfaces that the walk of a hit scatters at, and that of next-event estimation: n - 2 and n - 3.
        for (start, vertices, expected) in [
            (2, 2, 0.05 + 0.25),
            (2, 3, 0.05 / 0.5 + 0.25),
            (2, 4, 0.05 / 0.125 + 0.25 / 0.5),
            (2, 5, 0.3 / 0.125),
            (9, 5, 0.3 / 0.125),
            (1, 5, 0.3 / 0.5),
            (0, 5, 0.3),
        ] {
            let found = settings(start)
                .density_ratio(&Shares { vertices, ..SHARES })
                .all;
            check_near(found, expected, 1e-6, format!("{start}, {vertices}"));
        }
    }

    #[test]
    fn pixels_of_a_block_share_light_subpaths_with_a_part_of_each_other() {
        for (pixels, subpaths, neighbours) in [
            (256, 32.0, 63.0),
            (192 * 108, 512.0, 256.0 * 1024.0 / (192.0 * 108.0) - 1.0),
            (1920 * 1080, 1024.0, 0.0),
        ] {
            let draws = Draws::new(&LvcSettings::default(), pixels);
            check_near(draws.subpaths, subpaths, 1e-9, pixels);
            check_near(draws.neighbours, neighbours, 1e-9, pixels);
        }
    }
}
