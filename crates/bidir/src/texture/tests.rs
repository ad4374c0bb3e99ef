//! Textures against their formulas, each by a way of its own.

use super::*;
use crate::math::{Affine3A, PI, Vec2, square_to_direction};
use crate::shape::Differentials;
use crate::spectrum::luminance;

fn at(u: f32, v: f32) -> TexturePoint {
    TexturePoint::of_parameters(Vec2::new(u, v))
}

fn at_point(point: Vec3) -> TexturePoint {
    TexturePoint {
        point,
        ..at(0.0, 0.0)
    }
}

/// A plane whose parameters are metres, seen by pixels of this width.
fn seen(uv: Vec2, width: f32) -> TexturePoint {
    let differentials = Differentials {
        dp_du: Vec3::X,
        dp_dv: Vec3::Y,
        dn_du: Vec3::ZERO,
        dn_dv: Vec3::ZERO,
    };
    TexturePoint::of_parameters(uv).seen(width, &differentials)
}

fn map(wrap: Wrap, filter: ImageFilter) -> ImageMap<1> {
    let image = Image::new(2, vec![[1.0], [2.0], [3.0], [4.0]]).unwrap();
    ImageMap {
        image: Arc::new(image.with_copies()),
        wrap,
        filter,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    }
}

#[track_caller]
fn check(value: f32, expected: f32) {
    assert!(
        (value - expected).abs() < 1e-5,
        "{value} instead of {expected}"
    );
}

#[test]
fn the_top_row_is_at_v_one() {
    let point = map(Wrap::Repeat, ImageFilter::Point);
    for ([u, v], expected) in [
        ([0.25, 0.75], 1.0),
        ([0.75, 0.75], 2.0),
        ([0.25, 0.25], 3.0),
    ] {
        check(point.eval(&at(u, v))[0], expected);
    }
}

#[test]
fn texel_centres_keep_their_value_and_the_middle_is_the_mean() {
    for filter in [ImageFilter::Bilinear, ImageFilter::Trilinear] {
        let map = map(Wrap::Repeat, filter);
        check(map.eval(&at(0.25, 0.75))[0], 1.0);
        check(map.eval(&at(0.5, 0.5))[0], 2.5);
    }
}

#[test]
fn borders_wrap_as_asked() {
    let value = |wrap, filter, u, v| map(wrap, filter).eval(&at(u, v))[0];
    check(value(Wrap::Repeat, ImageFilter::Point, -0.75, 1.75), 1.0);
    check(value(Wrap::Clamp, ImageFilter::Point, 7.0, -3.0), 4.0);
    check(value(Wrap::Black, ImageFilter::Point, 1.25, 0.5), 0.0);
    check(value(Wrap::Black, ImageFilter::Bilinear, 0.0, 0.75), 0.5);
    for wrap in [
        Wrap::Repeat,
        Wrap::Clamp,
        Wrap::Black,
        Wrap::OctahedralSphere,
    ] {
        let far = map(wrap, ImageFilter::Bilinear).eval(&at(f32::MAX, -1e30));
        assert!(far[0].is_finite());
    }
}

#[test]
fn values_are_scaled_before_they_are_inverted() {
    let mut map = map(Wrap::Black, ImageFilter::Point);
    map.change = Change::ScaleAndInvert(0.25);
    check(map.eval(&at(0.25, 0.75))[0], 0.75);
    check(map.eval(&at(0.75, 0.25))[0], 0.0);
    check(map.eval(&at(7.0, 0.0))[0], 1.0);
}

/// Beyond a border lies what is near on the sphere: the direction of every texel that bilinear look-up
/// reaches is near the direction of its neighbours.
#[test]
fn octahedral_maps_have_no_border() {
    let n = 16;
    let directions = (0..n * n).map(|i| {
        let p = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
        square_to_direction(p).to_array()
    });
    let map = ImageMap {
        image: Arc::new(Image::new(n, directions.collect()).unwrap()),
        wrap: Wrap::OctahedralSphere,
        filter: ImageFilter::Point,
        change: Change::Scale(1.0),
        mapping: Mapping::IDENTITY,
    };
    let texel = 1.0 / n as f32;
    for i in 0..n {
        let along = (i as f32 + 0.5) * texel;
        let inside = [
            [0.5 * texel, along],
            [1.0 - 0.5 * texel, along],
            [along, 0.5 * texel],
            [along, 1.0 - 0.5 * texel],
        ];
        let outward = [[-texel, 0.0], [texel, 0.0], [0.0, -texel], [0.0, texel]];
        for (uv, step) in inside.into_iter().zip(outward) {
            let here = Vec3::from(map.eval(&at(uv[0], uv[1])));
            let beyond = Vec3::from(map.eval(&at(uv[0] + step[0], uv[1] + step[1])));
            assert!(here.distance(beyond) < 5.0 * texel, "{here} and {beyond}");
        }
    }
}

