#![allow(dead_code, reason = "every test file uses a part of this module")]
//! Small scenes in memory, for the tests of whole paths.

pub(crate) mod statistics;
pub(crate) mod walks;

use bidir::bsdf::{FacetScattering, Thickness};
use bidir::camera::{Camera, Perspective, PerspectiveSettings};
use bidir::driver::Settings;
use bidir::film::{FilmSettings, Filter};
use bidir::integrator::IntegratorKind;
use bidir::light::EmissionSides;
use bidir::material::{
    Anisotropy, Bitangent, CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial,
    ConductorIndex, Material, Mixture, NormalMap, PrincipledMaterial, Relief, Roughness,
    RoughnessMapping, ScaledColor, ScaledFloat,
};
use bidir::math::{Affine3A, Vec2, Vec3};
use bidir::medium::{Coefficients, Glow, HenyeyGreenstein, Medium, MediumId, MediumSides};
use bidir::path::PathSettings;
use bidir::scene::{Emission, MaterialId, Scene, SceneBuilder, SceneError};
use bidir::shape::{Mesh, Orientation, Shape, Sphere};
use bidir::spectrum::Rgb;
use bidir::texture::{ColorTexture, FloatTexture};
use bidir::view::View;
use statistics::Shown;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// The defaults of an integrator, with this limit of length.
pub(crate) fn settings(integrator: IntegratorKind, max_depth: Option<u32>) -> Settings {
    Settings {
        path: PathSettings {
            max_depth,
            ..PathSettings::default()
        },
        ..Settings::new(integrator)
    }
}

/// A camera at `eye` that looks along +z through a film of `size` pixels.
pub(crate) fn camera(eye: Vec3, size: u32, lens_radius: f32) -> Camera {
    camera_with(eye, size, 0.6, lens_radius)
}

/// A pinhole camera at `eye` that looks along +z, half as wide as `half_width` per distance.
pub(crate) fn narrow_camera(eye: Vec3, size: u32, half_width: f32) -> Camera {
    camera_with(eye, size, half_width, 0.0)
}

