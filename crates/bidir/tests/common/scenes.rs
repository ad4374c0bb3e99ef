#![allow(dead_code, reason = "every test uses a part of this module")]
//! Small scenes in memory, for the tests of units and of whole paths.

use super::materials::diffuse;
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::driver::{Resources, Session, Settings, render};
use bidir::film::{Film, FilmSettings, Filter};
use bidir::integrator::IntegratorKind;
use bidir::light::{EmissionSides, InfiniteLight, Light, PointLight};
use bidir::material::Material;
use bidir::math::{Affine3A, Vec2, Vec3};
use bidir::medium::{Coefficients, Grid, HenyeyGreenstein, Medium, MediumId, MediumSides};
use bidir::path::{Job, PathSettings};
use bidir::scene::{Emission, MaterialId, Scene, SceneBuilder};
use bidir::shape::{Mesh, Orientation, Shape, Sphere};
use bidir::spectrum::Rgb;
use bidir::view::View;
use std::ops::{Deref, DerefMut};

/// The defaults of an integrator, with this limit of length.
pub(crate) fn settings(integrator: IntegratorKind, max_depth: Option<u32>) -> Settings {
    let mut settings = Settings::new(integrator);
    settings.path.max_depth = max_depth;
    settings
}

/// The estimators of which no one chooses among others.
pub(crate) const METHODS: [IntegratorKind; 4] = [
    IntegratorKind::Path,
    IntegratorKind::Bdpt,
    IntegratorKind::Lvc,
    IntegratorKind::Light,
];

/// The integrators that walk subpaths from the camera.
pub(crate) const FROM_THE_CAMERA: [IntegratorKind; 3] = [METHODS[0], METHODS[1], METHODS[2]];

pub(crate) fn with_threads(threads: usize) -> Resources {
    Resources {
        threads,
        ..Resources::default()
    }
}

/// A camera at `eye` that looks along +z through a film of `size` pixels.
pub(crate) fn camera(eye: Vec3, size: u32, lens_radius: f32) -> Camera {
    camera_with(eye, size, 0.6, [lens_radius, 3.0])
}

/// A pinhole camera at `eye` that looks along +z, half as wide as `half_width` per distance.
pub(crate) fn narrow_camera(eye: Vec3, size: u32, half_width: f32) -> Camera {
    camera_with(eye, size, half_width, [0.0, 3.0])
}

/// The same with a lens of a radius and a focal distance.
pub(crate) fn camera_with(eye: Vec3, size: u32, half_width: f32, lens: [f32; 2]) -> Camera {
    let corner = Vec2::new(-half_width, half_width);
    let settings = PerspectiveSettings {
        world_from_camera: Affine3A::from_translation(eye),
        resolution: Vec2::splat(size as f32),
        screen: [corner, -corner],
        lens_radius: lens[0],
        focal_distance: lens[1],
    };
    Camera::Perspective(Perspective::new(&settings).expect("the camera is rigid"))
}

/// A scene with the view of it that is rendered.
pub(crate) struct Shot {
    pub(crate) scene: Scene,
    pub(crate) view: View,
}

impl Deref for Shot {
    type Target = Scene;

    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl Shot {
    pub(crate) fn session(&self, settings: Settings, threads: usize) -> Session<'_> {
        self.session_with(settings, &with_threads(threads))
    }

    pub(crate) fn session_with(&self, settings: Settings, resources: &Resources) -> Session<'_> {
        let session = Session::new(&self.scene, &self.view, settings, resources);
        session.expect("the film is small")
    }

    pub(crate) fn film(&self, settings: &Settings, passes: u64, threads: usize) -> Film {
        let resources = with_threads(threads);
        let film = render(&self.scene, &self.view, settings, passes, &resources);
        film.expect("the film is small")
    }

    pub(crate) fn job<'a>(&'a self, settings: &'a PathSettings) -> Job<'a> {
        Job::of_own_subpaths(&self.scene, &self.view, settings)
    }
}

