//! Textures against their formulas, each by a way of its own.

mod images;
mod mappings;
mod patterns;
mod ranges;

use super::TexturePoint;
use crate::math::{Vec2, Vec3};
use crate::shape::Differentials;
use crate::testing::check_near;

fn at(u: f32, v: f32) -> TexturePoint {
    TexturePoint::of_parameters(Vec2::new(u, v))
}

fn at_point(point: Vec3) -> TexturePoint {
    TexturePoint {
        point,
        ..at(0.0, 0.0)
    }
}

/// Returns a plane whose parameters are metres, seen by pixels of this width.
fn seen(uv: Vec2, width: f32) -> TexturePoint {
    let differentials = Differentials {
        dp_du: Vec3::X,
        dp_dv: Vec3::Y,
        dn_du: Vec3::ZERO,
        dn_dv: Vec3::ZERO,
    };
    TexturePoint::of_parameters(uv).seen(width, &differentials)
}

#[track_caller]
fn check(value: f32, expected: f32) {
    check_near(value, expected, 1e-5, "a texture");
}
