//! Bounds of textures against their values at many points.

use super::super::*;
use super::at;
use crate::testing::{check_near, prelude::image_map};

fn image(texels: &[f32], wrap: Beyond, change: Change) -> FloatTexture {
    let texels = texels.iter().map(|&texel| [texel]).collect();
    FloatTexture::Image(Arc::new(ImageMap {
        wrap: Wrap::all(wrap),
        change,
        ..image_map(2, texels, ImageFilter::Bilinear)
    }))
}

fn mix(textures: [FloatTexture; 2], amount: FloatTexture) -> FloatTexture {
    FloatTexture::Mix(Arc::new(Mix { textures, amount }))
}

fn scale(texture: FloatTexture, factor: f32) -> FloatTexture {
    let factor = FloatTexture::Constant(factor);
    FloatTexture::Scale(Arc::new(Scale { texture, factor }))
}

fn bilerp(corners: [f32; 4]) -> FloatTexture {
    FloatTexture::Bilerp(Arc::new(Bilerp {
        corners,
        mapping: Mapping::IDENTITY,
    }))
}

fn board(textures: [FloatTexture; 2]) -> FloatTexture {
    FloatTexture::Checkerboard(Arc::new(Checkerboard {
        textures,
        cells: Cells::Plane(Mapping::IDENTITY),
    }))
}

/// Checks all values, inside the unit square and beyond, and that the bounds are these.
#[track_caller]
fn check(texture: &FloatTexture, bounds: [f32; 2]) {
    let Range { least, most } = texture.range();
    check_near(least, bounds[0], 1e-6, "least");
    check_near(most, bounds[1], 1e-6, "most");
    for i in 0..40 * 40 {
        let [u, v] = [i % 40, i / 40].map(|k| k as f32 * 0.1 - 1.53);
        let value = texture.eval(&at(u, v));
        assert!(least - 1e-6 <= value && value <= most + 1e-6, "{value}");
    }
}

#[test]
fn no_value_is_outside_of_its_bounds() {
    use Texture::Constant;
    let texels = [0.5, 0.25, 0.75, 0.5];
    let plain = || image(&texels, Beyond::Repeat, Change::Scale(1.0));
    let inverted = image(&texels, Beyond::Clamp, Change::ScaleAndInvert(2.0));
    for (texture, bounds) in [
        (plain(), [0.25, 0.75]),
        (
            image(&texels, Beyond::Black, Change::Scale(2.0)),
            [0.0, 1.5],
        ),
        (inverted, [0.0, 0.5]),
        (scale(plain(), -2.0), [-1.5, -0.5]),
        (board([plain(), Constant(0.1)]), [0.1, 0.75]),
        (mix([plain(), Constant(2.0)], Constant(0.5)), [1.125, 1.375]),
        (mix([plain(), Constant(2.0)], Constant(1.0)), [2.0, 2.0]),
        (mix([Constant(0.2), Constant(0.4)], plain()), [0.25, 0.35]),
        (bilerp([0.5; 4]), [0.5, 0.5]),
    ] {
        check(&texture, bounds);
    }
}

#[test]
fn what_may_be_anything_has_no_bounds() {
    let (kind, space) = (NoiseKind::Windy, TextureSpace::WORLD);
    let noise = FloatTexture::Noise(Arc::new(Noise { kind, space }));
    let ends = [1.0, 2.0].map(FloatTexture::Constant);
    let corners = bilerp([0.1, 0.2, 0.3, 0.4]);
    for texture in [noise.clone(), mix(ends, noise), corners] {
        assert_eq!(texture.range(), Range::ALL);
    }
}
