//! A contribution that is not finite is dropped, counted and listed, and harms nothing else.

use crate::common::prelude::*;
use bidir::material::Material;
use bidir::stats::LISTED_DROPS;
use bidir::texture::{ColorTexture, ImageFilter};
use std::sync::Arc;

/// A lit room with a panel whose texture has one NaN texel out of four.
fn room_with_a_broken_texture() -> Shot {
    let mut builder = builder(8, 0.0);
    add_lit_walls(&mut builder, diffuse([0.6; 3]));
    let texels = vec![[0.5; 3], [0.5; 3], [f32::NAN; 3], [0.5; 3]];
    let map = image_map(2, texels, ImageFilter::Point);
    let reflectance = ColorTexture::Image(Arc::new(map));
    let panel = textured_quad(Vec3::new(-1.0, -1.0, 1.5), Vec3::Y * 2.0, Vec3::X * 2.0);
    builder.add(panel, Material::Diffuse { reflectance });
    builder.build()
}

#[test]
fn nan_in_a_texture_is_dropped_and_counted() {
    let scene = room_with_a_broken_texture();
    for (name, integrator) in IntegratorKind::NAMES {
        let mut session = scene.session(Settings::new(integrator), 0);
        steps(&mut session, 16);
        let stats = session.stats();
        assert!(stats.dropped > 0, "{name}");
        let listed = stats.dropped_list.len() as u64;
        assert_eq!(listed, stats.dropped.min(LISTED_DROPS as u64), "{name}");
        let pixels = session.film().develop().pixels.concat();
        assert!(pixels.iter().all(|v| v.is_finite()), "{name}");
        assert!(pixels.iter().any(|v| *v > 0.0), "{name}");
    }
}
