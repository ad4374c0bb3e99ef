//! Section 3: how long walks are, and how many shadow rays that makes.
//!
//! In a closed room where every surface reflects the part ρ of the light, and a walk goes on with
//! the probability ρ, a camera walk has N_e surfaces with P(N_e = j) = (1 - ρ) ρ^{j-1}, and a light
//! walk N_l vertices, the point on the light being the first of them:
//!
//!   E(N_e) = 1 / (1 - ρ),   E(N_l) = 1 + 1 / (1 - ρ),
//!   E(N_l N_e) = E(N_l) E(N_e) = (2 - ρ) / (1 - ρ)²                       \[Lafortune95\].
//!
//! N_l N_e is the number of connections. Those whose ends face away from each other carry nothing
//! before any ray is traced, and this renderer traces none for them.

use crate::statistics::{Interval, mean_interval};
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::driver::{Resources, Session, SessionError, Settings};
use bidir::film::{FilmSettings, Filter};
use bidir::light::EmissionSides;
use bidir::material::Material;
use bidir::math::{Affine3A, Vec2, Vec3};
use bidir::path::{Connections, PathContext, PathSettings, Subpath, camera_subpath, light_subpath};
use bidir::sampler::{Dimension, Domain, Purpose, Sampler, SamplerKind};
use bidir::scene::{Emission, Scene, SceneBuilder, SceneError};
use bidir::shape::{Mesh, Shape};
use bidir::stats::Stats;
use bidir::texture::ColorTexture;
use rayon::prelude::*;

/// Walks are split into so many parts, whose means are independent.
const PARTS: u64 = 40;
/// Width and height of the film. Unit: pixels.
const SIZE: u32 = 64;

/// What was found in a room.
#[derive(Clone, Copy, Debug)]
pub struct Depths {
    /// The part of light that every surface reflects, ρ.
    pub albedo: f64,
    /// Surfaces of a camera walk, N_e.
    pub camera: Interval,
    /// N_l N_e.
    pub connections: Interval,
    /// Shadow rays for each sample if all that are not black are traced.
    pub traced: f64,
}

impl Depths {
    /// E(N_e) by the formula.
    pub fn expected_camera(&self) -> f64 {
        1.0 / (1.0 - self.albedo)
    }

    /// E(N_l N_e) by the formula.
    pub fn expected_connections(&self) -> f64 {
        (2.0 - self.albedo) / ((1.0 - self.albedo) * (1.0 - self.albedo))
    }

    /// Walks in a room of this albedo, so many from each end; intervals hold with `confidence`. None:
    /// it is not in (0, 1).
    ///
    /// Errors: no thread can be started.
    pub fn measure(albedo: f32, walks: u64, confidence: f64) -> Result<Option<Self>, SessionError> {
        let Ok(scene) = room(albedo) else {
            return Ok(None);
        };
        let parts: Vec<_> = (0..PARTS)
            .into_par_iter()
            .map(|part| means(&scene, part, walks.div_ceil(PARTS)))
            .collect();
        let interval = |which: usize| {
            let values: Vec<f64> = parts.iter().map(|means| means[which]).collect();
            mean_interval(&values, confidence)
        };
        let (Some(camera), Some(connections)) = (interval(0), interval(1)) else {
            return Ok(None);
        };
        Ok(Some(Self {
            albedo: f64::from(albedo),
            camera,
            connections,
            traced: traced(&scene, walks / 10)?,
        }))
    }
}

/// The settings of the paper: roulette by reflectivity, and no other end.
fn path_settings() -> PathSettings {
    super::setting().apply(&Settings::default()).path
}

