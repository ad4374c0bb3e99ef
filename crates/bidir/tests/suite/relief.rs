//! All estimators agree on surfaces with relief and filtered textures: a bumped floor, glossy or
//! diffuse in patches, and a ball under a map of normals, lit by an area light.
//!
//! The footprint of a pixel decides how fine textures and bumps are. It must be the same from
//! whichever end a path was walked.

use crate::common::prelude::*;
use bidir::bsdf::TransportMode;
use bidir::material::{Bitangent, Material, Mixture, NormalMap, Relief, ScaledFloat};
use bidir::path::{Job, PathSettings, Scattering, Vertex};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::RayDraws;
use bidir::texture::{
    Cells, Checkerboard, ColorTexture, FloatTexture, ImageFilter, Mapping, Scale, TextureSpace,
};
use std::sync::Arc;

/// Pixels in a row: wide enough for bumps and texels to be finer than some, and coarser than others.
const SIZE: u32 = 64;

/// An image of colours between `low` and `high` without order, many texels to a pixel.
fn image(low: Rgb, high: Rgb) -> ColorTexture {
    let n = 128;
    let part = |i: usize| ((i * 7919 + i / n * 104_729) % 251) as f32 / 250.0;
    let texel = |i: usize| {
        std::array::from_fn(|channel| {
            let part = part(i * 3 + channel);
            low[channel] * (1.0 - part) + high[channel] * part
        })
    };
    let texels = (0..n * n).map(texel).collect();
    ColorTexture::Image(Arc::new(image_map(n, texels, ImageFilter::Trilinear)))
}

fn bumps() -> Relief {
    let space = TextureSpace::new(Affine3A::from_scale(Vec3::splat(3.0)));
    Relief::Displacement(FloatTexture::Scale(Arc::new(Scale {
        texture: fbm(6, 0.6, space),
        factor: FloatTexture::Constant(0.12),
    })))
}

fn normals() -> Relief {
    Relief::NormalMap(NormalMap {
        texture: image([0.2, 0.2, 0.7], [0.8, 0.8, 1.0]),
        scale: 0.8,
        bitangent: Bitangent::AlongV,
    })
}

/// Bumped metal and bumped colours in patches, and colours of an image.
fn floor() -> Material {
    let cells = Cells::Plane(Mapping::Parameters {
        scale: Vec2::new(4.0, 3.0),
        offset: Vec2::ZERO,
    });
    let reflectance = image([0.1, 0.4, 0.1], [0.9, 0.6, 0.5]);
    let mixture = Mixture {
        materials: [metal(0.3), Material::Diffuse { reflectance }],
        amount: FloatTexture::Checkerboard(Arc::new(Checkerboard {
            textures: [0.2, 0.8].map(FloatTexture::Constant),
            cells,
        })),
    };
    Material::Mix(Arc::new(mixture)).with_relief(bumps())
}

fn add_floor(builder: &mut ShotBuilder, material: Material) {
    let corner = Vec3::new(-1.9, -1.3, -1.5);
    builder.add(
        textured_quad(corner, Vec3::Z * 3.3, Vec3::X * 3.8),
        material,
    );
}

fn room() -> Shot {
    let mut builder = builder(SIZE, 0.0);
    add_lit_walls(&mut builder, diffuse([0.6, 0.5, 0.4]));
    add_floor(&mut builder, floor());
    let ball = sphere(Vec3::new(-0.5, -0.6, 0.9), 0.6);
    builder.add(ball, metal(0.4).with_relief(normals()));
    builder.build()
}

fn render(scene: &Shot, integrator: IntegratorKind, passes: u64) -> Replicates {
    replicates(scene, &settings(integrator, Some(3)), passes)
}

#[test]
fn estimators_agree_on_relief() {
    let scene = room();
    let path = render(&scene, IntegratorKind::Path, 128);
    let bdpt = render(&scene, IntegratorKind::Bdpt, 48);
    let light = render(&scene, IntegratorKind::Light, 128);
    let quarters = [WHOLE, SIZE as usize / 2];
    check_agree("bdpt and path", &bdpt, &path, &quarters);
    check_agree("light and path", &light, &path, &quarters);
}