fn camera_with(eye: Vec3, size: u32, half_width: f32, lens_radius: f32) -> Camera {
    let settings = PerspectiveSettings {
        world_from_camera: Affine3A::from_translation(eye),
        resolution: Vec2::splat(size as f32),
        screen: [
            Vec2::new(-half_width, half_width),
            Vec2::new(half_width, -half_width),
        ],
        lens_radius,
        focal_distance: 3.0,
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

impl<'a> From<&'a Shot> for Shown<'a> {
    fn from(shot: &'a Shot) -> Self {
        Self {
            scene: &shot.scene,
            view: &shot.view,
        }
    }
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

    fn with_filter(camera: Camera, size: u32, filter: Filter) -> Self {
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

    pub(crate) fn build(self) -> Result<Shot, SceneError> {
        Ok(Shot {
            scene: self.scene.build()?,
            view: self.view,
        })
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

pub(crate) fn diffuse(reflectance: Rgb) -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant(reflectance),
    }
}

fn roughness(alpha: f32) -> Roughness {
    let texture = FloatTexture::Constant(alpha);
    Roughness {
        u: texture.clone(),
        v: texture,
        mapping: RoughnessMapping::Identity,
    }
}

pub(crate) fn metal(alpha: f32) -> Material {
    let reflectance = ColorTexture::Constant([0.9, 0.7, 0.4]);
    Material::Conductor {
        index: ConductorIndex::Reflectance(reflectance),
        roughness: roughness(alpha),
        scattering: FacetScattering::Multiple,
    }
}

pub(crate) fn glass(alpha: f32) -> Material {
    Material::Dielectric {
        eta: 1.5,
        roughness: roughness(alpha),
        scattering: FacetScattering::Multiple,
    }
}

fn coat(alpha: f32) -> CoatSettings {
    CoatSettings {
        eta: 1.5,
        roughness: roughness(alpha),
        thickness: FloatTexture::Constant(0.05),
        albedo: CLEAR,
        g: FloatTexture::Constant(0.0),
    }
}

pub(crate) fn varnish(alpha: f32) -> Material {
    let base = ColorTexture::Constant([0.7, 0.3, 0.1]);
    Material::CoatedDiffuse(CoatedDiffuseMaterial::new(coat(alpha), base))
}

pub(crate) fn lacquer(coat_alpha: f32, metal_alpha: f32) -> Material {
    let index = ConductorIndex::Reflectance(ColorTexture::Constant([0.9, 0.7, 0.4]));
    let metal = roughness(metal_alpha);
    Material::CoatedConductor(CoatedConductorMaterial::new(coat(coat_alpha), index, metal))
}

pub(crate) fn mix(materials: [Material; 2], amount: f32) -> Material {
    Material::Mix(Arc::new(Mixture {
        materials,
        amount: FloatTexture::Constant(amount),
    }))
}

/// Reflects and transmits.
pub(crate) fn paper() -> Material {
    Material::DiffuseTransmission {
        reflectance: ColorTexture::Constant([0.5, 0.3, 0.2]),
        transmittance: ColorTexture::Constant([0.2, 0.4, 0.7]),
        scale: 0.9,
    }
}

/// Brushed metal, rough plastic and rough glass by shares, under sheen and a rough coat.
pub(crate) fn principled_rough() -> Material {
    Material::Principled(Arc::new(PrincipledMaterial {
        color: ScaledColor::constant([0.8, 0.5, 0.3]),
        metallic: ScaledFloat::constant(0.4),
        roughness: ScaledFloat::constant(0.55),
        anisotropy: Anisotropy {
            strength: 0.6,
            direction: Vec2::new(0.8, 0.6),
            texture: None,
        },
        transmission: ScaledFloat::constant(0.4),
        thickness: Thickness::Solid,
        diffuse_transmission: ScaledFloat::constant(0.3),
        coat: ScaledFloat::constant(0.7),
        coat_roughness: ScaledFloat::constant(0.5),
        sheen: ScaledColor::constant([0.1, 0.3, 0.5]),
        sheen_roughness: ScaledFloat::constant(0.6),
        ..PrincipledMaterial::default()
    }))
}

/// Brushed metal and plastic under a coat of this roughness, which has the normals of the mesh or of a map.
pub(crate) fn principled_layers(roughness: f32, coat_normal: Option<NormalMap>) -> Material {
    Material::Principled(Arc::new(PrincipledMaterial {
        color: ScaledColor::constant([0.8, 0.5, 0.3]),
        metallic: ScaledFloat::constant(0.4),
        roughness: ScaledFloat::constant(0.6),
        anisotropy: Anisotropy {
            strength: 0.6,
            direction: Vec2::new(0.8, 0.6),
            texture: None,
        },
        coat: ScaledFloat::constant(0.8),
        coat_roughness: ScaledFloat::constant(roughness),
        coat_normal,
        sheen: ScaledColor::constant([0.1, 0.3, 0.5]),
        sheen_roughness: ScaledFloat::constant(0.6),
        ..PrincipledMaterial::default()
    }))
}

/// Plastic and glass by shares, smooth, under a smooth coat.
pub(crate) fn principled_smooth() -> Material {
    Material::Principled(Arc::new(PrincipledMaterial {
        color: ScaledColor::constant([0.8, 0.5, 0.3]),
        metallic: ScaledFloat::constant(0.1),
        roughness: ScaledFloat::constant(0.0),
        transmission: ScaledFloat::constant(0.5),
        thickness: Thickness::Solid,
        coat: ScaledFloat::constant(0.8),
        ..PrincipledMaterial::default()
    }))
}

/// A map of normals that are all tilted so far along x and y.
pub(crate) fn slant(x: f32, y: f32) -> NormalMap {
    NormalMap {
        texture: ColorTexture::Constant([(x + 1.0) / 2.0, (y + 1.0) / 2.0, 1.0]),
        scale: 1.0,
        bitangent: Bitangent::AlongV,
    }
}

/// The material under a map of normals, 45° steep.
pub(crate) fn slanted(material: Material) -> Material {
    material.with_relief(Relief::NormalMap(slant(0.9, -0.45)))
}

/// The parallelogram at `corner` with edges `a` and `b`; the front is the side of a × b.
pub(crate) fn quad(corner: Vec3, a: Vec3, b: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + a, corner + a + b, corner + b],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Eight triangles that face outwards.
pub(crate) fn octahedron(centre: Vec3, radius: f32) -> Mesh {
    let positions = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| [axis, -axis]);
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
        positions: positions
            .iter()
            .flatten()
            .map(|&axis| centre + axis * radius)
            .collect(),
        triangles: (0..8).map(triangle).collect(),
        ..Mesh::default()
    }
}

pub(crate) fn sphere(centre: Vec3, radius: f32) -> Shape {
    Shape::Sphere(Sphere::new(
        Affine3A::from_translation(centre),
        radius,
        Orientation::Natural,
    ))
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
            let wall = quad(corner, a * 4.0, b * 4.0);
            builder.shape(Shape::Mesh(wall), material, None);
        }
    }
}