/// The means of N_e and of N_l N_e over a part of the walks.
fn means(scene: &Scene, part: u64, walks: u64) -> [f64; 2] {
    let settings = path_settings();
    let context = PathContext {
        scene,
        settings: &settings,
        wavelengths: scene.color().sample_wavelengths(0.5),
        connections: Connections::ONE_SUBPATH,
    };
    let sampler = Sampler::new(SamplerKind::Independent, part);
    let (mut camera, mut light) = (Subpath::default(), Subpath::default());
    let mut stats = Stats::default();
    let mut sums = [0.0; 2];
    for walk in 0..walks {
        let stream = sampler.stream(Domain::Camera, 0, walk);
        let at = |purpose| stream.get_2d(Dimension::at(0, purpose));
        let raster = at(Purpose::Film) * SIZE as f32;
        let ray = scene.camera().sample_ray(raster, || at(Purpose::Lens));
        camera_subpath(&context, &stream, &ray, 1.0, &mut camera, &mut stats);
        let stream = sampler.stream(Domain::Light, 0, walk);
        light_subpath(&context, &stream, &mut light, &mut stats);
        // The lens is the first camera vertex, and is not counted.
        let surfaces = camera.vertices.len().saturating_sub(1) as f64;
        sums[0] += surfaces;
        sums[1] += surfaces * light.vertices.len() as f64;
    }
    sums.map(|sum| sum / walks as f64)
}

/// Shadow rays for each sample of a render that traces all.
fn traced(scene: &Scene, samples: u64) -> Result<f64, SessionError> {
    let settings = super::setting().apply(&Settings::default());
    let mut session = Session::new(scene, settings, &Resources::default())?;
    for _ in 0..samples.div_ceil(u64::from(SIZE * SIZE)) {
        session.step(&());
    }
    let stats = session.stats();
    Ok(stats.rays.connection as f64 / stats.samples as f64)
}

/// A closed cube with a light below its ceiling, all of one albedo, seen from inside.
fn room(albedo: f32) -> Result<Scene, SceneError> {
    let film = FilmSettings::new([SIZE; 2], Filter::default());
    let mut builder = SceneBuilder::new(film);
    let camera = Perspective::new(&PerspectiveSettings {
        world_from_camera: Affine3A::from_translation(Vec3::new(0.1, -0.2, -1.7)),
        resolution: Vec2::splat(SIZE as f32),
        screen: [Vec2::new(-0.6, 0.6), Vec2::new(0.6, -0.6)],
        lens_radius: 0.0,
        focal_distance: 1.0,
    });
    let camera = camera.ok_or(SceneError::NoCamera)?;
    builder.camera(Camera::Perspective(camera));
    let surface = builder.material(Material::Diffuse {
        reflectance: ColorTexture::Constant([albedo; 3]),
    });
    for axis in 0..3 {
        for sign in [-2.0, 2.0] {
            let at = |k: usize| Vec3::AXES[(axis + k) % 3];
            let corner = at(0) * sign - (at(1) + at(2)) * 2.0;
            let wall = parallelogram(corner, at(1) * 4.0, at(2) * 4.0);
            builder.shape(wall, surface, None);
        }
    }
    let emission = Emission {
        radiance: [10.0; 3],
        pattern: None,
        sides: EmissionSides::Front,
    };
    let light = parallelogram(Vec3::new(-0.5, 1.99, -0.5), Vec3::X, Vec3::Z);
    builder.shape(light, surface, Some(emission));
    builder.build()
}

/// The parallelogram at `corner` with edges `a` and `b`; the front is the side of a × b.
fn parallelogram(corner: Vec3, a: Vec3, b: Vec3) -> Shape {
    Shape::Mesh(Mesh {
        positions: vec![corner, corner + a, corner + a + b, corner + b],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_those_of_the_paper() {
        let some = Interval {
            value: 1.0,
            low: 1.0,
            high: 1.0,
        };
        let depths = Depths {
            albedo: 0.5,
            camera: some,
            connections: some,
            traced: 0.0,
        };
        // Σ j 2^{-j} = 2, and three times as many light vertices as ... (1 + 2) · 2.
        assert!((depths.expected_camera() - 2.0).abs() < 1e-12);
        assert!((depths.expected_connections() - 6.0).abs() < 1e-12);
    }

    /// Seeds are fixed; intervals of the few walks here are about 2 % wide.
    #[test]
    fn walks_are_as_long_as_the_formulas_say() {
        let depths = Depths::measure(0.5, 40_000, 0.95).unwrap().unwrap();
        let near = |interval: Interval, expected: f64| (interval.value / expected - 1.0).abs();
        assert!(near(depths.camera, 2.0) < 0.02, "{depths:?}");
        assert!(near(depths.connections, 6.0) < 0.03, "{depths:?}");
        assert!(
            depths.traced > 3.0 && depths.traced < depths.connections.value,
            "{depths:?}"
        );
    }
}