/// The relief is there: without it the picture is another one.
#[test]
fn relief_changes_the_picture() {
    let mean = |emboss: &dyn Fn(Material) -> Material| {
        let mut builder = builder(SIZE, 0.0);
        builder.lamp(ceiling(), [6.0; 3]);
        add_floor(&mut builder, emboss(diffuse([0.5; 3])));
        render(&builder.build(), IntegratorKind::Path, 64).mean()
    };
    let smooth = mean(&|material| material);
    for relief in [bumps(), normals(), Relief::NormalMap(slant(0.6, 0.0))] {
        let rough = mean(&|material| material.with_relief(relief.clone()));
        let name = format!("{smooth} and {rough}: {relief:.30?}");
        assert!((smooth - rough).abs() > 0.01 * smooth, "{name:.60}");
    }
}

/// The vertex where a ray from `origin` meets the floor at `target`.
fn vertex(job: &Job<'_>, origin: Vec3, target: Vec3) -> Vertex {
    let stream = Sampler::new(SamplerKind::Independent, 1).stream(Domain::Camera, 0, 0);
    let direction = (target - origin).normalize();
    let chances = RayDraws::new(&stream, 1);
    let hit = job.scene.intersect(origin, direction, chances);
    let hit = hit.expect("the floor is there");
    Vertex::surface(job, &hit, -direction, Spectrum::ONE, || 0.9)
}

/// The frame and the albedo of a point are the same from wherever a walk comes.
#[test]
fn a_point_looks_the_same_to_every_walk() {
    let mut builder = builder(SIZE, 0.0);
    add_floor(&mut builder, floor());
    let (floor, settings) = (builder.build(), PathSettings::default());
    let job = floor.job(&settings);
    for i in 0..64 {
        let along = Vec2::new(
            (0.3 + 0.618 * i as f32).fract(),
            (0.1 + 0.414 * i as f32).fract(),
        );
        let target = Vec3::new(-1.7 + 3.4 * along.x, -1.3, -1.3 + 2.9 * along.y);
        let near = vertex(&job, target + Vec3::new(0.01, 0.02, 0.01), target);
        let far = vertex(&job, target + Vec3::new(7.0, 40.0, -9.0), target);
        let [near, far] = [near, far].map(|vertex| match vertex.scattering {
            Scattering::Surface(bsdf) => (vertex.frame.z, bsdf.albedo(Vec3::Z)[0]),
            Scattering::Camera | Scattering::Light | Scattering::Medium(_) => {
                panic!("it is on the floor")
            }
        });
        let turn = near.0.distance(far.0);
        assert!(turn < 2e-2, "the normal turns by {turn}");
        let (near, far) = (near.1, far.1);
        assert!((near - far).abs() < 1e-2, "albedos of {near} and {far}");
    }
}