/// Walls, a ceiling light, and floors and balls whose normals are far from those of the mesh: diffuse, metal,
/// plastic, and layers of which the coat has normals of its own. Nothing is a Dirac distribution.
pub(crate) fn steep_room(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    let wall = builder.material(slanted(diffuse([0.7, 0.6, 0.5])));
    add_walls(&mut builder, wall);
    let light = quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(Shape::Mesh(light), wall, emission([6.0, 5.0, 4.0]));
    let [coated, apart] = [None, Some(slant(-0.5, 0.3))].map(|map| principled_layers(0.5, map));
    let materials = [metal(0.4), varnish(0.3), glass(0.5), coated, apart];
    for (i, material) in (0u8..).zip(materials) {
        let material = builder.material(slanted(material));
        let x = -1.4 + 0.7 * f32::from(i);
        builder.shape(sphere(Vec3::new(x, -1.2, 0.3), 0.33), material, None);
        let panel = quad(Vec3::new(x - 0.3, -0.7, 1.8), Vec3::Y * 1.9, Vec3::X * 0.6);
        builder.shape(Shape::Mesh(panel), material, None);
    }
    builder.build().expect("the room is valid")
}

/// One-sided emission, as shapes take it.
#[expect(
    clippy::unnecessary_wraps,
    reason = "this is the type of the argument it stands for"
)]
pub(crate) fn emission(radiance: Rgb) -> Option<Emission> {
    Some(Emission {
        radiance,
        pattern: None,
        sides: EmissionSides::Front,
    })
}

/// Tilts the shading normals of a mesh: they are no longer the geometric ones.
pub(crate) fn tilt(mut mesh: Mesh, towards: Vec3) -> Mesh {
    let [a, b, c] = mesh.triangle(0);
    let n = (b - a).cross(c - a).normalize();
    mesh.normals = (0..mesh.positions.len())
        .map(|i| (n + towards * (0.3 + 0.2 * i as f32)).normalize())
        .collect();
    mesh
}

/// A closed room with a ceiling light, a sphere light, a tilted-normal panel, rough metal and
/// rough glass: every density differs from every other, and nothing is a Dirac distribution but
/// the lens.
pub(crate) fn room(lens_radius: f32) -> Shot {
    room_of(8, lens_radius)
}

/// The same with a film of `size` × `size` pixels.
pub(crate) fn room_of(size: u32, lens_radius: f32) -> Shot {
    let mut builder = builder(size, lens_radius);
    furnish(&mut builder);
    builder.build().expect("the room is valid")
}

/// The same full of fog, with a bubble that only absorbs.
pub(crate) fn foggy_room(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    furnish(&mut builder);
    let outside = builder.medium(medium([0.05, 0.1, 0.0], [0.1, 0.2, 0.4]));
    let inside = builder.medium(medium([0.2, 0.5, 1.0], [0.0; 3]));
    builder.medium_at(Vec3::new(0.0, 0.0, -1.8), outside);
    let bubble = sphere(Vec3::new(0.2, 0.3, 0.3), 0.6);
    builder.boundary(bubble, MediumSides { outside, inside });
    builder.build().expect("the room is valid")
}

/// The same with ink in the rough glass alone.
pub(crate) fn room_with_ink(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    let glass = furnish(&mut builder);
    let inside = builder.medium(medium([0.5, 0.2, 0.1], [0.4, 0.3, 0.0]));
    let outside = MediumId::VACUUM;
    builder.sides(glass, MediumSides { outside, inside });
    builder.build().expect("the room is valid")
}

/// The same with a ball of burning gas beside the glass.
pub(crate) fn room_with_fire(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    furnish(&mut builder);
    let gas = medium([0.5, 0.2, 0.1], [0.4, 0.3, 0.1]).glowing(Glow::Even([6.0, 3.0, 1.0]));
    let inside = builder.medium(gas.expect("light that can be computed with"));
    let outside = MediumId::VACUUM;
    let ball = sphere(Vec3::new(0.2, 0.3, 0.3), 0.6);
    builder.boundary(ball, MediumSides { outside, inside });
    builder.build().expect("the room is valid")
}

/// Fog, ink or gas.
fn medium(absorption: Rgb, scattering: Rgb) -> Medium {
    let coefficients = Coefficients::new(absorption, scattering).expect("valid coefficients");
    let phase = HenyeyGreenstein::new(0.4).expect("a mean cosine");
    Medium::homogeneous(coefficients, phase)
}

