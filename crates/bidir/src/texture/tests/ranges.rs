//! Bounds of textures against their values at many points.

use super::super::*;
use super::at;
use crate::math::Affine3A;

fn image(texels: &[f32], wrap: Beyond, change: Change) -> FloatTexture {
    let texels = texels.iter().map(|&texel| [texel]).collect();
    FloatTexture::Image(Arc::new(ImageMap {
        image: Arc::new(Image::new(2, texels).unwrap().with_copies()),
        wrap: Wrap::all(wrap),
        filter: ImageFilter::Bilinear,
        change,
        mapping: Mapping::IDENTITY,
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
    for (found, expected) in [least, most].into_iter().zip(bounds) {
        assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
    }
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
    check(&plain(), [0.25, 0.75]);
    check(
        &image(&texels, Beyond::Black, Change::Scale(2.0)),
        [0.0, 1.5],
    );
    let inverted = image(&texels, Beyond::Clamp, Change::ScaleAndInvert(2.0));
    check(&inverted, [0.0, 0.5]);
    check(&scale(plain(), -2.0), [-1.5, -0.5]);
    check(&board([plain(), Constant(0.1)]), [0.1, 0.75]);
    check(
        &mix([plain(), Constant(2.0)], Constant(0.5)),
        [1.125, 1.375],
    );
    check(&mix([plain(), Constant(2.0)], Constant(1.0)), [2.0, 2.0]);
    check(&mix([Constant(0.2), Constant(0.4)], plain()), [0.25, 0.35]);
    check(&bilerp([0.5; 4]), [0.5, 0.5]);
}

#[test]
fn what_may_be_anything_has_no_bounds() {
    let noise = FloatTexture::Noise(Arc::new(Noise {
        kind: NoiseKind::Windy,
        space: TextureSpace::new(Affine3A::IDENTITY),
    }));
    let ends = [1.0, 2.0].map(FloatTexture::Constant);
    for texture in [
        noise.clone(),
        mix(ends, noise),
        bilerp([0.1, 0.2, 0.3, 0.4]),
    ] {
        assert_eq!(texture.range(), Range::ALL);
    }
}