/// Renders passes, which nobody stops.
pub(crate) fn steps(session: &mut Session<'_>, passes: u64) {
    (0..passes).for_each(|_| assert!(session.step(&()), "nobody stops it"));
}

/// A [`Shot`] in the making.
pub(crate) struct ShotBuilder {
    scene: SceneBuilder,
    view: View,
}

impl ShotBuilder {
    /// Looks with `camera` at a square film of `size` pixels and a box filter.
    pub(crate) fn new(camera: Camera, size: u32) -> Self {
        Self::with_filter(camera, size, Filter::default())
    }

    pub(crate) fn with_filter(camera: Camera, size: u32, filter: Filter) -> Self {
        let film = FilmSettings::new([size; 2], filter);
        Self {
            scene: SceneBuilder::new(),
            view: View::new(camera, film).expect("the film is not empty"),
        }
    }

    /// Looks with another camera.
    pub(crate) fn camera(&mut self, camera: Camera) {
        let film = self.view.film().clone();
        self.view = View::new(camera, film).expect("the film is not empty");
    }

    /// Adds a shape of a material of its own, and returns its number.
    pub(crate) fn add(&mut self, shape: Shape, material: Material) -> usize {
        let material = self.scene.material(material);
        self.scene.shape(shape, material, None)
    }

    /// Adds a grey shape that emits.
    pub(crate) fn lamp(&mut self, shape: Shape, radiance: Rgb) {
        let grey = self.scene.material(diffuse([0.5; 3]));
        self.scene.shape(shape, grey, emission(radiance));
    }

    /// Adds an even sky.
    pub(crate) fn sky(&mut self, radiance: Rgb) {
        self.scene.light(sky(radiance));
    }

    /// Fills everything with a medium.
    pub(crate) fn fill(&mut self, medium: Medium) -> MediumId {
        let medium = self.scene.medium(medium);
        self.scene.medium_at(Vec3::new(0.0, 0.0, -1.8), medium);
        medium
    }

    /// Makes a shape the boundary of a medium.
    pub(crate) fn bound(&mut self, shape: Shape, outside: MediumId, inside: MediumId) -> usize {
        self.scene.boundary(shape, MediumSides { outside, inside })
    }

    pub(crate) fn build(self) -> Shot {
        Shot {
            scene: self.scene.build().expect("the scene is valid"),
            view: self.view,
        }
    }
}

impl Deref for ShotBuilder {
    type Target = SceneBuilder;

    fn deref(&self) -> &SceneBuilder {
        &self.scene
    }
}

impl DerefMut for ShotBuilder {
    fn deref_mut(&mut self) -> &mut SceneBuilder {
        &mut self.scene
    }
}

/// A builder with a square film and a box filter, and the camera of [`camera`] at z = -1.8.
pub(crate) fn builder(size: u32, lens_radius: f32) -> ShotBuilder {
    builder_with(size, lens_radius, Filter::default())
}

/// The same with another filter.
pub(crate) fn builder_with(size: u32, lens_radius: f32, filter: Filter) -> ShotBuilder {
    let camera = camera(Vec3::new(0.0, 0.0, -1.8), size, lens_radius);
    ShotBuilder::with_filter(camera, size, filter)
}

/// The parallelogram at `corner` with edges `a` and `b`; the front is the side of a × b.
pub(crate) fn parallelogram(corner: Vec3, a: Vec3, b: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + a, corner + a + b, corner + b],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The same as a shape.
pub(crate) fn quad(corner: Vec3, a: Vec3, b: Vec3) -> Shape {
    Shape::Mesh(parallelogram(corner, a, b))
}

/// The same with parameters along its edges.
pub(crate) fn textured_quad(corner: Vec3, a: Vec3, b: Vec3) -> Shape {
    Shape::Mesh(Mesh {
        uvs: vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X],
        ..parallelogram(corner, a, b)
    })
}