/// Walls, lights and the rest of [`room`]. Returns the number of the ball of rough glass.
fn furnish(builder: &mut ShotBuilder) -> usize {
    let wall = builder.material(diffuse([0.7, 0.6, 0.5]));
    let rough_metal = builder.material(metal(0.4));
    let rough_glass = builder.material(glass(0.5));
    add_walls(builder, wall);
    let light = quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(Shape::Mesh(light), wall, emission([6.0, 5.0, 4.0]));
    builder.shape(
        sphere(Vec3::new(1.3, -0.4, 0.8), 0.3),
        wall,
        emission([2.0, 3.0, 4.0]),
    );
    let panel = quad(Vec3::new(-1.8, -1.0, 1.5), Vec3::Y * 2.0, Vec3::X * 2.0);
    let panel = tilt(panel, Vec3::new(0.5, 0.8, 0.0));
    builder.shape(Shape::Mesh(panel), wall, None);
    builder.shape(sphere(Vec3::new(-0.8, -1.2, 0.2), 0.7), rough_metal, None);
    builder.shape(sphere(Vec3::new(0.6, -1.1, -0.2), 0.6), rough_glass, None)
}

/// A closed room with many lamps: a mesh, a ball, and quadrilaterals of one and of two sides, on the
/// walls and among what they light.
pub(crate) fn lamp_room(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    let wall = builder.material(diffuse([0.7, 0.6, 0.5]));
    let sheet = builder.material(paper());
    let rough_glass = builder.material(glass(0.5));
    add_walls(&mut builder, wall);
    let mesh = octahedron(Vec3::new(-0.9, 0.3, 0.4), 0.4);
    builder.shape(Shape::Mesh(mesh), wall, emission([2.0, 3.0, 4.0]));
    for i in 0..5u8 {
        let corner = Vec3::new(-1.5 + 0.6 * f32::from(i), 1.9 - 0.3 * f32::from(i % 3), 0.5);
        let light = quad(corner, Vec3::X * 0.2, Vec3::Z * 0.3);
        let sides = match i % 2 {
            0 => EmissionSides::Front,
            _ => EmissionSides::Both,
        };
        let emission = emission([6.0, 5.0, 4.0]).map(|light| Emission { sides, ..light });
        builder.shape(Shape::Mesh(light), wall, emission);
    }
    let ball = sphere(Vec3::new(1.3, -0.4, 0.8), 0.3);
    builder.shape(ball, wall, emission([2.0, 3.0, 4.0]));
    let hanging = quad(
        Vec3::new(0.4, -0.2, 1.0),
        Vec3::Y * 1.2,
        Vec3::new(1.0, 0.0, 0.4),
    );
    builder.shape(Shape::Mesh(hanging), sheet, None);
    builder.shape(sphere(Vec3::new(-0.2, -1.1, -0.2), 0.6), rough_glass, None);
    builder.build().expect("the room is valid")
}

/// A closed room of varnished walls with a ceiling light, a varnished panel with tilted normals, a
/// sheet of paper, and balls of lacquered metal and of a mixture.
pub(crate) fn gallery(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    let wall = builder.material(varnish(0.0));
    let panel = builder.material(varnish(0.3));
    let sheet = builder.material(paper());
    let metals = [lacquer(0.0, 0.4), lacquer(0.3, 0.3)].map(|metal| builder.material(metal));
    let mixture = builder.material(mix([metal(0.4), diffuse([0.3, 0.6, 0.9])], 0.5));
    add_walls(&mut builder, wall);
    let light = quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(Shape::Mesh(light), wall, emission([6.0, 5.0, 4.0]));
    let tilted = quad(Vec3::new(-1.8, -1.0, 1.5), Vec3::Y * 2.0, Vec3::X * 2.0);
    let tilted = tilt(tilted, Vec3::new(0.5, 0.8, 0.0));
    builder.shape(Shape::Mesh(tilted), panel, None);
    let hanging = quad(
        Vec3::new(0.4, -0.2, 1.0),
        Vec3::Y * 1.2,
        Vec3::new(1.0, 0.0, 0.4),
    );
    builder.shape(Shape::Mesh(hanging), sheet, None);
    builder.shape(sphere(Vec3::new(-0.8, -1.2, 0.2), 0.7), metals[0], None);
    builder.shape(sphere(Vec3::new(0.6, -1.3, -0.2), 0.4), metals[1], None);
    builder.shape(sphere(Vec3::new(1.3, -1.4, 0.8), 0.4), mixture, None);
    builder.build().expect("the gallery is valid")
}
