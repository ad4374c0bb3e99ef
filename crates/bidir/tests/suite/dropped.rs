//! A contribution that is not finite is dropped, counted and listed, and harms nothing else.

use crate::common::Shot;
use crate::common::{add_walls, builder, diffuse, emission, quad};
use bidir::driver::{Resources, Session, Settings};
use bidir::integrator::IntegratorKind;
use bidir::material::Material;
use bidir::math::{Vec2, Vec3};
use bidir::shape::Shape;
use bidir::stats::LISTED_DROPS;
use bidir::texture::{Beyond, Change, ColorTexture, Image, ImageFilter, ImageMap, Mapping, Wrap};
use std::sync::Arc;

/// A lit room with a panel whose texture has one NaN texel out of four.
fn room_with_a_broken_texture() -> Shot {
    let mut builder = builder(8, 0.0);
    let wall = builder.material(diffuse([0.6; 3]));
    add_walls(&mut builder, wall);
    let light = quad(Vec3::new(-0.7, 1.9, -0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(Shape::Mesh(light), wall, emission([5.0; 3]));
    let texels = vec![[0.5; 3], [0.5; 3], [f32::NAN; 3], [0.5; 3]];
    let image = Arc::new(Image::new(2, texels).expect("two rows of two texels"));
    let map = ImageMap {
        image,
        wrap: Wrap::all(Beyond::Clamp),
        filter: ImageFilter::Point,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    };
    let broken = builder.material(Material::Diffuse {
        reflectance: ColorTexture::Image(Arc::new(map)),
    });
    let mut panel = quad(Vec3::new(-1.0, -1.0, 1.5), Vec3::Y * 2.0, Vec3::X * 2.0);
    panel.uvs = vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X];
    builder.shape(Shape::Mesh(panel), broken, None);
    builder.build().expect("the room is valid")
}

#[test]
fn nan_in_a_texture_is_dropped_and_counted() {
    let scene = room_with_a_broken_texture();
    for (name, integrator) in IntegratorKind::NAMES {
        let settings = Settings::new(integrator);
        let resources = Resources::default();
        let mut session = Session::new(&scene.scene, &scene.view, settings, &resources)
            .expect("the film is small");
        (0..16).for_each(|_| assert!(session.step(&())));
        let stats = session.stats();
        assert!(stats.dropped > 0, "{name}");
        let listed = stats.dropped_list.len() as u64;
        assert_eq!(listed, stats.dropped.min(LISTED_DROPS as u64), "{name}");
        let picture = session.film().develop();
        assert!(
            picture.pixels.iter().flatten().all(|v| v.is_finite()),
            "{name}"
        );
        assert!(picture.pixels.iter().flatten().any(|v| *v > 0.0), "{name}");
    }
}