/// The mesh with its shading normals tilted: they are no longer the geometric ones.
pub(crate) fn tilted(mut mesh: Mesh, towards: Vec3) -> Shape {
    let [a, b, c] = mesh.triangle(0);
    let n = (b - a).cross(c - a).normalize();
    let normal = |i: usize| (n + towards * (0.3 + 0.2 * i as f32)).normalize();
    mesh.normals = (0..mesh.positions.len()).map(normal).collect();
    Shape::Mesh(mesh)
}

/// Eight triangles that face outwards.
pub(crate) fn octahedron(centre: Vec3, radius: f32) -> Mesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let positions = axes.map(|axis| [centre + axis * radius, centre - axis * radius]);
    let corner = |axis: u32, sign: u32| 2 * axis + sign;
    let triangle = |signs: u32| {
        let [x, y, z] = [0, 1, 2].map(|axis| corner(axis, signs >> axis & 1));
        // An odd number of mirrors turns the winding.
        if signs.count_ones().is_multiple_of(2) {
            [x, y, z]
        } else {
            [x, z, y]
        }
    };
    Mesh {
        positions: positions.concat(),
        triangles: (0..8).map(triangle).collect(),
        ..Mesh::default()
    }
}

pub(crate) fn sphere(centre: Vec3, radius: f32) -> Shape {
    let map = Affine3A::from_translation(centre);
    Shape::Sphere(Sphere::new(map, radius, Orientation::Natural))
}

/// The inside of a cube of half width 2, its walls facing inwards.
pub(crate) fn add_walls(builder: &mut SceneBuilder, material: MaterialId) {
    for axis in 0..3 {
        for sign in [-2.0, 2.0] {
            let at = |k: usize| Vec3::AXES[(axis + k) % 3];
            let corner = at(0) * sign - (at(1) + at(2)) * 2.0;
            let (a, b) = if sign < 0.0 {
                (at(1), at(2))
            } else {
                (at(2), at(1))
            };
            builder.shape(quad(corner, a * 4.0, b * 4.0), material, None);
        }
    }
}

/// The lamp in the ceiling of rooms.
pub(crate) fn ceiling() -> Shape {
    quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z)
}

/// Walls of this material, and of light [6, 5, 4] from the ceiling. Returns the material.
pub(crate) fn add_lit_walls(builder: &mut ShotBuilder, material: Material) -> MaterialId {
    let wall = builder.material(material);
    add_walls(builder, wall);
    builder.shape(ceiling(), wall, emission([6.0, 5.0, 4.0]));
    wall
}

/// One-sided emission, as shapes take it.
#[expect(
    clippy::unnecessary_wraps,
    reason = "this is the type of the argument it stands for"
)]
pub(crate) fn emission(radiance: Rgb) -> Option<Emission> {
    Some(Emission {
        radiance: radiance.into(),
        pattern: None,
        sides: EmissionSides::Front,
    })
}

/// An even sky.
pub(crate) fn sky(radiance: Rgb) -> Light {
    Light::Infinite(InfiniteLight::constant(radiance))
}

/// A point light of intensity 1.
pub(crate) fn point_light(position: Vec3) -> Light {
    let intensity = [1.0; 3];
    Light::Point(PointLight {
        position,
        intensity: intensity.into(),
    })
}

pub(crate) fn coefficients(absorption: Rgb, scattering: Rgb) -> Coefficients {
    Coefficients::new(absorption, scattering).expect("valid coefficients")
}

pub(crate) fn phase(g: f32) -> HenyeyGreenstein {
    HenyeyGreenstein::new(g).expect("a mean cosine")
}

/// The same matter everywhere.
pub(crate) fn medium(absorption: Rgb, scattering: Rgb, g: f32) -> Medium {
    Medium::homogeneous(coefficients(absorption, scattering), phase(g))
}

/// A medium of a density in a box.
pub(crate) fn smoke(coefficients: Coefficients, density: Grid<1>, g: f32) -> Medium {
    Medium::of_density(coefficients, density, phase(g)).expect("thin smoke")
}