/// Returns the integral over directions above the floor of `value`, at the point of this material that is seen along `wo`.
fn above(material: Material, wo: Vec3, value: impl Fn(&Vertex, &Job<'_>, Vec3) -> f32) -> f32 {
    let mut builder = builder(SIZE, 0.0);
    add_floor(&mut builder, material);
    let (floor, settings) = (builder.build(), PathSettings::default());
    let job = floor.job(&settings);
    let target = Vec3::new(0.2, -1.3, 0.3);
    let seen = vertex(&job, target + wo, target);
    let n = 200;
    let value = |i: i32| {
        // Even over the upper hemisphere.
        let at = |k: i32, of: i32| (k as f32 + 0.5) / of as f32;
        let (y, phi) = (at(i % n, n), 2.0 * PI * at(i / n, 2 * n));
        let r = (1.0 - y * y).sqrt();
        let wi = Vec3::new(r * libm::cosf(phi), y, r * libm::sinf(phi));
        value(&seen, &job, wi) * 2.0 * PI
    };
    (0..2 * n * n).map(value).sum::<f32>() / (2 * n * n) as f32
}

/// The light that a point under a slant sends along `wo` in a furnace: the mean weight of walks.
fn furnace(material: Material, wo: Vec3) -> f32 {
    above(material, wo, |seen, job, wi| {
        let event = seen.event(seen.wo, wi, TransportMode::Radiance);
        event.scatter(job)[0] * wi.y
    })
}

/// Walks from a light draw by the normal as it is, whatever the camera sees of it, and take the opposite of directions
/// below the surface.
#[test]
fn densities_of_light_walks_under_a_slant_integrate_to_one() {
    let wo = Vec3::new(0.3, 0.9, -0.2).normalize();
    for (x, y) in [(0.0, 0.0), (0.4, 0.4), (0.0, -0.6), (-0.9, 0.45)] {
        let relief = Relief::NormalMap(slant(x, y));
        let drawn = above(
            diffuse([0.5; 3]).with_relief(relief),
            wo,
            |seen, job, wi| {
                let event = seen.event(seen.wo, wi, TransportMode::Importance);
                event.pdf(job)
            },
        );
        assert!((drawn - 1.0).abs() < 2e-3, "{x}, {y}: {drawn}");
    }
}

/// A white surface under normals that face away from the viewer is nearly as bright as without.
#[test]
fn relief_is_not_black_at_grazing_angles() {
    let slants = [(0.58, 0.0), (0.4, 0.4), (0.0, -0.6), (-0.2, 0.5)];
    for degrees in [75.0f32, 80.0, 85.0, 88.0] {
        let (sin, cos) = libm::sincosf(degrees.to_radians());
        for turn in 0..4 {
            let (y, x) = libm::sincosf(f32::from(turn as u8) * 1.5);
            let wo = Vec3::new(x * sin, cos, y * sin);
            for (x, y) in slants {
                let relief = Relief::NormalMap(slant(x, y));
                let kept = furnace(diffuse([1.0; 3]).with_relief(relief), wo);
                // A slope s that faces the viewer loses the light below its horizon.
                let slope = libm::hypotf(x, y);
                let least = (1.0 + 1.0 / libm::hypotf(slope, 1.0)) / 2.0 - 5e-3;
                let is_kept = kept >= least && kept < 1.005;
                assert!(is_kept, "{degrees}, {turn}, {x}, {y}: {kept}");
            }
        }
    }
}

/// The light of a furnace that a plate under a slant shows to a camera that looks `degrees` off its normal.
fn shown(material: &Material, degrees: f32) -> f64 {
    let (sin, cos) = libm::sincosf(degrees.to_radians());
    let camera = narrow_camera(Vec3::new(0.0, 0.0, -1.8), 4, 1e-3);
    let mut builder = ShotBuilder::new(camera, 4);
    builder.sky([1.0; 3]);
    let (across, away) = (Vec3::Y, Vec3::new(cos, 0.0, sin));
    let plate = textured_quad(-across - away, across * 2.0, away * 2.0);
    builder.add(plate, material.clone());
    render(&builder.build(), IntegratorKind::Path, 96).mean()
}

/// What is diffuse under facets, smooth or rough, shows most of the light that it shows without relief, from wherever it
/// is seen: what the facets mirror does not get lost below the horizon.
#[test]
fn plastic_keeps_its_light_under_relief() {
    let plastic = |roughness: f32| {
        principled(|material| {
            material.metallic = ScaledFloat::constant(0.0);
            material.roughness = ScaledFloat::constant(roughness);
        })
    };
    let plastics = [0.0, 0.3, 0.6, 1.0].map(plastic).into_iter();
    for material in plastics.chain([0.0, 0.2].map(varnish)) {
        for degrees in [40.0, 60.0, 80.0] {
            let flat = shown(&material, degrees);
            for away in [0.35, 0.9] {
                let relief = Relief::NormalMap(slant(away, 0.1));
                let kept = shown(&material.clone().with_relief(relief), degrees) / flat;
                // Slopes that face the viewer lose the light below their horizons: at 40°, 0.13 of it.
                let (kind, is_kept) = (material.kind(), kept > 0.8 && kept * flat < 1.02);
                assert!(is_kept, "{kind}, {degrees}, {away}: {kept} of {flat}");
            }
        }
    }
}