/// At a pixel as wide as 2^k texels the value is that of copy k, between copies it is between them;
/// far away it is the mean.
#[test]
fn copies_are_chosen_by_the_width_of_a_pixel() {
    let n = 64;
    let texels = (0..n * n).map(|i| [((i * 7919) % 251) as f32]);
    let image = Arc::new(Image::new(n, texels.collect()).unwrap().with_copies());
    let map = ImageMap {
        image: Arc::clone(&image),
        filter: ImageFilter::Trilinear,
        ..map(Wrap::Repeat, ImageFilter::Trilinear)
    };
    let uv = Vec2::new(0.37, 0.61);
    let of_copy = |level: usize| {
        let image = Arc::new(image.copy(level).clone());
        let filter = ImageFilter::Bilinear;
        ImageMap {
            image,
            filter,
            ..map.clone()
        }
        .eval(&at(uv.x, uv.y))[0]
    };
    let texel = 1.0 / n as f32;
    check(map.eval(&seen(uv, 0.7 * texel))[0], of_copy(0));
    for level in 0..=6_usize {
        let width = texel * (1 << level) as f32;
        let value = map.eval(&seen(uv, width))[0];
        assert!((value - of_copy(level)).abs() < 1e-3, "{level}");
    }
    let between = map.eval(&seen(uv, 2f32.sqrt() * texel))[0];
    assert!((between - f32::midpoint(of_copy(0), of_copy(1))).abs() < 1e-3);
    let mean = image.texels().iter().map(|texel| texel[0]).sum::<f32>() / (n * n) as f32;
    assert!((map.eval(&seen(uv, 100.0))[0] - mean).abs() < 1e-3);
}

/// Stretched parameters: the direction in which texels are widest decides, so nothing is blurred.
#[test]
fn stretched_images_are_not_blurred() {
    let mut map = map(Wrap::Repeat, ImageFilter::Trilinear);
    map.mapping = Mapping::Parameters {
        scale: Vec2::new(100.0, 0.1),
        offset: Vec2::ZERO,
    };
    let uv = Vec2::new(0.0025, 7.5);
    check(map.eval(&seen(uv, 1.0))[0], 1.0);
}

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
        check(
            direction.eval(&TexturePoint {
                normal,
                ..at(0.0, 0.0)
            }),
            expected,
        );
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
fn mappings_know_their_directions() {
    let spherical = Mapping::Spherical(TextureSpace::WORLD);
    let cylindrical = Mapping::Cylindrical(TextureSpace::WORLD);
    for (p, on_sphere, on_cylinder) in [
        (Vec3::X, [0.5, 0.0], [0.5, 0.0]),
        (Vec3::Y * 3.0, [0.5, 0.25], [0.75, 0.0]),
        (-Vec3::Y, [0.5, 0.75], [0.25, 0.0]),
        (Vec3::new(1.0, 0.0, 1.0), [0.25, 0.0], [0.5, 1.0]),
        (Vec3::new(0.0, 1.0, -1.0), [0.75, 0.25], [0.75, -1.0]),
    ] {
        for (mapping, expected) in [(&spherical, on_sphere), (&cylindrical, on_cylinder)] {
            let st = mapping.st(&at_point(p));
            assert!((st - Vec2::from(expected)).length() < 1e-6, "{p}: {st}");
        }
    }
    let turned = Affine3A::from_rotation_z(PI / 2.0) * Affine3A::from_scale(Vec3::splat(2.0));
    let planar = Mapping::planar(&turned, [Vec3::X, Vec3::Y * 3.0], Vec2::new(0.5, 0.0));
    let st = planar.st(&at_point(Vec3::new(1.0, 2.0, 7.0)));
    assert!((st - Vec2::new(-3.5, 6.0)).length() < 1e-5, "{st}");
}

/// Gradients against differences of the mapping itself, along the surface.
#[test]
fn gradients_are_those_of_the_mapping() {
    let map = Affine3A::from_rotation_y(0.7)
        * Affine3A::from_scale(Vec3::new(0.5, 2.0, 1.5))
        * Affine3A::from_translation(Vec3::new(0.2, 0.3, -0.1));
    let space = TextureSpace::new(map);
    let vectors = [Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 1.0, -2.0)];
    for mapping in [
        Mapping::Spherical(space),
        Mapping::Cylindrical(space),
        Mapping::planar(&map, vectors, Vec2::ZERO),
    ] {
        let normal = Vec3::new(0.3, -0.5, 0.8).normalize();
        let point = Vec3::new(0.9, 0.7, 0.4);
        let here = TexturePoint {
            normal,
            ..at_point(point)
        };
        let [ds, dt] = mapping.gradients(&here);
        for tangent in [normal.any_orthonormal_vector(), normal.cross(Vec3::X)] {
            let h = 1e-2;
            let st = |side: f32| mapping.st(&at_point(point + tangent * side * h));
            let difference = (st(1.0) - st(-1.0)) / (2.0 * h);
            let expected = Vec2::new(ds.dot(tangent), dt.dot(tangent));
            assert!(
                (difference - expected).length() < 2e-3,
                "{difference} and {expected}"
            );
        }
        assert!(ds.dot(normal).abs() < 1e-5 && dt.dot(normal).abs() < 1e-5);
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

/// Where no octave is wider than a pixel, only the mean is left; without an extent all octaves are.
#[test]
fn octaves_finer_than_a_pixel_are_left_out() {
    let texture = |octaves| {
        FloatTexture::Noise(Arc::new(Noise {
            kind: NoiseKind::Fbm {
                octaves,
                roughness: 0.5,
            },
            space: TextureSpace::WORLD,
        }))
    };
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
        assert!(
            share == 0.0 || (share - PI * 0.35 * 0.35).abs() < 0.02,
            "{share}"
        );
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
