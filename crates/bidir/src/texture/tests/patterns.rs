//! Mixtures, patterns and noise.

use super::super::*;
use super::{at, at_point, check, seen};
use crate::math::{PI, Vec2};
use crate::spectrum::luminance;
use crate::testing::prelude::fbm;

#[test]
fn mixtures_and_factors_follow_their_formulas() {
    let constant = ColorTexture::Constant;
    let mix = Texture::Mix(Arc::new(Mix {
        textures: [constant([1.0, 0.0, 2.0]), constant([3.0, 4.0, 0.0])],
        amount: FloatTexture::Constant(0.25),
    }));
    let scaled = Texture::Scale(Arc::new(Scale {
        texture: mix,
        factor: FloatTexture::Constant(2.0),
    }));
    for (value, expected) in scaled.eval(&at(0.0, 0.0)).into_iter().zip([3.0, 2.0, 3.0]) {
        check(value, expected);
    }
    assert_eq!(scaled.size(), 6);
    let direction = Texture::DirectionMix(Arc::new(DirectionMix {
        textures: [1.0, 0.0].map(FloatTexture::Constant),
        direction: Vec3::Y,
    }));
    for (normal, expected) in [
        (Vec3::Y, 1.0),
        (Vec3::X, 0.0),
        (Vec3::new(0.0, -0.6, 0.8), 0.6),
    ] {
        let at = TexturePoint {
            normal,
            ..at(0.0, 0.0)
        };
        check(direction.eval(&at), expected);
    }
}

#[test]
fn corners_have_their_values_and_the_middle_their_mean() {
    let bilerp = Texture::Bilerp(Arc::new(Bilerp {
        corners: [1.0, 2.0, 3.0, 5.0],
        mapping: Mapping::IDENTITY,
    }));
    for ([u, v], expected) in [
        ([0.0, 0.0], 1.0),
        ([1.0, 0.0], 2.0),
        ([0.0, 1.0], 3.0),
        ([1.0, 1.0], 5.0),
        ([0.5, 0.5], 2.75),
    ] {
        check(bilerp.eval(&at(u, v)), expected);
    }
}

#[test]
fn checkerboards_alternate_from_the_origin() {
    let board = |cells| {
        Texture::Checkerboard(Arc::new(Checkerboard {
            textures: [1.0, 0.0].map(FloatTexture::Constant),
            cells,
        }))
    };
    let plane = board(Cells::Plane(Mapping::IDENTITY));
    let space = board(Cells::Space(TextureSpace::WORLD));
    for i in -5..5_i32 {
        for j in -5..5_i32 {
            let even = |sum: i32| if sum & 1 == 0 { 1.0 } else { 0.0 };
            let (x, y) = (i as f32 + 0.3, j as f32 + 0.9);
            check(plane.eval(&at(x, y)), even(i + j));
            for k in -2..3_i32 {
                let p = Vec3::new(x, y, k as f32 + 0.5);
                check(space.eval(&at_point(p)), even(i + j + k));
            }
        }
    }
}

#[test]
fn noise_is_zero_at_whole_numbers_smooth_and_without_mean() {
    let mut sum = 0.0;
    let n = 20_000;
    for i in 0..n {
        let x = i as f32;
        let p = Vec3::new(x * 0.618, x * 0.414, x * 0.732) * 0.37;
        assert!(noise::noise(p.floor()).abs() <= 0.0);
        let value = noise::noise(p);
        assert!(value.abs() <= 1.05, "{value}");
        assert!((noise::noise(p + 1e-3) - value).abs() < 1e-2);
        sum += f64::from(value);
    }
    assert!((sum / f64::from(n)).abs() < 0.01, "{sum}");
}

/// If no octave is wider than a pixel, only the mean is left; without an extent all octaves are.
#[test]
fn octaves_finer_than_a_pixel_are_left_out() {
    let texture = |octaves| fbm(octaves, 0.5, TextureSpace::WORLD);
    let point = Vec3::new(0.3, 0.7, 0.2);
    let with = |width| TexturePoint {
        point,
        ..seen(Vec2::ZERO, width)
    };
    check(texture(8).eval(&with(10.0)), 0.0);
    let octaves = [(1.0, 1.0), (1.99, 0.5), (1.99 * 1.99, 0.25)];
    let expected = octaves.map(|(frequency, weight)| weight * noise::noise(point * frequency));
    let expected: f32 = expected.into_iter().sum();
    check(texture(3).eval(&with(0.0)), expected);
    // Between 2⁻⁴ and 2⁻³: three octaves of eight.
    check(texture(8).eval(&with(0.06)), texture(3).eval(&with(0.0)));
}

/// Dots are in about half of the cells, have the documented area, and stay in their cell.
#[test]
fn dots_cover_their_share() {
    let dots = Texture::Dots(Arc::new(Dots {
        textures: [0.0, 1.0].map(FloatTexture::Constant),
        mapping: Mapping::IDENTITY,
    }));
    let (cells, fine) = (40, 32);
    let mut with_dot = 0;
    for cell in 0..cells * cells {
        let corner = Vec2::new((cell % cells) as f32, (cell / cells) as f32) - 0.5;
        let inside = (0..fine * fine).filter(|i| {
            let offset = Vec2::new((i % fine) as f32 + 0.5, (i / fine) as f32 + 0.5);
            let uv = corner + offset / fine as f32;
            dots.eval(&at(uv.x, uv.y)) > 0.5
        });
        let share = inside.count() as f32 / (fine * fine) as f32;
        let is_dot = (share - PI * 0.35 * 0.35).abs() < 0.02;
        assert!(share == 0.0 || is_dot, "{share}");
        with_dot += usize::from(share > 0.0);
    }
    let share = with_dot as f32 / (cells * cells) as f32;
    assert!((0.3..0.7).contains(&share), "{share}");
}

/// Marble repeats along y with 2π without noise, and its colours are between those of its curve.
#[test]
fn marble_is_layered_along_y() {
    let marble = |variation| {
        ColorTexture::Marble(Arc::new(Marble {
            octaves: 8,
            roughness: 0.5,
            scale: 1.0,
            variation,
            space: TextureSpace::WORLD,
        }))
    };
    let [plain, disturbed] = [0.0, 0.5].map(marble);
    for i in 0..100 {
        let p = Vec3::new(0.3, i as f32 * 0.1, -2.0);
        let moved = Vec3::new(7.0, p.y + 2.0 * PI, 3.0);
        let (here, there) = (plain.eval(&at_point(p)), plain.eval(&at_point(moved)));
        assert!((luminance(here) - luminance(there)).abs() < 1e-3);
        for channel in disturbed.eval(&at_point(p)) {
            assert!((0.2 * 1.5..=0.61 * 1.5).contains(&channel), "{channel}");
        }
    }
}
